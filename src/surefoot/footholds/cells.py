"""Contact tables of a free gait: cells of equal length in which a foot is in contact or not (Zhou et al., VI-D)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import InputError
from surefoot.footholds.gaits import LEG_NAMES, MOST_SAMPLES, FreeGait, Gait
from surefoot.footholds.problem import Problem

Cells = NDArray[np.bool_]
"""Which feet are in contact in which cell, shape (M, 4)."""

LEAST_CELLS = 3
MOST_CELLS = 60
_WHOLE = 1e-3


def check_cells(horizon_s: float, cell_s: float, step_s: float, min_dwell_cells: int = 1) -> None:
    """Refuse cells that do not fit the samples, a horizon that does not fit the cells, or a dwell beyond the horizon.

    Raises:
        InputError: saying what is allowed.
    """
    if horizon_s / step_s > MOST_SAMPLES:
        raise InputError(
            f"is {horizon_s:g} s, more than the {MOST_SAMPLES} steps of {step_s:g} s that are allowed", key="horizon_s"
        )
    if not _multiple(cell_s, step_s):
        raise InputError(f"is {cell_s:g} s; allowed are multiples of step_s = {step_s:g} s", key="options.cell_s")
    if not _multiple(horizon_s, cell_s) or not LEAST_CELLS <= round(horizon_s / cell_s) <= MOST_CELLS:
        raise InputError(
            f"is {horizon_s:g} s; allowed are multiples of options.cell_s = {cell_s:g} s, {LEAST_CELLS} to "
            f"{MOST_CELLS} of them",
            key="horizon_s",
        )
    most = round(horizon_s / cell_s) - 2
    if min_dwell_cells > most:
        raise InputError(
            f"is {min_dwell_cells}; allowed are 1 to {most}, the cells between the first and the last, in which all "
            "feet are in contact",
            key="options.min_dwell_cells",
        )


def _multiple(length_s: float, part_s: float) -> bool:
    count = length_s / part_s
    return count > 0.5 and abs(count - round(count)) < _WHOLE


def cell_count(problem: Problem) -> int:
    """Return how many cells the horizon of a free gait has."""
    return round(problem.gait.horizon_s / problem.options.cell_s)


def cell_samples(problem: Problem) -> int:
    """Return how many samples a cell has."""
    return round(problem.options.cell_s / problem.step_s)


def obeys(cells: Cells, min_dwell_cells: int) -> bool:
    """Return whether all feet stand at both ends, and no run between two changes is shorter than the dwell."""
    if not (cells[0].all() and cells[-1].all()):
        return False
    for foot in range(cells.shape[1]) if min_dwell_cells > 1 else ():
        changes = np.flatnonzero(np.diff(cells[:, foot]))
        if (np.diff(changes) < min_dwell_cells).any():
            return False
    return True


def gait_of(cells: Cells, cell_s: float) -> Gait:
    """Return the gait of a contact table: equal neighbours merged to modes."""
    begins = [0, *(np.flatnonzero((cells[1:] != cells[:-1]).any(axis=1)) + 1)]
    times = (*(round(float(m * cell_s), 9) for m in begins), round(len(cells) * cell_s, 9))
    return Gait(tuple(_mode(cells[m]) for m in begins), times)


def _mode(held: NDArray[np.bool_]) -> str:
    if held.all():
        return "STANCE"
    return "_".join(leg for leg, on in zip(LEG_NAMES, held, strict=True) if on) or "FLY"


def with_gait(problem: Problem, gait: Gait) -> Problem:
    """Return the problem of a free gait with the gait that was found."""
    return replace(problem, gait=gait)


def fixed(problem: Problem, cells: Cells) -> Problem:
    """Return the gait-fixed problem of a contact table."""
    return with_gait(problem, gait_of(cells, problem.options.cell_s))


def is_free(problem: Problem) -> bool:
    """Return whether the gait is to be found."""
    return isinstance(problem.gait, FreeGait)
