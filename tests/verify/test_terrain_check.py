"""The independent check of terrain files: it accepts what was made, and refuses what was tampered with."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from surefoot.errors import InputError
from surefoot.verify import verify_path
from surefoot.world import SegmentOptions, read_elevation, segment_terrain, terrain_of_regions
from surefoot.world.planar_regions import read_planar_regions
from surefoot.world.synthetic_terrain import stones
from surefoot.world.terrain_file import write_terrain

Document = dict[str, Any]
DATA = Path(__file__).parents[3] / "shared" / "data" / "elevation"


@pytest.fixture
def saved(tmp_path: Path) -> Path:
    scan = tmp_path / "scans" / "stones.npy"
    scan.parent.mkdir()
    np.save(scan, stones(rows=2, columns=3, floor=False, missing=0.02).elevation.height_m)
    elevation = read_elevation(scan, resolution_m=0.02)
    options = SegmentOptions()
    path = tmp_path / "out" / "terrain.json"
    write_terrain(path, segment_terrain(elevation, options), options, scan, elevation.reading)
    return path


def test_a_made_file_is_accepted(saved: Path) -> None:
    report = verify_path(saved)
    assert report.accepted, report.findings
    assert report.kind == "terrain"
    assert report.counts["polygons"] == len(json.loads(saved.read_text())["polygons"])
    cells = report.counts["cells"]
    assert isinstance(cells, int)
    assert cells > 1000


def test_polygons_can_be_pasted_into_a_foothold_problem(saved: Path) -> None:
    for polygon in json.loads(saved.read_text())["polygons"]:
        assert set(polygon) == {"vertices_m", "friction"}
        assert np.asarray(polygon["vertices_m"]).shape[1] == 3


def shift(document: Document, x: float, z: float) -> None:
    for polygon, source in zip(document["polygons"], document["sources"], strict=True):
        polygon["vertices_m"] = [[a + x, b, c + z] for a, b, c in polygon["vertices_m"]]
        normal = source["normal"]
        source["offset_m"] += normal[0] * x + normal[2] * z


def swap(document: Document) -> None:
    vertices = document["polygons"][0]["vertices_m"]
    vertices[0], vertices[1] = vertices[1], vertices[0]


def bend(document: Document) -> None:
    document["polygons"][0]["vertices_m"][0][2] += 0.001


def tilt(document: Document) -> None:
    document["options"]["max_slope_deg"] = 0.01
    document["sources"][0]["normal"] = [0.6, 0.0, 0.8]


def grow(document: Document) -> None:
    (x, y, z), *others = document["polygons"][0]["vertices_m"]
    middle = np.mean([[x, y, z], *others], axis=0)
    source = document["sources"][0]
    normal, wide = np.array(source["normal"]), []
    for vertex in document["polygons"][0]["vertices_m"]:
        flat = middle[:2] + 1.3 * (np.array(vertex[:2]) - middle[:2])
        wide.append([*flat.tolist(), float((source["offset_m"] - normal[:2] @ flat) / normal[2])])
    document["polygons"][0]["vertices_m"] = wide


@pytest.mark.parametrize(
    ("tamper", "rule"),
    [
        (lambda document: shift(document, 0.06, 0.0), "terrain, hole"),
        (lambda document: shift(document, 100.0, 0.0), "terrain, hole"),
        (lambda document: shift(document, 0.0, 0.04), "terrain, error"),
        (lambda document: shift(document, 0.0, 0.10), "terrain, cells"),
        (swap, "terrain, convex"),
        (bend, "terrain, plane"),
        (tilt, "terrain, slope"),
        (grow, "terrain, hole"),
        (lambda document: document["polygons"][0].update(friction=0.9), "terrain, friction"),
        (lambda document: document["statistics"].update(area_m2=9.0), "terrain, area"),
        (lambda document: document["statistics"].update(max_plane_error_m=0.5), "terrain, error"),
        (lambda document: document["statistics"].update(max_plane_error_m=1e-5), "terrain, error"),
    ],
)
def test_tampered_files_are_refused(saved: Path, tamper: Callable[[Document], None], rule: str) -> None:
    document = json.loads(saved.read_text())
    tamper(document)
    saved.write_text(json.dumps(document))
    report = verify_path(saved)
    assert not report.accepted
    assert rule in {finding.rule for finding in report.findings}


@pytest.fixture
def bars(tmp_path: Path) -> Path:
    """A slanted bar 4 cm wide over ground with dropouts, kept as a strip."""
    rows, columns = np.indices((120, 120))
    along, across = (columns - 60) * 0.9 + (rows - 60) * 0.436, (rows - 60) * 0.9 - (columns - 60) * 0.436
    heights = np.where((np.abs(across) < 1) & (np.abs(along) < 40), 0.1, 0.0)
    heights[np.random.default_rng(0).uniform(size=heights.shape) < 0.01] = np.nan
    scan = tmp_path / "bars.npy"
    np.save(scan, heights)
    elevation, options = read_elevation(scan, resolution_m=0.02), SegmentOptions(keep_narrow=True)
    write_terrain(tmp_path / "bars.json", segment_terrain(elevation, options), options, scan, elevation.reading)
    return tmp_path / "bars.json"


def test_strips_along_narrow_things_are_accepted(bars: Path) -> None:
    document = json.loads(bars.read_text())
    assert [source["region"] for source in document["sources"]].count(-1) == len(document["narrow"]) == 1
    report = verify_path(bars)
    assert report.accepted, report.findings


def lift_thing(document: Document) -> None:
    document["narrow"][0]["rise_m"] = 0.02


def test_a_thing_rises_no_higher_than_the_scan(tmp_path: Path) -> None:
    heights = np.zeros((120, 120))
    heights[60:62, 50:70] = 0.1
    scan = tmp_path / "bar.npy"
    np.save(scan, heights)
    elevation, options, path = read_elevation(scan, resolution_m=0.02), SegmentOptions(), tmp_path / "bar.json"
    write_terrain(path, segment_terrain(elevation, options), options, scan, elevation.reading)
    assert verify_path(path).accepted
    document = json.loads(path.read_text())
    document["narrow"][0]["rise_m"] = 0.2
    path.write_text(json.dumps(document))
    assert {finding.rule for finding in verify_path(path).findings} == {"terrain, narrow"}


def move_thing(document: Document) -> None:
    for end in ("start_m", "end_m"):
        document["narrow"][0][end][1] += 0.2


def widen_strip(document: Document) -> None:
    strip = next(k for k, source in enumerate(document["sources"]) if source["region"] < 0)
    corners = document["polygons"][strip]["vertices_m"]
    middle = np.mean(corners, axis=0)
    document["polygons"][strip]["vertices_m"] = [(middle + 1.1 * (np.array(one) - middle)).tolist() for one in corners]


@pytest.mark.parametrize(
    ("tamper", "rule"),
    [
        (lambda document: document["statistics"].update(kept_share=9.0), "terrain, statistics"),
        (lambda document: document["statistics"].update(kept_share=0.1), "terrain, statistics"),
        (lambda document: document["statistics"].update(ground_share=0.2), "terrain, statistics"),
        (lambda document: document["statistics"].update(ground_share=1.0), "terrain, statistics"),
        (lambda document: document["statistics"].update(pieces_per_region=1.0), "terrain, statistics"),
        (lambda document: document["statistics"].update(regions=7), "terrain, regions"),
        (lambda document: document["regions"][0].update(kept_m2=1.0), "terrain, regions"),
        (lambda document: document["regions"][0].update(area_m2=0.1), "terrain, regions"),
        (lambda document: document["regions"][0].update(area_m2=99.0), "terrain, regions"),
        (lambda document: document["regions"][0].update(normal=[0.0, 0.6, 0.8]), "terrain, regions"),
        (lambda document: document["regions"][0]["polygons"].pop(), "terrain, regions"),
        (lambda document: document["regions"].pop(), "terrain, regions"),
        (lambda document: document["statistics"].update(warnings=[]), "terrain, warnings"),
        (lambda document: document["statistics"]["warnings"].append("cells show nothing narrower than that"),
         "terrain, warnings"),
        (lambda document: document.update(narrow=[]), "terrain, strips"),
        (lambda document: document["options"].update(keep_narrow=False), "terrain, strips"),
        (lambda document: document["narrow"][0].update(length_m=3.0), "terrain, narrow"),
        (lambda document: document["narrow"][0].update(width_m=0.031), "terrain, narrow"),
        (lift_thing, "terrain, narrow"),
        (move_thing, "terrain, narrow"),
        (widen_strip, "terrain, strips"),
    ],
)  # fmt: skip
def test_statements_that_do_not_hold_are_refused(bars: Path, tamper: Callable[[Document], None], rule: str) -> None:
    document = json.loads(bars.read_text())
    tamper(document)
    bars.write_text(json.dumps(document))
    report = verify_path(bars)
    assert rule in {finding.rule for finding in report.findings}


def test_files_that_cannot_be_checked(saved: Path) -> None:
    document = json.loads(saved.read_text())
    for change, said in [
        ({"format": 2}, "format"),
        ({"sources": []}, "as long as polygons"),
        ({"polygons": [{"vertices_m": [[0, 0]], "friction": 1}], "sources": [{}]}, "vertices_m"),
        ({"input": {"path": "/etc/passwd", "sha256": "", "reading": {}}}, "relative"),
    ]:
        saved.write_text(json.dumps(document | change))
        with pytest.raises(InputError, match=said):
            verify_path(saved)
    saved.write_text(json.dumps(document))
    scan = saved.parent / document["input"]["path"]
    np.save(scan, np.zeros((5, 5)))
    with pytest.raises(InputError, match="another version"):
        verify_path(saved)


@pytest.mark.skipif(not DATA.is_dir(), reason="../shared/data/elevation is absent")
@pytest.mark.parametrize(
    ("name", "cell_m", "no_data"),
    [
        ("real_stairs_125cm", 0.04, 0),
        ("real_stairs_125cm", 0.02, 0),
        ("real_stairs_125cm", 0.02, None),
        ("terrain", 0.02, None),
    ],
)
def test_recorded_scans_are_segmented_honestly(tmp_path: Path, name: str, cell_m: float, no_data: int | None) -> None:
    source = DATA / f"{name}.png"
    elevation = read_elevation(source, resolution_m=cell_m, height_range_m=(0, 1.25), no_data=no_data)
    options = SegmentOptions()
    path = tmp_path / "terrain.json"
    write_terrain(path, segment_terrain(elevation, options), options, source, elevation.reading)
    report = verify_path(path)
    assert report.accepted, report.findings


def test_planar_regions_are_checked_too(tmp_path: Path) -> None:
    corners = [(0, 0), (1, 0), (1, 1), (0.5, 0.3), (0, 1)]
    region = {
        "plane_parameters": {
            "position": {"x": 1, "y": 2, "z": 0.3},
            "orientation": {"x": 0, "y": 0, "z": 0, "w": 1},
        },
        "boundary": {"outer_boundary": {"points": [{"x": x, "y": y} for x, y in corners]}},
    }
    source = tmp_path / "regions.json"
    source.write_text(json.dumps([region]))
    options = SegmentOptions()
    path = tmp_path / "terrain.json"
    terrain = terrain_of_regions(read_planar_regions(source), options)
    write_terrain(path, terrain, options, source, {"as": "planar regions", "topic": None, "message": -1})
    assert verify_path(path).accepted
    document = json.loads(path.read_text())
    shift(document, 0.3, 0.0)
    path.write_text(json.dumps(document))
    assert {finding.rule for finding in verify_path(path).findings} == {"terrain, region"}
