"""The time to decide growing specifications, as a picture."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from pathlib import Path

from surefoot.compute import written_whole


def draw_growth(path: Path, members: Sequence[tuple[str, int, float]], limit_s: float) -> None:
    """Draw processor seconds over the size, a line for each family, both axes logarithmic.

    Args:
        path: the picture, PNG or SVG by its ending.
        members: family, size and seconds; infinite for one that was not decided.
        limit_s: how long one was allowed.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 4.5), layout="constrained")
    axes = figure.add_subplot()
    for family in dict.fromkeys(name for name, _, _ in members):
        done = [(size, seconds) for name, size, seconds in members if name == family and isfinite(seconds)]
        failed = [size for name, size, seconds in members if name == family and not isfinite(seconds)]
        (line,) = axes.plot(*zip(*done, strict=True), marker="o", markersize=4, label=family)
        axes.plot(failed, [limit_s] * len(failed), marker="x", linestyle="none", color=line.get_color())
    axes.axhline(limit_s, color="grey", linewidth=0.8, linestyle="--")
    axes.annotate(
        f"limit {limit_s:g} s; x: not decided", (0.01, limit_s), xycoords=("axes fraction", "data"), va="bottom"
    )
    axes.set(xscale="log", yscale="log", xlabel="size of the member", ylabel="processor time to decide [s]")
    axes.set_xticks(sorted({size for _, size, _ in members}))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.minorticks_off()
    axes.legend(loc="upper left", bbox_to_anchor=(0.0, 0.93))
    axes.grid(visible=True, which="major", alpha=0.3)
    with written_whole(path) as stream:
        figure.savefig(stream, format=path.suffix.lstrip(".") or "png", dpi=150)
