"""``surefoot view``: pictures, pages, live views and recordings of whatever Surefoot made."""

from __future__ import annotations

import sys
from contextlib import suppress
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from surefoot.cli.output import AsJson, answer, to_write
from surefoot.errors import InputError

if TYPE_CHECKING:
    from surefoot.viewer.maps.answers import Asked


class BodyChoice(StrEnum):
    """The bodies of robots on pages."""

    SIMPLE = "simple"
    MESHES = "meshes"


class Heading(StrEnum):
    """The directions of the grid."""

    NORTH = "north"
    EAST = "east"
    SOUTH = "south"
    WEST = "west"


def view(
    path: Annotated[
        Path, typer.Argument(help="A run, a plan or a library of skills (folders), or a file.", show_default=False)
    ],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="The folder for the pictures; default: that folder.")
    ] = None,
    cell: Annotated[
        str | None,
        typer.Option(metavar="R,C", help="Of a plan: what the strategy does in this cell, for every belief."),
    ] = None,
    heading: Annotated[Heading | None, typer.Option(help="With this heading; default: the commonest there.")] = None,
    goal: Annotated[int | None, typer.Option(min=0, help="On the way to this goal; default: the commonest.")] = None,
    step: Annotated[
        int | None, typer.Option(min=0, help="Of a biped's run: this step, its push and the strategy around it.")
    ] = None,
    html: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            callback=to_write(".html", ".htm"),
            help="Write a page: a run or footholds in motion, a strategy to ask.",
        ),
    ] = None,
    body: Annotated[
        BodyChoice | None,
        typer.Option(help="Of --html: the robot's body; default: its own meshes if installed, else simple."),
    ] = None,
    mcap: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", callback=to_write(".mcap"), help="Record it as ROS 2 messages, for Foxglove and rosbag2."
        ),
    ] = None,
    follow: Annotated[
        bool,
        typer.Option(
            "--follow",
            "--live",
            help="Serve a run while it is walked, or a plan's strategy, to this machine's browsers until Ctrl-C.",
        ),
    ] = False,
    port: Annotated[
        int | None, typer.Option(min=1024, max=65535, help="Of --follow: listen there; default: any free port.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Draw a run, a plan, a scenario, ground, footholds, regions or skills; show them in the browser; record them.

    Without an option it draws pictures. What cannot be shown in a way says
    in which ways it can.

    Examples:
      surefoot view run/
      surefoot view run/ --html replay.html
      surefoot view run/ --html replay.html --body meshes
      surefoot view run/ --mcap run.mcap
      surefoot view run/ --follow --port 8080
      surefoot view run/ --step 12
      surefoot view plan/ -o pictures/
      surefoot view plan/ --html strategy.html
      surefoot view plan/ --live
      surefoot view strategy.json --html strategy.html
      surefoot view footholds.json --html footholds.html
      surefoot view plan/ --cell 3,4 --heading west --goal 1
      surefoot view my.yaml
      surefoot view terrain.yaml -o pictures/

    Exit code 0: drawn, written, or looked at; 2: the input cannot be used.
    """
    from surefoot.viewer import view_answers, view_folder, view_step

    if cell is None and (heading is not None or goal is not None):
        raise InputError("--heading and --goal belong to --cell R,C; give all or none of them")
    if port is not None and not follow:
        raise InputError("--port belongs to --follow; give both or only --follow")
    if body is not None and html is None:
        raise InputError("--body belongs to --html; give both or none")
    _one_way(follow=follow, page=html is not None or mcap is not None, step=step is not None, cell=cell is not None)
    if output is not None and (follow or html is not None or mcap is not None):
        raise InputError("-o names a folder for pictures; --html and --mcap name their files, and --follow writes none")
    if follow:
        _follow(path, port, as_json=as_json)
    if html is not None or mcap is not None:
        _write(path, html, body, mcap, as_json=as_json)
    if step is not None:
        pictures = view_step(path, step, output)
    elif cell is not None:
        pictures = view_answers(path, _asked(cell, heading, goal), output)
    else:
        pictures = view_folder(path, output)
    answer({"pictures": pictures}, [str(picture) for picture in pictures], yes=True, as_json=as_json)


def _one_way(*, follow: bool, page: bool, step: bool, cell: bool) -> None:
    """Refuse several ways to look at once."""
    ways = {"--follow": follow, "--html and --mcap": page, "--step": step, "--cell": cell}
    given = [name for name, wanted in ways.items() if wanted]
    if len(given) > 1:
        raise InputError(f"{', '.join(given)} are different ways to look; give one of them")


def _write(path: Path, html: Path | None, body: BodyChoice | None, mcap: Path | None, *, as_json: bool) -> None:
    """Write a page, a recording, or both; what had to be drawn otherwise than it was planned is said."""
    from surefoot.viewer import view_bag, view_page

    written: dict[str, object] = {}
    remarks: list[str] = []
    if html is not None:
        written["page"] = view_page(path, html, body, remarks.append)
    if mcap is not None:
        written["recording"] = view_bag(path, mcap, remarks.append)
    lines = [f"Wrote {file}" for file in written.values()]
    answer({**written, "remarks": remarks}, [*lines, *dict.fromkeys(remarks)], yes=True, as_json=as_json)


def _follow(path: Path, port: int | None, *, as_json: bool) -> None:
    """Serve a run, or the strategy of a plan, until the user has seen enough."""
    from surefoot.viewer import kinds
    from surefoot.viewer.live.strategy import serve_strategy
    from surefoot.viewer.live.view import follow

    def say(address: str) -> None:
        print(f"open {address} with a browser of this machine; Ctrl-C ends the view", file=sys.stderr, flush=True)

    serve = serve_strategy if kinds.demand(path, "--follow") is kinds.PLAN else follow
    with suppress(KeyboardInterrupt):
        serve(path, port, say)
    answer({"followed": path}, ["The view has ended"], yes=True, as_json=as_json)


def _asked(cell: str, heading: Heading | None, goal: int | None) -> Asked:
    """Return the robot state that was asked about."""
    from surefoot.frames import Cell, Direction
    from surefoot.viewer.maps.answers import Asked

    parts = cell.split(",")
    if len(parts) != 2 or not all(part.strip().isdecimal() and len(part) < 9 for part in parts):
        raise InputError(f"--cell {cell!r} is no cell; allowed are a row and a column, such as 3,4")
    row, column = map(int, parts)
    return Asked(Cell(row, column), None if heading is None else Direction[heading.name], goal)
