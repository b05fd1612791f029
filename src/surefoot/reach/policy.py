"""The robust keyframe policy: walk slower where the terrain or the heading changes.

Warnke et al. (Section II) take the size of the initial winning set as the indicator of robustness and lower the apex
velocity with the height change and the heading change; they give no formula. Here the size that is demanded grows in
proportion to both changes, and the policy allows the fastest apex velocity whose set is that large.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

from surefoot.errors import InputError
from surefoot.reach.winning_sets import GRAVITY_MPS2, KeyframeStep, initial_winning_set


@lru_cache(maxsize=4096)
def winning_set_size(step: KeyframeStep) -> int:
    """Return how many cells the initial winning set of a step has."""
    return initial_winning_set(step).size


@dataclass(frozen=True, slots=True)
class KeyframePolicy:
    """Which apex velocity a step may aim at, by its height change and heading change.

    Attributes:
        cruise_mps: apex velocity on flat ground straight ahead; the size of its set is what is demanded there.
        slowest_mps: the policy never goes below.
        step_mps: velocities are tried in these steps.
        height_m: |height change| that doubles the demanded size.
        turn_rad: |heading change| that doubles it.
        step_length_m: of the step.
        apex_height_m: of the robot.
        size: of the initial winning set of a step [cells]; replaceable.
    """

    cruise_mps: float = 0.6
    slowest_mps: float = 0.2
    step_mps: float = 0.02
    height_m: float = 0.2
    turn_rad: float = math.pi / 8
    step_length_m: float = 0.5
    apex_height_m: float = 1.0
    size: Callable[[KeyframeStep], int] = winning_set_size

    def demanded(self, height_change_m: float, heading_change_rad: float) -> float:
        """Return how large the initial winning set has to be [cells]."""
        flat = self.size(self._step(self.cruise_mps, 0.0, 0.0))
        return flat * (1 + abs(height_change_m) / self.height_m + abs(heading_change_rad) / self.turn_rad)

    def apex_velocity(self, height_change_m: float = 0.0, heading_change_rad: float = 0.0) -> float:
        """Return the fastest apex velocity whose set is large enough, or else the one with the largest set [m/s]."""
        wanted = self.demanded(height_change_m, heading_change_rad)
        count = round((self.cruise_mps - self.slowest_mps) / self.step_mps)
        best, largest = self.slowest_mps, -1
        for k in range(count, -1, -1):
            speed = self.slowest_mps + k * self.step_mps
            found = self.size(self._step(speed, height_change_m, heading_change_rad))
            if found >= wanted:
                return speed
            if found > largest:
                best, largest = speed, found
        return best

    def _step(self, speed: float, height_change_m: float, heading_change_rad: float) -> KeyframeStep:
        return KeyframeStep(
            round(speed, 6),
            self.step_length_m,
            height_change_m,
            abs(heading_change_rad),
            self.apex_height_m,
        )


def robust_keyframe_policy(cruise_mps: float = 0.6, slowest_mps: float = 0.2) -> KeyframePolicy:
    """Return the policy for a cruising and a slowest apex velocity.

    Raises:
        InputError: they are reversed or outside the workshop grid.
    """
    if not 0.1 <= slowest_mps < cruise_mps <= 1.0:
        raise InputError("the apex velocities have to obey 0.1 <= slowest < cruise <= 1.0 m/s")
    return KeyframePolicy(cruise_mps, slowest_mps)


@dataclass(frozen=True, slots=True)
class SlopedPendulum:
    """The pendulum of the workshop paper (Appendix A), whose CoM moves on the plane z = a x + b y + h.

    Attributes:
        slope_along: a, along the heading.
        slope_across: b, to the left.
        height_m: h, 0.8 m in the paper.
        foot_m: (x, y) of the stance foot.
    """

    slope_along: float
    slope_across: float
    height_m: float
    foot_m: tuple[float, float]

    @property
    def apex_height_m(self) -> float:
        """Height of the CoM plane above the foot: a x_foot + b y_foot + h.

        Raises:
            InputError: the plane does not pass above the foot.
        """
        height = self.slope_along * self.foot_m[0] + self.slope_across * self.foot_m[1] + self.height_m
        if height <= 0:
            raise InputError("the plane of the CoM has to pass above the foot")
        return height

    @property
    def omega_radps(self) -> float:
        """The rate of the pendulum, the root of gravity over apex height."""
        return math.sqrt(GRAVITY_MPS2 / self.apex_height_m)

    def acceleration(self, x_m: float, y_m: float) -> tuple[float, float, float]:
        """Return the CoM's acceleration (Eq. 1): it stays in the plane."""
        square = self.omega_radps**2
        along, across = square * (x_m - self.foot_m[0]), square * (y_m - self.foot_m[1])
        return along, across, self.slope_along * along + self.slope_across * across
