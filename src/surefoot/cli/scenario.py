"""``surefoot scenario``: make a starting scenario, print the schema."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from surefoot.cli.output import AsJson, answer, facts, jsonable, progress

app = typer.Typer(help="Scenario files: make one for a map, print their schema.", rich_markup_mode="rich")


@app.command("init")
def init(
    map_path: Annotated[
        Path,
        typer.Argument(metavar="MAP", help="ROS map_server YAML, or a black-and-white picture.", show_default=False),
    ],
    output: Annotated[Path, typer.Option("-o", "--output", help="The scenario to write.")] = Path("scenario.yaml"),
    cell_size_m: Annotated[
        float, typer.Option("--cell-size", min=0.1, max=100, help="Side of a coarse cell, in metres.")
    ] = 2.70351,
    resolution_m: Annotated[
        float | None, typer.Option("--resolution", min=1e-6, help="Metres per pixel, for a picture without YAML.")
    ] = None,
    robot: Annotated[str, typer.Option(help="Name of the robot.")] = "digit",
    force: Annotated[bool, typer.Option("--force", help="Replace an existing scenario.")] = False,
    as_json: AsJson = False,
) -> None:
    """Write a starting scenario for a map, and a picture of its grid beside it.

    The grid is laid so that many cells are free and connected; start, goals
    and an obstacle are proposed. Edit the file to make it yours: the picture
    shows the cells, and their coordinates in metres.

    Examples:
      surefoot scenario init map.yaml -o my.yaml
      surefoot scenario init floor.png --resolution 0.05 --cell-size 2.0
    """
    from surefoot.missions.scenario_init import init_scenario
    from surefoot.viewer import view_scenario

    with progress() as say:
        made = init_scenario(
            map_path,
            output,
            cell_size_m=cell_size_m,
            resolution_m=resolution_m,
            robot=robot,
            replace=force,
            progress=say,
        )
        say("drawing")
        (picture,) = view_scenario(made.scenario, None)
    checked = {True: "yes", False: "NO", None: "not found out in time"}[made.checked]
    shown = {"picture": picture, "free cells": made.free_cells, "obstacle": made.obstacle, "can be planned": checked}
    lines = [f"Wrote {made.scenario}", *facts(shown), *(f"  note: {note}" for note in made.notes)]
    answer({**jsonable(made), "picture": str(picture)}, lines, yes=True, as_json=as_json)


@app.command("schema")
def schema(as_json: AsJson = False) -> None:
    """Print the JSON Schema of a scenario file (for editors and for other programs).

    Examples:
      surefoot scenario schema > scenario.schema.json
    """
    from surefoot.missions.scenario.file import scenario_schema

    printed = scenario_schema()
    answer(printed, json.dumps(printed, indent=2).splitlines(), yes=True, as_json=as_json)
