"""Evaluates every constraint of the foothold model on the numbers of a plan, and its cost.

A transcription of docs/footholds.md of its own: plain arrays, no matrices of rows.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from surefoot.verify.footholds.file import Array, FootholdFile
from surefoot.verify.footholds.legs import legs_in

PLANE_TOLERANCE_M = 1e-6


class Surface:
    """A polygon's plane, sides and friction pyramid, from its corners.

    Args:
        corners: of a convex polygon, in order.
        friction: coefficient.
    """

    def __init__(self, corners: Any, friction: float) -> None:
        self.corners = np.array(corners, dtype=float)
        first = self.corners[0]
        fan = self.corners[1:] - first
        area = np.cross(fan[:-1], fan[1:]).sum(axis=0)
        self.normal = area / np.linalg.norm(area)
        if self.normal[2] < 0:
            self.normal, self.corners = -self.normal, self.corners[::-1]
        ex = np.array([1.0, 0.0, 0.0])
        self.t1 = ex - (ex @ self.normal) * self.normal
        self.t1 /= np.linalg.norm(self.t1)
        self.t2 = np.cross(self.normal, self.t1)
        self.slope = friction / np.sqrt(2.0)

    def outside(self, point: Array) -> float:
        """Return by how much a point is off the plane (beyond its tolerance) or beyond a side [m]."""
        off = abs(float((point - self.corners[0]) @ self.normal)) - PLANE_TOLERANCE_M
        sides = np.roll(self.corners, -1, axis=0) - self.corners
        inward = np.cross(self.normal, sides)
        inward /= np.linalg.norm(inward, axis=1)[:, None]
        return max(off, -float(((point - self.corners) * inward).sum(axis=1).min()))

    def slip(self, forces: Array) -> float:
        """Return by how much forces, shape (k, 3), leave the inner friction pyramid [N]."""
        press = forces @ self.normal
        tangential = np.maximum(np.abs(forces @ self.t1), np.abs(forces @ self.t2))
        return float(np.maximum(tangential - self.slope * press, -press).max(initial=0.0))

    def rays(self) -> Array:
        """Return the edges of the friction pyramid, shape (4, 3)."""
        s = self.slope
        return np.array([self.normal + a * s * self.t1 + b * s * self.t2 for a in (-1, 1) for b in (-1, 1)])


def surfaces(plan: FootholdFile) -> list[Surface]:
    """Return the polygons of a plan."""
    return [Surface(one["vertices_m"], float(one["friction"])) for one in plan.values["polygons"]]


def start_surface(plan: FootholdFile, ground: list[Surface], foot: int) -> int:
    """Return the first polygon that holds a start foot; -1 when there is none."""
    point = np.array(plan.values["start"]["feet_m"][foot], dtype=float)
    return next((r for r, one in enumerate(ground) if one.outside(point) <= 1e-6), -1)


def references(plan: FootholdFile) -> tuple[Array, Array, Array]:
    """Return the references of base (N, 3) and angles (N, 3), and the rotation matrices of the angles (N, 3, 3)."""
    values, size = plan.values, len(plan.contacts)
    ramp = np.linspace(0.0, 1.0, size)[:, None]
    start, goal = values["start"], values["goal"]
    base = (1 - ramp) * np.array(start["position_m"], dtype=float) + ramp * np.array(goal["position_m"], dtype=float)
    first, last = np.array(start["rpy_rad"], dtype=float), np.array(goal["rpy_rad"], dtype=float)
    angles = (1 - ramp) * first + ramp * last
    if values["options"]["pitch_keyframe"]:
        way = base[-1] - base[0]
        slope = -np.arctan2(way[2], np.hypot(way[0], way[1]))
        angles[:, 1] = np.interp(ramp[:, 0], (0.0, 0.5, 1.0), (first[1], slope, last[1]))
    return base, angles, np.array([_turn(*row) for row in angles])


def _turn(roll: float, pitch: float, yaw: float) -> Array:
    def about(axis: int, angle: float) -> Array:
        a, b = [k for k in range(3) if k != axis]
        matrix = np.eye(3)
        sign = -1.0 if axis == 1 else 1.0
        matrix[a, a] = matrix[b, b] = np.cos(angle)
        matrix[a, b], matrix[b, a] = -sign * np.sin(angle), sign * np.sin(angle)
        return matrix

    return about(2, yaw) @ about(1, pitch) @ about(0, roll)


def nominal(plan: FootholdFile) -> Array:
    """Return the nominal feet in the base frame, shape (4, 3)."""
    x, y, z = plan.values["robot"]["foot_reference_m"]
    return np.array([[x, y, z], [x, -y, z], [-x, y, z], [-x, -y, z]], dtype=float)


def jacobians(plan: FootholdFile) -> Array:
    """Return d foot / d joints of a leg with abduction (x), hip (y) and knee (y), shape (4, 3, 3)."""
    robot = plan.values["robot"]
    q0, q1, q2 = (float(q) for q in robot["joint_reference_rad"])
    link, offset = float(robot["link_m"]), float(robot["hip_offset_m"])
    found = []
    for side in (1, -1, 1, -1):
        roll = _turn(q0, 0.0, 0.0)
        hip = np.array([0.0, side * offset, 0.0])
        thigh = _turn(0.0, q1, 0.0) @ np.array([0.0, 0.0, -link])
        shank = _turn(0.0, q1 + q2, 0.0) @ np.array([0.0, 0.0, -link])
        y = np.array([0.0, 1.0, 0.0])
        columns = [
            np.cross([1.0, 0.0, 0.0], roll @ (hip + thigh + shank)),
            roll @ np.cross(y, thigh + shank),
            roll @ np.cross(y, shank),
        ]
        found.append(np.array(columns).T)
    return np.array(found)


def violations(plan: FootholdFile) -> dict[str, float]:
    """Return the worst violation of every family of constraints."""
    a, values = plan.arrays, plan.values
    found = {**_ends(plan), **_motion_laws(plan), **_limits(plan)}
    ground = surfaces(plan)
    found["region"] = max(
        (ground[r].outside(a["feet_m"][s.touch, s.foot]) for s, r in zip(plan.steps, plan.polygons, strict=True)),
        default=0.0,
    )
    found["friction"] = _friction(plan, ground)
    if values["options"]["collision"]:
        found["collision"] = _collision(plan)
    return found


def _ends(plan: FootholdFile) -> dict[str, float]:
    a, start, goal = plan.arrays, plan.values["start"], plan.values["goal"]
    errors = [
        a["base_m"][0] - np.array(start["position_m"]),
        a["rpy_rad"][0] - np.array(start["rpy_rad"]),
        a["base_m"][-1] - np.array(goal["position_m"]),
        a["rpy_rad"][-1] - np.array(goal["rpy_rad"]),
        (a["feet_m"][0] - np.array(start["feet_m"])).ravel(),
    ]
    errors += [a[name][end] for name in ("base_velocity_mps", "rpy_rate_radps") for end in (0, -1)]
    return {"boundary": max(float(np.abs(error).max()) for error in errors)}


def _motion_laws(plan: FootholdFile) -> dict[str, float]:
    a, dt, robot = plan.arrays, plan.number("step_s"), plan.values["robot"]
    chains = (
        ("base_m", "base_velocity_mps", "base_acceleration_mps2"),
        ("rpy_rad", "rpy_rate_radps", "rpy_acceleration_radps2"),
        ("feet_m", "feet_velocity_mps", "feet_acceleration_mps2"),
    )
    integration = 0.0
    for chain in chains:
        for low, high in pairwise(chain):
            integration = max(integration, float(np.abs(a[low][1:] - a[low][:-1] - dt * a[high][1:]).max()))
    gravity = np.array([0.0, 0.0, -plan.number("gravity_mps2")])
    mass = float(robot["mass_kg"])
    newton = mass * (a["base_acceleration_mps2"] - gravity) - a["forces_n"].sum(axis=1)
    found = {
        "integration": integration,
        "dynamics": float(np.abs(newton).max()),
        "contact": max(
            float(np.abs(a["feet_velocity_mps"][plan.contacts]).max(initial=0.0)),
            float(np.abs(a["forces_n"][~plan.contacts]).max(initial=0.0)),
        ),
    }
    if plan.values["options"]["moment_balance"]:
        turns = references(plan)[2]
        arms = np.einsum("iab,jb->ija", turns, nominal(plan))
        inertia = np.diag(np.array(robot["inertia_kgm2"], dtype=float))
        spin = np.einsum("iab,bc,idc,id->ia", turns, inertia, turns, a["rpy_acceleration_radps2"])
        found["moment"] = float(np.abs(spin - np.cross(arms, a["forces_n"]).sum(axis=1)).max())
    return found


def _limits(plan: FootholdFile) -> dict[str, float]:
    a, robot, options = plan.arrays, plan.values["robot"], plan.values["options"]
    torque = np.einsum("jab,ija->ijb", jacobians(plan), a["forces_n"])
    spin = np.abs(np.array(robot["inertia_kgm2"]) * a["rpy_acceleration_radps2"])
    local = np.einsum("iba,ijb->ija", references(plan)[2], a["feet_m"] - a["base_m"][:, None])
    found = {
        "torque": float((np.abs(torque) - np.array(robot["torque_max_nm"])).max()),
        "base torque": float((spin - float(robot["base_torque_max_nm"])).max()),
        "reach": float((np.abs(local - nominal(plan)) - np.array(robot["foot_reach_m"])).max()),
    }
    if options.get("joint_reach"):
        found["leg"] = float(legs_in(plan).joints_rad(local)[1].max())
    if options["moment_balance"]:
        found["tilt"] = float((np.abs(a["rpy_rad"] - references(plan)[1]) - float(options["tilt_max_rad"])).max())
    height = float(options["clearance_m"])
    if height > 0:
        lacks = [0.0]
        for step in plan.steps:
            z, quarter = a["feet_m"][:, step.foot, 2], (step.touch - step.lift) // 4
            inner = z[step.lift + quarter : step.touch - quarter]
            if len(inner):
                lacks.append(max(z[step.lift - 1], z[step.touch]) + height - float(inner.min()))
        found["clearance"] = max(lacks)
    if options["com_support_m"] is not None:
        held = plan.contacts.sum(axis=1) >= 3
        mean = (a["feet_m"] * plan.contacts[..., None]).sum(axis=1)[held] / plan.contacts.sum(axis=1)[held, None]
        off = np.abs(a["base_m"][held, :2] - mean[:, :2]) - float(options["com_support_m"])
        found["support"] = float(off.max(initial=0.0))
    return {name: max(worst, 0.0) for name, worst in found.items()}


def _friction(plan: FootholdFile, ground: list[Surface]) -> float:
    worst = 0.0
    for foot in range(4):
        index = start_surface(plan, ground, foot)
        if index < 0:
            return float("inf")
        lifts = [(step.touch, r) for step, r in zip(plan.steps, plan.polygons, strict=True) if step.foot == foot]
        for i in np.flatnonzero(plan.contacts[:, foot]):
            on = [r for touch, r in lifts if touch <= i]
            surface = ground[on[-1]] if on else ground[index]
            worst = max(worst, surface.slip(plan.arrays["forces_n"][i : i + 1, foot]))
    return worst


def windows(plan: FootholdFile) -> list[range]:
    """Return the samples of every collision window, both ends included."""
    count, last = int(plan.values["options"]["collision_windows"]), len(plan.contacts) - 1
    return [range(w * last // count, (w + 1) * last // count + 1) for w in range(count)]


def _collision(plan: FootholdFile) -> float:
    worst, parts = 0.0, windows(plan)
    for number, region in enumerate(plan.regions):
        given = plan.values["free_regions"][region]
        points = plan.arrays["feet_m"][list(parts[number % len(parts)]), number // len(parts)]
        worst = max(
            worst, float((points @ np.array(given["A"], dtype=float).T - np.array(given["b"], dtype=float)).max())
        )
    if len(plan.regions) != 4 * len(parts):
        return float("inf")
    return worst


def cost(plan: FootholdFile) -> float:
    """Return the cost of a plan: weights times squared deviations, over all samples."""
    a, w = plan.arrays, plan.values["weights"]
    base, angles, turns = references(plan)
    feet = base[:, None] + np.einsum("iab,jb->ija", turns, nominal(plan))
    deviations = (
        ("position", a["base_m"] - base),
        ("orientation", a["rpy_rad"] - angles),
        ("foot", a["feet_m"] - feet),
        ("acceleration", a["base_acceleration_mps2"]),
        ("angular_acceleration", a["rpy_acceleration_radps2"]),
        ("foot_acceleration", a["feet_acceleration_mps2"]),
        ("force", a["forces_n"]),
    )
    return float(sum(float(w[name]) * float((deviation**2).sum()) for name, deviation in deviations))


def gravity_cost(plan: FootholdFile) -> float:
    """Return the part of the cost that only holds the weight up, shared by all feet in contact."""
    held = plan.contacts.sum(axis=1)
    weight = float(plan.values["robot"]["mass_kg"]) * plan.number("gravity_mps2")
    return float(plan.values["weights"]["force"]) * weight**2 * float((1.0 / held[held > 0]).sum())
