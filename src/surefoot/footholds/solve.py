"""Solves a foothold problem: the fast path, what it falls back to, and the answer with its proof."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from surefoot.errors import BackendFailed
from surefoot.footholds.certify import Certificate, refuted_by_highs
from surefoot.footholds.explain import Explanation, explain
from surefoot.footholds.model import Choice
from surefoot.footholds.nodes import Node, Program, ReducedProgram, WholeProgram
from surefoot.footholds.orientation import Turning, turning
from surefoot.footholds.plan import Plan, objective, plan_of, residuals, shared_forces
from surefoot.footholds.problem import Problem
from surefoot.footholds.proof import Proof, impossible_cost, proof_of
from surefoot.footholds.pruning import reachable
from surefoot.footholds.rows import Array
from surefoot.footholds.search import Outcome, search

RESIDUAL_MAX = 1e-6
_SLACK_N = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """The answer to a foothold problem.

    Attributes:
        verdict: ``feasible``, ``infeasible`` or ``unknown``.
        objective: of the best plan; None without one.
        bound: certified lower bound of the objective; None when there is none.
        gap: (objective - bound) / objective; None without a plan.
        net_gap: the same without the constant gravity cost.
        solve_ms: until the search ended.
        certify_ms: what certifying (and explaining) infeasibility took.
        nodes: convex programs solved.
        max_residual: worst violation of any row of the whole model.
        residuals: the same by family.
        certificate: what proves the verdict.
        explanation: why it is infeasible.
        limit: which limit stopped the search, if one did.
        notes: which premises of the fast path did not hold.
        plan: the best plan.
        proof: what proves bound or infeasibility.
    """

    verdict: str
    objective: float | None
    bound: float | None
    gap: float | None
    net_gap: float | None
    solve_ms: float
    certify_ms: float
    nodes: int
    max_residual: float | None
    residuals: dict[str, float]
    certificate: str
    explanation: Explanation | None
    limit: str | None
    notes: tuple[str, ...]
    plan: Plan | None
    proof: Proof | None


def solve(
    problem: Problem,
    *,
    cancelled: Callable[[], bool] = lambda: False,
    guesses: tuple[Choice, ...] = (),
    certify: bool = True,
    why: bool = True,
) -> Solution:
    """Find the best footholds, forces and base motion, or prove that there are none.

    Args:
        problem: what to solve; its options hold gap and time limit.
        cancelled: asked before every convex program; True ends the search with what there is.
        guesses: decided choices to try first, such as those of a plan for a similar problem.
        certify: whether "infeasible" is confirmed by a second method.
        why: whether "infeasible" is explained.
    """
    return _Solving(problem, cancelled, guesses).run(certify, why)


class _Solving:
    def __init__(self, problem: Problem, cancelled: Callable[[], bool], guesses: tuple[Choice, ...]) -> None:
        self.problem, self.cancelled, self.guesses = problem, cancelled, guesses
        self.begin = time.perf_counter()
        self.notes: list[str] = []
        self.limit: str | None = None

    def run(self, certify: bool, why: bool) -> Solution:
        root, boxes = reachable(self.problem)
        turned = None if self.problem.options.moment_balance else turning(self.problem)
        if boxes.empty is not None:
            return self.refuted(root, "intervals: " + boxes.empty, None, 0, certify, why)
        if turned is not None and turned.feasible is False:
            return self.refuted(root, "farkas ray: the base cannot turn so fast", None, 0, certify, why)
        program, outcome = self.searched(root)
        if outcome.best is not None and outcome.node is not None:
            return self.feasible(program, outcome, root, turned)
        if outcome.complete and outcome.bound >= impossible_cost(self.problem):
            proof = proof_of(self.problem, root, outcome, turned)
            return self.refuted(root, "farkas rays in every leaf", proof, outcome.nodes, certify, why)
        if outcome.complete and certify:
            return self.refuted(root, "", None, outcome.nodes, certify, why)
        return self.unknown(outcome.nodes)

    def stop(self) -> bool:
        if self.cancelled():
            self.limit = "cancelled"
        elif time.perf_counter() - self.begin > self.problem.options.time_limit_s:
            self.limit = f"the time limit of {self.problem.options.time_limit_s:g} s was reached"
        return self.limit is not None

    def searched(self, root: Choice) -> tuple[Program, Outcome]:
        """Search with shared forces; where friction or torque press, again with the forces as unknowns."""
        gap = self.problem.options.gap
        if self.problem.options.moment_balance:
            self.notes.append("whole model: with moment balance orientation and forces are coupled")
            whole = WholeProgram(self.problem)
            return whole, search(self.problem, whole, root, gap=gap, stop=self.stop, guesses=self.guesses)
        program: Program = ReducedProgram(self.problem, forces=False)
        accept = self.slack
        outcome = search(self.problem, program, root, gap=gap, stop=self.stop, accept=accept, guesses=self.guesses)
        if outcome.slack:
            return program, outcome
        self.notes.append("forces are kept as unknowns: shared equally, they leave a friction pyramid or a torque limit")
        program = ReducedProgram(self.problem, forces=True)
        again = search(self.problem, program, root, gap=gap, stop=self.stop, guesses=self.guesses)
        again.nodes += outcome.nodes
        return program, again

    def slack(self, choice: Choice, node: Node) -> bool:
        """Return whether the forces of a plan may be shared equally."""
        problem = self.problem
        acceleration = sum(np.asarray(c) * q.at(node.answer.unknowns) for c, q in self.acceleration(node))
        forces = shared_forces(problem, np.asarray(acceleration))
        for foot in range(4):
            held = problem.contacts[:, foot]
            torque = forces[held, foot] @ np.array(problem.robot.jacobians[foot])
            if (np.abs(torque) > np.array(problem.robot.torque_max_nm) + _SLACK_N).any():
                return False
            index = problem.support_index[:, foot]
            for support in np.unique(index[held]):
                ids = problem.start_polygons[foot] if support < 0 else choice[support][0]
                cone = problem.polygons[ids].pyramid
                if (forces[index == support, foot] @ cone.T > _SLACK_N).any():
                    return False
        return True

    def acceleration(self, node: Node) -> tuple[tuple[object, object], ...]:
        raise NotImplementedError

    def elapsed_ms(self) -> float:
        return (time.perf_counter() - self.begin) * 1e3
