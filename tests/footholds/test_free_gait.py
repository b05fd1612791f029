"""Free gaits: cells, templates, plans, bounds, refutations, and what the checker says to all that."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from free_scenes import checked, leap, tiny
from hypothesis import given
from hypothesis import strategies as st

from surefoot.errors import BackendMissing, InputError, SurefootError
from surefoot.footholds import FreeGait, read_problem, solve, solve_with_gaits, write_plan
from surefoot.footholds.cells import cell_count, fixed, gait_of, obeys
from surefoot.footholds.decide import decided_exactly
from surefoot.footholds.free_families import FREE_FAMILIES, free_problem_of
from surefoot.footholds.free_form import free_form, reach_boxes
from surefoot.footholds.gaits import contact_table, gait_text, read_gait
from surefoot.footholds.moves import proposal
from surefoot.footholds.skeleton import skeleton
from surefoot.footholds.solvers import HighsSolver, run_highs, solver_of
from surefoot.footholds.templates import first_templates, templates
from surefoot.footholds.terrain import polygon
from surefoot.verify.footholds.file import read_foothold_plan
from surefoot.verify.footholds.free import Relaxation

GOOD = """\
format: 1
robot: go2
gait: free
horizon_s: 1.0
start: {position_m: [0, 0, 0.29]}
goal:  {position_m: [0.6, 0, 0.29]}
polygons:
  - {vertices_m: [[-1, -1, 0], [2, -1, 0], [2, 1, 0], [-1, 1, 0]], friction: 0.6}
"""

TABLES = st.lists(st.tuples(*[st.booleans()] * 4), min_size=1, max_size=8).map(
    lambda rows: np.array([[True] * 4, *rows, [True] * 4])
)


@given(TABLES)
def test_a_gait_gives_back_its_cells(cells: np.ndarray) -> None:
    table = contact_table(gait_of(cells, 0.1), 0.025)
    assert np.array_equal(table, np.repeat(cells, 4, axis=0))


@given(TABLES)
def test_a_gait_survives_its_text(tmp_path_factory: pytest.TempPathFactory, cells: np.ndarray) -> None:
    path = tmp_path_factory.mktemp("gait") / "gait.info"
    gait = gait_of(cells, 0.1)
    path.write_text(gait_text(gait))
    assert read_gait(path) == gait


@pytest.mark.parametrize("dwell", [1, 2, 3])
def test_templates_and_changes_are_different_and_obey(dwell: int) -> None:
    found = [cells for _, cells in templates(12, dwell)]
    assert len({cells.tobytes() for cells in found}) == len(found) > 50
    assert all(obeys(cells, dwell) for cells in found)
    assert all(obeys(cells, dwell) for _, cells in first_templates(12, dwell))
    chance, near = np.random.default_rng(0), found[-1]
    for _ in range(200):
        changed = proposal(near, dwell, chance)
        assert changed is None or (obeys(changed, dwell) and not np.array_equal(changed, near))
        near = near if changed is None else changed
    assert not np.array_equal(near, found[-1])


def test_reads_a_free_gait(tmp_path: Path) -> None:
    path = tmp_path / "problem.yaml"
    path.write_text(GOOD)
    problem = read_problem(path)
    assert problem.gait == FreeGait(1.0)
    assert problem.samples == 40
    assert cell_count(problem) == 10
    with pytest.raises(SurefootError, match="gait is free"):
        _ = problem.contacts


@pytest.mark.parametrize(
    ("line", "instead", "says"),
    [
        ("horizon_s: 1.0\n", "", "needs `horizon_s"),
        ("horizon_s: 1.0", "horizon_s: 1.03", "multiples of options.cell_s"),
        ("horizon_s: 1.0", "horizon_s: 0.2", "multiples of options.cell_s"),
        ("gait: free", "gait: trot-1s", "has its own horizon"),
        ("horizon_s: 1.0", "horizon_s: 1.0\noptions: {cell_s: 0.03}", "multiples of step_s"),
    ],
)
def test_refuses_cells_that_do_not_fit(tmp_path: Path, line: str, instead: str, says: str) -> None:
    path = tmp_path / "problem.yaml"
    path.write_text(GOOD.replace(line, instead))
    with pytest.raises(InputError, match=says):
        read_problem(path)


def test_finds_a_gait_for_a_leap_that_verifies(tmp_path: Path) -> None:
    problem = leap()
    solution = solve(problem)
    assert solution.verdict == "feasible"
    assert solution.free is not None
    assert solution.free.gait is not None
    assert solution.free.first_feasible_s is not None
    assert solution.max_residual is not None
    assert solution.max_residual < 1e-6
    assert solution.bound is not None
    assert solution.objective is not None
    assert 0 < solution.bound < solution.objective
    path = tmp_path / "plan.json"
    write_plan(path, problem, solution)
    assert not checked(path).kept
    again = solve(replace(problem, gait=solution.free.gait))
    assert again.objective == pytest.approx(solution.objective, rel=1e-3)


def test_the_checker_refuses_gaits_that_do_not_fit_their_cells(tmp_path: Path) -> None:
    problem = leap()
    path = tmp_path / "plan.json"
    write_plan(path, problem, solve(problem))
    document = json.loads(path.read_text())
    for change, says in (({"cell_s": 0.5}, "within a cell"), ({"min_dwell_cells": 9}, "shorter than")):
        broken = json.loads(path.read_text())
        broken["values"]["options"] |= change
        (tmp_path / "broken.json").write_text(json.dumps(broken))
        assert any(says in finding.message for finding in checked(tmp_path / "broken.json").kept)
    document["free"]["horizon_s"] = 2.0
    (tmp_path / "broken.json").write_text(json.dumps(document))
    assert checked(tmp_path / "broken.json").kept


@pytest.fixture(scope="module")
def proved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a plan whose bound comes from prices that were improved, with a turn in it."""
    problem = leap()
    turned = replace(problem, goal_rpy_rad=np.array([0.0, 0.0, 0.1]))
    path = tmp_path_factory.mktemp("proved") / "plan.json"
    write_plan(path, turned, solve(replace(turned, options=replace(turned.options, first_plan=False, gap=0.3))))
    return path


