"""Time and memory of navigation games against cells, obstacles and regions, as a picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from surefoot.navigation.scaling import Growth
from surefoot.viewer import style

_LABELS = {"cells": "free cells (1 obstacle)", "obstacles": "obstacles", "regions": "belief regions"}


def draw_scaling(rows: Sequence[Growth], path: Path) -> Path:
    """Draw processor time (left axes) and peak memory (right axes), a panel for each thing that grows."""
    along = list(dict.fromkeys(row.along for row in rows))
    with style.pictured(path, 9.0, 3.3) as figure:
        for panel, name in zip(figure.subplots(1, len(along), squeeze=False)[0], along, strict=True):
            mine = [row for row in rows if row.along == name and row.total_s is not None]
            sizes = [row.size for row in mine]
            panel.plot(sizes, [row.total_s for row in mine], "o-", color=style.BLUE)
            panel.set_yscale("log")
            panel.set_xlabel(_LABELS[name])
            panel.set_ylabel("processor time [s]", color=style.BLUE)
            style.light_grid(panel)
            memory = panel.twinx()
            memory.plot(sizes, [row.peak_mb for row in mine], "s--", color=style.VERMILION)
            memory.set_ylim(0, None)
            memory.set_ylabel("peak memory [MB]", color=style.VERMILION)
            memory.spines["top"].set_visible(False)
            if name == "obstacles":
                panel.set_xticks(sizes)
            if name == "cells":
                panel.set_xscale("log")
    return path
