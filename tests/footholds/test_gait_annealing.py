"""Annealing of gaits, and programs that are put together from parts of other contact tables."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from free_scenes import leap, tiny

from surefoot.footholds import solve, write_plan
from surefoot.footholds.anneal import Annealing
from surefoot.footholds.assembly import Parts
from surefoot.footholds.cells import cell_count, fixed
from surefoot.footholds.free_families import free_problem_of
from surefoot.footholds.model import all_open, cost_of, whole_rows
from surefoot.footholds.moves import proposal
from surefoot.footholds.nodes import ReducedProgram
from surefoot.footholds.solve import cheapest
from surefoot.footholds.tables import polygons_after
from surefoot.footholds.templates import first_templates
from surefoot.verify.findings import Ledger
from surefoot.verify.footholds.check import check_footholds


@pytest.mark.parametrize("forces", [False, True])
def test_parts_of_other_tables_make_the_same_program(forces: bool) -> None:
    problem = replace(free_problem_of("mixed-stones", 3), goal_rpy_rad=np.array([0.0, 0.0, 0.3]))
    shared, chance = Parts(problem), np.random.default_rng(1)
    cells = next(first_templates(cell_count(problem), 1))[1]
    for _ in range(12):
        changed = proposal(cells, 1, chance)
        cells = cells if changed is None else changed
        at = fixed(problem, cells)
        one = ReducedProgram(at, forces=forces, parts=shared)
        other = ReducedProgram(at, forces=forces)
        direct = cost_of(at, other.motion)
        point = chance.normal(size=one.motion.size)
        assert one.cost.at(point) == pytest.approx(direct.at(point), rel=1e-9)
        assert np.allclose(one.cost.curvature, direct.curvature)
        rows, same = one.rows(all_open(at)), other.rows(all_open(at))
        assert abs(rows.matrix - same.matrix).max() == 0
        assert np.array_equal(rows.where, same.where)
        assert np.array_equal(rows.upper, same.upper)


def test_rows_of_a_program_are_those_of_the_whole_model() -> None:
    """A plan of the reduced program, whose rows are moved about, keeps every row of the model."""
    problem = leap()
    parts = Parts(problem)
    for name, cells in first_templates(cell_count(problem), 1):
        at = fixed(problem, cells)
        _, choice, _ = cheapest(at, cancelled=lambda: False, worth=np.inf, parts=parts)
        if choice is not None and name != "pronk":
            solution = solve(at, guesses=(choice,), certify=False, why=False)
            assert solution.plan is not None
            assert whole_rows(at, solution.plan.choice).excess(solution.plan.unknowns).max() < 1e-6
            return
    pytest.fail("no template has a plan")


def annealed(steps: int) -> tuple[float, list[float]]:
    problem = tiny(0.3, cells=7)
    parts = Parts(problem)
    for _, cells in first_templates(7, 1):
        value, choice, _ = cheapest(fixed(problem, cells), cancelled=lambda: False, worth=np.inf, parts=parts)
        if choice is not None:
            break
    assert choice is not None
    walk = Annealing(problem, parts, first_templates(7, 1), lambda: False)
    walk.offer(cells, choice, value)
    better = [one.value for one in (walk.step() for _ in range(steps)) if one is not None]
    assert walk.best is not None
    solution = solve(fixed(problem, walk.best.cells), guesses=(walk.best.choice,), certify=False, why=False)
    assert solution.objective is not None
    assert solution.objective <= walk.best.value * (1 + 1e-6)
    return value, better


def test_annealing_lowers_the_cost_and_repeats_itself() -> None:
    start, better = annealed(120)
    assert better == sorted(better, reverse=True)
    assert better[-1] < start
    assert annealed(120)[1] == better


def test_polygons_follow_the_feet() -> None:
    problem = leap()
    solution = solve(problem)
    assert solution.free is not None
    assert solution.free.gait is not None
    assert solution.plan is not None
    at = replace(problem, gait=solution.free.gait)
    cells = at.contacts[:: round(problem.options.cell_s / problem.step_s)]
    walk = Annealing(problem, Parts(problem), iter(()), lambda: False)
    walk.offer(cells, solution.plan.choice, solution.objective or 0.0)
    assert walk.best is not None
    assert polygons_after(problem, walk.best, cells) == solution.plan.choice


OPTIONS: dict[str, dict[str, Any]] = {
    "collision": {"collision": True, "collision_windows": 10},
    "moments": {"moment_balance": True},
    "support": {"com_support_m": 0.08},
}


@pytest.mark.parametrize("name", list(OPTIONS))
def test_annealed_plans_keep_the_rows_of_the_options(tmp_path: Path, name: str) -> None:
    """A plan that annealing calls best is one of the whole model, windows and supports included."""
    problem = tiny(0.3, cells=7)
    above, behind = np.array([[0.0, 0.0, -1.0]]), np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0]])
    regions = ((above, np.array([0.01])), (behind, np.array([0.01, 0.4])))
    problem = replace(problem, free_regions=regions, options=replace(problem.options, **OPTIONS[name]))
    parts = Parts(problem)
    walk = Annealing(problem, parts, first_templates(7, 1), lambda: False)
    for _, cells in first_templates(7, 1):
        at = fixed(problem, cells)
        value, choice, _ = cheapest(at, cancelled=lambda: False, worth=np.inf, parts=parts)
        if choice is not None:
            walk.offer(cells, choice, value)
            break
    for _ in range(60):
        walk.step()
    assert walk.best is not None
    at = fixed(problem, walk.best.cells)
    solution = solve(at, guesses=(walk.best.choice,), certify=False, why=False)
    assert solution.verdict == "feasible"
    assert solution.plan is not None
    assert solution.objective is not None
    assert solution.objective <= walk.best.value * (1 + 1e-3)
    write_plan(tmp_path / "plan.json", at, solution)
    ledger = Ledger()
    check_footholds(tmp_path / "plan.json", ledger)
    assert not ledger.kept


def test_who_is_there_stands() -> None:
    problem = leap()
    solution = solve(replace(problem, goal_m=problem.start_m))
    assert solution.free is not None
    assert solution.free.gait is not None
    assert solution.free.gait.modes == ("STANCE",)