def test_the_checker_derives_the_bound_over_all_gaits(proved: Path) -> None:
    ledger = checked(proved)
    assert not ledger.kept
    claimed = json.loads(proved.read_text())["answer"]["bound"]
    assert claimed * (1 - 1e-6) <= ledger.counts["bound"] < 1.02 * claimed


def _with_bound(document: dict[str, Any], factor: float) -> None:
    answer = document["answer"]
    answer["bound"] *= factor
    answer["gap"] = (answer["objective"] - answer["bound"]) / answer["objective"]


@pytest.mark.parametrize(
    ("doctor", "says"),
    [
        (lambda file: _with_bound(file, 1.03), "the multipliers give"),
        (lambda file: file["free"]["bound"]["first"].update(pull=[[0.0, 0.0, 0.0]] * 40), "the multipliers give"),
        (lambda file: file["free"]["bound"]["first"]["reach"].append([20, 0, 2, 0, 9e4]), "the multipliers give"),
        (lambda file: file["free"]["bound"]["first"].update(contact=[0.0] * 10), "the multipliers give"),
        (lambda file: file["free"].update(bound=None), "has no multipliers"),
        (lambda file: file["answer"].update(gap=0.01), "is 0."),
    ],
)
def test_the_checker_refuses_doctored_bounds(
    proved: Path, tmp_path: Path, doctor: Callable[[dict[str, Any]], None], says: str
) -> None:
    document = json.loads(proved.read_text())
    doctor(document)
    (tmp_path / "broken.json").write_text(json.dumps(document))
    assert any(says in finding.message for finding in checked(tmp_path / "broken.json").kept)


@pytest.mark.parametrize("price", [-2.3e18, -7e18, -1.1e19, -4.3e19])
def test_no_bound_rests_on_rounding(proved: Path, tmp_path: Path, price: float) -> None:
    """All feet stand in the first and the last cell, so that what they are paid there should cancel."""
    document = json.loads(proved.read_text())
    bound = document["free"]["bound"]
    bound.update(tree=None, worth=None)
    bound["first"]["contact"][0] = bound["first"]["contact"][-1] = price
    (tmp_path / "large.json").write_text(json.dumps(document))
    ledger = checked(tmp_path / "large.json")
    assert ledger.kept
    assert float(str(ledger.counts["bound"])) < 0


def test_no_bound_is_claimed_that_the_checker_could_not_derive(tmp_path: Path) -> None:
    short = replace(leap(), options=replace(leap().options, cell_s=0.05, min_dwell_cells=1))
    solution = solve(short)
    assert solution.bound is None
    assert solution.gap is None
    assert any("no bound over all gaits is claimed" in note for note in solution.notes)
    write_plan(tmp_path / "plan.json", short, solution)
    assert not checked(tmp_path / "plan.json").kept


def test_a_search_that_ends_early_says_so(tmp_path: Path) -> None:
    """The first prices prove too little here, though swings of a cell are long enough to check more."""
    (tmp_path / "flat.yaml").write_text(GOOD.replace("s: 1.0", "s: 0.8").replace("0.6, 0, 0.29", "0.047, 0, 0.29"))
    problem = read_problem(tmp_path / "flat.yaml")
    solution = solve(replace(problem, options=replace(problem.options, first_plan=True)))
    assert solution.bound is None
    assert "ended before" in solution.notes[-1]


def test_is_deterministic() -> None:
    first, second = solve(leap()), solve(leap())
    assert first.objective == second.objective
    assert first.bound == second.bound


def test_the_first_plan_ends_the_search() -> None:
    solution = solve(leap())
    assert solution.free is not None
    assert solution.free.first_objective == pytest.approx(solution.objective, rel=1e-3)


def test_cancelling_at_once_answers_unknown() -> None:
    solution = solve(leap(), cancelled=lambda: True)
    assert solution.verdict == "unknown"
    assert solution.limit == "cancelled"


