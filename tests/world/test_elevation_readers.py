"""Reading scans: pictures, arrays, grid maps in bags, planar regions; and what is said about unusable files."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from elevation_bags import grid_map, write_bag
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from surefoot.errors import InputError
from surefoot.world import elevation_map, read_elevation, terrain_of_regions
from surefoot.world.elevation_bags import grid_map_elevation
from surefoot.world.planar_regions import read_planar_regions


def picture(path: Path, values: Any) -> Path:
    Image.fromarray(np.asarray(values)).save(path)
    return path


def test_grey_becomes_height_and_the_top_row_is_the_north(tmp_path: Path) -> None:
    path = picture(tmp_path / "a.png", np.array([[0, 51], [102, 255]], np.uint8))
    scan = read_elevation(path, resolution_m=0.5, height_range_m=(-1.0, 1.0), origin_m=(10.0, 20.0))
    assert np.allclose(scan.height_m, np.array([[-1.0, -0.6], [-0.2, 1.0]]))
    assert np.allclose(scan.place_m(np.array([0.0, 1.0]), np.array([0.0, 1.0])), [[10.25, 20.75], [10.75, 20.25]])
    assert scan.size_m == (1.0, 1.0)
    with pytest.raises(ValueError, match="read-only"):
        scan.height_m[0, 0] = 0


def test_sixteen_bits_and_alpha(tmp_path: Path) -> None:
    deep = picture(tmp_path / "deep.png", np.array([[0, 65535], [32768, 13107]], np.uint16))
    assert np.allclose(
        read_elevation(deep, resolution_m=0.1, height_range_m=(0, 1)).height_m,
        np.array([[0, 1], [0.5, 0.2]]),
        atol=1e-5,
    )
    rgba = np.full((2, 2, 4), 255, np.uint8)
    rgba[0, 0] = (200, 10, 30, 0)  # colour under a transparent pixel does not count
    rgba[1, 1, :3] = 0
    scan = read_elevation(picture(tmp_path / "alpha.png", rgba), resolution_m=0.1, height_range_m=(0, 1))
    assert np.isnan(scan.height_m[0, 0])
    assert scan.height_m[0, 1] == 1.0
    assert scan.height_m[1, 1] == 0.0


def test_black_that_looks_like_a_hole_is_reported_and_can_be_one(tmp_path: Path) -> None:
    values = np.full((10, 10), 120, np.uint8)
    values[:2] = 0
    path = picture(tmp_path / "a.png", values)
    scan = read_elevation(path, resolution_m=0.1, height_range_m=(0, 1))
    assert "--no-data 0" in " ".join(scan.notes)
    assert scan.known.all()
    holed = read_elevation(path, resolution_m=0.1, height_range_m=(0, 1), no_data=0)
    assert int((~holed.known).sum()) == 20
    assert not holed.notes


def test_arrays(tmp_path: Path) -> None:
    heights = np.array([[0.1, np.inf], [np.nan, 0.4]])
    np.save(tmp_path / "a.npy", heights)
    scan = read_elevation(tmp_path / "a.npy", resolution_m=0.02)
    assert np.array_equal(scan.known, [[True, False], [False, True]])
    np.savez(tmp_path / "b.npz", elevation=heights, other=np.zeros((2, 2)), resolution_m=0.05, origin_m=[1.0, 2.0])
    carried = read_elevation(tmp_path / "b.npz")
    assert (carried.resolution_m, carried.origin_m) == (0.05, (1.0, 2.0))
    assert read_elevation(tmp_path / "b.npz", layer="other").height_m.max() == 0
    np.save(tmp_path / "c.npy", np.array([[0, 255]], np.uint8))
    assert np.allclose(read_elevation(tmp_path / "c.npy", resolution_m=0.1, height_range_m=(1, 2)).height_m, [[1, 2]])


@pytest.mark.parametrize("mcap", [False, True])
@pytest.mark.parametrize("bare", [False, True])
def test_a_grid_map_of_a_bag(tmp_path: Path, mcap: bool, bare: bool) -> None:
    heights = np.arange(12.0).reshape(3, 4)
    heights[1, 2] = np.nan
    variance = np.zeros((3, 4))
    variance[0, 0] = np.nan
    older, newer = (
        grid_map(heights + shift, 0.1, (1.0, 2.0), start=(3, 1), basic={"variance": variance}) for shift in (5, 0)
    )
    folder = write_bag(tmp_path / "bag", [older, newer], mcap=mcap)
    path = next(iter(folder.glob("*.mcap" if mcap else "*.db3"))) if bare else folder
    scan = read_elevation(path, topic="/elevation_map")
    assert np.isnan(scan.height_m[0, 0])  # a basic layer is empty there
    assert np.isnan(scan.height_m[1, 2])
    assert np.nanmax(scan.height_m) == 11.0
    assert scan.height_m[2, 0] == 8.0
    assert np.allclose(scan.origin_m, (0.8, 1.85))
    assert scan.resolution_m == 0.1
    assert read_elevation(path, message=0).height_m[2, 0] == 13.0
    assert read_elevation(path, layer="variance").known.sum() == 11


@given(
    rows=st.integers(1, 6), columns=st.integers(1, 6), a=st.integers(0, 9), b=st.integers(0, 9), by_rows=st.booleans()
)
@settings(max_examples=30, deadline=None)
def test_the_circular_buffer_is_unrolled(rows: int, columns: int, a: int, b: int, by_rows: bool) -> None:
    heights = np.arange(float(rows * columns)).reshape(rows, columns)
    message = grid_map(heights, 0.1, start=(a % columns, b % rows), by_rows=by_rows)
    assert np.array_equal(grid_map_elevation(message, Path("bag"), None, {}).height_m, heights)


def region(
    points: list[tuple[float, float]], holes: Any = (), turn: Any = (0, 0, 0, 1), z: float = 0.0
) -> dict[str, Any]:
    return {
        "plane_parameters": {
            "position": {"x": 1.0, "y": 0.0, "z": z},
            "orientation": dict(zip("xyzw", turn, strict=True)),
        },
        "boundary": {
            "outer_boundary": {"points": [{"x": x, "y": y} for x, y in points]},
            "holes": [{"points": [{"x": x, "y": y} for x, y in hole]} for hole in holes],
        },
    }


SQUARE = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
HOLE = [(0.4, 0.4), (0.6, 0.4), (0.6, 0.6), (0.4, 0.6)]


@pytest.mark.parametrize("suffix", [".json", ".yaml"])
def test_planar_regions_become_polygons(tmp_path: Path, suffix: str) -> None:
    tilted = (0.0, float(np.sin(np.pi / 24)), 0.0, float(np.cos(np.pi / 24)))  # 15 degrees about y
    wall = (0.0, float(np.sin(np.pi / 4)), 0.0, float(np.cos(np.pi / 4)))
    document = {
        "planarRegions": [region(SQUARE, [HOLE], z=0.5), region(SQUARE, turn=tilted), region(SQUARE, turn=wall)]
    }
    path = tmp_path / f"regions{suffix}"
    path.write_text(json.dumps(document) + ("\n---\n" if suffix == ".yaml" else ""))
    terrain = terrain_of_regions(read_planar_regions(path))
    assert len(terrain.regions) == 2
    assert "1 regions are steeper" in " ".join(terrain.warnings)
    flat = [terrain.polygons[k] for k in terrain.regions[0].polygons]
    assert np.isclose(sum(polygon.area_m2 for polygon in flat), 0.96**2 - 0.24**2)
    assert all(np.allclose(polygon.vertices_m[:, 2], 0.5) for polygon in flat)
    (slanted,) = (terrain.polygons[k] for k in terrain.regions[1].polygons)
    assert np.isclose(slanted.area_m2, 0.96**2)
    assert np.isclose(slanted.normal[2], np.cos(np.pi / 12))


def test_bad_input_is_one_sentence(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    grey = picture(tmp_path / "grey.png", np.zeros((4, 4), np.uint8))
    photo = picture(tmp_path / "photo.png", rng.integers(0, 255, (4, 4, 3), np.uint8))
    np.save(tmp_path / "nan.npy", np.full((3, 3), np.nan))
    np.save(tmp_path / "none.npy", np.zeros((0, 3)))
    np.save(tmp_path / "cube.npy", np.zeros((2, 2, 2)))
    np.save(tmp_path / "text.npy", np.array([["a", "b"]]))
    np.save(tmp_path / "pickled.npy", np.array([[{}]], object), allow_pickle=True)
    (tmp_path / "broken.npz").write_bytes(b"PK nothing")
    (tmp_path / "scan.tiff").write_bytes(b"II")
    empty = write_bag(tmp_path / "empty", [])
    bag = write_bag(tmp_path / "bag", [grid_map(np.zeros((2, 2)), 0.1)])
    rolled = replace(grid_map(np.zeros((2, 2)), 0.1), outer_start_index=2)
    outside = write_bag(tmp_path / "outside", [rolled])
    (tmp_path / "folder").mkdir()
    (tmp_path / "torn.mcap").write_bytes(b"\x89MCAP0\r\n torn")
    ready: dict[str, Any] = {"resolution_m": 0.1, "height_range_m": (0, 1)}
    cases: list[tuple[Path, dict[str, Any], str]] = [
        (grey, {"resolution_m": 0.1}, "height-range: is required"),
        (grey, {"height_range_m": (0, 1)}, "resolution: is required"),
        (grey, {**ready, "resolution_m": 0.0}, "metres per cell"),
        (grey, {**ready, "resolution_m": -0.02}, "metres per cell"),
        (grey, {**ready, "resolution_m": float("nan")}, "metres per cell"),
        (grey, {**ready, "height_range_m": (1, 0)}, "lower one first"),
        (grey, {**ready, "height_range_m": (0, float("inf"))}, "lower one first"),
        (grey, {**ready, "topic": "/x"}, "only allowed for bags"),
        (photo, ready, "colour picture"),
        (tmp_path / "nan.npy", {"resolution_m": 0.1}, "no height at all"),
        (tmp_path / "none.npy", {"resolution_m": 0.1}, "no cells"),
        (tmp_path / "cube.npy", {"resolution_m": 0.1}, "table of rows and columns"),
        (tmp_path / "text.npy", {"resolution_m": 0.1}, "real numbers"),
        (tmp_path / "pickled.npy", {"resolution_m": 0.1}, "plain arrays"),
        (tmp_path / "broken.npz", {"resolution_m": 0.1}, "plain arrays"),
        (tmp_path / "scan.tiff", ready, "no known kind"),
        (tmp_path / "missing.png", ready, "no such picture"),
        (tmp_path / "missing.mcap", {}, "no such bag"),
        (tmp_path / "torn.mcap", {}, "no readable bag"),
        (tmp_path / "folder", {}, "metadata.yaml"),
        (empty, {}, "carries no grid map; its topics are: /chatter"),
        (bag, {"topic": "/map"}, "has no topic '/map'; its topics are: /chatter (std_msgs/msg/String), /elevation_map"),
        (bag, {"topic": "/chatter"}, "carries std_msgs/msg/String"),
        (bag, {"layer": "cost"}, "has no layer 'cost'; there are: elevation"),
        (bag, {"message": 3}, "has 1 messages"),
        (bag, {"resolution_m": 0.1}, "carries its own"),
        (bag, {"origin_m": (5.0, 5.0)}, "origin: is only allowed for pictures and arrays"),
        (outside, {}, "2 x 2 cells whose buffer starts at row 2, column 0; that does not fit"),
    ]
    for path, options, said in cases:
        with pytest.raises(InputError) as caught:
            read_elevation(path, **options)
        assert said in str(caught.value), path
        assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("document", "said"),
    [
        ({}, "holds no planar regions"),
        ({"planarRegions": []}, "at least one planar region"),
        ({"planarRegions": [{"plane_parameters": {}}]}, "'position' is missing"),
        ({"planarRegions": [region(SQUARE[:2])]}, "at least 3 points"),
        ({"planarRegions": [region(SQUARE, turn=(0, 0, 0, 0))]}, "unit quaternion"),
        ({"planarRegions": [region([(0, 0), (float("nan"), 0), (1, 1)])]}, "finite numbers x, y"),
    ],
)
def test_bad_planar_regions(tmp_path: Path, document: Any, said: str) -> None:
    path = tmp_path / "regions.json"
    path.write_text(json.dumps(document))
    with pytest.raises(InputError, match=said):
        read_planar_regions(path)


def test_heights_are_checked() -> None:
    with pytest.raises(InputError, match="beyond"):
        elevation_map(np.array([[1e9]]), 0.1)
    with pytest.raises(InputError, match="origin"):
        elevation_map(np.array([[1.0]]), 0.1, (float("nan"), 0.0))
