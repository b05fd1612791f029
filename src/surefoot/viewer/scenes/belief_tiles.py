"""Belief in a scene: coloured tiles on the cells that an obstacle may be in."""

from __future__ import annotations

from typing import Any

import numpy as np

from surefoot.frames import Cell
from surefoot.viewer import style
from surefoot.viewer.browser.page import add_solid
from surefoot.viewer.browser.solids import cell_tiles
from surefoot.viewer.sources.cells import heights_of
from surefoot.viewer.sources.plans import PlanSource

KIND_HUES = (
    (style.OBSTACLE, style.BELIEF),
    (style.BLUE, style.SKY),
    (style.BLACK, style.YELLOW),
    (style.VERMILION, "#f4b183"),
)
"""Obstacle and belief of every kind; more kinds begin again."""

Believed = frozenset[tuple[int, Cell]]
"""Pairs of a kind and a cell that one of its obstacles may be in."""


class BeliefTiles:
    """Draws beliefs into a scene, one at a time; only what has changed is sent.

    Args:
        scene: of a viser server.
        plan: whose grid the cells are of.
    """

    def __init__(self, scene: Any, plan: PlanSource) -> None:
        self.scene, self.grid, self.heights = scene, plan.grid, heights_of(plan)
        self.shown: Believed = frozenset()
        self.tiles: dict[tuple[int, Cell], Any] = {}

    def show(self, believed: Believed) -> None:
        """Show a belief instead of the one before."""
        for place in self.shown - believed:
            self.tiles[place].visible = False
        for place in believed - self.shown:
            if place not in self.tiles:
                self.tiles[place] = self._tile(*place)
            self.tiles[place].visible = True
        self.shown = believed

    def _tile(self, kind: int, cell: Cell) -> Any:
        """Add the tile of a belief; those of several kinds in one cell lie inside and above one another."""
        above_m, inset = 0.02 + 0.012 * kind, 0.06 + min(0.06 * kind, 0.3)
        solid = cell_tiles(self.grid, self.heights, np.array([cell]), above_m, inset)
        name, hue = f"/belief/{kind}/{cell.row}_{cell.column}", KIND_HUES[kind % len(KIND_HUES)][1]
        return add_solid(self.scene, name, solid, hue, opacity=0.55, cast_shadow=False)
