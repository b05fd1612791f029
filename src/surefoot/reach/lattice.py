"""The grid of a synthesis, with the tests of cells against bounds.

A cell counts as inside a set only when it lies wholly inside; a cell whose edge or corner lies exactly on a bound
counts as outside. Windows are compared in exact rational arithmetic; curved bounds in doubles with a slack of 1e-12
toward rejection, far above the rounding of the few operations involved (below 1e-15) and far below any cell.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import InputError
from surefoot.reach.parameters import GridSpec, exact

SLACK = 1e-12
BYTES_PER_CELL = 2 * (1 + 1 + 1) + 8
"""Winning, target and source cells of both halves, and the kernel's run lengths; a word of both masks is 16 more."""

Cells = NDArray[np.bool_]
Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Lattice:
    """The cells of one transition.

    Attributes:
        x0_m: centre of the first column.
        v0_mps: centre of the first row.
        x_step_m: width of a cell.
        v_step_mps: height of a cell.
        columns: how many positions.
        rows: how many velocities.
    """

    x0_m: float
    v0_mps: float
    x_step_m: float
    v_step_mps: float
    columns: int
    rows: int

    @property
    def shape(self) -> tuple[int, int]:
        """Columns and rows."""
        return self.columns, self.rows

    @property
    def cell_area(self) -> float:
        """Area of a cell [m m/s]."""
        return self.x_step_m * self.v_step_mps

    def x_edges(self) -> tuple[Floats, Floats]:
        """Return the left and right edges of the columns [m]."""
        return _edges(self.x0_m, self.x_step_m, self.columns)

    def v_edges(self) -> tuple[Floats, Floats]:
        """Return the lower and upper edges of the rows [m/s]."""
        return _edges(self.v0_mps, self.v_step_mps, self.rows)

    def columns_within(self, low: Fraction, high: Fraction) -> slice:
        """Return the columns that lie wholly, and not touching, between two positions."""
        return _strictly_within(exact(self.x0_m), exact(self.x_step_m), self.columns, low, high)

    def rows_within(self, low: Fraction, high: Fraction) -> slice:
        """Return the rows that lie wholly, and not touching, between two velocities."""
        return _strictly_within(exact(self.v0_mps), exact(self.v_step_mps), self.rows, low, high)


def lattice(spec: GridSpec, step_length_m: float, words: int = 1) -> Lattice:
    """Return the grid of a step.

    Args:
        spec: of the cells.
        step_length_m: from apex to apex.
        words: of a mask, for the estimate of the memory.

    Raises:
        InputError: its arrays would not fit into memory; the message says the estimate.
    """
    length = exact(step_length_m) + exact(spec.beyond_m) + exact(spec.behind_m)
    columns = math.floor(length / exact(spec.x_step_m)) + 1
    rows = math.floor((exact(spec.fastest_mps) - exact(spec.slowest_mps)) / exact(spec.v_step_mps)) + 1
    needed, there = columns * rows * (BYTES_PER_CELL + 16 * words), available_bytes()
    if needed > there:
        raise InputError(
            f"{columns} x {rows} cells need about {needed / 1e9:.3g} GB, and {there / 1e9:.3g} GB may be used; "
            "take a coarser grid",
            key="grid",
        )
    return Lattice(-spec.behind_m, spec.slowest_mps, spec.x_step_m, spec.v_step_mps, columns, rows)


def available_bytes() -> int:
    """Return how much memory a synthesis may use: half of what is free, 8 GB at most."""
    import os

    try:
        free = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_AVPHYS_PAGES")
    except (ValueError, OSError):  # pragma: no cover - not on Linux
        free = 4_000_000_000
    return min(free // 2, 8_000_000_000)


def above_asymptotes(cells: Lattice, foot_m: float, omega_radps: float) -> Cells:
    """Return the cells that lie wholly above v = omega |x - x_foot|."""
    left, right = cells.x_edges()
    lower, _ = cells.v_edges()
    reach = omega_radps * np.maximum(np.abs(left - foot_m), np.abs(right - foot_m))
    return np.asarray(lower[None, :] > reach[:, None] + SLACK)


def between_manifolds(
    cells: Lattice, foot_m: float, omega_radps: float, slowest_mps: float, fastest_mps: float
) -> Cells:
    """Return the cells ahead of a foot that lie wholly between two tangent manifolds.

    A tangent manifold of an apex velocity is v^2 = v_apex^2 + omega^2 (x - x_foot)^2. A cell is ahead when its
    centre is.
    """
    left, right = cells.x_edges()
    lower, upper = cells.v_edges()
    near, far = np.maximum(left - foot_m, 0), right - foot_m
    least = lower[None, :] ** 2 - (omega_radps * far[:, None]) ** 2
    most = upper[None, :] ** 2 - (omega_radps * near[:, None]) ** 2
    ahead = 0.5 * (left + right) > foot_m + SLACK
    inside = (least > slowest_mps**2 + SLACK) & (most < fastest_mps**2 - SLACK)
    return np.asarray(inside & ahead[:, None])


def _edges(first: float, step: float, count: int) -> tuple[Floats, Floats]:
    edges = first + step * (np.arange(count + 1) - 0.5)
    return np.asarray(edges[:-1], np.float64), np.asarray(edges[1:], np.float64)


def _strictly_within(first: Fraction, step: Fraction, count: int, low: Fraction, high: Fraction) -> slice:
    begin = math.floor((low - first) / step + Fraction(1, 2)) + 1
    end = math.ceil((high - first) / step - Fraction(1, 2))
    begin = max(begin, 0)
    return slice(begin, max(begin, min(end, count)))
