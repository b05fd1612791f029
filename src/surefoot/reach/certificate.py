"""Checks a region against its definition: every corner of a cell, every vertex of the disturbance, every held omega.

It flows true states instead of boxes, so an error in the boxes shows. ``verify`` has an adversary of its own for saved
regions, which shares no code with this room.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surefoot.reach.flows import rate_bounds
from surefoot.reach.parameters import Reading
from surefoot.reach.synthesis import HalfStep, Region


@dataclass(frozen=True, slots=True)
class Certificate:
    """What the adversary found: no violation is what a sound region shows."""

    steps: int
    violations: int
    example: tuple[str, float, float, float] | None = None

    @property
    def holds(self) -> bool:
        """Whether no step left the region."""
        return self.violations == 0


def certify(region: Region, steps: int = 100_000, seed: int = 0) -> Certificate:
    """Let every one of random (cell, omega) pairs take the 16 extreme steps, and see whether all stay in the region.

    Args:
        region: to check.
        steps: how many extreme steps at least.
        seed: of the choice.
    """
    rng = np.random.default_rng(seed)
    pairs = -(-steps // 32)
    first = _half(region, region.first, "first", pairs, rng)
    second = _half(region, region.second, "second", pairs, rng)
    example = first.example or second.example
    return Certificate(first.steps + second.steps, first.violations + second.violations, example)


def _half(region: Region, half: HalfStep, name: str, pairs: int, rng: np.random.Generator) -> Certificate:
    i, j = np.nonzero(half.masks.any(axis=2))
    if i.size == 0:
        return Certificate(0, 0)
    chosen = rng.integers(0, i.size, pairs)
    i, j = i[chosen], j[chosen]
    bits = (half.masks[i, j, :, None] >> np.arange(64, dtype=np.uint64)) & np.uint64(1)
    bits = bits.reshape(pairs, -1)[:, : len(half.omegas_radps)]
    k = np.argmax(bits * rng.random(bits.shape), axis=1)
    w = np.array(half.omegas_radps)[k]
    left, right = region.cells.x_edges()
    lower, upper = region.cells.v_edges()
    violations, example = 0, None
    for x in (left[i], right[i]):
        for v in (lower[j], upper[j]):
            for a in (-1.0, 1.0):
                for b in (-1.0, 1.0):
                    bad = ~_stays(region, half, x, v, w, a, b)
                    violations += int(bad.sum())
                    if bad.any() and example is None:
                        n = int(np.argmax(bad))
                        example = (name, float(x[n]), float(v[n]), float(w[n]))
    return Certificate(16 * pairs, violations, example)


def _stays(
    region: Region, half: HalfStep, x: np.ndarray, v: np.ndarray, w: np.ndarray, a: float, b: float
) -> np.ndarray:
    """Tell whether one extreme step of every state ends in the region."""
    tau, bound, cells = region.settings.tau_s, region.settings.disturbance, region.cells
    c, s = np.cosh(w * tau), np.sinh(w * tau)
    jump = bound.reading is Reading.JUMP
    d1, d2 = (np.zeros_like(w), np.zeros_like(w)) if jump else rate_bounds(bound, w)
    y = half.foot_m + c * (x - half.foot_m) + s / w * (v + a * d1) + (c - 1) / w**2 * b * d2
    u = w * s * (x - half.foot_m) + c * v + (c - 1) * a * d1 + s / w * b * d2
    if jump:
        y, u = y + a * bound.first, u + b * bound.second
    i = np.floor((y - cells.x0_m) / cells.x_step_m + 0.5).astype(int)
    j = np.floor((u - cells.v0_mps) / cells.v_step_mps + 0.5).astype(int)
    inside = (i >= 0) & (i < cells.columns) & (j >= 0) & (j < cells.rows)
    inside[inside] = half.won[i[inside], j[inside]]
    return np.asarray(inside)
