"""Which omega to hold for the next sample, looked up in the region of one half step.

A look-up is a multiplication, two floors and a few bit operations on a mask. Of the omegas that a mask allows the law
of Shamsah et al. (T-RO 2023, Section VII) takes the one that minimises 0.5 (w - w_nominal)^2 + 0.5 (w - w_previous)^2,
which is the one nearest to the mean of the two.
"""

from __future__ import annotations

from bisect import bisect_left

import numpy as np

from surefoot.reach.ensembles import NOMINAL_OMEGA_RADPS
from surefoot.reach.lattice import Cells
from surefoot.reach.synthesis import HalfStep, Region


class HalfStepController:
    """Looks up the omegas of one half step; immutable.

    Args:
        region: the synthesised regions.
        half: which half step.
    """

    __slots__ = (
        "_bits",
        "_half",
        "_inverse_v",
        "_inverse_x",
        "_omegas",
        "_rows",
        "_v_low",
        "_v_span",
        "_words",
        "_x_low",
        "_x_span",
    )

    def __init__(self, region: Region, half: HalfStep) -> None:
        cells = region.cells
        self._half = half
        self._omegas = half.omegas_radps
        self._inverse_x, self._inverse_v = 1 / cells.x_step_m, 1 / cells.v_step_mps
        self._x_low = cells.x0_m - 0.5 * cells.x_step_m
        self._v_low = cells.v0_mps - 0.5 * cells.v_step_mps
        self._x_span, self._v_span = float(cells.columns), float(cells.rows)
        self._rows, self._words = cells.rows, half.masks.shape[2]
        # A memory view of a read-only copy: indexing it is five times faster than indexing an array.
        self._bits = memoryview(np.ascontiguousarray(half.masks).tobytes()).cast("Q")

    @property
    def half(self) -> HalfStep:
        """The region that is looked up."""
        return self._half

    def mask(self, x_m: float, v_mps: float) -> int:
        """Return the bit mask of the allowed omegas; 0 outside the region and in its target."""
        i = (x_m - self._x_low) * self._inverse_x
        j = (v_mps - self._v_low) * self._inverse_v
        if 0.0 <= i < self._x_span and 0.0 <= j < self._v_span:
            at = int(i) * self._rows + int(j)
            if self._words == 1:
                return self._bits[at]
            return sum(self._bits[at * self._words + word] << (64 * word) for word in range(self._words))
        return 0

    def omegas(self, x_m: float, v_mps: float) -> tuple[float, ...]:
        """Return every omega that keeps the promise from a state [rad/s]."""
        mask = self.mask(x_m, v_mps)
        return tuple(w for k, w in enumerate(self._omegas) if mask >> k & 1)

    def omega(self, x_m: float, v_mps: float, previous_radps: float = NOMINAL_OMEGA_RADPS) -> float | None:
        """Return the omega to hold for the next sample, or None outside the region and in its target.

        Args:
            x_m: position of the CoM in the frame of the step.
            v_mps: its velocity.
            previous_radps: what was held before.
        """
        mask = self.mask(x_m, v_mps)
        if mask == 0:
            return None
        omegas = self._omegas
        wish = 0.5 * (NOMINAL_OMEGA_RADPS + previous_radps)
        at = bisect_left(omegas, wish)
        above, below = mask >> at, mask & ((1 << at) - 1)
        if above:
            k = at + (above & -above).bit_length() - 1
            if below:
                other = below.bit_length() - 1
                return omegas[other] if wish - omegas[other] < omegas[k] - wish else omegas[k]
            return omegas[k]
        return omegas[below.bit_length() - 1]

    def in_target(self, x_m: float, v_mps: float) -> bool:
        """Tell whether a state is in the target of the half step."""
        return self._holds(self._half.target, x_m, v_mps)

    def contains(self, x_m: float, v_mps: float) -> bool:
        """Tell whether a state is in the region, its target included."""
        return self._holds(self._half.won, x_m, v_mps)

    def margins(self, x_m: float, v_mps: float) -> tuple[float, float]:
        """Return how much velocity may be lost and gained in the region at this position [m/s]; see ``margin``."""
        winning = self._intervals(x_m)
        for low, high in winning:
            if low <= v_mps <= high:
                return v_mps - low, high - v_mps
        if not winning:
            return -np.inf, -np.inf
        low, high = min(winning, key=lambda span: max(span[0] - v_mps, v_mps - span[1]))
        return min(v_mps - low, 0.0), min(high - v_mps, 0.0)

    def margin(self, x_m: float, v_mps: float) -> float:
        """Return the velocity jump that leads out of the region, at this position [m/s].

        Returns:
            Not negative inside; outside minus the jump that would lead back in, minus infinity where no velocity wins.
        """
        return float(min(self.margins(x_m, v_mps)))

    def _holds(self, cells: Cells, x_m: float, v_mps: float) -> bool:
        i = (x_m - self._x_low) * self._inverse_x
        j = (v_mps - self._v_low) * self._inverse_v
        return 0.0 <= i < self._x_span and 0.0 <= j < self._v_span and bool(cells[int(i), int(j)])

    def _intervals(self, x_m: float) -> list[tuple[float, float]]:
        """Return the intervals of winning velocities at a position."""
        i = (x_m - self._x_low) * self._inverse_x
        if not 0.0 <= i < self._x_span:
            return []
        column = np.concatenate(([False], self._half.won[int(i)], [False]))
        edges = np.flatnonzero(column[1:] != column[:-1])
        speeds = self._v_low + edges / self._inverse_v
        return [(float(a), float(b)) for a, b in zip(speeds[::2], speeds[1::2], strict=True)]
