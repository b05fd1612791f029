"""Checks the terrain of a quadruped that was laid over a scan: its polygons are some of the scan's, turned.

Written from formats.md, section 9, key ``laid``. The polygons of the scan are checked by ``terrain_polygons``.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from surefoot.errors import InputError
from surefoot.verify.artefacts import checked_file
from surefoot.verify.findings import Ledger
from surefoot.verify.quadruped_map import Array, Patch, read_map

_OFF_M = 1e-6


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
    laid = ground.given.mapping("laid")
    scan = read_map(checked_file(laid, path.parent, "scan", "sha256"))
    yaw = math.radians(laid.number("yaw_deg"))
    back = np.array([[math.cos(yaw), -math.sin(yaw), 0.0], [math.sin(yaw), math.cos(yaw), 0.0], [0.0, 0.0, 1.0]])
    middles = cKDTree(np.array([one.vertices_m.mean(axis=0) for one in scan.patches]))
    for number, one in enumerate(ground.patches):
        corners = one.vertices_m @ back.T
        near = middles.query_ball_point(corners.mean(axis=0), 2 * _OFF_M)
        if not any(_same(corners, one.friction, scan.patches[k]) for k in near):
            message = "is no polygon of the scan, turned by laid.yaw_deg"
            ledger.refuse("laid, polygons", message, f"polygons[{number}]")
    ledger.counts["polygons"] = len(ground.patches)
    ledger.counts["of"] = len(scan.patches)


def _same(corners_m: Array, friction: float, other: Patch) -> bool:
    return (
        corners_m.shape == other.vertices_m.shape
        and friction == other.friction
        and float(np.abs(corners_m - other.vertices_m).max()) <= _OFF_M
    )
