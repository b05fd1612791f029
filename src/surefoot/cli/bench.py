"""``surefoot bench``: the benchmarks, one table."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING, Annotated

import typer

from surefoot.cli.bench_regions import answer_table_1, region_figures
from surefoot.cli.output import AsJson, answer, progress

if TYPE_CHECKING:
    from surefoot.missions.benchmarks import Figure


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
    from surefoot.missions.benchmarks import benchmarks

    with progress() as say:
        if which is Which.TABLE1:
            answer_table_1(say, as_json=as_json)
        figures = (
            ()
            if which in {Which.FOOTHOLDS, Which.REGIONS, Which.TERRAIN, Which.SYNTHESIS}
            else benchmarks(which.value, say)
        )
        if which in {Which.REGIONS, Which.ALL}:
            figures += tuple(region_figures(say))
        if which in {Which.FOOTHOLDS, Which.ALL}:
            from surefoot.cli.bench_footholds import foothold_figures

            figures += tuple(foothold_figures(say))
        if which in {Which.TERRAIN, Which.ALL}:
            from surefoot.cli.bench_terrain import terrain_figures

            figures += tuple(terrain_figures(say))
        if which in {Which.SYNTHESIS, Which.ALL}:
            from surefoot.cli.bench_synthesis import synthesis_figures

            figures += tuple(synthesis_figures(say))
    met = all(figure.met is not False for figure in figures)
    answer({"figures": figures, "met": met}, _table(figures), yes=met, as_json=as_json)


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
