"""Deadlines, cancelling, warm starts, determinism, explanations, and moment balance."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from surefoot.footholds import read_problem, retarget, retargeted, solve
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
    """A second on the two left legs: in the paper's model forces exert no moment, so that nothing tips."""
    problem = read_problem(Path(__file__).parents[2] / "scenes/footholds/tipping.yaml")
    free = solve(problem, why=False)
    assert free.verdict == "feasible"
    assert free.plan is not None
    moments = np.cross(problem.levers_m, free.plan.forces_n).sum(axis=1)
    assert np.abs(moments[:, 0]).max() > 15
    assert np.abs(free.plan.rpy_rad).max() == 0.0
    balanced = solve(replace(problem, options=replace(problem.options, moment_balance=True)), why=False)
    assert balanced.verdict == "infeasible"
    assert "Farkas" in balanced.certificate


def test_moves_the_goal_to_where_all_feet_find_a_stone() -> None:
    problem = problem_of("stones-8", 0)
    wished = replace(problem, goal_m=np.array([0.8, 0.12, 0.29]))
    found = retarget(wished)
    assert found.verdict == "feasible"
    assert found.position_m is not None
    assert found.feet_m is not None
    assert found.shift_m is not None
    assert np.abs(found.position_m[:2] - found.feet_m[:, :2].mean(axis=0)).max() <= 0.05 + 1e-6
    for foot, ground in zip(found.feet_m, found.polygons, strict=True):
        assert problem.polygons[ground].excess(foot) < 1e-6
    assert np.abs(retargeted(wished, found).goal_m - wished.goal_m).max() <= 0.15 + 1e-6
    assert retarget(replace(problem, goal_m=np.array([5.0, 0.0, 0.29]))).verdict == "infeasible"


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
