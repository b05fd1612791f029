"""The fast path against enumeration on the whole model, and every answer against the independent checker."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from surefoot.footholds import solve, write_plan
from surefoot.footholds.exhaustive import best_of_all
from surefoot.footholds.generators import borderline, strips
from surefoot.footholds.problem import Problem
from surefoot.verify import verify_path

GAP = 1e-4
KINDS: dict[str, dict[str, Any]] = {
    "flat": {},
    "tilted": {"tilt": 0.4},
    "slippery": {"tilt": 0.5, "friction": 0.2, "goal_x_m": 0.35},
    "far": {"goal_x_m": 0.45, "clearance_m": 0.0},
    "too slippery": {"friction": 0.1},
    "moments": {"goal_x_m": 0.35, "moment_balance": True, "tilt": 0.2},
    "support": {"com_support_m": 0.05},
    "pitch": {"tilt": 0.4, "pitch_keyframe": True},
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", [1, 2])
def test_agrees_with_enumeration(kind: str, seed: int, tmp_path: Path) -> None:
    compare(strips(seed, **KINDS[kind]), tmp_path)


def test_agrees_with_enumeration_when_turning(tmp_path: Path) -> None:
    problem = strips(2, goal_x_m=0.3)
    compare(replace(problem, goal_rpy_rad=np.array([0.0, 0.0, 0.4])), tmp_path)


def test_agrees_with_enumeration_with_free_regions(tmp_path: Path) -> None:
    problem = strips(2, collision=True, collision_windows=3, bands=2, goal_x_m=0.25)
    edge = float(problem.polygons[1].vertices_m[:, 0].min()) - 0.01
    before = (np.array([[1.0, 0.0, 0.0]]), np.array([edge]))
    beyond = (np.array([[-1.0, 0.0, 0.0]]), np.array([-edge]))
    above = (np.array([[0.0, 0.0, -1.0]]), np.array([-0.03]))
    problem = replace(problem, free_regions=(before, above, beyond))
    solution = solve(problem, why=False)
    write_plan(tmp_path / "plan.json", problem, solution)
    assert verify_path(tmp_path / "plan.json").accepted
    free = solve(replace(problem, options=replace(problem.options, collision=False)), why=False)
    assert free.objective is not None
    assert solution.objective is None or solution.objective >= free.objective * (1 - GAP)


def test_agrees_with_enumeration_half_a_millimetre_beside_the_border(tmp_path: Path) -> None:
    near, far = borderline("stones-8", 0, lambda p: solve(p, certify=False, why=False).verdict == "feasible", steps=11)
    assert far.goal_m[0] - near.goal_m[0] < 1e-3
    for problem, verdict in ((near, "feasible"), (far, "infeasible")):
        solution = solve(problem)
        write_plan(tmp_path / "plan.json", problem, solution)
        assert solution.verdict == verdict
        assert verify_path(tmp_path / "plan.json").accepted


@pytest.mark.campaign
@pytest.mark.parametrize("seed", range(3, 25))
@pytest.mark.parametrize("kind", KINDS)
def test_agrees_with_enumeration_often(kind: str, seed: int, tmp_path: Path) -> None:
    compare(strips(seed, **KINDS[kind]), tmp_path)


def compare(problem: Problem, folder: Path) -> None:
    solution = solve(problem, why=False)
    choice, value = best_of_all(problem)
    if choice is None:
        assert solution.verdict == "infeasible"
    else:
        assert solution.verdict == "feasible"
        assert solution.objective is not None
        assert solution.bound is not None
        assert solution.max_residual is not None
        assert solution.objective <= value * (1 + GAP) + 1e-6
        assert solution.objective >= value * (1 - 1e-8)
        assert solution.bound <= value * (1 + 1e-9)
        assert solution.gap is not None
        assert solution.gap <= GAP
        assert solution.max_residual < 1e-6
    write_plan(folder / "plan.json", problem, solution)
    report = verify_path(folder / "plan.json")
    assert report.accepted, report.findings
