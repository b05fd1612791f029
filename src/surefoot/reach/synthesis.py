"""Robust controllable regions of one walking step, backwards from the target at the next apex.

The second half step has to reach the target; the first half step has to reach the guard: states of the second half's
region that lie between two tangent manifolds of the first. Omega is held for one sample, and the disturbance is any
within its bound. Source: Shamsah et al., T-RO 2023, Definitions IV.1-IV.2 and Section IV-B.
"""

from __future__ import annotations

import time
import warnings
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surefoot.reach._sweep import sweep
from surefoot.reach.flows import Flow, flow, images, least_advance
from surefoot.reach.lattice import Cells, Lattice, above_asymptotes, between_manifolds, lattice
from surefoot.reach.parameters import Settings, Transition, exact


@dataclass(frozen=True, slots=True)
class HalfStep:
    """The region of one half step.

    Attributes:
        foot_m: the stance foot.
        omegas_radps: what may be held.
        target: cells that the half step has to reach.
        won: its controllable region, the target included.
        masks: per cell the omegas after which the state surely stays in ``won``, bit k % 64 of word k // 64 for the
            k-th (columns, rows, words); none in the target.
    """

    foot_m: float
    omegas_radps: tuple[float, ...]
    target: Cells
    won: Cells
    masks: NDArray[np.uint64]


@dataclass(frozen=True, slots=True)
class Region:
    """The controllable regions of a walking step.

    Attributes:
        transition: of the step.
        settings: it was synthesised with.
        cells: the grid.
        first: half step; its target is the guard.
        second: half step; its target is the window at the next apex.
        all_masks: whether the masks hold every winning omega, or only the first one.
        time_s: of the synthesis.
        notes: warnings, one sentence each.
    """

    transition: Transition
    settings: Settings
    cells: Lattice
    first: HalfStep
    second: HalfStep
    all_masks: bool
    time_s: float
    notes: tuple[str, ...]

    @property
    def counts(self) -> dict[str, int]:
        """Cells of target, second half's region, guard and first half's region."""
        sets = {
            "target": self.second.target,
            "shws": self.second.won,
            "guard": self.first.target,
            "fhws": self.first.won,
        }
        return {name: int(np.count_nonzero(cells)) for name, cells in sets.items()}

    @property
    def area(self) -> dict[str, float]:
        """Areas of the two regions [m m/s]."""
        return {name: self.counts[name] * self.cells.cell_area for name in ("shws", "fhws")}

    @property
    def emptied_by(self) -> str | None:
        """Why a region is empty, or None; an empty region is an answer."""
        if not self.second.target.any():
            return (
                "no cell of the grid lies wholly inside the target window: the grid is too coarse or does not cover it"
            )
        if not self.second.masks.any():
            return (
                "no omega brings any cell surely into the target within one sample: the disturbance and the growth of "
                f"a cell over tau = {self.settings.tau_s:g} s are wider than the target"
            )
        if not self.first.target.any():
            begin = self.cells.x_edges()[0][np.nonzero(self.second.won.any(axis=1))[0][0]]
            return (
                f"the guard is empty: no state of the second half's region, which begins at x = {begin:.3f} m, "
                "lies between the tangent manifolds of the first half"
            )
        if not self.first.masks.any():
            return "no omega brings any cell of the first half step surely into the guard"
        return None


def synthesize(
    transition: Transition, settings: Settings, *, all_masks: bool = True, within: Cells | None = None
) -> Region:
    """Synthesise the regions of a walking step.

    Args:
        transition: of the step.
        settings: disturbance, sampling time, grid and inputs.
        all_masks: keep every winning omega per cell, or only the first that is found.
        within: cells that the target is cut with, such as those that the next step can start from.

    Raises:
        InputError: the grid does not fit into memory.
    """
    begin = time.perf_counter()
    cells = lattice(settings.grid, transition.step_length_m, settings.omegas.words)
    omegas = settings.omegas.values_radps
    second_omegas = tuple(w * transition.second_omega_scale for w in omegas)
    target = target_cells(transition, settings, cells)
    if within is not None:
        target &= within
    everywhere = np.ones(cells.shape, np.bool_)
    second = _half_step(cells, transition.step_length_m, second_omegas, target, everywhere, settings, all_masks)
    foot, tube = transition.first_foot_m, settings.guard
    guard = second.won & between_manifolds(cells, foot, tube.omega_radps, tube.slowest_mps, tube.fastest_mps)
    source = above_asymptotes(cells, foot, omegas[0])
    first = _half_step(cells, foot, omegas, guard, source, settings, all_masks)
    notes = _notes(transition, settings)
    return Region(transition, settings, cells, first, second, all_masks, time.perf_counter() - begin, notes)


def target_cells(transition: Transition, settings: Settings, cells: Lattice) -> Cells:
    """Return the cells wholly inside the target: the window of apex velocities, near the next apex."""
    length, half = exact(transition.step_length_m), exact(settings.target_half_width_m)
    low, high = transition.apex_velocity_mps
    found = np.zeros(cells.shape, np.bool_)
    found[cells.columns_within(length - half, length + half), cells.rows_within(exact(low), exact(high))] = True
    return found


def _half_step(
    cells: Lattice,
    foot_m: float,
    omegas: tuple[float, ...],
    target: Cells,
    source: Cells,
    settings: Settings,
    all_masks: bool,
) -> HalfStep:
    step = flow(omegas, settings.tau_s, settings.disturbance)
    won, masks = sweep(target, source, images(cells, foot_m, step), not all_masks)
    if all_masks and not _progresses(cells, won, foot_m, step):
        won, masks = sweep(target, source, images(cells, foot_m, step), True)
    return HalfStep(foot_m, omegas, target, won, masks)


def _progresses(cells: Lattice, won: Cells, foot_m: float, step: Flow) -> bool:
    """Tell whether every omega moves every winning state forward, so that none of them can stay short of the target.

    It holds for any sensible disturbance. Where it does not, only the first omega that was found is kept: the order in
    which cells were found to win is a ranking that it decreases.
    """
    return least_advance(cells, won, foot_m, step) > 0


def _notes(transition: Transition, settings: Settings) -> tuple[str, ...]:
    fastest, width = transition.apex_velocity_mps[1], 2 * settings.target_half_width_m
    if settings.tau_s * fastest <= width:
        return ()
    return (
        f"in one sample the CoM moves up to {1e3 * settings.tau_s * fastest:.1f} mm, more than the target's "
        f"{1e3 * width:.1f} mm: states may jump over it, and the regions shrink",
    )


def warn(region: Region) -> None:
    """Emit the region's notes as warnings, for Python users."""
    for note in region.notes:
        warnings.warn(note, stacklevel=2)
