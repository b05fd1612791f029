"""A foothold plan: every array of the model, recovered from a solved program, with residuals of its own."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surefoot.footholds.model import Choice, gravity, whole_cost, whole_rows
from surefoot.footholds.nodes import Node, Program
from surefoot.footholds.orientation import Turning
from surefoot.footholds.problem import Problem
from surefoot.footholds.rows import FAMILIES, Array


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """A motion that obeys the model; SI units, world frame, feet in the order FL, FR, RL, RR.

    Attributes:
        choice: the polygon of every footstep, then the free region of every foot and window.
        base_m, base_velocity_mps, base_acceleration_mps2: shape (N, 3).
        rpy_rad, rpy_rate_radps, rpy_acceleration_radps2: shape (N, 3).
        feet_m, feet_velocity_mps, feet_acceleration_mps2, forces_n: shape (N, 4, 3).
    """

    choice: Choice
    base_m: Array
    base_velocity_mps: Array
    base_acceleration_mps2: Array
    rpy_rad: Array
    rpy_rate_radps: Array
    rpy_acceleration_radps2: Array
    feet_m: Array
    feet_velocity_mps: Array
    feet_acceleration_mps2: Array
    forces_n: Array

    @property
    def unknowns(self) -> Array:
        """Return the 66 numbers of every sample in the order of Eq. (2)."""
        body = [self.base_m, self.base_velocity_mps, self.base_acceleration_mps2]
        body += [self.rpy_rad, self.rpy_rate_radps, self.rpy_acceleration_radps2]
        legs = [self.feet_m, self.feet_velocity_mps, self.feet_acceleration_mps2, self.forces_n]
        joined = np.stack(legs, axis=2).reshape(len(self.base_m), 48)
        return np.concatenate([*body, joined], axis=1).ravel()


def plan_of(problem: Problem, program: Program, choice: Choice, node: Node, turned: Turning | None) -> Plan:
    """Recover the whole motion from a solved program."""
    unknowns = node.answer.unknowns
    motion = program.motion
    if turned is None:
        return whole_plan(problem, choice, unknowns)
    base, feet = motion.base.at(unknowns), motion.feet.at(unknowns)
    velocity, acceleration = rates_of(base, problem.step_s)
    acceleration[0] = unknowns[motion.base_acceleration[-1][1].index[0]]
    turn_rate, turn_acceleration = rates_of(turned.angles_rad, problem.step_s)
    feet_velocity, feet_acceleration = rates_of(feet, problem.step_s)
    forces = shared_forces(problem, acceleration) if motion.force is None else motion.force.at(unknowns)
    return Plan(
        choice, base, velocity, acceleration, turned.angles_rad, turn_rate, turn_acceleration,
        feet, feet_velocity, feet_acceleration, forces,
    )  # fmt: skip


def whole_plan(problem: Problem, choice: Choice, unknowns: Array) -> Plan:
    """Return the plan that a solution of the whole program is."""
    table = unknowns.reshape(problem.samples, 66)
    body = [table[:, a : a + 3] for a in range(0, 18, 3)]
    legs = table[:, 18:].reshape(problem.samples, 4, 4, 3)
    return Plan(choice, *body, *(legs[:, :, a] for a in range(4)))


def rates_of(position: Array, step_s: float) -> tuple[Array, Array]:
    """Return velocity and acceleration of a path that starts at rest, by backward Euler."""
    velocity, acceleration = np.zeros_like(position), np.zeros_like(position)
    velocity[1:] = np.diff(position, axis=0) / step_s
    acceleration[1:] = np.diff(velocity, axis=0) / step_s
    return velocity, acceleration


def shared_forces(problem: Problem, acceleration: Array) -> Array:
    """Return the forces that move the base when the feet in contact share them equally, shape (N, 4, 3)."""
    total = problem.robot.mass_kg * (acceleration - gravity(problem))
    counts = np.maximum(problem.contacts.sum(axis=1), 1)
    return np.where(problem.contacts[:, :, None], (total / counts[:, None])[:, None, :], 0.0)


def residuals(problem: Problem, plan: Plan) -> dict[str, float]:
    """Return the worst violation of every family of rows of the whole model, in metres, newtons, and so on."""
    rows = whole_rows(problem, plan.choice)
    excess = rows.excess(plan.unknowns)
    return {
        name: max(float(excess[rows.family == number].max()), 0.0)
        for number, name in enumerate(FAMILIES)
        if (rows.family == number).any()
    }


def objective(problem: Problem, plan: Plan) -> float:
    """Return the cost of Eqs. (4)-(5) of a plan."""
    return whole_cost(problem).at(plan.unknowns)
