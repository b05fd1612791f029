"""Outlines of regions: contours are exact, and no polygon leaves the scan or enters a cell without data."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import shapely  # type: ignore[import-untyped]
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy import ndimage

from surefoot.verify import verify_path
from surefoot.world import SegmentOptions, read_elevation, segment_terrain
from surefoot.world._convex_kernels import convex_ring, without_straight
from surefoot.world._outline_kernels import beside, contours, framed
from surefoot.world.outlines import inset_outline
from surefoot.world.segmentation import segment
from surefoot.world.simple_outlines import inset_outlines
from surefoot.world.synthetic_terrain import stones
from surefoot.world.terrain_file import write_terrain

MASKS = arrays(np.bool_, st.tuples(st.integers(1, 9), st.integers(1, 9)))


def area_of(ring: np.ndarray) -> float:
    x, y = ring.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


@settings(max_examples=60, deadline=None)
@given(MASKS)
def test_contours_run_around_every_part_and_every_hole(mask: np.ndarray) -> None:
    wide = framed(mask)
    points, begins = contours(wide, np.zeros_like(wide))
    rings = [points[a:b] for a, b in pairwise(begins.tolist())]
    parts = ndimage.label(mask)[1]
    holes = ndimage.label(np.pad(~mask, 1, constant_values=True), np.ones((3, 3)))[1] - 1
    assert (sum(area_of(ring) > 0 for ring in rings), sum(area_of(ring) < 0 for ring in rings)) == (parts, holes)
    sides = sum(int((np.pad(mask, 1) & ~np.roll(np.pad(mask, 1), k, axis)).sum()) for axis in (0, 1) for k in (-1, 1))
    assert len(points) == sides
    assert len({tuple(point) for point in points.tolist()}) == sides


@settings(max_examples=40, deadline=None)
@given(MASKS)
def test_cells_beside_a_region_are_counted_with_its_neighbours(mask: np.ndarray) -> None:
    centres, tips = beside(framed(mask), 5)
    around = ndimage.convolve(np.pad(mask, 2).astype(int), np.ones((3, 3), int), mode="constant")
    there = {(c - 2, r - 2) for r, c in np.argwhere((around > 0) & ~np.pad(mask, 2))}
    assert {tuple(map(int, point)) for point in centres} == there
    assert [bool(around[int(y) + 2, int(x) + 2] >= 5) for x, y in centres] == tips.tolist()


def test_convex_rings_are_told_from_others_whatever_their_order() -> None:
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 0.5), (1.0, 1.0), (1.0, 1.0), (0.0, 1.0)])
    for ring in (square, square[::-1].copy()):
        found = convex_ring(ring, 1e-7)
        assert area_of(found) == 1.0
        assert len(without_straight(found)) == 4
    dented = np.array([(0.0, 0.0), (1.0, 0.0), (0.5, 0.4), (1.0, 1.0), (0.0, 1.0)])
    assert len(convex_ring(dented, 1e-7)) == 0
    assert len(convex_ring(square[:2], 1e-7)) == 0


def scan(seed: int) -> tuple[np.ndarray, float]:
    """Return heights of a wave, a flight or a slope with dropouts and a round hole, and the side of a cell."""
    chance = np.random.default_rng(seed)
    rows, columns = chance.integers(8, 50, 2)
    cell_m = float(chance.choice([0.02, 0.05, 0.1]))
    y, x = np.mgrid[0:rows, 0:columns] * cell_m
    along = x * np.cos(seed) + y * np.sin(seed)
    height = [0.05 * np.sin(6 * x) * np.cos(6 * y), 0.12 * np.floor(along / 0.4), 0.3 * along][seed % 3]
    height = height + chance.normal(0, 0.003, x.shape)
    height[chance.random(x.shape) < 0.03] = np.nan
    height[np.hypot(x - x.mean(), y - y.mean()) < chance.uniform(0.1, 0.3)] = np.nan
    return height, cell_m


@pytest.mark.parametrize("seed", range(9))
@pytest.mark.parametrize("margin_m", [0.0, 0.005, 0.02])
def test_polygons_stay_on_the_scan_and_off_its_holes(tmp_path: Path, seed: int, margin_m: float) -> None:
    heights, cell_m = scan(seed)
    path, options = tmp_path / "scan.npz", SegmentOptions(margin_m=margin_m, fill_m=0.0)
    np.savez(path, heights=heights, resolution_m=cell_m)
    elevation = read_elevation(path)
    terrain = segment_terrain(elevation, options)
    if not terrain.polygons:
        return
    write_terrain(tmp_path / "terrain.json", terrain, options, path, elevation.reading)
    report = verify_path(tmp_path / "terrain.json")
    assert report.findings == ()
    corners = np.concatenate([np.array(one["vertices_m"]) for one in _polygons(tmp_path / "terrain.json")])
    assert (corners[:, :2] >= 0).all()
    assert (corners[:, :2] <= np.array(heights.shape[::-1]) * cell_m).all()


def _polygons(path: Path) -> list[dict[str, object]]:
    found: list[dict[str, object]] = json.loads(path.read_text())["polygons"]
    return found


@pytest.mark.parametrize("margin_cells", [0.0, 0.4, 1.0])
def test_outlines_of_many_regions_are_those_of_each(margin_cells: float) -> None:
    found = segment(stones(rows=3, columns=4, seed=2, yaw_rad=0.3, missing=0.01).elevation, SegmentOptions())
    numbers = [k for k in range(1, found.regions + 1) if (found.labels == k).any()]
    masks = [found.labels == k for k in numbers] + [np.eye(3, dtype=np.bool_), np.ones((1, 2), np.bool_)]
    least = [2.0 + k % 5 for k in range(len(masks))]
    around = [np.pad(found.holes, 2) if k % 3 else None for k in range(len(numbers))] + [None, None]
    together = inset_outlines(masks, margin_cells, least, around)
    for number, (shape, area) in enumerate(together):
        alone, alone_area = inset_outline(masks[number], margin_cells, least[number], around[number])
        assert shapely.equals(shape, alone) or shape.symmetric_difference(alone).area < 1e-9
        assert area == pytest.approx(alone_area, abs=1e-9)
