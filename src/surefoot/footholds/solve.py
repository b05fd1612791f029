"""Solves a foothold problem: the fast path, what it falls back to, and the answer with its proof."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from surefoot.errors import InputError
from surefoot.footholds.assembly import Parts
from surefoot.footholds.explain import Explanation, explain
from surefoot.footholds.form import standard_form
from surefoot.footholds.gaits import FreeGait, Gait
from surefoot.footholds.model import Choice
from surefoot.footholds.nodes import Node, Program, ReducedProgram, WholeProgram
from surefoot.footholds.orientation import Turning, turning
from surefoot.footholds.plan import Plan, objective, plan_of, residuals, shared_forces
from surefoot.footholds.problem import Problem, impossible_cost
from surefoot.footholds.proof import Proof, proof_of
from surefoot.footholds.pruning import reachable
from surefoot.footholds.search import Accept, Branch, Outcome, search
from surefoot.footholds.solvers import HighsSolver

if TYPE_CHECKING:
    from surefoot.footholds.bounding import GaitProof
    from surefoot.footholds.refute import Refuted

RESIDUAL_MAX = 1e-6
_SLACK_N = 1e-9
_CERTIFY_S = 20.0


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """The answer to a foothold problem.

    Attributes:
        verdict: ``feasible``, ``infeasible`` or ``unknown``.
        objective: of the best plan; None without one.
        bound: certified lower bound of the objective; None when there is none.
        gap: (objective - bound) / objective; None without a plan.
        net_gap: the same without the constant gravity cost; None where the objective does not exceed that.
        solve_ms: until the search ended, by the clock.
        solve_cpu_ms: the same in CPU time, which a busy machine does not stretch.
        certify_ms: what confirming infeasibility by the second method took.
        explain_ms: what explaining it took.
        nodes: convex programs solved.
        max_residual: worst violation of any row of the whole model.
        residuals: the same by family.
        certificate: what proves the verdict.
        explanation: why it is infeasible.
        limit: which limit stopped the search, if one did.
        notes: which premises of the fast path did not hold.
        plan: the best plan.
        proof: what proves bound or infeasibility.
        free: what a search for the gait adds; None where the gait was given.
    """

    verdict: str
    objective: float | None
    bound: float | None
    gap: float | None
    net_gap: float | None
    solve_ms: float
    solve_cpu_ms: float
    certify_ms: float
    explain_ms: float
    nodes: int
    max_residual: float | None
    residuals: dict[str, float]
    certificate: str
    explanation: Explanation | None
    limit: str | None
    notes: tuple[str, ...]
    plan: Plan | None
    proof: Proof | None
    free: FreeAnswer | None = None


@dataclass(frozen=True, slots=True, eq=False)
class FreeAnswer:
    """What a search for the gait adds to an answer; ``bound`` and ``gap`` of the answer are over all gaits.

    Attributes:
        gait: that was found; None without a plan.
        origin: what proposed it: the name of a template, ``annealing``, ``prices``, or ``exact program``.
        templates_tried: how many contact tables were tried.
        first_feasible_s: until the first verified plan; None without one.
        first_objective: of that plan.
        proof: what proves the bound.
        turning: multipliers of the orientation, which is solved apart (see ``Proof``).
        refutation: what proves infeasibility.
    """

    gait: Gait | None
    origin: str
    templates_tried: int
    first_feasible_s: float | None
    first_objective: float | None
    proof: GaitProof | None = None
    turning: tuple[list[float], ...] = ()
    refutation: Refuted | None = None


def solve(
    problem: Problem,
    *,
    cancelled: Callable[[], bool] = lambda: False,
    guesses: tuple[Choice, ...] = (),
    certify: bool = True,
    why: bool = True,
    worth: float = np.inf,
) -> Solution:
    """Find the best footholds, forces and base motion, or prove that there are none; and the gait, where it is free.

    Args:
        problem: what to solve; its options hold gap and time limit.
        cancelled: asked before every convex program; True ends the search with what there is.
        guesses: decided choices to try first, such as those of a plan for a similar problem.
        certify: whether "infeasible" is confirmed by a second method.
        why: whether "infeasible" is explained.
        worth: plans that cost as much are not looked for; the answer is then ``unknown``.
    """
    if isinstance(problem.gait, FreeGait):
        if problem.options.joint_reach:
            raise InputError("is for gaits that are given, not for a free one", key="options.joint_reach")
        from surefoot.footholds.gaitfree import solve_free

        return solve_free(problem, cancelled=cancelled, certify=certify, why=why)
    return _Solving(problem, cancelled, guesses, worth).run(certify, why)


def cheapest(
    problem: Problem, *, cancelled: Callable[[], bool], worth: float, parts: Parts | None = None
) -> tuple[float, Choice | None, Node | None]:
    """Return what a gait costs without turning, its choice, and its first program; none when it is worth too little.

    This is ``solve`` without plan, residuals and certificates: for comparing many gaits, whose programs share parts.
    """
    run = _Solving(problem, cancelled, (), worth, parts)
    root, boxes = reachable(problem)
    if boxes.empty is not None:
        return np.inf, None, None
    _, outcome = run.searched(root)
    return outcome.value, outcome.best, outcome.root.node


class _Solving:
    """One run: what it needs to know on the way."""

    def __init__(
        self,
        problem: Problem,
        cancelled: Callable[[], bool],
        guesses: tuple[Choice, ...],
        worth: float = np.inf,
        parts: Parts | None = None,
    ) -> None:
        self.parts = parts or Parts(problem)
        self.problem, self.cancelled, self.guesses, self.worth = problem, cancelled, guesses, worth
        load_backends()
        self.begin, self.begin_cpu = time.perf_counter(), time.process_time()
        self.solve_cpu_ms = 0.0
        self.notes: list[str] = []
        self.limit: str | None = None
        self.nodes = 0

    def run(self, certify: bool, why: bool) -> Solution:
        problem = self.problem
        root, boxes = reachable(problem)
        if boxes.empty is not None:
            return self.refuted("interval propagation", None, certify, why)
        turned = None if problem.options.moment_balance else turning(problem)
        if turned is not None and turned.feasible is False:
            return self.refuted("", None, certify, why)
        self.worth -= turned.value if turned is not None else 0.0
        program, outcome = self.searched(root)
        self.nodes += outcome.nodes
        if outcome.best is not None and outcome.node is not None:
            return self.feasible(program, outcome, turned)
        if not outcome.complete:
            return self.unknown()
        if outcome.bound < impossible_cost(problem) and np.isfinite(self.worth):
            self.limit = f"no plan costs less than {self.worth:g}"
            return self.unknown()
        if outcome.bound >= impossible_cost(problem):
            return self.refuted("Farkas rays", proof_of(problem, outcome, turned), certify, why)
        return self.refuted("", None, certify, why)

    def stop(self) -> bool:
        if self.cancelled():
            self.limit = "cancelled"
        elif time.perf_counter() - self.begin > self.problem.options.time_limit_s:
            self.limit = f"the time limit of {self.problem.options.time_limit_s:g} s was reached"
        return self.limit is not None

    def searched(self, root: Choice) -> tuple[Program, Outcome]:
        """Search with shared forces; where friction or torque press, again with the forces as unknowns."""
        program: Program
        if self.problem.options.moment_balance:
            self.notes.append("whole model: with moment balance orientation and forces are coupled")
            program = WholeProgram(self.problem)
            return program, self.search(program, root)
        program = ReducedProgram(self.problem, forces=False, parts=self.parts)
        outcome = self.search(program, root, accept=lambda choice, node: slack(self.problem, program, choice, node))
        if outcome.slack or self.limit is not None:
            return program, outcome
        self.nodes += outcome.nodes
        self.notes.append(
            "forces are kept as unknowns: shared equally, they leave a friction pyramid or a torque limit"
        )
        program = ReducedProgram(self.problem, forces=True, parts=self.parts)
        tried = () if outcome.pressing is None else (outcome.pressing,)
        return program, self.search(program, root, guesses=(*tried, *self.guesses), before=outcome.root)

    def search(
        self,
        program: Program,
        root: Choice,
        *,
        accept: Accept = lambda _choice, _node: True,
        guesses: tuple[Choice, ...] | None = None,
        before: Branch | None = None,
    ) -> Outcome:
        guesses = self.guesses if guesses is None else guesses
        gap = self.problem.options.stop_gap
        return search(
            self.problem, program, root, gap=gap, stop=self.stop, accept=accept, guesses=guesses, before=before,
            worth=self.worth,
        )  # fmt: skip

    def feasible(self, program: Program, outcome: Outcome, turned: Turning | None) -> Solution:
        problem = self.problem
        assert outcome.best is not None
        assert outcome.node is not None
        plan = plan_of(problem, program, outcome.best, outcome.node, turned)
        solve_ms = self.elapsed_ms()
        value = objective(problem, plan)
        bound = min(outcome.bound + (turned.bound if turned is not None else 0.0), value)
        worst = residuals(problem, plan)
        kept = max(worst.values()) <= RESIDUAL_MAX
        return Solution(
            verdict="feasible" if kept else "unknown",
            objective=value,
            bound=bound if np.isfinite(bound) else None,
            gap=(value - bound) / value,
            net_gap=(value - bound) / (value - problem.gravity_cost) if value > problem.gravity_cost else None,
            solve_ms=solve_ms,
            solve_cpu_ms=self.solve_cpu_ms,
            certify_ms=0.0,
            explain_ms=0.0,
            nodes=self.nodes,
            max_residual=max(worst.values()),
            residuals=worst,
            certificate="rows of the whole model recomputed" if kept else "none: rows of the whole model are violated",
            explanation=None,
            limit=self.limit,
            notes=tuple(self.notes),
            plan=plan,
            proof=proof_of(problem, outcome, turned),
        )

    def refuted(self, first: str, proof: Proof | None, certify: bool, why: bool) -> Solution:
        """Answer that there is no plan, if one of the methods proves it and none of them disagrees."""
        solve_ms = self.elapsed_ms()
        begin = time.perf_counter()
        second = HighsSolver().solve(standard_form(self.problem), _CERTIFY_S).feasible if certify else None
        methods = [name for name, proved in ((first, bool(first)), ("HiGHS feasibility", second is False)) if proved]
        proved = bool(methods) and second is not True
        if second is True:
            self.limit = "the two methods disagree about feasibility, within their tolerances"
        elif not methods:
            self.limit = "infeasible by PIQP, but no second method confirms it"
        certify_ms = (time.perf_counter() - begin) * 1e3
        explanation = explain(self.problem) if proved and why else None
        explain_ms = (time.perf_counter() - begin) * 1e3 - certify_ms
        return self.negative(
            "infeasible" if proved else "unknown",
            solve_ms=solve_ms,
            certify_ms=certify_ms,
            explain_ms=explain_ms,
            certificate=" and ".join(methods) if proved else "none",
            explanation=explanation,
            proof=proof,
        )

    def unknown(self) -> Solution:
        return self.negative(
            "unknown",
            solve_ms=self.elapsed_ms(),
            certify_ms=0.0,
            explain_ms=0.0,
            certificate="none",
            explanation=None,
            proof=None,
        )

    def negative(
        self,
        verdict: str,
        *,
        solve_ms: float,
        certify_ms: float,
        explain_ms: float,
        certificate: str,
        explanation: Explanation | None,
        proof: Proof | None,
    ) -> Solution:
        return replace(
            no_plan(verdict, certificate, self.limit),
            solve_ms=solve_ms,
            solve_cpu_ms=self.solve_cpu_ms,
            certify_ms=certify_ms,
            explain_ms=explain_ms,
            nodes=self.nodes,
            explanation=explanation,
            notes=tuple(self.notes),
            proof=proof,
        )

    def elapsed_ms(self) -> float:
        """Return the clock's time so far, and keep the CPU time."""
        self.solve_cpu_ms = (time.process_time() - self.begin_cpu) * 1e3
        return (time.perf_counter() - self.begin) * 1e3


