"""``surefoot bench``: the benchmarks, one table."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from enum import StrEnum
from functools import partial
from typing import TYPE_CHECKING, Annotated

import typer

from surefoot.cli.bench_regions import answer_table_1, region_figures
from surefoot.cli.output import AsJson, Say, answer, progress

if TYPE_CHECKING:
    from surefoot.missions.benchmarks import Figure

Suite = Callable[[Say], "Iterable[Figure]"]


class Which(StrEnum):
    """What to measure."""

    ALL = "all"
    WALKING = "walking"
    NAVIGATION = "navigation"
    ACTION = "action"
    MISSION = "mission"
    FOOTHOLDS = "footholds"
    REGIONS = "regions"
    TERRAIN = "terrain"
    TABLE1 = "table1"
    SYNTHESIS = "synthesis"


def bench(
    which: Annotated[Which, typer.Argument(help="What to measure.")] = Which.ALL,
    as_json: AsJson = False,
) -> None:
    """Measure speed and memory, walk a campaign, and compare with the paper and with the targets.

    Examples:
      surefoot bench
      surefoot bench navigation --json

    Exit code 0: every target is met; 1: some is missed.
    """
    with progress() as say:
        if which is Which.TABLE1:
            answer_table_1(say, as_json=as_json)
        figures = tuple(figure for suite in _suites(which) for figure in suite(say))
    met = all(figure.met is not False for figure in figures)
    answer({"figures": figures, "met": met}, _table(figures), yes=met, as_json=as_json)


def _suites(which: Which) -> tuple[Suite, ...]:
    """Return the functions that measure what was asked for."""
    suites: dict[Which, Suite] = {
        Which.REGIONS: region_figures,
        Which.FOOTHOLDS: _footholds,
        Which.TERRAIN: _terrain,
        Which.SYNTHESIS: _synthesis,
    }
    if which in suites:
        return (suites[which],)
    return (partial(_biped, which.value), *(suites.values() if which is Which.ALL else ()))


def _biped(which: str, say: Say) -> Iterable[Figure]:
    from surefoot.missions.benchmarks import benchmarks

    return benchmarks(which, say)


def _footholds(say: Say) -> Iterable[Figure]:
    from surefoot.cli.bench_footholds import foothold_figures

    return foothold_figures(say)


def _terrain(say: Say) -> Iterable[Figure]:
    from surefoot.cli.bench_terrain import terrain_figures

    return terrain_figures(say)


def _synthesis(say: Say) -> Iterable[Figure]:
    from surefoot.cli.bench_synthesis import synthesis_figures

    return synthesis_figures(say)


def _table(figures: tuple[Figure, ...]) -> list[str]:
    from io import StringIO

    from rich.console import Console
    from rich.table import Table

    table = Table(title="Surefoot benchmarks", title_justify="left")
    for name, side in [
        ("what", "left"),
        ("measured", "right"),
        ("target", "right"),
        ("paper", "left"),
        ("met", "left"),
    ]:
        table.add_column(name, justify=side)  # type: ignore[arg-type]
    for figure in figures:
        met = {True: "yes", False: "NO", None: ""}[figure.met]
        table.add_row(figure.what, figure.measured_text, figure.target_text, figure.paper, met)
    text = StringIO()
    Console(file=text, width=120).print(table)
    return text.getvalue().splitlines()
