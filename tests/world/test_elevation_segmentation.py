"""Terrain polygons against synthetic truth: area kept, points off the surface, holes, narrow things; convex pieces."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely  # type: ignore[import-untyped]
from hypothesis import given, settings
from hypothesis import strategies as st

from surefoot.errors import InputError
from surefoot.world import CellClass, SegmentOptions, elevation_map, read_elevation, segment_terrain
from surefoot.world.convex_core import convex_core
from surefoot.world.convex_pieces import area_of, convex_pieces
from surefoot.world.segmentation import find_dropouts
from surefoot.world.synthetic_terrain import stairs, stones
from surefoot.world.terrain_truth import compare_with_truth

DATA = Path(__file__).parents[3] / "shared" / "data" / "elevation"
SCENES: list[Any] = [
    stairs(yaw_rad=0.3, seed=1),
    stairs(tread_m=0.25, riser_m=0.18, missing=0.02),
    stones(yaw_rad=0.2),
    stones(floor=False, missing=0.05, seed=3),
    stones(gap_m=0.15, rows=3, columns=5, yaw_rad=0.7, height_spread_m=0.03),
]


@pytest.mark.parametrize("truth", SCENES)
def test_noisy_scans_keep_the_true_ground_and_nothing_else(truth: Any) -> None:
    terrain = segment_terrain(truth.elevation)
    found = compare_with_truth(terrain, truth)
    assert found.kept_share >= 0.95
    assert found.points > 5_000
    assert found.points_off == 0
    assert found.points_over_holes == 0
    assert terrain.max_plane_error_m <= 0.02
    assert 0.005 < terrain.noise_m < 0.015


def test_the_truth_can_be_missed() -> None:
    truth = stones()
    terrain = segment_terrain(truth.elevation, SegmentOptions(margin_m=0.05))
    assert compare_with_truth(terrain, truth).kept_share < 0.7
    shifted = stones(seed=0, yaw_rad=0.5)
    assert compare_with_truth(terrain, shifted).points_off > 0
    assert compare_with_truth(terrain, shifted).points_over_holes > 0


def test_clean_stairs_are_one_rectangle_a_step() -> None:
    terrain = segment_terrain(stairs(noise_m=0.0).elevation)
    assert terrain.pieces_per_region == 1.0
    assert len(terrain.polygons) == 9
    assert all(len(polygon.vertices_m) == 4 for polygon in terrain.polygons)
    assert terrain.max_plane_error_m < 1e-12


def flat(rows: int = 60, columns: int = 60) -> Any:
    return np.zeros((rows, columns))


def test_holes_stay_holes_and_dropouts_do_not() -> None:
    heights = flat()
    heights[20:30, 20:30] = np.nan
    heights[45, 45] = np.nan
    terrain = segment_terrain(elevation_map(heights, 0.02))
    ground = shapely.union_all([shapely.polygons(polygon.vertices_m[:, :2]) for polygon in terrain.polygons])
    assert ground.distance(shapely.box(0.40, 0.60, 0.60, 0.80)) >= 0.0149
    assert ground.contains(shapely.Point(0.91, 0.29))
    assert "dropout" in " ".join(terrain.warnings)
    strict = segment_terrain(elevation_map(heights, 0.02), SegmentOptions(fill_m=0.0))
    holed = shapely.union_all([shapely.polygons(polygon.vertices_m[:, :2]) for polygon in strict.polygons])
    assert not holed.contains(shapely.Point(0.91, 0.29))


def test_dropouts_are_narrow_and_short() -> None:
    heights = flat(40, 40)
    heights[10, 10:13] = np.nan
    heights[20, 5:35] = np.nan
    heights[30:33, 30:33] = np.nan
    found = find_dropouts(heights, 0.02, 0.03)
    assert found[10, 10:13].all()
    assert not found[20].any()
    assert not found[30:33].any()


def test_a_single_deep_cell_is_a_hole_in_the_ground() -> None:
    heights = flat()
    heights[30, 30] = -0.3
    terrain = segment_terrain(elevation_map(heights, 0.02))
    ground = shapely.union_all([shapely.polygons(polygon.vertices_m[:, :2]) for polygon in terrain.polygons])
    assert not ground.contains(shapely.Point(0.61, 0.59))
    assert ground.area > 0.95 * (1.16**2)


def test_bars_are_reported_or_kept_on_wish() -> None:
    heights = flat(100, 100) - 0.2
    heights[:, 49:52] = 0.0  # a bar 3 cm wide at 1 cm
    scan = elevation_map(heights, 0.01)
    terrain = segment_terrain(scan)
    (bar,) = terrain.narrow
    assert bar.width_m == pytest.approx(0.03)
    assert bar.length_m == pytest.approx(1.0)
    assert bar.rise_m == pytest.approx(0.2)
    assert "narrow raised thing" in " ".join(terrain.warnings)
    assert (np.asarray(terrain.classes)[:, 50] == CellClass.NARROW).all()
    assert all(np.isclose(polygon.vertices_m[0, 2], -0.2) for polygon in terrain.polygons)
    (strip,) = (
        polygon for polygon in segment_terrain(scan, SegmentOptions(keep_narrow=True)).polygons if polygon.region == -1
    )
    assert np.allclose(strip.vertices_m[:, 2], 0.0)
    assert np.allclose(np.abs(strip.vertices_m[:, 0] - 0.505), 0.005)


def test_a_bar_at_the_border_of_the_scan_is_seen() -> None:
    heights = flat(100, 100) - 0.2
    heights[:, :3] = 0.0
    (bar,) = segment_terrain(elevation_map(heights, 0.01)).narrow
    assert bar.length_m == pytest.approx(1.0)


def test_what_is_too_steep_or_too_rough_is_no_ground() -> None:
    columns = np.indices((60, 60))[1]
    steep = segment_terrain(elevation_map(columns * 0.02 * np.tan(np.radians(40)), 0.02))
    assert not steep.polygons
    assert (np.asarray(steep.classes) == CellClass.STEEP).all()
    gentle = segment_terrain(elevation_map(columns * 0.02 * np.tan(np.radians(20)), 0.02))
    (slope,) = gentle.polygons
    assert slope.normal[2] == pytest.approx(np.cos(np.radians(20)))
    assert slope.normal[0] < 0
    gravel = segment_terrain(elevation_map(np.random.default_rng(0).normal(0, 0.05, (60, 60)), 0.02))
    assert gravel.area_m2 < 0.1


def test_a_dome_is_covered_by_patches_within_the_error() -> None:
    rows, columns = np.indices((100, 100)) * 0.02
    dome = 0.3 - 0.15 * ((rows - 1) ** 2 + (columns - 1) ** 2)
    terrain = segment_terrain(elevation_map(dome, 0.02))
    assert len(terrain.regions) > 4
    for polygon in terrain.polygons:
        x, y, z = polygon.vertices_m.T
        assert np.abs(z - (0.3 - 0.15 * ((2.0 - y - 0.01 - 1) ** 2 + (x - 0.01 - 1) ** 2))).max() < 0.02
    assert terrain.area_m2 > 2.5


@pytest.mark.parametrize(
    "change", [{"margin_m": -0.1}, {"max_slope_deg": 89.0}, {"friction": float("nan")}, {"min_area_m2": 0.0}]
)
def test_impossible_limits_are_refused(change: Any) -> None:
    with pytest.raises(InputError, match="has to lie between"):
        SegmentOptions(**change)


def polygon_of(boxes: list[tuple[int, int, int, int]]) -> Any:
    return shapely.union_all([shapely.box(x, y, x + w, y + h) for x, y, w, h in boxes])


boxes_drawn = st.lists(
    st.tuples(st.integers(0, 8), st.integers(0, 8), st.integers(1, 6), st.integers(1, 6)), min_size=1, max_size=8
)


@given(boxes_drawn, st.floats(0, 3.1))
@settings(max_examples=60, deadline=None)
def test_convex_pieces_are_a_partition(boxes: list[tuple[int, int, int, int]], angle: float) -> None:
    for part in shapely.get_parts(shapely.affinity.rotate(polygon_of(boxes), angle, use_radians=True)):
        pieces = convex_pieces(part)
        shapes = [shapely.polygons(piece) for piece in pieces]
        assert np.isclose(sum(area_of(piece) for piece in pieces), part.area, rtol=1e-4)
        assert shapely.union_all(shapes).symmetric_difference(part).area < 1e-3 * part.area
        assert all(shape.convex_hull.area - shape.area <= 1e-9 for shape in shapes)
        corners = sum(len(ring.coords) - 1 for ring in (part.exterior, *part.interiors))
        assert len(pieces) <= corners


def test_repeated_points_hide_no_corner() -> None:
    corner = [(1.0, 1.0), (1.0 + 1e-12, 1.0), (1.0, 1.0 + 1e-13)]
    shape = shapely.Polygon([(0, 0), (3, 0), (3, 1), *corner, (1, 3), (0, 3)])
    assert np.isclose(sum(area_of(piece) for piece in convex_pieces(shape)), 5.0)
    assert len(convex_pieces(shape)) == 2


def test_few_pieces() -> None:
    ring = shapely.box(0, 0, 3, 3).difference(shapely.box(1, 1, 2, 2))
    assert len(convex_pieces(ring)) <= 4
    assert len(convex_pieces(polygon_of([(0, 0, 3, 1), (0, 0, 1, 3)]))) == 2
    assert len(convex_pieces(polygon_of([(0, 1, 3, 1), (1, 0, 1, 3)]))) == 3


@pytest.mark.skipif(not DATA.is_dir(), reason="../shared/data/elevation is absent")
@pytest.mark.parametrize(
    ("name", "cell_m", "least_m2"), [("real_stairs_125cm", 0.04, 8.0), ("terrain", 0.02, 60.0), ("holes", 0.04, 3.0)]
)
def test_recorded_scans(name: str, cell_m: float, least_m2: float) -> None:
    scan = read_elevation(DATA / f"{name}.png", resolution_m=cell_m, height_range_m=(0, 1.25), no_data=None)
    terrain = segment_terrain(scan)
    assert terrain.area_m2 > least_m2
    assert terrain.max_plane_error_m <= 0.02
    assert terrain.kept_share > 0.95
    cells = np.asarray(terrain.classes)
    for polygon in terrain.polygons:
        middle = polygon.vertices_m.mean(axis=0)
        column = int(middle[0] / cell_m)
        row = cells.shape[0] - 1 - int(middle[1] / cell_m)
        assert cells[row, column] == CellClass.STEPPABLE
        assert abs(float(np.dot(polygon.normal, middle)) - polygon.offset_m) < 1e-9


def test_a_mesh_of_bars_over_nothing_gets_no_strip_through_its_holes() -> None:
    x, y = np.meshgrid((np.arange(150) + 0.5) * 0.02, (np.arange(60) + 0.5) * 0.02)
    mesh = np.where((x % 0.2 < 0.04) | (y % 0.2 < 0.04), 0.0, np.nan)
    terrain = segment_terrain(elevation_map(mesh, 0.02), SegmentOptions(keep_narrow=True))
    assert terrain.narrow == ()
    assert all(polygon.region >= 0 for polygon in terrain.polygons)


@settings(max_examples=60, deadline=None)
@given(st.lists(st.floats(0.2, 1.0), min_size=5, max_size=14))
def test_the_convex_core_of_a_polygon_lies_in_it(radii: list[float]) -> None:
    angles = np.linspace(0, 2 * np.pi, len(radii), endpoint=False)
    star = shapely.polygons(np.column_stack((np.cos(angles), np.sin(angles))) * np.array(radii)[:, None])
    core = convex_core(star)
    assert len(core) >= 3
    turned = np.roll(core, -1, axis=0) - core
    following = np.roll(turned, -1, axis=0)
    assert (turned[:, 0] * following[:, 1] - turned[:, 1] * following[:, 0] > 0).all()
    assert shapely.difference(shapely.polygons(core), star).area < 1e-5
    assert shapely.area(shapely.polygons(core)) > 0.1 * star.area


def test_a_polygon_with_a_hole_has_no_core() -> None:
    assert len(convex_core(shapely.box(0, 0, 4, 4).difference(shapely.box(1, 1, 2, 2)))) == 0


def test_small_stones_are_found() -> None:
    lost = 0
    for seed in (1, 5):
        truth = stones(seed=seed, yaw_rad=0.1 * seed, stone_m=0.10, gap_m=0.08)
        terrain = segment_terrain(truth.elevation)
        covered = shapely.union_all([shapely.polygons(one.vertices_m[:, :2]) for one in terrain.polygons])
        tops = [shapely.buffer(shapely.polygons(top), -0.02, join_style="mitre") for top in truth.tops_m]
        lost += sum(top.intersection(covered).area < 0.3 * top.area for top in tops)
    assert lost <= 2