def no_plan(verdict: str, certificate: str, limit: str | None) -> Solution:
    """Return an answer without a plan."""
    return Solution(
        verdict=verdict, objective=None, bound=None, gap=None, net_gap=None, solve_ms=0.0, solve_cpu_ms=0.0,
        certify_ms=0.0, explain_ms=0.0, nodes=0, max_residual=None, residuals={}, certificate=certificate,
        explanation=None, limit=limit, notes=(), plan=None, proof=None,
    )  # fmt: skip


def load_backends() -> None:
    """Import what the search needs, so that importing does not count as solving."""
    import piqp  # type: ignore[import-untyped]  # noqa: F401
    import scipy.sparse.linalg
    import scipy.spatial  # noqa: F401


def slack(problem: Problem, program: Program, choice: Choice, node: Node) -> bool:
    """Return whether the forces of a plan may be shared equally: friction and torque do not press."""
    terms = program.motion.base_acceleration
    acceleration = sum(np.asarray(factor) * quantity.at(node.answer.unknowns) for factor, quantity in terms)
    forces = shared_forces(problem, np.asarray(acceleration))
    limit = np.array(problem.robot.torque_max_nm) + _SLACK_N
    for foot in range(4):
        torque = forces[:, foot] @ np.array(problem.robot.jacobians[foot])
        if (np.abs(torque) > limit).any():
            return False
        index = problem.support_index[:, foot]
        for support in np.unique(index[index > -2]):
            ids = problem.start_polygons[foot] if support < 0 else choice[support][0]
            if (forces[index == support, foot] @ problem.polygons[ids].pyramid.T > _SLACK_N).any():
                return False
    return True
