"""The feet of a run log: on free pixels, at the height of the floor, clear of risers; double supports that balance."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from surefoot.verify.findings import Ledger
from surefoot.verify.runs.file import Support
from surefoot.verify.runs.replay import Walked
from surefoot.verify.scene.derived import Scene
from surefoot.verify.scene.grid import disc_is_free
from surefoot.verify.scene.heights import RISER_CLEARANCE_M

TOLERANCE_M = 1e-6
SAMPLES = 65
Vector = NDArray[np.float64]


def check_feet(scene: Scene, walked: list[Walked], ledger: Ledger) -> None:
    """Check every foot that is planted in a log."""
    done: set[tuple[float, ...]] = set()
    for item in walked:
        planted = [item.step.vectors["foot_m"], item.step.vectors["next_foot_m"]]
        if item.step.rise is not None:
            planted.append(item.step.vectors["swing_from_m"])
            if not np.allclose(
                item.step.vectors["swing_from_m"], item.step.vectors["swing_lift_m"], rtol=0, atol=TOLERANCE_M
            ):
                ledger.refuse("rules.md 6, continuity", "the other foot is not where it stood", _where(item))
            if np.abs(item.step.vectors["swing_velocity_mps"]).max() > TOLERANCE_M:
                ledger.refuse("rules.md 6, continuity", "a standing foot moves", _where(item))
        if item.step.closing_foot_m is not None:
            planted.append(item.step.closing_foot_m)
        for foot in planted:
            key = tuple(float(value) for value in foot)
            if key not in done:
                done.add(key)
                _check_foot(scene, foot, _where(item), ledger)
    ledger.counts["footholds"] = len(done)


def _check_foot(scene: Scene, foot: Vector, where: str, ledger: Ledger) -> None:
    """Check one planted foot against map and terrain."""
    point = (float(foot[0]), float(foot[1]))
    if not disc_is_free(scene.floor, scene.solid, point, scene.robot.foot_radius_m):
        ledger.refuse(
            "rules.md 1, footprint", f"a foot at ({point[0]:.3f}, {point[1]:.3f}) m is not in free space", where
        )
    if abs(scene.terrain.height_at(point) - float(foot[2])) > TOLERANCE_M:
        ledger.refuse("rules.md 2, heights", "a foot is not at the height of the floor", where)
    if scene.terrain.riser_gap_m(point) < RISER_CLEARANCE_M - TOLERANCE_M:
        ledger.refuse("rules.md 2, risers", "a foot is closer than 0.10 m to a riser", where)


def check_supports(scene: Scene, walked: list[Walked], ledger: Ledger) -> None:
    """Check that the centre of pressure of every double support lies within the feet."""
    for item in walked:
        step, at = item.step, item.step.vectors
        yaw = step.numbers["yaw_rad"]
        if step.rise is not None:
            motion = (step.rise.com_m, np.zeros(2), at["com_m"], at["velocity_mps"])
            _check_support(scene, step.rise, motion, (at["foot_m"], at["swing_from_m"]), yaw, _where(item), ledger)
        if step.rest is not None and step.closing_foot_m is not None:
            motion = (at["next_com_m"], at["next_velocity_mps"], step.rest.com_m, np.zeros(2))
            _check_support(
                scene, step.rest, motion, (at["next_foot_m"], step.closing_foot_m), yaw, _where(item), ledger
            )


def _check_support(
    scene: Scene,
    support: Support,
    motion: tuple[Vector, Vector, Vector, Vector],
    feet: tuple[Vector, Vector],
    yaw_rad: float,
    where: str,
    ledger: Ledger,
) -> None:
    """Check one double support: start and end, with velocities, of a cubic per axis."""
    start, start_velocity, end, end_velocity = motion
    rule = "formats.md 3, double support"
    if support.lasts_s <= 0 or abs(float(start[2] - end[2])) > TOLERANCE_M:
        ledger.refuse(rule, "lasts no time, or changes height", where)
        return
    if abs(float(feet[0][2] - feet[1][2])) > TOLERANCE_M:
        ledger.refuse(rule, "the feet stand at different heights", where)
    pressure = _pressure(start[:2], start_velocity, end[:2], end_velocity, support.lasts_s, scene.robot.omega_radps)
    corners = np.concatenate([_outline(scene, foot, yaw_rad) for foot in feet])
    if outside_m(pressure, corners) > TOLERANCE_M:
        ledger.refuse(rule, "the centre of pressure leaves the feet", where)


def _pressure(
    start: Vector, start_velocity: Vector, end: Vector, end_velocity: Vector, lasts_s: float, omega_radps: float
) -> Vector:
    """Return samples of the centre of pressure x - x'' / omega^2 along a cubic."""
    t = np.linspace(0, lasts_s, SAMPLES)[:, None]
    gap = (end - start - start_velocity * lasts_s) / lasts_s**2
    bend = (end_velocity - start_velocity) / lasts_s
    square, cube = 3 * gap - bend, (bend - 2 * gap) / lasts_s
    position = start + start_velocity * t + square * t**2 + cube * t**3
    pressure: Vector = position - (2 * square + 6 * cube * t) / omega_radps**2
    return pressure


def _outline(scene: Scene, foot: Vector, yaw_rad: float) -> Vector:
    """Return the corners of a foot."""
    half = np.array([scene.robot.foot_half_length_m, scene.robot.foot_half_width_m])
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], float) * half
    cosine, sine = np.cos(yaw_rad), np.sin(yaw_rad)
    turned: Vector = corners @ np.array([[cosine, sine], [-sine, cosine]]) + foot[:2]
    return turned


def outside_m(points: Vector, corners: Vector) -> float:
    """Return how far the farthest of some points lies outside the convex hull of some corners; 0 inside.

    A point is outside by the largest distance to a line through two corners that has all corners on its other side.
    """
    worst = 0.0
    for first in corners:
        for second in corners:
            edge = second - first
            length = float(np.hypot(*edge))
            if length < 1e-12:
                continue
            normal = np.array([edge[1], -edge[0]]) / length
            if float(((corners - first) @ normal).max()) <= 1e-12:
                worst = max(worst, float(((points - first) @ normal).max()))
    return worst


def _where(item: Walked) -> str:
    return f"run.jsonl line {item.step.line}"
