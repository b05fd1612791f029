"""Why cells are obstacles, as commands tell it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from surefoot.skills.blocking import Barrier
    from surefoot.skills.quadruped_terrain import QuadrupedTerrain

_SHOWN = 6


def obstacles_of(terrain: QuadrupedTerrain) -> list[dict[str, Any]]:
    """Return the cells in which nobody can stand, each with the measures that decide."""
    from surefoot.skills.obstacles import in_words, why_obstacle

    whys = {cell: why_obstacle(terrain, cell) for cell in terrain.measured}
    return [
        {"cell": cell, "centre_m": terrain.centre_m(cell), "why": why, "text": in_words(why)}
        for cell, why in whys.items()
        if why
    ]


def obstacle_lines(obstacles: Sequence[dict[str, Any]], cells: int) -> list[str]:
    """Return lines that tell how many cells are obstacles by which measure, each with an example."""
    deciding = [" and ".join(one.measure for one in obstacle["why"]) for obstacle in obstacles]
    examples = dict(zip(reversed(deciding), reversed(obstacles), strict=True))
    lines = (
        [f"  {len(obstacles)} of {cells} cells {'is an obstacle' if len(obstacles) == 1 else 'are obstacles'}"]
        if obstacles
        else []
    )
    for measures, count in Counter(deciding).most_common(_SHOWN):
        cell, text = examples[measures]["cell"], examples[measures]["text"]
        lines.append(f"    {count} by {measures}; in cell {list(cell)} {text}")
    return lines


def barrier_lines(barriers: Sequence[Barrier]) -> list[str]:
    """Return a line for everything that is in the way."""
    return [f"  in the way: {one.sentence}" for one in barriers]