@pytest.mark.parametrize("seed", range(4))
def test_refutes_the_hopeless_and_the_checker_agrees(tmp_path: Path, seed: int) -> None:
    problem = free_problem_of("hopeless", (0, 2, 3, 5)[seed])
    solution = solve(problem)
    assert solution.verdict == "infeasible"
    assert " and " in solution.certificate
    path = tmp_path / "plan.json"
    write_plan(path, problem, solution)
    assert not checked(path).kept
    document = json.loads(path.read_text())
    near = document["values"]["goal"]["position_m"]
    document["values"]["goal"]["position_m"] = [0.05, near[1], 0.29]
    square = [[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]]
    document["values"]["polygons"][0] = {"vertices_m": square, "friction": 0.6}
    (tmp_path / "false.json").write_text(json.dumps(document))
    assert checked(tmp_path / "false.json").kept


NOTHING: dict[str, list[Any]] = {
    "pinned": [], "newton": [], "limit": [], "cover": [], "near": [], "cone": [],
}  # fmt: skip


@pytest.fixture(scope="module")
def relaxed(tmp_path_factory: pytest.TempPathFactory) -> Relaxation:
    """What a checker knows of a problem that has a plan."""
    path = tmp_path_factory.mktemp("relaxed") / "plan.json"
    write_plan(path, leap(), solve(leap()))
    return Relaxation(read_foothold_plan(path))


@pytest.mark.parametrize(
    "leaf",
    [
        {"newton": [[1, 2, 1.0], [1, -1, -1.0]]},
        {"newton": [[True, 0, 1.0]]},
        {"newton": [[1.5, 0, 1.0]]},
        {"near": [[5, 2, 0, 2, 1.0]]},
        {"pinned": [[5, 0.5]]},
        {"pinned": [[10_000, 1]]},
    ],
)
def test_the_checker_refuses_rows_that_are_not_there(relaxed: Relaxation, leaf: dict[str, Any]) -> None:
    with pytest.raises((ValueError, IndexError)):
        relaxed.least({**NOTHING, **leaf})


@pytest.mark.parametrize("large", [1e16, 1e17, 3e18, 1e30])
def test_no_refutation_rests_on_rounding(relaxed: Relaxation, large: float) -> None:
    cover = [[0, large], [9, 3.3], [9, 7.7]]
    near = [[5, 0, 0, 0, large], [5, 0, 0, 1, -large]]
    assert relaxed.least({**NOTHING, "cover": cover}) <= 0
    assert relaxed.least({**NOTHING, "cover": cover, "near": near}) <= 0


@pytest.mark.parametrize("seed", [0, 1])
def test_a_plan_obeys_the_exact_program_and_its_relaxation(seed: int) -> None:
    """What has a plan must be feasible for whatever may refute it: no constant may cut it off."""
    problem = replace(tiny(0.3 + 0.1 * seed), options=replace(tiny(0.3).options, first_plan=True))
    solution = solve(problem)
    assert solution.plan is not None
    plan = solution.plan
    low, high = reach_boxes(problem)[0]
    assert (plan.base_m >= low - 1e-6).all()
    assert (plan.base_m <= high + 1e-6).all()
    assert HighsSolver().solve(free_form(problem).form, 60.0).feasible is True
    form = skeleton(problem)
    assert run_highs(form, np.zeros(len(form.cost.linear)), 60.0)[0] is True


def test_the_exact_program_finds_a_contact_table() -> None:
    problem = tiny(0.3)
    decided = decided_exactly(problem, 60.0)
    assert decided.cells is not None
    assert obeys(decided.cells, 1)
    assert solve(fixed(problem, decided.cells), why=False).verdict == "feasible"


def test_high_grounds_are_not_cut_off() -> None:
    """A bound typed in once made a leap up 40 cm infeasible for every solver."""
    problem = free_problem_of("height-step", 0)
    ground = list(problem.polygons)
    ground[1] = polygon([[x, y, 0.4] for x, y, _ in problem.polygons[1].vertices_m])
    goal = np.array([problem.goal_m[0], 0.0, 0.69])
    high = replace(problem, polygons=tuple(ground), goal_m=goal, gait=FreeGait(1.2))
    form = skeleton(high)
    assert run_highs(form, np.zeros(len(form.cost.linear)), 60.0)[0] is True


def test_tries_known_gaits_first() -> None:
    problem = leap()
    at, solution = solve_with_gaits(problem, ["trot-1s"], [1.0])
    assert solution.verdict == "feasible"
    assert (solution.free is None) == (not isinstance(at.gait, FreeGait))


@pytest.mark.parametrize("name", ["scip", "gurobi", "mosek"])
def test_absent_solvers_say_how_to_install_them(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    package = {"scip": "pyscipopt", "gurobi": "gurobipy", "mosek": "mosek"}[name]
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(BackendMissing, match="pip install"):
        solver_of(name)


@pytest.mark.campaign
@pytest.mark.parametrize("family", FREE_FAMILIES)
@pytest.mark.parametrize("seed", range(10))
def test_families_are_decided(family: str, seed: int) -> None:
    problem = free_problem_of(family, seed)
    solution = solve(replace(problem, options=replace(problem.options, first_plan=True, time_limit_s=120.0)))
    assert solution.verdict == ("infeasible" if family == "hopeless" else "feasible")
