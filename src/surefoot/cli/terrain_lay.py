"""``surefoot terrain lay``: cells over a segmented scan, so that a quadruped's mission can be run on it."""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from surefoot.cli.output import PICTURES, AsJson, answer, facts, to_write
from surefoot.cli.run_quadruped import place

if TYPE_CHECKING:
    from surefoot.skills.blocking import Barrier
    from surefoot.skills.classes import ClassSet
    from surefoot.skills.laid_cells import Lay


def lay(
    scan: Annotated[
        Path, typer.Argument(metavar="TERRAIN", help="What `surefoot terrain segment` wrote.", show_default=False)
    ],
    classes: Annotated[
        list[str] | None,
        typer.Option(help="A set of classes to try, or a file of rules; repeatable. Default: unstructured-8, stairs."),
    ] = None,
    cell_m: Annotated[
        float | None, typer.Option("--cell", help="Side of a cell in metres; default: what fits best.", min=0.1, max=5)
    ] = None,
    yaw_deg: Annotated[
        float | None,
        typer.Option(
            "--yaw", help="Heading of the robot on the scan, in degrees; default: up the steps, or to the goal."
        ),
    ] = None,
    start: Annotated[
        str | None, typer.Option(metavar="X,Y", help="Where the robot starts, in metres of the scan.")
    ] = None,
    goal: Annotated[str | None, typer.Option(metavar="X,Y", help="Where it is to go, in metres of the scan.")] = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", callback=to_write(".yaml", ".yml"), help="The terrain file (YAML) to write."),
    ] = None,
    plot: Annotated[
        Path | None, typer.Option("--plot", callback=to_write(*PICTURES), help="A picture (PNG): polygons and classes.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Lay cells over a scan so that edges of steps and stones fall on their sides.

    Heading, side and offset of the cells are chosen so that the rules of the
    classes leave the most ground to walk on, or a way from start to goal; of
    nearly equal ones the largest cells. `surefoot run` takes the file that is
    written. Its frame is turned against the scan by the angle that is shown;
    x leads up the steps. Low ground that higher ground closes, such as the
    floor between stepping stones, is left out: the robot steps over it.

    Examples:
      surefoot terrain lay stairs.json --start 1.2,0.8 --goal 0.34,0.7 -o mission.yaml --plot mission.png
      surefoot run mission.yaml -o run/
      surefoot terrain lay stones.json --classes unstructured-8 --cell 0.6 --json

    Exit code 0: there is a way from start to goal by the rules of the classes;
    1: there is none, and what is in the way is told; 2: bad input.
    """
    from surefoot.skills.blocking import barriers
    from surefoot.skills.terrain_file import write_terrain

    begin = time.perf_counter()
    laid, tried = _laid(scan, classes, cell_m, yaw_deg, start, goal, output)
    terrain = laid.terrain
    ends = [None if one is None else terrain.cell_at(one) for one in (terrain.start_m, terrain.goal_m)]
    blocked = barriers(terrain, ends[0], ends[1]) if ends[0] is not None and ends[1] is not None else ()
    taken = time.perf_counter() - begin
    if output is not None:
        write_terrain(output, terrain)
    if plot is not None:
        from surefoot.viewer.terrain.classes import draw_quadruped_terrain

        draw_quadruped_terrain(terrain, plot)
    files = [str(file) for file in (output, plot) if file is not None]
    given = start is not None and goal is not None
    _say(laid, blocked, {"lattices_measured": tried, "time_s": taken}, files, given=given, as_json=as_json)


def _laid(
    scan: Path,
    classes: list[str] | None,
    cell_m: float | None,
    yaw_deg: float | None,
    start: str | None,
    goal: str | None,
    output: Path | None,
) -> tuple[Lay, int]:
    import math
    from dataclasses import replace

    from surefoot.compute import sha256_of
    from surefoot.errors import InputError
    from surefoot.skills.laying import Wish, lay_cells
    from surefoot.skills.quadruped_terrain import Laid
    from surefoot.skills.segmented import read_segmented

    if yaw_deg is not None and not math.isfinite(yaw_deg):
        raise InputError("needs a finite number of degrees", key="--yaw")
    ground = read_segmented(scan)
    sets = tuple(_set(name) for name in classes or ("unstructured-8", "stairs"))
    wish = Wish(
        sets,
        cell_m,
        None if yaw_deg is None else math.radians(yaw_deg),
        place(start, "--start"),
        place(goal, "--goal"),
        name=scan.stem,
    )
    margin = sets[0].margin_m if ground.margin_m is None else ground.margin_m
    laid, tried = lay_cells(ground.polygons, margin, wish)
    folder = (output or Path()).resolve().parent if output is not None else Path.cwd()
    assert laid.terrain.laid is not None
    named = Laid(laid.terrain.laid.yaw_deg, os.path.relpath(scan.resolve(), folder), sha256_of(scan))
    changed = replace(laid.terrain, laid=named)
    vars(changed)["measured"] = laid.terrain.measured  # the cached property
    return replace(laid, terrain=changed), tried


def _set(name: str) -> ClassSet:
    from surefoot.cli.skills_terrain import class_set_of

    return class_set_of(name)


def _say(
    laid: Lay, blocked: tuple[Barrier, ...], measured: dict[str, Any], files: list[str], *, given: bool, as_json: bool
) -> None:
    from surefoot.cli.obstacle_words import barrier_lines, obstacle_lines, obstacles_of

    terrain = laid.terrain
    assert terrain.laid is not None
    obstacles = obstacles_of(terrain)
    shown = {
        "classes": terrain.classes.name,
        "cell_m": terrain.cell_m,
        "yaw_deg": terrain.laid.yaw_deg,
        "origin_m": list(terrain.origin_m),
        "cells": list(terrain.cells),
        "polygons": len(terrain.polygons),
        "left_out": len(laid.left_out),
        "standing": len(laid.standing),
        "connected": len(laid.part),
        "start_m": None if terrain.start_m is None else list(terrain.start_m),
        "goal_m": None if terrain.goal_m is None else list(terrain.goal_m),
        **measured,
    }
    yes = laid.arrives and not blocked
    head = "There is a way" if yes else "There is NO way by the rules of the classes"
    lines = [
        f"{head} from start to goal, on cells of {terrain.cell_m:g} m ({terrain.classes.name})",
        *facts(shown),
        *([] if given else [_ends(laid)]),
        *barrier_lines(blocked),
        *obstacle_lines(obstacles, len(terrain.measured)),
    ]
    value = {"way": yes, **shown, "blocked_by": blocked, "obstacles": obstacles, "files": files}
    answer(value, lines, yes=yes, as_json=as_json)


def _ends(laid: Lay) -> str:
    """Return how start and goal were chosen, where the user did not give both, and what that leaves out."""
    part, beside = len(laid.part), len(laid.standing) - len(laid.part)
    if not part:
        return "  nobody can stand in any cell, so there is neither start nor goal"
    if part == 1:
        return "  there is one cell to stand in, for start and goal alike"
    left = f"; no way was looked for to the other {beside} in which one can stand" if beside else ""
    return f"  what was not given of start and goal was chosen among the {part} connected cells{left}"
