"""Tables of benchmarks, as text."""

from __future__ import annotations

from collections.abc import Sequence
from io import StringIO
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from surefoot.missions.bench.figures import Figure

_WIDTH = 120


def figure_table(figures: Sequence[Figure]) -> list[str]:
    """Return the lines of a table of figures, beside their targets and the paper's numbers."""
    met = {True: "yes", False: "NO", None: ""}
    cells = [(one.what, one.measured_text, one.target_text, one.paper, met[one.met]) for one in figures]
    return plain_table("Surefoot benchmarks", ("what", "measured", "target", "paper", "met"), cells, left=(0, 3, 4))


def plain_table(
    title: str, head: Sequence[str], rows: Sequence[Sequence[str]], *, left: Sequence[int] = (0, 1)
) -> list[str]:
    """Return the lines of a table.

    Args:
        title: above it.
        head: names of the columns.
        rows: their cells.
        left: columns that are aligned to the left.
    """
    from rich.console import Console
    from rich.table import Table

    table = Table(title=title, title_justify="left")
    for number, name in enumerate(head):
        table.add_column(name, justify="left" if number in left else "right")
    for row in rows:
        table.add_row(*row)
    text = StringIO()
    Console(file=text, width=_WIDTH).print(table)
    return text.getvalue().splitlines()
