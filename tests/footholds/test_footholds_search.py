"""Deadlines, cancelling, warm starts, determinism, explanations, and moment balance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from surefoot.footholds import solve
from surefoot.footholds.gaits import NAMED
from surefoot.footholds.generators import FAMILIES, problem_of, strips


def test_is_deterministic() -> None:
    first, second = solve(problem_of("misaligned", 1)), solve(problem_of("misaligned", 1))
    assert first.objective == second.objective
    assert first.bound == second.bound
    assert first.nodes == second.nodes


def test_cancelling_at_once_answers_unknown() -> None:
    solution = solve(problem_of("stones-8", 0), cancelled=lambda: True)
    assert solution.verdict == "unknown"
    assert solution.limit == "cancelled"


def test_cancelling_later_keeps_the_best_plan_and_a_valid_bound() -> None:
    whole = solve(problem_of("misaligned", 3), why=False)
    asked = iter([False, False])
    part = solve(problem_of("misaligned", 3), cancelled=lambda: next(asked, True), why=False)
    assert part.verdict == "feasible"
    assert part.objective is not None
    assert part.bound is not None
    assert whole.objective is not None
    assert part.bound <= whole.objective <= part.objective * (1 + 1e-9)
    assert part.limit == "cancelled"


def test_a_deadline_that_has_passed_answers_unknown() -> None:
    problem = problem_of("stones-8", 0)
    late = replace(problem, options=replace(problem.options, time_limit_s=1e-9))
    solution = solve(late)
    assert solution.verdict == "unknown"
    assert solution.limit is not None
    assert "time limit" in solution.limit


def test_a_warm_start_finds_the_same_plan() -> None:
    cold = solve(problem_of("sparse", 1))
    assert cold.plan is not None
    warm = solve(problem_of("sparse", 1), guesses=(cold.plan.choice,))
    assert warm.objective == pytest.approx(cold.objective, rel=1e-4)


def test_says_what_has_to_give() -> None:
    problem = problem_of("stones-8", 0)
    solution = solve(replace(problem, goal_m=np.array([1.25, 0.0, 0.29])))
    assert solution.verdict == "infeasible"
    assert solution.explanation is not None
    lack = solution.explanation.lacks[0]
    assert lack.family == "reach"
    assert lack.unit == "m"
    assert 0 < lack.amount < 0.3
    assert "reach short by" in lack.text


def test_names_friction_where_friction_lacks() -> None:
    solution = solve(strips(1, friction=0.1))
    assert solution.verdict == "infeasible"
    assert solution.explanation is not None
    assert {lack.family for lack in solution.explanation.lacks} & {"friction", "reach"}
    assert "HiGHS" in solution.certificate


def test_the_fast_path_says_when_a_premise_fails() -> None:
    assert not solve(strips(2)).notes
    assert "forces are kept" in solve(strips(2, tilt=0.5, friction=0.2, goal_x_m=0.35)).notes[0]
    assert "whole model" in solve(strips(2, moment_balance=True, goal_x_m=0.3)).notes[0]


def test_the_papers_model_certifies_what_tips() -> None:
    """A leap takes off from the hind feet alone: without moment balance nothing says that the base pitches."""
    leap = replace(problem_of("stones-8", 0), gait=NAMED["leap-1.5s"])
    ground = replace(strips(0), step_s=0.025).polygons[:1]
    problem = replace(leap, polygons=ground, feet_m=_flat_feet(), goal_m=np.array([0.05, 0.0, 0.29]))
    free = solve(problem, why=False)
    assert free.plan is not None
    moments = np.cross(problem.levers_m, free.plan.forces_n).sum(axis=1)
    assert np.abs(moments[:, 1]).max() > problem.robot.base_torque_max_nm / 3
    assert np.abs(free.plan.rpy_rad).max() == 0.0
    balanced = solve(replace(problem, options=replace(problem.options, moment_balance=True)), why=False)
    assert balanced.verdict == "infeasible" or (
        balanced.plan is not None and np.abs(balanced.plan.rpy_rad).max() > 0.01
    )


def _flat_feet() -> np.ndarray:
    return np.array([[0.1805, 0.1308, 0.0], [0.1805, -0.1308, 0.0], [-0.1805, 0.1308, 0.0], [-0.1805, -0.1308, 0.0]])


@pytest.mark.parametrize("family", FAMILIES)
def test_families_are_seeded_and_solvable(family: str) -> None:
    assert np.array_equal(problem_of(family, 4).polygons[0].vertices_m, problem_of(family, 4).polygons[0].vertices_m)
    solution = solve(problem_of(family, 4), why=False)
    assert solution.verdict in {"feasible", "infeasible"}
    if solution.verdict == "feasible":
        assert solution.gap is not None
        assert solution.gap <= 1e-4
        assert solution.max_residual is not None
        assert solution.max_residual < 1e-6
