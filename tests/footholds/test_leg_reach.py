"""The option joint_reach: feet keep to where legs reach by their joints; certified, checked, explained, refused."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from surefoot.errors import InputError
from surefoot.footholds import FreeGait, Problem, Solution, read_problem, retarget, solve, write_plan
from surefoot.footholds.generators import problem_of
from surefoot.footholds.leg_reach import leg_cuts
from surefoot.robots.legs import legs
from surefoot.robots.quadruped import quadruped
from surefoot.verify import verify_path


def within_legs(problem: Problem) -> Problem:
    return replace(problem, options=replace(problem.options, joint_reach=True))


def away_m(problem: Problem, solution: Solution) -> float:
    """Return how far any foot of a plan is from where its leg reaches."""
    assert solution.plan is not None
    apart = solution.plan.feet_m - solution.plan.base_m[:, None]
    local = np.einsum("nba,njb->nja", problem.rotations, apart)
    return float(legs(problem.robot).joints_rad(local)[1].max())


@pytest.mark.parametrize("name", ["go2", "chotu"])
def test_the_half_spaces_are_inside_and_fill_most_of_what_legs_reach(name: str) -> None:
    robot = quadruped(name)
    normals, bounds = leg_cuts(robot)
    rng = np.random.default_rng(1)
    feet = np.array(robot.feet_m) + rng.uniform(-1, 1, (50_000, 4, 3)) * np.array(robot.foot_reach_m)
    allowed = (np.einsum("jka,nja->njk", normals, feet) <= bounds).all(axis=2)
    reached = legs(robot).joints_rad(feet)[1] < 1e-9
    assert not (allowed & ~reached).any()
    assert 0.7 < reached.mean() < 0.85
    assert allowed.mean() > 0.94 * reached.mean()


@pytest.mark.parametrize("family", ["step-up", "step-down"])
def test_feet_keep_to_where_legs_reach(family: str, tmp_path: Path) -> None:
    plain = problem_of(family, 0)
    problem = within_legs(plain)
    before, after = solve(plain), solve(problem)
    assert away_m(plain, before) > 0.03
    assert away_m(problem, after) < 1e-6
    assert before.objective is not None
    assert after.objective is not None
    assert 1.0 < after.objective / before.objective < 1.1
    write_plan(tmp_path / "plan.json", problem, after)
    assert verify_path(tmp_path / "plan.json").accepted


def test_where_legs_do_not_press_nothing_changes() -> None:
    plain = problem_of("stones-8", 0)
    before, after = solve(plain), solve(within_legs(plain))
    assert after.objective == pytest.approx(before.objective, rel=1e-4)


def test_a_plan_that_stretches_a_leg_is_refused(tmp_path: Path) -> None:
    problem = problem_of("step-up", 0)
    path = tmp_path / "plan.json"
    write_plan(path, problem, solve(problem))
    assert verify_path(path).accepted
    document = json.loads(path.read_text())
    document["values"]["options"]["joint_reach"] = True
    path.write_text(json.dumps(document))
    assert "footholds, leg" in {finding.rule for finding in verify_path(path).findings}


@pytest.fixture(scope="module")
def high() -> tuple[Problem, Solution]:
    """Return the stones with a goal so high that no leg gets down to them, and its answer."""
    plain = problem_of("stones-8", 0)
    problem = within_legs(replace(plain, goal_m=plain.goal_m + np.array([0.0, 0.0, 0.11])))
    assert solve(replace(problem, options=plain.options)).verdict == "feasible"
    return problem, solve(problem)


def test_what_legs_forbid_is_proved_and_explained(high: tuple[Problem, Solution], tmp_path: Path) -> None:
    problem, solution = high
    assert solution.verdict == "infeasible"
    assert solution.explanation is not None
    assert {lack.family for lack in solution.explanation.lacks} == {"leg"}
    assert "leg short by" in solution.explanation.text
    assert "Farkas rays" in solution.certificate
    assert retarget(problem).verdict == "feasible"  # a lower pose
    write_plan(tmp_path / "plan.json", problem, solution)
    report = verify_path(tmp_path / "plan.json")
    assert report.accepted, report.findings


def test_a_proof_by_legs_is_none_without_the_option(high: tuple[Problem, Solution], tmp_path: Path) -> None:
    path = tmp_path / "plan.json"
    write_plan(path, *high)
    document = json.loads(path.read_text())
    document["values"]["options"]["joint_reach"] = False
    path.write_text(json.dumps(document))
    assert not verify_path(path).accepted


def test_free_gaits_and_other_robots_are_refused(tmp_path: Path, scenes: Path) -> None:
    problem = within_legs(problem_of("stones-8", 0))
    with pytest.raises(InputError, match="gaits that are given"):
        solve(replace(problem, gait=FreeGait(1.5)))
    with pytest.raises(InputError, match="longer than the reach box"):
        leg_cuts(replace(problem.robot, link_m=0.05))
    with pytest.raises(InputError, match="legs reach all of the box"):
        leg_cuts(replace(problem.robot, foot_reference_m=(0.1805, 0.1308, -0.2)))
    text = (scenes / "footholds" / "stones.yaml").read_text()
    assert "gait: " in text
    free = "".join(line for line in text.splitlines(keepends=True) if not line.startswith(("gait:", "options:")))
    (tmp_path / "free.yaml").write_text(f"{free}\ngait: free\nhorizon_s: 2\noptions: {{joint_reach: true}}\n")
    with pytest.raises(InputError, match="gaits that are given"):
        read_problem(tmp_path / "free.yaml")
