"""The parts of ``surefoot bench`` that concern controllable regions: ``regions`` and ``table1``."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from surefoot.cli.output import answer, facts

if TYPE_CHECKING:
    from surefoot.missions.bench.figures import Figure

Say = Callable[[str], None]


def region_figures(say: Say) -> Iterator[Figure]:
    """Measure the room of controllable regions."""
    from surefoot.missions.bench.figures import Figure
    from surefoot.reach.benchmarks import measure

    for one in measure(say):
        bound = "at most" if one.at_most else "at least"
        yield Figure(one.what, one.value, one.unit, one.target, bound, one.paper)  # type: ignore[arg-type]


def answer_table_1(say: Say, *, as_json: bool) -> None:
    """Repeat Table I and answer whether its mean is within two points of the paper's, and ours at least 97 %."""
    from surefoot.reach.benchmarks import table

    found = table(say)
    mean, ours, paper = (
        float(str(found[key])) for key in ("table_mean_percent", "barrier_mean_percent", "paper_mean_percent")
    )
    met = abs(mean - paper) <= 2 and ours >= 97
    lines = [
        f"Table I, {found['runs']} runs per cell; reading: {found['reading']}",
        *_rows(found),
        *facts(
            {
                "mean, table law (paper's criterion) [%]": f"{mean:.1f}",
                "mean, paper [%]": f"{paper:.1f}",
                "mean, barrier-aware law [%]": f"{ours:.1f}",
            }
        ),
    ]
    answer({**found, "met": met}, lines, yes=met, as_json=as_json)


def _rows(found: dict[str, object]) -> list[str]:
    from surefoot.reach.ensembles import TableCell

    rows = ["  window [m/s]  length [m]  table law  paper  barrier law  table law, any instant"]
    columns = [found["table"], found["barrier"], found["random_instant"]]
    for cells in zip(*columns, strict=True):
        table, barrier, anytime = cells
        if isinstance(table, TableCell):
            window = f"{table.window_mps[0]:g}-{table.window_mps[1]:g}"
            rows.append(
                f"  {window:<12}  {table.step_length_m:<10g}  {table.percent:<9.1f}  {table.paper_percent:<5.1f}  "
                f"{barrier.percent:<11.1f}  {anytime.percent:.1f}"
            )
    return rows
