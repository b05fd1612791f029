"""Checks the terrain of a quadruped that was laid over a scan: its polygons are some of the scan's, turned.

Written from formats.md, section 9, key ``laid``. Polygons that it leaves out have to lie in crevices: what stands out
may not be forgotten. The polygons of the scan are checked by ``terrain_polygons``.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import shapely  # type: ignore[import-untyped]
from scipy.spatial import cKDTree

from surefoot.errors import InputError
from surefoot.verify.artefacts import checked_file, parse_json, read_bytes
from surefoot.verify.findings import Ledger
from surefoot.verify.terrain.map import Array, MapFile, Patch, read_map
from surefoot.verify.values import Fields

_OFF_M = 1e-6
_HIGHER_M = 0.05
_NEAR_M = 0.11
_PROBE_M = 0.02
_CLOSED_SHARE = 0.9


def check_laid_terrain(path: Path, ledger: Ledger) -> None:
    """Check a terrain against the scan that it was laid over.

    Args:
        path: of the terrain's file.
        ledger: takes the findings and counts.

    Raises:
        InputError: a file cannot be read, names no scan, or the scan has changed.
    """
    ground = read_map(path)
    if not ground.given.has("laid"):
        message = "was not laid over a scan by `surefoot terrain lay`: there is nothing to check it against"
        raise InputError(message, source=path, key="laid")
    ledger.counts["polygons"] = len(ground.patches)
    ledger.counts["of"] = check_against_scan(ground, path.parent, ledger)


def check_against_scan(ground: MapFile, folder: Path, ledger: Ledger) -> int:
    """Compare a terrain that was laid over a scan with that; return how many polygons the scan has.

    Args:
        ground: the terrain.
        folder: where its file stands.
        ledger: takes the findings.

    Raises:
        InputError: the scan cannot be read, or has changed.
    """
    laid = ground.given.mapping("laid")
    source = checked_file(laid, folder, "scan", "sha256")
    scan = read_map(source)
    _check_margin(ground, source, ledger)
    yaw = math.radians(laid.number("yaw_deg"))
    back = np.array([[math.cos(yaw), -math.sin(yaw), 0.0], [math.sin(yaw), math.cos(yaw), 0.0], [0.0, 0.0, 1.0]])
    middles = cKDTree(np.array([one.vertices_m.mean(axis=0) for one in scan.patches]))
    found: set[int] = set()
    for number, one in enumerate(ground.patches):
        corners = one.vertices_m @ back.T
        near = middles.query_ball_point(corners.mean(axis=0), 2 * _OFF_M)
        same = {k for k in near if _same(corners, one.friction, scan.patches[k])}
        if not same:
            message = "is no polygon of the scan, turned by laid.yaw_deg"
            ledger.refuse("laid, polygons", message, f"polygons[{number}]")
        elif same <= found:
            ledger.refuse("laid, polygons", "is there twice", f"polygons[{number}]")
        found |= same
    _check_left_out(scan.patches, found, ground.margin_m, ledger)
    return len(scan.patches)


def _same(corners_m: Array, friction: float, other: Patch) -> bool:
    return (
        corners_m.shape == other.vertices_m.shape
        and friction == other.friction
        and float(np.abs(corners_m - other.vertices_m).max()) <= _OFF_M
    )


def _check_margin(ground: MapFile, source: Path, ledger: Ledger) -> None:
    """Refuse another margin than the scan's: cells are measured with it put back."""
    options = Fields.of(parse_json(read_bytes(source), source), source).mapping("options", optional=True)
    if options.get("margin_m") is not None and options.number("margin_m") != ground.margin_m:
        ledger.refuse("laid, margin", "is not what was taken off the polygons of the scan", "margin_m")


def _check_left_out(patches: tuple[Patch, ...], kept: set[int], margin_m: float, ledger: Ledger) -> None:
    """Refuse a scan of which other ground was left out than what higher ground closes."""
    left = sorted(set(range(len(patches))) - kept)
    if not left:
        return
    outlines = [shapely.Polygon(one.vertices_m[:, :2]) for one in patches]
    heights = np.array([float(one.vertices_m[:, 2].mean()) for one in patches])
    for k in left:
        higher = [outlines[j] for j in np.flatnonzero(heights >= heights[k] + _HIGHER_M - _OFF_M)]
        probes = shapely.points(_probes(outlines[k]))
        near = shapely.union_all(shapely.buffer(higher, margin_m, join_style="mitre")) if higher else shapely.Point()
        closed = shapely.dwithin(probes, near, _NEAR_M + _OFF_M)
        if not closed.mean() >= _CLOSED_SHARE:
            message = f"polygons[{k}] of the scan is left out, and lies in no crevice of higher ground"
            ledger.refuse("laid, left out", message, "polygons")


def _probes(outline: shapely.Polygon) -> Array:
    """Return points of a polygon, 2 cm apart; its centroid if there are none."""
    west, south, east, north = outline.bounds
    x, y = np.meshgrid(np.arange(west, east, _PROBE_M), np.arange(south, north, _PROBE_M))
    inside = shapely.contains_xy(outline, x, y)
    points = np.column_stack((x[inside], y[inside]))
    return points if len(points) else np.array([[outline.centroid.x, outline.centroid.y]])
