"""Reduced programs put together from parts: one of the base, and one of every foot with its contacts.

Rows and costs of a foot depend on its own contacts alone, so that contact tables which differ in one foot share all
other parts. The formulas are those of ``model``; here they are cut out of one program, kept, and moved into another.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp

from surefoot.footholds.model import (
    Motion,
    base_cost,
    clearance_rows,
    foothold_rows,
    gravity,
    leg_cost,
    leg_rows,
    reach_rows,
    stance_rows,
    torque_rows,
)
from surefoot.footholds.problem import Problem
from surefoot.footholds.reduction import base_motion, leg_size, reduced_motion
from surefoot.footholds.rows import FAMILIES, Array, Cost, CostBuilder, Index, Quantity, RowBuilder, Rows, squared
from surefoot.footholds.terrain import Hull, cone_hull, hull_of

_REGION, _CLEARANCE = FAMILIES.index("region"), FAMILIES.index("clearance")
_START = -1


@dataclass(frozen=True, slots=True, eq=False)
class Leg:
    """The part of one foot.

    Attributes:
        key: foot, whether there are forces, and the contacts.
        first: its first unknown in the program that it was cut out of; those of the base come before all feet.
        size: how many unknowns it has.
        step: number of its first footstep in that program.
        cost: over its own unknowns.
        rows: over the unknowns of that program.
    """

    key: tuple[int, bool, bytes]
    first: int
    size: int
    step: int
    cost: Cost
    rows: Rows


@dataclass(frozen=True, slots=True)
class Part:
    """Rows to be moved into a program.

    Attributes:
        rows: over the unknowns of the base and of at most one foot.
        shift: of the unknowns of the foot.
        step: to be added to the numbers of footsteps.
    """

    rows: Rows
    shift: int = 0
    step: int = 0


class Parts:
    """What the programs of one problem share, whatever the gait.

    Args:
        problem: its gait may be free.
    """

    def __init__(self, problem: Problem) -> None:
        base, acceleration, self.base_size = base_motion(problem)
        self.legs: dict[tuple[int, bool, bytes], Leg] = {}
        self.steps: dict[tuple[object, ...], Rows] = {}
        self.hulls: dict[tuple[int, ...], Hull] = {}
        self.cones: dict[tuple[int, ...], Array] = {}
        cost, pulled = CostBuilder(self.base_size), RowBuilder(self.base_size)
        base_cost(cost, problem, base, acceleration)
        self.base_cost = cost.cost()
        mass, pull = problem.robot.mass_kg, problem.robot.mass_kg * gravity(problem)
        terms = [(mass * np.asarray(factor), quantity) for factor, quantity in acceleration]
        where = (np.arange(problem.samples)[:, None], np.arange(3))
        pulled.add("dynamics", pull, pull, terms, where=where)
        self.pulled = pulled.rows()


class Assembly:
    """The program of one gait.

    Args:
        problem: its gait is given.
        parts: shared with other gaits of the same problem.
        forces: whether forces are unknowns.
    """

    def __init__(self, problem: Problem, parts: Parts, *, forces: bool) -> None:
        self.problem, self.parts, self.forces = problem, parts, forces
        self.motion: Motion = reduced_motion(problem, forces=forces)
        sizes = [leg_size(problem, foot, forces=forces) for foot in range(4)]
        self.firsts = [parts.base_size + sum(sizes[:foot]) for foot in range(4)]
        owners = [step.foot for step in problem.footsteps]
        self.numbers = [sum(owner < foot for owner in owners) for foot in range(4)]
        self.legs = [self._leg(foot, size) for foot, size in enumerate(sizes)]

    def _leg(self, foot: int, size: int) -> Leg:
        key = (foot, self.forces, self.problem.contacts[:, foot].tobytes())
        if key not in self.parts.legs:
            self.parts.legs[key] = self._cut(key, foot, size)
        return self.parts.legs[key]

    def _cut(self, key: tuple[int, bool, bytes], foot: int, size: int) -> Leg:
        costs, rows, first = CostBuilder(size), RowBuilder(self.motion.size), self.firsts[foot]
        leg_cost(costs, self.problem, _numbered_from(self.motion, first), [foot])
        reach_rows(rows, self.problem, self.motion, [foot])
        leg_rows(rows, self.problem, self.motion, [foot])
        clearance_rows(rows, self.problem, self.motion, [foot])
        if self.forces:
            torque_rows(rows, self.problem, self.motion, [foot])
        return Leg(key, first, size, self.numbers[foot], costs.cost(), rows.rows())

    def cost(self) -> Cost:
        """Return the cost: of the base, with the forces where equal shares are understood, and of every foot."""
        base = self.parts.base_cost
        if not self.forces:
            counts = self.problem.contacts.sum(axis=1)
            share = np.where(counts > 0, self.problem.weights.force / np.maximum(counts, 1), 0.0)
            shared = squared(self.parts.pulled, np.repeat(share, 3))
            base = Cost(
                sp.csc_matrix(base.hessian + shared.hessian), base.linear + shared.linear,
                base.constant + shared.constant, base.curvature + shared.curvature,
            )  # fmt: skip
        parts = [base, *(leg.cost for leg in self.legs)]
        return Cost(
            _diagonal([part.hessian for part in parts]),
            np.concatenate([part.linear for part in parts]),
            sum(part.constant for part in parts),
            np.concatenate([part.curvature for part in parts]),
        )

    def fixed(self) -> list[Part]:
        """Return the rows that no choice of polygons changes."""
        return [Part(self._dynamics()), *(self._placed(foot, leg.rows, leg) for foot, leg in enumerate(self.legs))]

    def _dynamics(self) -> Rows:
        """Return Newton's law, of all samples with the forces, or of those in flight."""
        pulled = self.parts.pulled
        if not self.forces:
            flight = pulled.pick(np.repeat(~self.problem.contacts.any(axis=1), 3))
            return replace(flight, family=np.full(len(flight.lower), FAMILIES.index("flight")))
        assert self.motion.force is not None
        sample, _, axis = np.nonzero(self.motion.force.index >= 0)
        column = self.motion.force.index[self.motion.force.index >= 0]
        shape = (len(pulled.lower), self.motion.size)
        pushing = sp.csr_matrix((np.full(len(column), -1.0), (3 * sample + axis, column)), shape=shape)
        base = sp.csr_matrix((pulled.matrix.data, pulled.matrix.indices, pulled.matrix.indptr), shape=shape)
        return replace(pulled, matrix=sp.csr_matrix(base + pushing))

    def step(self, number: int, left: tuple[int, ...]) -> list[Part]:
        """Return the rows of a footstep: its region, and its friction where forces are kept."""
        foot = self.problem.footsteps[number].foot
        leg = self.legs[foot]

        def region(build: RowBuilder) -> None:
            foothold_rows(build, self.problem, self.motion, number, self._hull(left))

        found = [self._kept(foot, (leg.key, "region", number - self.numbers[foot], left), region)]
        return [*found, self._friction(foot, number, left)] if self.forces else found

    def first_stance(self, foot: int) -> Part:
        """Return the friction rows of a foot before its first swing."""
        return self._friction(foot, _START, (self.problem.start_polygons[foot],))

    def _friction(self, foot: int, support: int, left: tuple[int, ...]) -> Part:
        def friction(build: RowBuilder) -> None:
            stance_rows(build, self.problem, self.motion, foot, support, self._cone(left))

        step = support - self.numbers[foot] if support != _START else _START
        return self._kept(foot, (self.legs[foot].key, "friction", step, left), friction)

    def _kept(self, foot: int, key: tuple[object, ...], write: Callable[[RowBuilder], None]) -> Part:
        """Return rows of a foot, moved here from the program for which they were written first."""
        leg, known = self.legs[foot], self.parts.steps
        if key not in known:
            build = RowBuilder(self.motion.size)
            write(build)
            back = Part(build.rows(), leg.first - self.firsts[foot], leg.step - self.numbers[foot])
            known[key] = _moved([back], self.parts.base_size, leg.first + leg.size)
        return self._placed(foot, known[key], leg)

    def _placed(self, foot: int, rows: Rows, leg: Leg) -> Part:
        return Part(rows, self.firsts[foot] - leg.first, self.numbers[foot] - leg.step)

    def rows(self, parts: Sequence[Part]) -> Rows:
        """Return parts as rows of this program."""
        return _moved(parts, self.parts.base_size, self.motion.size)

    def _hull(self, left: tuple[int, ...]) -> Hull:
        if left not in self.parts.hulls:
            self.parts.hulls[left] = hull_of([self.problem.polygons[r] for r in left])
        return self.parts.hulls[left]

    def _cone(self, left: tuple[int, ...]) -> Array:
        if left not in self.parts.cones:
            self.parts.cones[left] = cone_hull([self.problem.polygons[r] for r in left])
        return self.parts.cones[left]


