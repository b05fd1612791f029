"""The controller of a region: both half steps of a walking step."""

from __future__ import annotations

from typing import Literal

from surefoot.reach.certificate import Certificate, certify
from surefoot.reach.ensembles import NOMINAL_OMEGA_RADPS
from surefoot.reach.look_up import HalfStepController
from surefoot.reach.simulation import Push, Trace, simulate
from surefoot.reach.synthesis import Region

Half = Literal["first", "second"]


class Controller:
    """The controller of a walking step; immutable.

    Positions and velocities are those of the CoM in the frame of the step (origin at the current apex, x along the
    heading). The first half step ends at the first sample in the guard; from then on the second half is asked.

    Args:
        region: the synthesised regions.

    Attributes:
        region: the same.
        first: look-up of the first half step.
        second: look-up of the second half step.
    """

    __slots__ = ("first", "region", "second")

    def __init__(self, region: Region) -> None:
        self.region = region
        self.first = HalfStepController(region, region.first)
        self.second = HalfStepController(region, region.second)

    def half(self, half: Half) -> HalfStepController:
        """Return the look-up of a half step."""
        return self.first if half == "first" else self.second

    def omega(
        self, x_m: float, v_mps: float, half: Half = "first", previous_radps: float = NOMINAL_OMEGA_RADPS
    ) -> float | None:
        """Return the omega to hold for the next sample, or None where the half step promises nothing."""
        return self.half(half).omega(x_m, v_mps, previous_radps)

    def omegas(self, x_m: float, v_mps: float, half: Half = "first") -> tuple[float, ...]:
        """Return every omega that keeps the promise."""
        return self.half(half).omegas(x_m, v_mps)

    def switches(self, x_m: float, v_mps: float) -> bool:
        """Tell whether the stance foot may be switched in a state."""
        return self.first.in_target(x_m, v_mps)

    def contains(self, x_m: float, v_mps: float, half: Half = "first") -> bool:
        """Tell whether the target is surely reached from a state."""
        return self.half(half).contains(x_m, v_mps)

    def margin(self, x_m: float, v_mps: float, half: Half = "first") -> float:
        """Return the velocity jump that leads out of the region [m/s]; negative outside."""
        return self.half(half).margin(x_m, v_mps)

    def simulate(
        self, x_m: float, v_mps: float, pushes: tuple[Push, ...] = (), *, seed: int | None = None, law: str = "table"
    ) -> Trace:
        """Walk the step from a state; see ``surefoot.reach.simulation.simulate``."""
        return simulate(self.region, x_m, v_mps, pushes, seed=seed, law=law)

    def certify(self, steps: int = 100_000, seed: int = 0) -> Certificate:
        """Let an adversary try to leave the region; see ``surefoot.reach.certificate``."""
        return certify(self.region, steps, seed)


def controller(region: Region) -> Controller:
    """Return the controller of a region."""
    return Controller(region)
