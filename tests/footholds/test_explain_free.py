"""Why no gait is feasible: amounts against geometry, refutations and torque limits of their own."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from free_scenes import checked

from surefoot.footholds import FreeGait, Problem, solve, write_plan
from surefoot.footholds.explain_free import explain_free
from surefoot.footholds.free_families import free_problem_of
from surefoot.footholds.refute import refuted
from surefoot.footholds.skeleton import skeleton
from surefoot.footholds.terrain import polygon
from surefoot.robots.quadruped import FOOT_NAMES


def test_a_goal_above_a_hole_names_the_feet_and_the_distance() -> None:
    problem = free_problem_of("hopeless", 2)
    explanation = explain_free(problem)
    assert explanation is not None
    assert sorted(lack.foot for lack in explanation.lacks) == sorted(FOOT_NAMES)
    edges = [corner for one in problem.polygons for corner in one.vertices_m[:, 0]]
    for lack, foot in ((one, FOOT_NAMES.index(one.foot)) for one in explanation.lacks):
        at = problem.goal_m[0] + problem.robot.feet_m[foot][0]
        nearest = min(abs(edge - at) for edge in edges)
        assert lack.amount == pytest.approx(nearest - problem.robot.foot_reach_m[0])


@pytest.mark.parametrize("seed", [0, 3, 5])
def test_less_than_the_least_horizon_is_refuted(seed: int) -> None:
    problem = free_problem_of("hopeless", seed)
    explanation = explain_free(problem)
    assert explanation is not None
    longer = next(lack for lack in explanation.lacks if lack.family == "horizon")
    assert longer.amount > problem.options.cell_s / 2
    short = replace(problem, gait=FreeGait(problem.gait.horizon_s + longer.amount - problem.options.cell_s))
    assert refuted(short, skeleton(short), lambda: False, 400) is not None


def test_a_turn_that_is_too_fast_says_how_much_torque_it_takes() -> None:
    problem = free_problem_of("gap-leap", 0)
    turned = replace(problem, gait=FreeGait(0.4), goal_rpy_rad=np.array([0.0, 0.0, 3.0]))
    explanation = explain_free(turned)
    assert explanation is not None
    lack = explanation.lacks[0]
    assert lack.family == "base torque"
    robot = replace(problem.robot, base_torque_max_nm=problem.robot.base_torque_max_nm + lack.amount * 1.001)
    assert explain_free(replace(turned, robot=robot)) is None or (
        explain_free(replace(turned, robot=robot)).lacks[0].family != "base torque"  # type: ignore[union-attr]
    )


def test_an_infeasible_answer_is_explained() -> None:
    solution = solve(free_problem_of("hopeless", 3))
    assert solution.verdict == "infeasible"
    assert solution.explanation is not None
    assert "too little" in solution.explanation.text


def goal_beyond_a_wall(ahead_m: float) -> Problem:
    """Return a problem whose goal is so far from the end of the ground that the front feet find none there."""
    problem = free_problem_of("gap-leap", 0)
    ground = polygon([[-0.6, -0.4, 0], [0.5, -0.4, 0], [0.5, 0.4, 0], [-0.6, 0.4, 0]])
    options = replace(problem.options, time_limit_s=20.0)
    goal = np.array([ahead_m, 0.0, problem.goal_m[2]])
    return replace(problem, polygons=(ground,), goal_m=goal, gait=FreeGait(1.5), options=options)


def test_a_foot_without_ground_at_the_goal_is_proof_enough(tmp_path: Path) -> None:
    """Also for the checker, which looks at the ground itself; not where the ground is just within reach."""
    edge_m = 0.5 - free_problem_of("gap-leap", 0).robot.feet_m[0][0] + 0.15
    beyond = goal_beyond_a_wall(edge_m + 0.01)
    solution = solve(beyond)
    assert solution.verdict == "infeasible"
    write_plan(tmp_path / "plan.json", beyond, solution)
    ledger = checked(tmp_path / "plan.json")
    assert not ledger.kept
    assert ledger.counts["refuted_by"] == "a foot without ground at the goal"
    document = json.loads((tmp_path / "plan.json").read_text())
    document["free"]["refutation"] = None
    document["values"]["goal"]["position_m"][0] = edge_m - 0.01
    (tmp_path / "doctored.json").write_text(json.dumps(document))
    assert checked(tmp_path / "doctored.json").kept
