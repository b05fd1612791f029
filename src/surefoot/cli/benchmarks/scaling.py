"""``surefoot bench scaling``: how navigation games grow."""

from __future__ import annotations

from pathlib import Path

from surefoot.cli.output import Say, answer


def answer_scaling(say: Say, picture: Path | None, *, as_json: bool) -> None:
    """Measure games of growing halls, draw them if a picture is asked for, and end the command."""
    from surefoot.navigation.scaling import growth

    rows = tuple(growth(say))
    if picture is not None:
        from surefoot.viewer.studies.scaling import draw_scaling

        draw_scaling(rows, picture)
    lines = [f"{'grows':<10}{'size':>6}{'cells':>7}{'obstacles':>11}{'turns':>12}{'CPU [s]':>9}{'peak [MB]':>11}"]
    for row in rows:
        head = f"{row.along:<10}{row.size:>6}{row.cells:>7}{row.obstacles:>11}"
        known = row.turns is not None
        lines.append(head + (f"{row.turns:>12,}{row.total_s:>9.2f}{row.peak_mb:>11.0f}" if known else f"  {row.limit}"))
    answer({"rows": rows}, lines, yes=True, as_json=as_json)
