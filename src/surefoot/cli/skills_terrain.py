"""``surefoot skills terrain|classes|physics``: where a quadruped walks, how cells are classed, what its body can do."""

from __future__ import annotations

import json
import re
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from surefoot.cli.failures import ExitCode
from surefoot.cli.output import PICTURES, AsJson, answer, counted, facts, jsonable, progress, to_write

if TYPE_CHECKING:
    from surefoot.skills.classes import ClassSet
    from surefoot.skills.quadruped_terrain import QuadrupedTerrain
    from surefoot.skills.values import CheckResult, Primitive

app = typer.Typer(help="Skills: terrain classes, and what physics lets a robot do on them.", rich_markup_mode="rich")


@app.command("terrain")
def terrain(
    scene: Annotated[
        str,
        typer.Argument(
            metavar="SCENE",
            help="unstructured-4, unstructured-8, rebar-7, rebar-14, zig-zag; or a file: the terrain of a quadruped, "
            "or what `surefoot terrain segment` wrote.",
            show_default=False,
        ),
    ],
    seed: Annotated[int, typer.Option(min=0, help="Of what is drawn; the same seed gives the same terrain.")] = 0,
    grid: Annotated[str, typer.Option(help="Rows and columns of the local grid, for scenes.")] = "3x3",
    classes: Annotated[
        str, typer.Option(help="The set of classes, for segmented terrains, which name none.")
    ] = "unstructured-8",
    yaw: Annotated[bool, typer.Option("--yaw", help="The robot turns in place, by 90 degrees.")] = False,
    no_sideways: Annotated[
        bool, typer.Option("--no-sideways", help="With --yaw: it walks forward and backward only.")
    ] = False,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", callback=to_write(".yaml", ".yml"), help="The terrain file to write."),
    ] = None,
    plot: Annotated[
        Path | None, typer.Option("--plot", callback=to_write(*PICTURES), help="A picture (PNG): polygons and classes.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Make or read the terrain of a quadruped, and say which terrain states its map holds.

    Examples:
      surefoot skills terrain unstructured-8 --seed 3 -o terrain.yaml --plot terrain.png
      surefoot skills terrain rebar-14 --grid 5x5 -o terrain.yaml
      surefoot skills terrain zig-zag --yaw --no-sideways -o zig-zag.yaml
      surefoot skills terrain stairs.json --classes unstructured-8 --plot terrain.png

    Obstacles are told with the measures that decide; `surefoot terrain lay`
    proposes cells that fit a scan.

    Exit code 0: there are places to stand; 1: every cell is an obstacle; 2: the
    terrain cannot be used.
    """
    from surefoot.cli.obstacle_words import obstacle_lines, obstacles_of
    from surefoot.skills.grid import terrain_set
    from surefoot.skills.terrain_file import write_terrain

    made = _turning(_terrain(scene, seed, grid, classes), yaw, no_sideways)
    begin = time.perf_counter()
    obstacles = obstacles_of(made)
    stands = len(obstacles) < len(made.measured)
    states = terrain_set(made) if stands else None
    taken = time.perf_counter() - begin
    if output is not None:
        write_terrain(output, made)
    if plot is not None:
        from surefoot.viewer.terrain.classes import draw_quadruped_terrain

        draw_quadruped_terrain(made, plot)
    grids = () if states is None else states.states
    labels = Counter(label for state in grids for row in state.labels for label in row)
    shown = {
        "robot": made.robot,
        "classes": made.classes.name,
        "polygons": len(made.polygons),
        "cells": list(made.cells),
        "grid": list(made.grid),
        "yaw": made.yaw,
        "directions": [way.value for way in made.directions],
        "terrain_states": len(grids),
        "pairs": 0 if states is None else len(states.pairs()),
        "labels": dict(sorted(labels.items())),
        "time_s": taken,
    }
    lines = [f"{made.name}" + (f", in {output}" if output else ""), *facts({**shown, "labels": _counted(labels)})]
    lines += obstacle_lines(obstacles, len(made.measured))
    if not stands:
        lines.append("  the robot can stand in none of them; `surefoot terrain lay` proposes cells that fit a scan")
    files = [str(file) for file in (output, plot) if file is not None]
    answer({"name": made.name, **shown, "obstacles": obstacles, "files": files}, lines, yes=stands, as_json=as_json)


def _terrain(scene: str, seed: int, grid: str, classes: str) -> QuadrupedTerrain:
    from surefoot.errors import InputError
    from surefoot.skills.terrain_file import read_terrain
    from surefoot.skills.terrains import SCENES, generated

    if scene not in SCENES and (Path(scene).suffix or "/" in scene):
        return read_terrain(Path(scene), classes=classes)
    sides = re.fullmatch(r"(\d{1,2})x(\d{1,2})", grid)
    if sides is None:
        raise InputError(f"needs two odd numbers such as 3x3 or 5x5, not {grid!r}", key="grid")
    return generated(scene, seed, grid=(int(sides[1]), int(sides[2])))


def _turning(made: QuadrupedTerrain, yaw: bool, no_sideways: bool) -> QuadrupedTerrain:
    """Return a terrain whose robot turns in place, if that is asked for."""
    from dataclasses import replace

    from surefoot.errors import InputError
    from surefoot.skills.values import Direction

    if no_sideways and not (yaw or made.yaw):
        raise InputError("is a choice for a robot that turns: give --yaw too", key="--no-sideways")
    ways = (Direction.FORWARD, Direction.BACKWARD)
    return replace(made, yaw=yaw or made.yaw, directions=ways if no_sideways else made.directions)


def _counted(counts: Counter[str]) -> list[str]:
    return [f"{name} {count}" for name, count in counts.most_common()]


@app.command("classes")
def classes(
    name: Annotated[
        str, typer.Argument(metavar="SET", help="A set of classes, or a file of rules.", show_default=False)
    ],
    plot: Annotated[
        Path | None, typer.Option("--plot", callback=to_write(*PICTURES), help="A picture (PNG) of every class.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Show a set of terrain classes: what they are, and the worst case that physics certifies.

    Rules that leave ground without a class, or that give it two, are refused.

    Examples:
      surefoot skills classes unstructured-8 --plot classes.png
      surefoot skills classes my_rules.yaml --json
    """
    shown = class_set_of(name)
    if plot is not None:
        from surefoot.viewer.terrain.classes import draw_classes

        draw_classes(shown, plot)
    value = {
        "name": shown.name,
        "robot": shown.robot,
        "cell_m": shown.cell_m,
        "margin_m": shown.margin_m,
        "classes": {one.name: {"about": one.about, **one.ground.model_dump()} for one in shown.classes.values()},
        "easy": shown.easy,
        "digest": shown.digest,
        "files": [str(plot)] if plot is not None else [],
    }
    head = f"{shown.name}: {len(shown.classes)} classes for {shown.robot}, cells of {shown.cell_m:g} m"
    answer(value, [head, *facts({one.name: one.about for one in shown.classes.values()})], yes=True, as_json=as_json)


def class_set_of(name: str) -> ClassSet:
    """Return a set of classes by its name, or the one of a file of rules."""
    from surefoot.errors import InputError
    from surefoot.skills.classes import class_set, read_classes

    if not Path(name).suffix:
        return class_set(name)
    sets = read_classes(Path(name))
    if len(sets) != 1:
        raise InputError(f"holds {len(sets)} sets of classes: {', '.join(sets)}; one is allowed", source=name)
    return next(iter(sets.values()))


@app.command("physics")
def physics(
    name: Annotated[
        str, typer.Argument(metavar="SET", help="A set of classes, or a file of rules.", show_default=False)
    ],
    primitives: Annotated[
        list[str] | None,
        typer.Argument(metavar="[PRIMITIVE]...", help="Such as 'forward flat->gap'; none: all.", show_default=False),
    ] = None,
    gait: Annotated[
        list[str] | None,
        typer.Option(help="Tried in order: trot-2s, leap-1.5s, ..., free-1.5s; may be repeated. Default: the trots."),
    ] = None,
    start: Annotated[bool, typer.Option("--start", help="Only the pairs that the set calls easy.")] = False,
    cell_m: Annotated[float | None, typer.Option("--cell", help="Side of a cell in metres.", min=0.1, max=5)] = None,
    deadline_s: Annotated[
        float | None, typer.Option("--deadline", help="For all checks together, in seconds.", min=0)
    ] = None,
    workers: Annotated[int | None, typer.Option(help="Processes; default: one per core.", min=1, max=256)] = None,
    why: Annotated[bool, typer.Option("--why/--no-why", help="Explain what is infeasible, which takes time.")] = False,
    plot: Annotated[
        Path | None,
        typer.Option("--plot", callback=to_write(*PICTURES), help="A picture (PNG): from which class to which."),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Ask physics which primitives a gait can do, on the worst cases of the classes.

    Examples:
      surefoot skills physics unstructured-4 'forward flat->gap' --gait trot-2s --gait leap-1.5s --why
      surefoot skills physics unstructured-8 --plot physics.png
      surefoot skills physics rebar-14 --start --json

    Exit code 0: all are feasible; 1: some are not; 3: some stayed unknown.
    """
    from surefoot.skills.physics import INITIAL_GAITS, Limits, PhysicsOfClasses, all_primitives, start_primitives
    from surefoot.skills.values import Physics, Primitive

    rules = class_set_of(name)
    asked: Sequence[Primitive] = [Primitive.parse(one) for one in primitives or ()]
    asked = asked or (start_primitives(rules) if start else all_primitives(rules))
    limits = Limits(gaits=tuple(gait or INITIAL_GAITS), deadline_s=deadline_s, explain=why)
    checks = PhysicsOfClasses(rules, cell_m=cell_m, limits=limits, workers=workers)
    begin = time.perf_counter()
    results: list[CheckResult] = []
    with progress() as say:
        say(f"checking {counted(len(asked), 'primitive')} of {rules.name}")
        for one in checks(asked):
            results.append(one)
            if len(results) % 25 == 0:
                say(f"{len(results)} of {len(asked)} checked")
    taken = time.perf_counter() - begin
    results.sort(key=lambda one: one.primitive)
    if plot is not None:
        from surefoot.viewer.terrain.classes import draw_physics

        draw_physics(rules, results, plot)
    value = _summary(results, taken) | {"files": [str(plot)] if plot is not None else []}
    if any(one.verdict is Physics.UNKNOWN for one in results):
        print(json.dumps(jsonable(value)) if as_json else "\n".join(_lines(results, value)))
        raise typer.Exit(int(ExitCode.UNKNOWN))
    yes = all(one.verdict is Physics.FEASIBLE for one in results)
    answer(value, _lines(results, value), yes=yes, as_json=as_json)


@app.command("schema")
def schema(as_json: AsJson = False) -> None:
    """Print the JSON Schema of the terrain of a quadruped (for editors and for other programs).

    Examples:
      surefoot skills schema > terrain.schema.json
    """
    from surefoot.skills.terrain_file import terrain_schema

    printed = terrain_schema()
    answer(printed, json.dumps(printed, indent=2).splitlines(), yes=True, as_json=as_json)


def _summary(results: Sequence[CheckResult], taken_s: float) -> dict[str, Any]:
    verdicts = Counter(one.verdict.value for one in results)
    gaits = Counter(one.gait for one in results if one.verdict.value == "feasible")
    times = [one.time_s for one in results]
    return {
        "checks_feasible": verdicts["feasible"],
        "checks_infeasible": verdicts["infeasible"],
        "checks_unknown": verdicts["unknown"],
        "gaits": dict(sorted(gaits.items())),
        "time_s": taken_s,
        "mean_check_s": sum(times) / max(len(times), 1),
        "max_check_s": max(times, default=0.0),
        "checks": [
            {
                "primitive": one.primitive.name,
                "verdict": one.verdict.value,
                "gait": one.gait,
                "explanation": one.explanation or None,
                "horizon_s": one.horizon_s,
                "cost": one.cost,
                "time_s": one.time_s,
            }
            for one in results
        ],
    }


def _lines(results: Sequence[CheckResult], value: dict[str, Any]) -> list[str]:
    told = {key: value[key] for key in ("checks_feasible", "checks_infeasible", "checks_unknown", "time_s")}
    told |= {"slowest check [s]": value["max_check_s"]}
    each = [
        f"  {one.primitive.name}: {one.verdict.value}"
        + (f" ({one.gait})" if one.verdict.value == "feasible" else f" ({one.explanation})" if one.explanation else "")
        for one in results
    ]
    return [counted(len(results), "primitive"), *facts(told), *(each if len(results) <= 64 else [])]
