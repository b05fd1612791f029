"""Foot placement after a push that no held omega can absorb: Eq. (7) of Shamsah et al., T-RO 2023, corrected.

The printed equation adds the squares of the two velocities; conservation of the orbit's energy in the second half step,
v_switch^2 - omega^2 (x_foot - x_switch)^2 = v_apex^2, asks for their difference. So a foot exists only when the state
arrives at the switch faster than the next apex velocity; otherwise that velocity is lowered.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

from surefoot.errors import UnsafeStepError


class FootMove(StrEnum):
    """In which fine cell the new foot lands (the flag t_nd of Section VII)."""

    NOMINAL = "nominal"
    FORWARD = "forward"
    BACKWARD = "backward"


@dataclass(frozen=True, slots=True)
class CaptureStep:
    """What the capture rule says after a push.

    Attributes:
        recovered: False when the CoM never gets to the switch: a fall.
        margin_mps: velocity to spare over the asymptote at the pushed state; negative is what was missing.
        switch_m: where the foot is switched.
        switch_velocity_mps: with which velocity.
        apex_velocity_mps: at the new apex; lower than wished when the state is too slow.
        foot_m: the new foot, along the heading from the current apex.
        shift_m: how far that is from the nominal foot.
        cells: the same in fine cells, rounded.
        move: in which direction.
    """

    recovered: bool
    margin_mps: float
    switch_m: float
    switch_velocity_mps: float
    apex_velocity_mps: float
    foot_m: float
    shift_m: float
    cells: int
    move: FootMove


def capture_foot(switch_m: float, switch_velocity_mps: float, apex_velocity_mps: float, omega_radps: float) -> float:
    """Return the next foot that leads from the switch to an apex velocity (Eq. 7 with the right sign).

    Raises:
        UnsafeStepError: the state is slower than the apex velocity; no foot ahead makes it faster.
    """
    square = switch_velocity_mps**2 - apex_velocity_mps**2
    if square < 0 or switch_velocity_mps < 0:
        raise UnsafeStepError(
            f"no foot leads from {switch_velocity_mps:.3f} m/s at the switch to {apex_velocity_mps:.3f} m/s at the "
            "apex; at most the velocity at the switch can be kept"
        )
    return switch_m + math.sqrt(square) / omega_radps


def capture_step(
    x_m: float,
    v_mps: float,
    *,
    stance_foot_m: float,
    switch_m: float,
    apex_velocity_mps: float,
    omega_radps: float,
    nominal_foot_m: float,
    fine_cell_m: float,
    slowest_mps: float = 0.1,
) -> CaptureStep:
    """Return the foot that recovers a pushed state of the first half step.

    Args:
        x_m: CoM position after the push, in the frame of the step.
        v_mps: its velocity.
        stance_foot_m: the current foot.
        switch_m: where the nominal step switches (the guard of Fig. 12); a state beyond it switches at once.
        apex_velocity_mps: wished at the next apex.
        omega_radps: held until then.
        nominal_foot_m: where the next foot was to be.
        fine_cell_m: side of a fine cell.
        slowest_mps: the apex velocity is never lowered below this.
    """
    at = max(switch_m, x_m)
    ahead = stance_foot_m - x_m
    margin = v_mps - max(omega_radps * ahead, 0.0)
    square = v_mps**2 + omega_radps**2 * ((at - stance_foot_m) ** 2 - (x_m - stance_foot_m) ** 2)
    speed = math.sqrt(max(square, 0.0))
    if margin <= 0 or speed < slowest_mps:
        margin = margin if margin <= 0 else speed - slowest_mps
        return CaptureStep(False, margin, at, speed, 0.0, nominal_foot_m, 0.0, 0, FootMove.NOMINAL)
    apex = min(apex_velocity_mps, speed)
    foot = capture_foot(at, speed, apex, omega_radps)
    shift = foot - nominal_foot_m
    cells = round(shift / fine_cell_m)
    move = FootMove.NOMINAL if cells == 0 else FootMove.FORWARD if cells > 0 else FootMove.BACKWARD
    return CaptureStep(True, margin, at, speed, apex, foot, shift, cells, move)
