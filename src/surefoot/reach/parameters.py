"""What a region is synthesised for: a transition, the disturbance and how it is read, the grid, the control inputs.

Lengths are metres and velocities metres per second in the frame of the step: origin at the current apex, x along the
heading. The first stance foot stands at ``first_foot_m`` (0 when walking straight), the next one below the next apex,
at the step length. Source: Shamsah et al., T-RO 2023, Definitions IV.1-IV.2 and Section VII.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from fractions import Fraction

from surefoot.errors import InputError

LARGEST_INPUTS = 1024
"""How many omegas there may be; masks have a word for every 64."""


def exact(value: float) -> Fraction:
    """Return the decimal that a double was written as, exactly."""
    return Fraction(repr(float(value)))


def _above_zero(value: float, key: str) -> None:
    if not (math.isfinite(value) and value > 0):
        raise InputError(f"{value:g} is not allowed; it has to be above 0", key=key)


def _at_least(value: float, least: float, key: str) -> None:
    if not (math.isfinite(value) and value >= least):
        raise InputError(f"{value:g} is not allowed; it has to be at least {least:g}", key=key)


class Reading(StrEnum):
    """How the bound on the disturbance is read; the paper's text allows all three.

    RATE: an additive rate, x' = v + d1, v' = omega^2 (x - x_foot) + d2, bounds in m/s and m/s^2.
    INSIDE_PHI: the state is shifted inside the vector field (Definition IV.1 taken literally), bounds in m and m/s.
    JUMP: the state jumps by up to the bound at every sample, bounds in m and m/s.
    """

    RATE = "rate"
    INSIDE_PHI = "inside_phi"
    JUMP = "jump"


@dataclass(frozen=True, slots=True)
class Disturbance:
    """A bounded disturbance.

    Attributes:
        reading: what the two bounds mean.
        first: bound on the first component (position).
        second: bound on the second component (velocity).
    """

    reading: Reading
    first: float = 0.01
    second: float = 0.02

    def __post_init__(self) -> None:
        if not isinstance(self.reading, Reading):
            raise InputError(f"{self.reading!r} is no reading; there are rate, inside_phi and jump", key="disturbance")
        _at_least(self.first, 0.0, "disturbance-bound")
        _at_least(self.second, 0.0, "disturbance-bound")


@dataclass(frozen=True, slots=True)
class OmegaSet:
    """The values of omega that the controller may hold for a sample: ``low``, ``low + step`` ... up to ``high``.

    ``scale`` multiplies them all (see ``Transition.level_com``); ``values_radps`` are the scaled values.
    """

    low_radps: float = 2.8
    high_radps: float = 3.5
    step_radps: float = 0.02
    scale: float = 1.0

    def __post_init__(self) -> None:
        for value in (self.low_radps, self.step_radps, self.scale):
            _above_zero(value, "omega")
        _above_zero(self.high_radps, "omega")
        if self.high_radps < self.low_radps:
            raise InputError(
                f"the set of omegas from {self.low_radps:g} to {self.high_radps:g} rad/s is reversed or empty; "
                "give LOW HIGH STEP with LOW <= HIGH",
                key="omega",
            )
        if self._count() > LARGEST_INPUTS:
            raise InputError(
                f"{self._count()} omegas are more than the {LARGEST_INPUTS} that are allowed; take a larger step",
                key="omega",
            )

    def _count(self) -> int:
        return int((exact(self.high_radps) - exact(self.low_radps)) / exact(self.step_radps)) + 1

    @property
    def words(self) -> int:
        """How many words of 64 bits a mask has."""
        return (self._count() + 63) // 64

    @property
    def values_radps(self) -> tuple[float, ...]:
        """All values, ascending; each is the double nearest to its decimal."""
        low, step = exact(self.low_radps), exact(self.step_radps)
        return tuple(float(low + k * step) * self.scale for k in range(self._count()))


@dataclass(frozen=True, slots=True)
class GridSpec:
    """The cells: centres at ``-behind + i x_step`` (up to length + ``beyond``) and ``slowest + j v_step``."""

    x_step_m: float = 0.002
    v_step_mps: float = 0.004
    behind_m: float = 0.05
    beyond_m: float = 0.02
    slowest_mps: float = 0.1
    fastest_mps: float = 1.1

    def __post_init__(self) -> None:
        _above_zero(self.x_step_m, "grid")
        _above_zero(self.v_step_mps, "grid")
        _at_least(self.behind_m, 0.0, "grid")
        _at_least(self.beyond_m, 0.0, "grid")
        _above_zero(self.slowest_mps, "grid")
        if not (math.isfinite(self.fastest_mps) and self.fastest_mps > self.slowest_mps):
            raise InputError("the fastest velocity has to be above the slowest", key="grid")


@dataclass(frozen=True, slots=True)
class GuardTube:
    """The tangent manifolds of the first half step that bound where the foot may be switched."""

    omega_radps: float = 3.1
    slowest_mps: float = 0.15
    fastest_mps: float = 0.70

    def __post_init__(self) -> None:
        _above_zero(self.omega_radps, "guard-omega")
        _at_least(self.slowest_mps, 0.0, "guard-velocity")
        if not (math.isfinite(self.fastest_mps) and self.fastest_mps >= self.slowest_mps):
            raise InputError("the guard velocities are reversed; give LOW HIGH with LOW <= HIGH", key="guard-velocity")


@dataclass(frozen=True, slots=True)
class Settings:
    """Everything about a synthesis that is not the transition; the disturbance is a required choice."""

    disturbance: Disturbance
    tau_s: float = 0.02
    grid: GridSpec = GridSpec()
    omegas: OmegaSet = OmegaSet()
    guard: GuardTube = GuardTube()
    target_half_width_m: float = 0.0071

    def __post_init__(self) -> None:
        _above_zero(self.tau_s, "tau")
        _above_zero(self.target_half_width_m, "target-half-width")
        if self.tau_s * self.omegas.high_radps > 3:
            raise InputError(f"tau = {self.tau_s:g} s is longer than a step; at most 3 / omega is allowed", key="tau")


@dataclass(frozen=True, slots=True)
class Transition:
    """One walking step between two apexes.

    Attributes:
        step_length_m: from the current apex to the next one.
        apex_velocity_mps: window of the velocity at the next apex.
        first_foot_m: the current stance foot; not 0 after a heading change (``first_foot_after_turn``).
        height_change_m: of the floor, from foot to foot.
        level_com: False (journal paper): the CoM keeps its apex height over every foot, so omega does not change.
            True (workshop paper): the CoM stays level, so the apex height over the second foot is less the height
            change, and its omegas are scaled by the root of the heights' ratio.
        apex_height_m: of the CoM over the first foot; used only with ``level_com``.
    """

    step_length_m: float
    apex_velocity_mps: tuple[float, float]
    first_foot_m: float = 0.0
    height_change_m: float = 0.0
    level_com: bool = False
    apex_height_m: float = 0.985

    def __post_init__(self) -> None:
        _above_zero(self.step_length_m, "step-length")
        if self.step_length_m > 10:
            raise InputError(f"a step of {self.step_length_m:g} m is too long; at most 10 m", key="step-length")
        low, high = self.apex_velocity_mps
        if not (0 < low < high and math.isfinite(high)):
            raise InputError(
                f"the window {low:g} .. {high:g} m/s is reversed, empty or not above 0; "
                "give LOW HIGH with 0 < LOW < HIGH",
                key="apex-velocity",
            )
        if not abs(self.first_foot_m) < self.step_length_m:
            raise InputError("the first foot has to be less than a step length from the apex", key="first-foot")
        _above_zero(self.apex_height_m, "apex-height")
        if not math.isfinite(self.height_change_m) or self.height_change_m >= self.apex_height_m:
            raise InputError("the height change has to be below the apex height", key="height-change")

    @property
    def second_omega_scale(self) -> float:
        """By what the omegas of the second half step are multiplied."""
        if not self.level_com:
            return 1.0
        return math.sqrt(self.apex_height_m / (self.apex_height_m - self.height_change_m))


def first_foot_after_turn(heading_change_rad: float, stance_side: float, dy2_m: float) -> float:
    """Return where the stance foot is along the new heading, seen from the apex, after a heading change.

    Args:
        heading_change_rad: left positive.
        stance_side: +1 when the left foot stands, -1 when the right one does.
        dy2_m: magnitude of the lateral distance from the apex CoM to its foot.

    Returns:
        Positive (ahead) for a turn toward the stance foot, negative for a turn away from it (Theorem IV.2).
    """
    return math.copysign(1.0, stance_side) * dy2_m * math.sin(heading_change_rad)
