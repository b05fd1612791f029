"""The numbers that walking depends on: the `walking` block of a scenario with its defaults filled in."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from numbers import Integral, Real
from typing import Any

from surefoot.errors import InputError
from surefoot.walking.turns import default_lengths, drift_free

_TYPICAL_FINE_CELL_M = 0.104
_FEWEST_BY_DEFAULT = 26
"""A cell needs room for a turn and its deviations; in cells below 2.7 m the steps shrink with the fine cells."""


@dataclass(frozen=True, slots=True)
class WalkingParameters:
    """The resolved `walking` block of a scenario (docs/formats.md, section 1).

    Lengths named ``_cells`` are in fine cells. Sources: Shamsah et al., T-RO 2023, Table III.

    Attributes:
        fine_cells: fine cells per side of a coarse cell.
        fine_cell_m: side of a fine cell.
        turn_angle_deg: heading change of one turn step.
        straight_cells: lengths of straight steps, in order of preference.
        pre_step_cells: length of the straight step before a type-B turn.
        stop_cells: length of a stop step and of a start step.
        turn_a_cells: lengths of a turn whose first step is away from the stance foot.
        turn_b_cells: lengths of a turn whose first step is toward the stance foot.
        side_band_cells: how many cells beside a walking robot stay inside its coarse cell.
        sagittal_outcomes_cells: how far a straight step may deviate along its heading.
        lateral_outcomes_cells: how far the last step of a turn may be corrected sideways.
        max_step_height_m: bound on the height change of a step.
        safety_distance_m: bound on foot to waypoint, sideways (b_safety).
        apex_speed_mps: least and most apex speed.
        steering_speed_max_mps: bound on the apex speed that a turn step leads to.
        switch_speed_max_mps: bound on the sagittal speed at the switch of the stance foot (v_max).
        dy1_m: desired distance of the apex CoM from the waypoint.
        dy2_m: desired distance of the foot from the apex CoM.
        cost_straight: weights c1 .. c4 of Algorithm 1 of a straight step.
        cost_steering: the same of a turn step.
        desired_duration_s: T_d of Algorithm 1.
        desired_width_m: W_d of Algorithm 1.
    """

    fine_cells: int
    fine_cell_m: float
    turn_angle_deg: float
    straight_cells: tuple[int, ...]
    pre_step_cells: int
    stop_cells: int
    turn_a_cells: tuple[float, ...]
    turn_b_cells: tuple[float, ...]
    side_band_cells: int
    sagittal_outcomes_cells: int
    lateral_outcomes_cells: int
    max_step_height_m: float
    safety_distance_m: float
    apex_speed_mps: tuple[float, float]
    steering_speed_max_mps: float
    switch_speed_max_mps: float
    dy1_m: float
    dy2_m: float
    cost_straight: tuple[float, float, float, float]
    cost_steering: tuple[float, float, float, float]
    desired_duration_s: float
    desired_width_m: float

    @property
    def turn_steps(self) -> int:
        """Return k, the number of steps of a quarter turn."""
        return round(90 / self.turn_angle_deg)

    @property
    def turn_rad(self) -> float:
        """Return the heading change of one turn step."""
        return math.pi / 2 / self.turn_steps


def walking_parameters(cell_size_m: float, **given: Any) -> WalkingParameters:
    """Fill in the defaults of the `walking` block and check it.

    Args:
        cell_size_m: side of a coarse cell.
        **given: any keys of the block; None means the default.

    Raises:
        InputError: naming the key and what is allowed.
    """
    cell_m = _number(cell_size_m, "grid.cell_size_m", 0.1, 100.0)
    known = [name for name in WalkingParameters.__slots__ if name != "fine_cell_m"]
    for name in given:
        if name not in known:
            raise InputError(f"unknown key; the walking block has: {', '.join(known)}", key=f"walking.{name}")

    def take(name: str, default: Any, check: Callable[..., Any], *bounds: float) -> Any:
        value = given.get(name)
        return check(default if value is None else value, f"walking.{name}", *bounds)

    fine = take("fine_cells", max(_FEWEST_BY_DEFAULT, round(cell_m / _TYPICAL_FINE_CELL_M)), _integer, 4, 64)
    angle, steps = take("turn_angle_deg", 22.5, _turn_angle)
    speeds = take("apex_speed_mps", (0.2, 0.7), _numbers, 2, 0.11, 2.0)
    if speeds[1] < speeds[0]:
        raise InputError(f"the least speed {speeds[0]} exceeds the most {speeds[1]}", key="walking.apex_speed_mps")
    return WalkingParameters(
        fine_cells=fine,
        fine_cell_m=cell_m / fine,
        turn_angle_deg=angle,
        straight_cells=take("straight_cells", (4, 3, 2), _step_lengths, fine - 1),
        pre_step_cells=take("pre_step_cells", 4, _integer, 1, fine - 1),
        stop_cells=take("stop_cells", 2, _integer, 1, fine - 1),
        turn_a_cells=_turn(given, "turn_a_cells", steps, fine - 1),
        turn_b_cells=_turn(given, "turn_b_cells", steps, fine - 1),
        side_band_cells=take("side_band_cells", 6, _integer, 0, (fine - 1) // 2),
        sagittal_outcomes_cells=take("sagittal_outcomes_cells", 1, _integer, 0, 2),
        lateral_outcomes_cells=take("lateral_outcomes_cells", 2, _integer, 0, 4),
        max_step_height_m=take("max_step_height_m", 0.2, _number, 0.0, 0.2),
        safety_distance_m=take("safety_distance_m", 0.52, _number, 0.1, 2.0),
        apex_speed_mps=speeds,
        steering_speed_max_mps=take("steering_speed_max_mps", max(0.4, speeds[0]), _number, speeds[0], 2.0),
        switch_speed_max_mps=take("switch_speed_max_mps", 1.1, _number, speeds[0], 3.0),
        dy1_m=take("dy1_m", 0.10, _number, 0.0, 0.5),
        dy2_m=take("dy2_m", 0.135, _number, 0.02, 0.5),
        cost_straight=take("cost_straight", (1.0, 1.0, 0.0, 0.0), _numbers, 4, 0.0, 1e6),
        cost_steering=take("cost_steering", (7.0, 4.0, 0.0, 0.0), _numbers, 4, 0.0, 1e6),
        desired_duration_s=take("desired_duration_s", 0.45, _number, 0.05, 5.0),
        desired_width_m=take("desired_width_m", 0.45, _number, 0.0, 2.0),
    )


def _number(value: Any, key: str, low: float, high: float) -> float:
    if isinstance(value, bool) or not isinstance(value, Real) or not low <= float(value) <= high:
        raise InputError(f"{value!r} is not allowed; a number from {low:g} to {high:g} is", key=key)
    return float(value)


def _integer(value: Any, key: str, low: int, high: int) -> int:
    if isinstance(value, bool) or not isinstance(value, Integral) or not low <= int(value) <= high:
        raise InputError(f"{value!r} is not allowed; a whole number from {low} to {high} is", key=key)
    return int(value)


def _list(value: Any, key: str, count: int | None) -> Sequence[Any]:
    wanted = "a list of" if count is None else f"a list of {count}"
    if not isinstance(value, list | tuple) or (count is not None and len(value) != count) or not 1 <= len(value) <= 64:
        raise InputError(f"{value!r} is not allowed; {wanted} numbers is", key=key)
    return value


def _numbers(value: Any, key: str, count: int, low: float, high: float) -> tuple[float, ...]:
    return tuple(_number(item, key, low, high) for item in _list(value, key, count))


def _step_lengths(value: Any, key: str, high: int) -> tuple[int, ...]:
    lengths = tuple(_integer(item, key, 1, high) for item in _list(value, key, None))
    if len(set(lengths)) < len(lengths):
        raise InputError(f"{list(lengths)} names a length twice", key=key)
    return lengths


def _turn_angle(value: Any, key: str) -> tuple[float, int]:
    """Return the angle of a turn step and how many make a quarter turn."""
    angle = _number(value, key, 5.0, 45.0)
    steps = round(90 / angle)
    if abs(steps * angle - 90) > 1e-6:
        raise InputError(f"{angle:g} does not divide 90 degrees; for instance 22.5, 18 and 15 do", key=key)
    return 90 / steps, steps


def _turn(given: dict[str, Any], name: str, steps: int, high: int) -> tuple[float, ...]:
    if given.get(name) is None:
        return default_lengths(steps, name[5].upper())
    lengths = _numbers(given[name], f"walking.{name}", steps, 0.1, high)
    return drift_free(lengths, f"walking.{name}")
