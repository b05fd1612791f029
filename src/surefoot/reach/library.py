"""Regions for many steps in a row (Shamsah et al., T-RO 2023, Corollary IV.6).

A walk stays safe when the target of every step lies in the first-half region of the next one, seen in the next step's
frame. The library holds the regions of given transitions, and says for which pairs that holds and for which it does
not, and by how much.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from surefoot.compute import Deadline
from surefoot.errors import InputError
from surefoot.reach.artefact import inputs_sha256, load_region, save_region
from surefoot.reach.controller import Controller
from surefoot.reach.flows import Floats
from surefoot.reach.lattice import Cells
from surefoot.reach.parameters import Settings, Transition, first_foot_after_turn
from surefoot.reach.synthesis import Region, synthesize
from surefoot.walking import StepLibrary

WINDOWS_MPS = ((0.2, 0.45), (0.45, 0.7))
_NO_DEADLINE = Deadline()


@dataclass(frozen=True, slots=True)
class LibraryStep:
    """A transition as it follows another one.

    Attributes:
        name: for people.
        transition: in the frame of the new heading.
        heading_change_rad: by which the heading changes at its current apex, before the step.
        turn: kind of the turn that it is a step of, empty when straight.
        number: which step of that turn, counted from 1.
        last: whether it is the last one.
    """

    name: str
    transition: Transition
    heading_change_rad: float = 0.0
    turn: str = ""
    number: int = 0
    last: bool = False


@dataclass(frozen=True, slots=True)
class Gap:
    """A pair of steps whose regions do not compose.

    Attributes:
        before: name of the step whose target is meant.
        after: name of the step whose first-half region does not hold it.
        missing: share of the target that is not held.
        velocities_mps: least and greatest apex velocity (in the frame of ``before``) that is not held.
    """

    before: str
    after: str
    missing: float
    velocities_mps: tuple[float, float]


@dataclass(frozen=True, slots=True)
class RegionLibrary:
    """Regions by the name of their step.

    Attributes:
        steps: in the order given.
        regions: by name.
        settings: of every synthesis.
    """

    steps: tuple[LibraryStep, ...]
    regions: Mapping[str, Region]
    settings: Settings

    def controller(self, name: str) -> Controller:
        """Return the controller of a step.

        Raises:
            InputError: there is none of that name.
        """
        if name not in self.regions:
            raise InputError(f"there is no step {name!r}; there are: {', '.join(self.regions)}")
        return Controller(self.regions[name])

    @property
    def empty(self) -> dict[str, str]:
        """Steps without a region, with the reason."""
        reasons = {name: region.emptied_by for name, region in self.regions.items()}
        return {name: reason for name, reason in reasons.items() if reason is not None}

    def gaps(self, follows: Callable[[LibraryStep, LibraryStep], bool] = lambda before, after: True) -> tuple[Gap, ...]:
        """Return every pair that may follow one another and does not compose.

        Args:
            follows: which pairs may; all of them by default.
        """
        pairs = ((before, after) for before in self.steps for after in self.steps if follows(before, after))
        found = (self._gap(before, after) for before, after in pairs)
        return tuple(gap for gap in found if gap is not None)

    def _gap(self, before: LibraryStep, after: LibraryStep) -> Gap | None:
        source, region = self.regions[before.name], self.regions[after.name]
        i, j = np.nonzero(source.second.target)
        if i.size == 0:
            return None
        held = _target_held(source, after, region, i, j)
        if held.all():
            return None
        lost, (low, high) = j[~held], source.cells.v_edges()
        span = (float(low[lost].min()), float(high[lost].max()))
        return Gap(before.name, after.name, float((~held).mean()), span)


def region_library(
    steps: Sequence[LibraryStep],
    settings: Settings,
    *,
    cache: Path | None = None,
    progress: Callable[[str], None] = lambda _: None,
    deadline: Deadline = _NO_DEADLINE,
) -> RegionLibrary:
    """Synthesise the regions of every step, or take them from a cache.

    Args:
        steps: with different names.
        settings: of every synthesis.
        cache: a folder of saved regions, named by the hash of their inputs; made if it is missing.
        progress: is told what is done.
        deadline: when to give up.

    Raises:
        InputError: two steps have one name, or a cached file is broken.
        LimitExceeded: the deadline passed.
    """
    if len({step.name for step in steps}) != len(steps):
        raise InputError("two steps of the library have the same name")
    regions: dict[str, Region] = {}
    for step in steps:
        deadline.check(f"synthesising the regions of {step.name}")
        progress(step.name)
        regions[step.name] = _region(step.transition, settings, cache)
    return RegionLibrary(tuple(steps), MappingProxyType(regions), settings)


def composed_library(
    steps: Sequence[LibraryStep],
    settings: Settings,
    *,
    follows: Callable[[LibraryStep, LibraryStep], bool] = lambda before, after: True,
    deadline: Deadline = _NO_DEADLINE,
) -> RegionLibrary:
    """Synthesise regions that compose: every target is cut down to what the steps after it can start from.

    Steps that differ in their window of apex velocities only are one action, whose window is free to choose. A target
    cell stays when every action that may follow has a window whose first-half region holds the cell. Cutting targets
    shrinks regions, so it is repeated until nothing is cut. Source: Corollary IV.6 (i).

    Args:
        steps: with different names.
        settings: of every synthesis.
        follows: which steps may follow which.
        deadline: when to give up.

    Raises:
        LimitExceeded: the deadline passed.
    """
    regions = dict(region_library(steps, settings, deadline=deadline).regions)
    while True:
        deadline.check("composing regions")
        kept = {step.name: _kept_target(step, steps, regions, follows) for step in steps}
        cut = [step for step in steps if (regions[step.name].second.target & ~kept[step.name]).any()]
        if not cut:
            return RegionLibrary(tuple(steps), MappingProxyType(regions), settings)
        for step in cut:
            regions[step.name] = synthesize(step.transition, settings, within=kept[step.name])


def _kept_target(
    before: LibraryStep,
    steps: Sequence[LibraryStep],
    regions: Mapping[str, Region],
    follows: Callable[[LibraryStep, LibraryStep], bool],
) -> Cells:
    """Return the target cells of a step from which every action that may follow can be started."""
    source = regions[before.name]
    i, j = np.nonzero(source.second.target)
    actions: dict[tuple[object, ...], NDArray[np.bool_]] = {}
    for after in steps:
        if not follows(before, after):
            continue
        held = _target_held(source, after, regions[after.name], i, j)
        key = (after.transition.step_length_m, after.transition.first_foot_m, after.turn, after.number)
        actions[key] = actions.get(key, np.zeros(i.size, np.bool_)) | held
    kept = np.zeros_like(source.second.target)
    stays = np.all(list(actions.values()), axis=0) if actions else np.ones(i.size, np.bool_)
    kept[i[stays], j[stays]] = True
    return kept


def _target_held(
    source: Region, after: LibraryStep, region: Region, i: NDArray[np.int64], j: NDArray[np.int64]
) -> NDArray[np.bool_]:
    """Tell which target cells of one step lie, in the frame of the next, in its first-half region."""
    turn, length = math.cos(after.heading_change_rad), source.transition.step_length_m
    x0, x1 = ((edges[i] - length) * turn for edges in source.cells.x_edges())
    v0, v1 = (edges[j] * turn for edges in source.cells.v_edges())
    return _covered(region, x0, x1, v0, v1)


def action_steps(
    walking: StepLibrary, windows_mps: Sequence[tuple[float, float]] = WINDOWS_MPS
) -> tuple[LibraryStep, ...]:
    """Return the transitions of the action game: every length with its deviations, straight and turned, per window.

    Stop and start are left out: they pass an apex velocity of 0.1 m/s, at the lower end of the grid. The stance foot
    after a turn is taken at the desired dy2 of the walk.
    """
    p = walking.parameters
    deviations = range(-p.sagittal_outcomes_cells, p.sagittal_outcomes_cells + 1)
    cells = sorted({n + e for n in (*p.straight_cells, p.pre_step_cells) for e in deviations if n + e > 0})
    steps = [
        LibraryStep(f"straight {n} cells to {low:g}-{high:g} m/s", Transition(n * p.fine_cell_m, (low, high)))
        for n in cells
        for low, high in windows_mps
    ]
    slow = [(low, min(high, p.steering_speed_max_mps)) for low, high in windows_mps if low < p.steering_speed_max_mps]
    for kind, lengths in (("A", p.turn_a_cells), ("B", p.turn_b_cells)):
        for number, length in enumerate(lengths, 1):
            toward = (number % 2 == 1) == (kind == "B")
            foot = first_foot_after_turn(p.turn_rad if toward else -p.turn_rad, 1.0, p.dy2_m)
            for low, high in slow:
                name = f"turn {kind} step {number} to {low:g}-{high:g} m/s"
                transition, last = Transition(length * p.fine_cell_m, (low, high), foot), number == len(lengths)
                steps.append(LibraryStep(name, transition, p.turn_rad, kind, number, last))
    return tuple(steps)


def action_follows(before: LibraryStep, after: LibraryStep) -> bool:
    """Tell whether the action game lets one step follow another: turns are walked to their end, then straight on."""
    if before.turn and not before.last:
        return after.turn == before.turn and after.number == before.number + 1
    return after.number <= 1 and not (before.turn and after.turn)


def _region(transition: Transition, settings: Settings, cache: Path | None) -> Region:
    if cache is None:
        return synthesize(transition, settings)
    path = cache / f"{inputs_sha256(transition, settings)[:32]}.json"
    if path.is_file():
        return load_region(path)
    region = synthesize(transition, settings)
    save_region(region, path)
    return region


def _covered(region: Region, x0: Floats, x1: Floats, v0: Floats, v1: Floats) -> NDArray[np.bool_]:
    """Tell which rectangles lie in winning cells of the first half step; edges may touch."""
    cells, inward = region.cells, 1e-9
    i0 = np.floor((x0 - cells.x0_m) / cells.x_step_m + 0.5 + inward).astype(int)
    i1 = np.ceil((x1 - cells.x0_m) / cells.x_step_m + 0.5 - inward).astype(int)
    j0 = np.floor((v0 - cells.v0_mps) / cells.v_step_mps + 0.5 + inward).astype(int)
    j1 = np.ceil((v1 - cells.v0_mps) / cells.v_step_mps + 0.5 - inward).astype(int)
    sums = np.zeros((cells.columns + 1, cells.rows + 1), np.int64)
    sums[1:, 1:] = region.first.won.cumsum(0).cumsum(1)
    inside = (i0 >= 0) & (i1 <= cells.columns) & (j0 >= 0) & (j1 <= cells.rows)
    a, b = np.clip(i0, 0, cells.columns), np.clip(i1, 0, cells.columns)
    c, d = np.clip(j0, 0, cells.rows), np.clip(j1, 0, cells.rows)
    won = sums[b, d] - sums[a, d] - sums[b, c] + sums[a, c]
    return np.asarray(inside & (won == (b - a) * (d - c)))