def _numbered_from(motion: Motion, first: int) -> Motion:
    """Return a motion whose unknowns from a place on are numbered from 0: for a foot that begins there."""

    def numbered(quantity: Quantity) -> Quantity:
        return Quantity(np.where(quantity.index >= 0, quantity.index - first, -1), quantity.value)

    return replace(
        motion,
        feet=numbered(motion.feet),
        feet_acceleration=tuple((factor, numbered(quantity)) for factor, quantity in motion.feet_acceleration),
        force=None if motion.force is None else numbered(motion.force),
    )


def _moved(parts: Sequence[Part], base_size: int, size: int) -> Rows:
    columns: list[Index] = []
    wheres: list[Index] = []
    for part in parts:
        indices, where = part.rows.matrix.indices, part.rows.where
        columns.append(np.where(indices >= base_size, indices + part.shift, indices) if part.shift else indices)
        if part.step:
            where = where.copy()
            where[part.rows.family == _REGION, 0] += part.step
            where[part.rows.family == _CLEARANCE, 1] += part.step
        wheres.append(where)
    counts = np.concatenate([np.diff(part.rows.matrix.indptr) for part in parts])
    starts = np.concatenate([[0], np.cumsum(counts)])
    data = np.concatenate([part.rows.matrix.data for part in parts])
    return Rows(
        sp.csr_matrix((data, np.concatenate(columns), starts), shape=(len(starts) - 1, size)),
        np.concatenate([part.rows.lower for part in parts]),
        np.concatenate([part.rows.upper for part in parts]),
        np.concatenate([part.rows.family for part in parts]),
        np.concatenate(wheres),
    )


def _diagonal(blocks: Sequence[sp.csc_matrix]) -> sp.csc_matrix:
    sizes = np.cumsum([0, *(block.shape[0] for block in blocks)])
    counts = np.concatenate([np.diff(block.indptr) for block in blocks])
    rows = np.concatenate([block.indices + before for block, before in zip(blocks, sizes, strict=False)])
    starts = np.concatenate([[0], np.cumsum(counts)])
    data = np.concatenate([block.data for block in blocks])
    found = sp.csc_matrix((data, rows, starts), shape=(sizes[-1], sizes[-1]))
    found.sort_indices()
    return found
