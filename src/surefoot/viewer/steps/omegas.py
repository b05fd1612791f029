"""Which omegas may be held in every cell of a step's regions."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot.reach import Region
from surefoot.reach.synthesis import HalfStep
from surefoot.viewer import style


def draw_omegas(region: Region, path: Path) -> Path:
    """Draw the lowest and the highest winning omega of every cell, one row of panels for each half step.

    Where a region keeps only the first winning omega of a cell, both are the same.

    Args:
        region: of a step.
        path: of the PNG file.
    """
    x0, x1 = region.cells.x_edges()
    v0, v1 = region.cells.v_edges()
    extent = (x0[0], x1[-1], v0[0], v1[-1])
    halves = {"first half": region.first, "second half": region.second}
    bounds = {name: _bounds(half) for name, half in halves.items()}
    values = [value for half in halves.values() for value in half.omegas_radps]
    with style.pictured(path, 8.4, 6.2) as figure:
        panels = figure.subplots(2, 2, sharex=True, sharey=True)
        for row, (name, pair) in zip(panels, bounds.items(), strict=True):
            for axes, shown, which in zip(row, pair, ("lowest", "highest"), strict=True):
                looks: dict[str, Any] = {"vmin": min(values), "vmax": max(values), "cmap": "viridis"}
                image = axes.imshow(shown.T, origin="lower", extent=extent, aspect="auto", **looks)
                axes.set_title(f"{name}: {which} winning omega")
                style.light_grid(axes)
        for axes in panels[1]:
            axes.set_xlabel("CoM position along the heading [m]")
        for axes in panels[:, 0]:
            axes.set_ylabel("CoM velocity [m/s]")
        figure.colorbar(image, ax=panels, label="omega [rad/s]", shrink=0.8)
    return path


def _bounds(half: HalfStep) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the lowest and the highest winning omega of every cell; not a number where there is none."""
    lowest, highest = (np.full(half.masks.shape[:2], np.nan) for _ in range(2))
    for number in np.argsort(half.omegas_radps).tolist():
        omega = half.omegas_radps[number]
        wins = (half.masks[:, :, number // 64] >> np.uint64(number % 64)) & np.uint64(1) == 1
        lowest[wins & np.isnan(lowest)] = omega
        highest[wins] = omega
    return lowest, highest
