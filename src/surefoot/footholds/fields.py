"""Endless fields of stepping stones and of rebar, cut to a length: the terrains of the two baselines."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surefoot.errors import InputError
from surefoot.footholds.terrain import Polygon, polygon

STONE_M = 0.2
BAR_M = 0.03
WIDTH_M = 0.8
_MARGIN_M = 0.3
_BEHIND_M = 0.45


@dataclass(frozen=True, slots=True)
class Field:
    """A kind of ground.

    Attributes:
        name: as tables call it.
        bars: bars across the way; else square stones.
        spacing_m: free distance between neighbours.
    """

    name: str
    bars: bool
    spacing_m: float


FIELDS = (
    Field("sparse stones", bars=False, spacing_m=0.15),
    Field("dense stones", bars=False, spacing_m=0.05),
    Field("sparse rebar", bars=True, spacing_m=0.30),
    Field("dense rebar", bars=True, spacing_m=0.15),
)
"""Zhou et al. 2025, IX-E; the size of the stones and the width of the field are assumptions."""


def field(name: str) -> Field:
    """Return a field by its name.

    Raises:
        InputError: there is none of that name.
    """
    for one in FIELDS:
        if one.name == name:
            return one
    raise InputError(f"there is no field {name!r}; there are: {', '.join(one.name for one in FIELDS)}")


def field_polygons(kind: Field, length_m: float, seed: int) -> tuple[Polygon, ...]:
    """Return the polygons between a robot's hind feet and a margin beyond the way ahead.

    Args:
        kind: what lies there.
        length_m: of the way, along x from 0.
        seed: shifts the field under the robot.
    """
    rng = np.random.default_rng([seed, 11])
    size_m = BAR_M if kind.bars else STONE_M
    pitch_m = size_m + kind.spacing_m
    centres_x = _lattice(-_BEHIND_M, length_m + _BEHIND_M + _MARGIN_M, pitch_m, rng.uniform(0, pitch_m))
    if kind.bars:
        return tuple(rectangle(x, 0.0, BAR_M, WIDTH_M) for x in centres_x)
    centres_y = _lattice(-WIDTH_M / 2, WIDTH_M / 2, pitch_m, rng.uniform(0, pitch_m))
    return tuple(rectangle(x, y, STONE_M, STONE_M) for x in centres_x for y in centres_y)


def bars_with_gap(length_m: float, widest_m: float, seed: int) -> tuple[Polygon, ...]:
    """Return bars across the way, 0.1 to 0.3 m apart (at most the widest), with one gap of the widest half way.

    Source: Zhou et al. 2025, X-C and X-D: bars were removed until the widest spacing was 0.48 m.
    """
    rng = np.random.default_rng([seed, 13])
    x, end, crossed = -_BEHIND_M, length_m + _BEHIND_M + _MARGIN_M, False
    bars = []
    while x < end:
        bars.append(rectangle(x, 0.0, BAR_M, WIDTH_M))
        here = not crossed and x > length_m / 2
        x += BAR_M + (widest_m if here else rng.uniform(0.1, min(0.3, widest_m)))
        crossed = crossed or here
    return tuple(bars)


def rectangle(x_m: float, y_m: float, length_m: float, width_m: float) -> Polygon:
    """Return a level rectangle at height 0 about a point."""
    corners = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    return polygon([[x_m + a * length_m / 2, y_m + b * width_m / 2, 0.0] for a, b in corners])


def _lattice(low: float, high: float, pitch: float, offset: float) -> list[float]:
    count = int(np.ceil((high - low) / pitch)) + 1
    return [low + offset + k * pitch for k in range(-1, count) if low <= low + offset + k * pitch <= high]
