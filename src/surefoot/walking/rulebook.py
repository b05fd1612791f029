"""What the parameters of a walk mean for the compiled code."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from surefoot.robots.biped import Biped
from surefoot.walking.costs import Aim
from surefoot.walking.parameters import WalkingParameters
from surefoot.walking.risk import RiskTable, risk_table
from surefoot.walking.rules import Limits

SPEED_STEP_MPS = 0.01


@dataclass(frozen=True, slots=True)
class Rulebook:
    """What a walk's parameters mean for the compiled code; made once for a walk.

    Attributes:
        limits: of the hard rules.
        straight: costs of straight steps, and of the last step of a turn.
        steering: costs of the other turn steps.
        risks: of the apexes.
        speeds_mps: apex speeds of straight steps.
        steering_speeds_mps: apex speeds of turn steps.
        corrections_cells: of the last turn step, least first.
        dy2_range_m: Def. V.2.
    """

    limits: Limits
    straight: Aim
    steering: Aim
    risks: RiskTable
    speeds_mps: NDArray[np.float64]
    steering_speeds_mps: NDArray[np.float64]
    corrections_cells: NDArray[np.int64]
    dy2_range_m: tuple[float, float]


@lru_cache(maxsize=8)
def rulebook(parameters: WalkingParameters, robot: Biped) -> Rulebook:
    """Return the numbers of a walk in the form that Algorithm 1 takes; the first call for a walk takes a while."""
    p, omega = parameters, robot.omega_radps
    common = (p.dy2_m, p.desired_duration_s, p.desired_width_m)
    straight = Aim(p.dy1_m, *common, *p.cost_straight, p.fine_cell_m)
    steering = Aim(0.0, *common, *p.cost_steering, p.fine_cell_m)
    limits = Limits(omega, p.switch_speed_max_mps, p.safety_distance_m)
    low, high = p.apex_speed_mps
    tan, cells = math.tan(p.turn_rad), p.lateral_outcomes_cells
    return Rulebook(
        limits=limits,
        straight=straight,
        steering=steering,
        risks=risk_table(p, limits, straight, steering),
        speeds_mps=_speeds(low, high),
        steering_speeds_mps=_speeds(low, min(high, p.steering_speed_max_mps)),
        corrections_cells=np.array(sorted(range(-cells, cells + 1), key=abs), np.int64),
        dy2_range_m=(high * tan / omega, low / (omega * tan)),
    )


def _speeds(low: float, high: float) -> NDArray[np.float64]:
    count = math.floor((high - low) / SPEED_STEP_MPS + 1e-9)
    return np.asarray(np.minimum(low + SPEED_STEP_MPS * np.arange(count + 1), high), np.float64)
