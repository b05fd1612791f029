"""What all pictures share: colours that colour-blind people can tell apart, fonts, and how they are saved."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from textwrap import wrap
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from surefoot.compute import written_whole

# Okabe and Ito's palette.
BLACK, ORANGE, SKY, GREEN = "#000000", "#E69F00", "#56B4E9", "#009E73"
YELLOW, BLUE, VERMILION, PURPLE = "#F0E442", "#0072B2", "#D55E00", "#CC79A7"

LEFT, RIGHT = BLUE, VERMILION
FOOT_COLOURS = (BLUE, VERMILION, GREEN, PURPLE)
FOOT_LABELS = ("front left", "front right", "hind left", "hind right")
OBSTACLE, GOAL, BELIEF, BOUND = PURPLE, GREEN, ORANGE, "#555555"
WALL, UNKNOWN, BLOCKED, UNSEEN = "#595959", "#b9b9b9", "#d9d9d9", "#c4ccd4"
REGIONS = (SKY, YELLOW, ORANGE, GREEN, PURPLE, VERMILION, BLUE)

_SETTINGS: dict[Any, Any] = {
    "font.size": 9.0,
    "axes.titlesize": 10.0,
    "axes.labelsize": 9.0,
    "legend.fontsize": 8.5,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "axes.linewidth": 0.8,
    "axes.axisbelow": True,
    "figure.dpi": 100.0,
    "savefig.dpi": 200.0,
    "hatch.linewidth": 0.6,
}

_LEGEND_IN = 0.6
"""The height that pictures reserve for their legend, in inches."""


@contextmanager
def pictured(path: Path, width_in: float, height_in: float) -> Iterator[Figure]:
    """Yield a figure that is saved under a path when the block ends without an error.

    Args:
        path: of the PNG file.
        width_in: width in inches.
        height_in: height in inches.
    """
    with mpl.rc_context(_SETTINGS):
        figure = Figure(figsize=(width_in, height_in), layout="constrained")
        FigureCanvasAgg(figure)
        yield figure
        with written_whole(path) as stream:
            figure.savefig(stream, format="png", metadata={"Software": "surefoot"})


def title(figure: Figure, text: str) -> None:
    """Write a title above all panels of a figure, in as many lines as its width needs."""
    lines = wrap(text, max(24, int(12 * figure.get_figwidth())))
    figure.suptitle("\n".join(lines), fontsize=10)
    _grow(figure, 0.17 * (len(lines) - 1))


def legend_outside(figure: Figure, handles: list[Any], *, columns: int) -> None:
    """Put a legend below all panels of a figure, in as many columns as its width has room for."""
    looks: dict[str, Any] = {"loc": "outside lower center", "frameon": False, "handletextpad": 0.6}
    for count in range(columns, 0, -1):
        legend = figure.legend(handles=handles, ncols=count, **looks)
        extent = legend.get_window_extent(FigureCanvasAgg(figure).get_renderer())  # type: ignore[no-untyped-call]
        if extent.width <= figure.bbox.width or count == 1:
            break
        legend.remove()
    _grow(figure, extent.height / figure.dpi - _LEGEND_IN)


def _grow(figure: Figure, inches: float) -> None:
    """Make a figure higher, so that its panels keep their size."""
    if inches > 0:
        figure.set_figheight(figure.get_figheight() + inches)


def light_grid(axes: Axes) -> None:
    """Give a panel thin grid lines and no box."""
    axes.grid(visible=True, color="#e6e6e6", linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)
