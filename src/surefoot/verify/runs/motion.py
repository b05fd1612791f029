"""The continuous side of a run log: the pendulum integrated again, and the rules of rules.md 6 recomputed.

Everything is derived from positions and velocities in the map's frame; formulas are transcribed from Shamsah et al.,
T-RO 2023, Secs. III-V. "Sagittal" is along the heading of a step, "lateral" to its left.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from surefoot.verify.findings import Ledger
from surefoot.verify.navigation.claims import Claims
from surefoot.verify.plan.moves import CONTINUE, PRE_STEP, START, STOPPING, STRAIGHT, TURN
from surefoot.verify.runs.file import NUMBERS, VECTORS
from surefoot.verify.runs.pendulum import runge_kutta
from surefoot.verify.runs.replay import Walked
from surefoot.verify.scene.derived import Scene, fine_center_m

TOLERANCE = 1e-6
SUBSTEPS = 200
Vectors = NDArray[np.float64]
Flags = NDArray[np.bool_]


class Motion:
    """The steps of a log as arrays, one row a step; vectors under the names of formats.md without their units."""

    def __init__(self, walked: list[Walked], claims: Claims) -> None:
        self.walked = walked
        self.claims = claims
        self.of = {name: np.array([item.step.numbers[name] for item in walked]) for name in NUMBERS}
        self.at = {name: np.array([item.step.vectors[name] for item in walked]) for name in VECTORS}
        yaw, change = self.of["yaw_rad"], self.of["heading_change_rad"]
        self.ahead, self.left = _axes(yaw)
        self.old_ahead, self.old_left = _axes(yaw - change)
        self.turning = np.abs(change) > TOLERANCE
        self.side = np.array([1.0 if item.step.stance == 0 else -1.0 for item in walked])
        self.pushed = np.array([item.step.push is not None for item in walked])
        self.side_speed_after = np.array([item.step.side_speed_mps or 0.0 for item in walked])
        self.side_speed = np.concatenate([[0.0], self.side_speed_after[:-1]])

    def gap(self, end: str, start: str) -> Vectors:
        """Return the horizontal vectors from one named point to another."""
        gap: Vectors = self.at[end][:, :2] - self.at[start][:, :2]
        return gap


def check_motion(scene: Scene, claims: Claims, walked: list[Walked], ledger: Ledger) -> None:
    """Check every step of a log and the joints between them."""
    if not walked:
        return
    motion = Motion(walked, claims)

    def require(rule: str, message: str, holds: Flags) -> None:
        broken = np.flatnonzero(~holds)
        if len(broken):
            ledger.refuse(rule, message, f"run.jsonl line {walked[int(broken[0])].step.line}", len(broken))

    with np.errstate(all="ignore"):
        _check_commands(scene, motion, require)
        _check_dynamics(scene, motion, require)
        _check_theorems(motion, require)
        _check_joints(motion, require)
        _count(motion, require, ledger)


Require = Callable[[str, str, Flags], None]


def _check_commands(scene: Scene, motion: Motion, require: Require) -> None:
    """Check heading, length and waypoint of every step against the action game."""
    claims, rule = motion.claims, "rules.md 6, commands"
    steps = claims.turn_steps
    angle = math.pi / 2 / steps
    yaw = np.array([math.pi / 2 - item.after[2] * angle for item in motion.walked]) + scene.frame.rotation_rad
    before = np.array([math.pi / 2 - item.step.core[2] * angle for item in motion.walked]) + scene.frame.rotation_rad
    require(rule, "the heading is not that of the fine state", np.abs(_wrapped(motion.of["yaw_rad"] - yaw)) < TOLERANCE)
    change = _wrapped(yaw - before)
    require(
        rule, "the heading change is not the action's", np.abs(motion.of["heading_change_rad"] - change) < TOLERANCE
    )
    length = np.array([_length_m(claims, item) for item in motion.walked])
    outcomes = np.array([[item.step.sagittal, item.step.lateral] for item in motion.walked])
    shift = outcomes * claims.walking["fine_cell_m"]
    walked = length + shift[:, 0]
    require(rule, "the length is not the action's", np.abs(motion.of["length_m"] - walked) < TOLERANCE)
    reach = motion.at["waypoint_m"][:, :2] + motion.ahead * walked[:, None] + motion.left * shift[:, 1:]
    moved = [item.step.moved for item in motion.walked]
    east, north = _axes(np.full(len(moved), scene.frame.rotation_rad))
    reach += claims.walking["fine_cell_m"] * np.array(moved)[:, 1:] * east
    reach -= claims.walking["fine_cell_m"] * np.array(moved)[:, :1] * north
    close = _near(reach, motion.at["next_waypoint_m"][:, :2])
    require(rule, "the waypoint does not move by length and outcome", close)
    for name, places in (
        ("waypoint_m", [(item.cell, item.step.core) for item in motion.walked]),
        ("next_waypoint_m", [(item.after_cell, item.after) for item in motion.walked]),
    ):
        centers = np.array([fine_center_m(scene, cell, (core[0], core[1])) for cell, core in places])
        off = np.abs(scene.frame.to_grid(motion.at[name][:, :2]) - centers).max(axis=1)
        inside = off <= claims.walking["fine_cell_m"] / 2 + TOLERANCE
        require("rules.md 6, waypoint", f"{name} is outside the fine cell of the game", inside)


def _length_m(claims: Claims, item: Walked) -> float:
    """Return the commanded length of a step."""
    action, core = item.step.action, item.step.core
    if action in (CONTINUE, TURN):
        kind = 1 if core[4] in (2, 5, 6) else 0
        steps = claims.turn_steps
        done = 0 if action == TURN else (core[2] if core[4] % 2 == 0 else -core[2]) % steps
        cells = claims.turns[kind][done]
    elif action in (STOPPING, START):
        cells = claims.walking["stop_cells"]
    elif action == PRE_STEP:
        cells = claims.walking["pre_step_cells"]
    else:
        cells = claims.straight[action - STRAIGHT]
    return cells * claims.walking["fine_cell_m"]


def _check_dynamics(scene: Scene, motion: Motion, require: Require) -> None:
    """Integrate both halves of every step, and check apexes, heights and speeds."""
    of, at, rule = motion.of, motion.at, "rules.md 6, pendulum"
    require(rule, "omega is not the robot's", np.abs(of["omega_radps"] - scene.robot.omega_radps) < TOLERANCE)
    require(rule, "a time is not positive", (of["first_half_s"] > 0) & (of["second_half_s"] > 0))
    for start, speed in (("velocity_mps", "apex_speed_mps"), ("next_velocity_mps", "next_apex_speed_mps")):
        before = start == "velocity_mps"
        axis, aside = (motion.old_ahead, motion.old_left) if before else (motion.ahead, motion.left)
        side_speed = motion.side_speed if before else motion.side_speed_after
        straight = _near(at[start], axis * of[speed][:, None] + aside * side_speed[:, None]) & (of[speed] > 0)
        require(rule, f"{start} is not {speed} along the heading", straight)
    squared = scene.robot.omega_radps**2
    position, velocity = integrated(at["com_m"], at["velocity_mps"], at["foot_m"], of["first_half_s"], squared)
    same = _near(position, at["switch_m"]) & _near(velocity, at["switch_velocity_mps"])
    require(rule, "integrating the first half does not lead to the switch", same | motion.pushed)
    position, velocity = integrated(
        at["switch_m"], at["switch_velocity_mps"], at["next_foot_m"], of["second_half_s"], squared
    )
    same = _near(position, at["next_com_m"][:, :2]) & _near(velocity, at["next_velocity_mps"])
    require(rule, "integrating the second half does not lead to the next apex", same | motion.pushed)
    along = _dot(motion.gap("next_foot_m", "next_waypoint_m"), motion.ahead)
    require(rule, "the next foot is not at the new waypoint sagittally", (np.abs(along) < TOLERANCE) | motion.pushed)
    along = _dot(motion.gap("next_foot_m", "next_com_m"), motion.ahead)
    require(rule, "the next apex is not above the next foot sagittally", np.abs(along) < TOLERANCE)
    for com, foot, waypoint in (("com_m", "foot_m", "waypoint_m"), ("next_com_m", "next_foot_m", "next_waypoint_m")):
        rise = at[com][:, 2] - at[foot][:, 2] - scene.robot.apex_height_m
        require(rule, f"{com} is not at apex height over the foot", np.abs(rise) < TOLERANCE)
        level = np.abs(at[waypoint][:, 2] - at[foot][:, 2]) < TOLERANCE
        require("formats.md 3, waypoint", f"the height of {waypoint} is not that of the foot", level)
    change = at["next_foot_m"][:, 2] - at["foot_m"][:, 2]
    require(rule, "the height change is not that of the feet", np.abs(of["height_change_m"] - change) < TOLERANCE)


def _check_theorems(motion: Motion, require: Require) -> None:
    """Check the hard rules of rules.md 6."""
    of, at, walking = motion.of, motion.at, motion.claims.walking
    current, following = (_dot(at[name][:, :2], motion.ahead) for name in ("com_m", "next_com_m"))
    foot, next_foot = (_dot(at[name][:, :2], motion.ahead) for name in ("foot_m", "next_foot_m"))
    switch = _dot(at["switch_m"], motion.ahead)
    omega, travel = of["omega_radps"], following - current
    gain = of["next_apex_speed_mps"] ** 2 - _dot(at["velocity_mps"], motion.ahead) ** 2
    most = omega**2 * travel * (current + following - 2 * foot)
    least = -(omega**2) * travel * (2 * next_foot - current - following)
    holds = (gain <= most + TOLERANCE) & (gain >= least - TOLERANCE)
    holds &= (switch >= current - TOLERANCE) & (switch <= following + TOLERANCE)
    require(
        "rules.md 6, Theorem IV.1", "the apex speeds cannot follow each other", holds | motion.turning | motion.pushed
    )
    holds |= ~motion.turning | motion.pushed
    require("rules.md 6, Theorems IV.3 and IV.4", "the apex speeds cannot follow each other", holds)
    aside = _dot(motion.gap("foot_m", "com_m"), motion.old_left)
    holds = may_turn(of["apex_speed_mps"], aside, motion.side, of["heading_change_rad"], omega)
    swayed = may_go_on(of["apex_speed_mps"], motion.side_speed, aside, of["heading_change_rad"], omega)
    holds = np.where(motion.side_speed == 0, holds, swayed)
    require("rules.md 6, Theorem IV.2", "the heading change makes the robot fall", holds)
    aside = _dot(motion.gap("next_foot_m", "next_com_m"), motion.left)
    holds = np.ones(len(aside), np.bool_)
    for index, item in enumerate(motion.walked):
        if motion.pushed[index]:
            continue
        for change in {*item.step.next_heading_changes_rad, *item.may_turn_rad}:
            now = slice(index, index + 1)
            speed, turn = of["next_apex_speed_mps"][now], np.array([change])
            holds[index] &= bool(may_turn(speed, aside[now], -motion.side[now], turn, omega[now])[0])
    require("rules.md 6, Theorem IV.2", "a heading change that may come next makes the robot fall", holds)
    speed = _dot(at["switch_velocity_mps"], motion.ahead)
    slow = (speed <= walking["switch_speed_max_mps"] + TOLERANCE) | motion.pushed
    require("rules.md 6, switch speed", "is above the limit", slow)
    wide = _dot(motion.gap("next_foot_m", "next_waypoint_m"), motion.left)
    near = np.abs(wide) <= walking["safety_distance_m"] + TOLERANCE
    require("rules.md 6, safety distance", "the foot is too far from the waypoint", near)


def may_turn(speed: Vectors, aside: Vectors, side: Vectors, change: Vectors, omega: Vectors) -> Flags:
    """Return whether Theorem IV.2, side-aware, allows heading changes at an apex.

    Args:
        speed: at the apex.
        aside: how far the foot is left of the centre of mass.
        side: +1 when the left foot carries the robot, -1 for the right; a foot on its wrong side has to pass both
            cases.
        change: heading change, left positive.
        omega: of the pendulum.
    """
    slope = np.tan(np.abs(change))
    reach = np.abs(aside) * omega
    over = speed >= reach * slope - TOLERANCE
    beside = speed * slope <= reach + TOLERANCE
    toward = np.sign(change) == side
    crossed = np.sign(aside) != side
    holds = np.where(toward, over, beside) & (~crossed | (over & beside))
    safe: Flags = holds | (np.abs(change) <= TOLERANCE)
    return safe


def may_go_on(speed: Vectors, side_speed: Vectors, aside: Vectors, change: Vectors, omega: Vectors) -> Flags:
    """Return whether an apex that a push has left with a lateral speed gets over its foot, and not across it.

    Args:
        speed: along the heading before its change.
        side_speed: to the left of it.
        aside: how far the foot is left of the centre of mass.
        change: heading change, left positive.
        omega: of the pendulum.
    """
    sine, cosine = np.sin(change), np.cos(change)
    over = speed * cosine + side_speed * sine >= omega * aside * sine - TOLERANCE
    toward = np.sign(aside) * (side_speed * cosine - speed * sine)
    kept: Flags = over & (toward <= omega * np.abs(aside) * cosine + TOLERANCE)
    return kept


def _check_joints(motion: Motion, require: Require) -> None:
    """Check that every step begins where the last one ended."""
    walked, rule = motion.walked, "rules.md 6, continuity"
    first = walked[0].step
    for index, item in enumerate(walked):
        step = item.step
        standing = step.action == START
        before = walked[index - 1].step if index else None
        start_s = 0.0
        joined = (step.rise is not None) == standing and (step.rest is not None) == (
            step.action == STOPPING and (step.push is None or not step.push.put_off)
        )
        joined &= (step.closing_foot_m is not None) == (step.rest is not None)
        if before is not None:
            pairs = [("next_com_m", "com_m"), ("next_velocity_mps", "velocity_mps"), ("foot_m", "swing_lift_m")]
            pairs += [("next_foot_m", "foot_m"), ("next_waypoint_m", "waypoint_m")]
            kept = pairs[3:] if standing else pairs
            joined &= all(_near(before.vectors[a][None], step.vectors[b][None])[0] for a, b in kept)
            joined &= step.stance != before.stance
            start_s = before.time_s + before.duration_s
            if standing:
                joined &= before.rest is not None and before.closing_foot_m is not None
            if before.rest is not None and before.closing_foot_m is not None and step.rise is not None:
                start_s += before.rest.lasts_s
                joined &= bool(_near(before.rest.com_m[None], step.rise.com_m[None])[0])
                joined &= bool(_near(before.closing_foot_m[None], step.vectors["swing_from_m"][None])[0])
        joined &= first is not step or standing
        rise_s = step.rise.lasts_s if step.rise is not None else 0.0
        late = step.time_s - rise_s - start_s
        timely = late > -TOLERANCE if standing else abs(late) < TOLERANCE
        elsewhere = np.arange(len(walked)) != index
        require(rule, "the step does not begin where the last one ended", elsewhere | joined)
        require("formats.md 3, time_s", "is not the time at the start apex of the step", elsewhere | timely)


def _count(motion: Motion, require: Require, ledger: Ledger) -> None:
    """Recompute dy1 and dy2 and what is counted, compare with the log, and note the counts."""
    of, walking = motion.of, motion.claims.walking
    dy1 = _dot(motion.gap("next_com_m", "next_waypoint_m"), motion.left)
    dy2 = _dot(motion.gap("next_foot_m", "next_com_m"), motion.left)
    close = (np.abs(of["dy1_m"] - dy1) < TOLERANCE) & (np.abs(of["dy2_m"] - dy2) < TOLERANCE)
    require("rules.md 6, dy1 and dy2", "are not what the positions give", close)
    sums = dy1 + dy2
    start = _dot(motion.gap("foot_m", "waypoint_m"), motion.old_left)[0]
    before = np.concatenate([[start], sums[:-1]])
    alternates = before * sums < 0
    logged = np.array([item.step.sign_alternates for item in motion.walked])
    unclear = np.minimum(np.abs(before), np.abs(sums)) < TOLERANCE
    require(
        "rules.md 6, Proposition V.1",
        "sign_alternates is not what the positions give",
        (logged == alternates) | unclear,
    )
    slope = math.tan(math.radians(walking["turn_angle_deg"])) if walking["turn_angle_deg"] < 90 else math.inf
    low, high = motion.claims.apex_speeds
    omega = of["omega_radps"]
    least, most = high * slope / omega, low / (omega * slope)
    inside = (np.abs(dy2) >= least) & (np.abs(dy2) <= most)
    logged = np.array([item.step.dy2_in_range for item in motion.walked])
    unclear = np.minimum(np.abs(np.abs(dy2) - least), np.abs(np.abs(dy2) - most)) < TOLERANCE
    require("rules.md 6, Definition V.2", "dy2_in_range is not what the positions give", (logged == inside) | unclear)
    ledger.counts["sign_alternation_share"] = round(float(alternates.mean()), 6)
    ledger.counts["dy2_in_range_share"] = round(float(inside.mean()), 6)


def integrated(
    com: Vectors, velocity: Vectors, foot: Vectors, lasts_s: Vectors, omega_squared: float
) -> tuple[Vectors, Vectors]:
    """Integrate the pendulum in both axes, every row for as long as it lasts."""
    step_s = (np.clip(lasts_s, 0.0, 10.0) / SUBSTEPS)[:, None]
    return runge_kutta(com[:, :2], velocity, foot[:, :2], omega_squared, step_s, SUBSTEPS)


def _axes(yaw: Vectors) -> tuple[Vectors, Vectors]:
    """Return the unit vectors along a heading and to its left."""
    ahead = np.stack([np.cos(yaw), np.sin(yaw)], axis=1)
    return ahead, np.stack([-ahead[:, 1], ahead[:, 0]], axis=1)


def _dot(vectors: Vectors, axes: Vectors) -> Vectors:
    product: Vectors = (vectors * axes).sum(axis=1)
    return product


def _near(one: Vectors, other: Vectors) -> Flags:
    """Return which rows agree."""
    return np.asarray((np.abs(one - other) < TOLERANCE).all(axis=1))


def _wrapped(angle: Vectors) -> Vectors:
    """Return angles in (-pi, pi]."""
    turned: Vectors = np.arctan2(np.sin(angle), np.cos(angle))
    return turned
