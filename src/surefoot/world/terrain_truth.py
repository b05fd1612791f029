"""How a segmented terrain compares with a truth that is known."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely  # type: ignore[import-untyped]

from surefoot.world.synthetic_terrain import SyntheticTerrain
from surefoot.world.terrain_polygons import Terrain

PROBES = 40


@dataclass(frozen=True, slots=True)
class TruthReport:
    """A terrain measured against the truth.

    Attributes:
        kept_share: share of the true tops, the margin taken off, that polygons cover, seen from above.
        least_kept_share: the same of the top that fares worst.
        largest_error_m: largest distance of a polygon's points from the true surface below them.
        points: how many points were probed: vertices and a grid over every polygon.
        points_off: those that are more than 2 cm off.
        points_over_holes: those that hang over nothing.
    """

    kept_share: float
    least_kept_share: float
    largest_error_m: float
    points: int
    points_off: int
    points_over_holes: int


def compare_with_truth(terrain: Terrain, truth: SyntheticTerrain, margin_m: float = 0.02) -> TruthReport:
    """Return how much of the true ground a terrain keeps, and how far it strays from it.

    Args:
        terrain: polygons made from ``truth.elevation``.
        truth: the terrain as it is.
        margin_m: taken off the true tops before areas are compared.
    """
    tops = [shapely.buffer(shapely.polygons(top), -margin_m, join_style="mitre") for top in truth.tops_m]
    tops = [top for top in tops if not top.is_empty]
    covered = shapely.union_all([shapely.polygons(polygon.vertices_m[:, :2]) for polygon in terrain.polygons])
    shares = np.array([top.intersection(covered).area / top.area for top in tops])
    areas = np.array([top.area for top in tops])
    errors, over = [], 0
    for polygon in terrain.polygons:
        shape = shapely.polygons(polygon.vertices_m[:, :2])
        west, south, east, north = shape.bounds
        grid = np.stack(np.meshgrid(np.linspace(west, east, PROBES), np.linspace(south, north, PROBES)), -1).reshape(
            -1, 2
        )
        x, y = np.vstack((grid[shapely.contains_xy(shape, grid)], polygon.vertices_m[:, :2])).T
        true_m = truth.height_m(x, y)
        over += int(np.isnan(true_m).sum())
        plane_m = (polygon.offset_m - polygon.normal[0] * x - polygon.normal[1] * y) / polygon.normal[2]
        errors.append(np.abs(plane_m - true_m))
    apart = np.concatenate(errors) if errors else np.zeros(0)
    return TruthReport(
        kept_share=float(shares @ areas / areas.sum()),
        least_kept_share=float(shares.min()),
        largest_error_m=float(np.nanmax(apart)) if np.isfinite(apart).any() else 0.0,
        points=len(apart),
        points_off=int((apart > 0.02).sum()),
        points_over_holes=over,
    )
