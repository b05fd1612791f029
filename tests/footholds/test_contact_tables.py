"""Plans of contact tables with given polygons: the active-set method against the programs that PIQP solves."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from free_scenes import leap

from surefoot.footholds.assembly import Parts
from surefoot.footholds.cells import Cells, cell_count, fixed
from surefoot.footholds.free_families import free_problem_of
from surefoot.footholds.model import Choice
from surefoot.footholds.moves import proposal
from surefoot.footholds.nodes import ReducedProgram
from surefoot.footholds.problem import Problem
from surefoot.footholds.solve import slack
from surefoot.footholds.tables import Tables, Trial, polygons_after
from surefoot.footholds.templates import first_templates


def turning(problem: Problem) -> Problem:
    return replace(problem, goal_rpy_rad=np.array([0.0, 0.1, 0.3]))


def tilted(problem: Problem) -> Problem:
    """Put the reference askew to the start, so that no axis of reach is one of the world."""
    return replace(problem, goal_rpy_rad=np.array([0.05, -0.1, 0.4]), start_rpy_rad=np.array([0.02, 0.0, -0.1]))


PROBLEMS = {
    "leap": leap(),
    "stones": free_problem_of("mixed-stones", 3),
    "step": free_problem_of("height-step", 1),
    "turning": turning(free_problem_of("gap-leap", 0)),
    "tilted": tilted(free_problem_of("height-step", 0)),
    "low": replace(leap(), options=replace(leap().options, clearance_m=0.0)),
}


def exact(problem: Problem, cells: Cells, choice: Choice, parts: Parts) -> float:
    """Return the least cost with the forces as unknowns where sharing them equally breaks a limit."""
    at = fixed(problem, cells)
    program = ReducedProgram(at, forces=False, parts=parts)
    node = program.solve(choice)
    if node.answer.feasible and not slack(at, program, choice, node):
        node = ReducedProgram(at, forces=True, parts=parts).solve(choice)
    return node.answer.value if node.answer.feasible else np.inf


def walk(problem: Problem, tables: Tables, steps: int) -> Iterator[tuple[Cells, Choice, Trial | None, Trial]]:
    """Yield tables with polygons near the last one that has a plan, what became of them, and that one."""
    begun = (
        tables.tried(cells, tables.nearest(cells), 1e7)
        for name, cells in first_templates(cell_count(problem), 1)
        if name != "stand"
    )
    here = next(one for one in begun if one is not None)
    chance = np.random.default_rng(4)
    for _ in range(steps):
        cells = proposal(here.cells, 1, chance)
        if cells is not None:
            choice = polygons_after(problem, here, cells)
            found = tables.tried(cells, choice, 1.3 * here.value, here)
            yield cells, choice, found, here
            here = found or here


@pytest.mark.parametrize("name", list(PROBLEMS))
def test_costs_are_those_of_the_convex_program(name: str) -> None:
    """Equal shares cost the least where they keep the limits; where not, they cost little more than other shares."""
    problem = PROBLEMS[name]
    parts, tables, solved = Parts(problem), Tables(problem), 0
    for cells, choice, found, here in walk(problem, tables, 25):
        value = exact(problem, cells, choice, parts)
        if found is None:
            assert value > 1.25 * here.value
        else:
            assert value * (1 - 1e-6) <= found.value <= value * (1 + 2e-3)
            solved += 1
    assert solved > 3


def test_it_does_not_matter_where_a_program_starts() -> None:
    problem = PROBLEMS["stones"]
    tables = Tables(problem)
    for cells, choice, found, here in walk(problem, tables, 40):
        cold = tables.tried(cells, choice, 1.3 * here.value)
        assert (cold is None) == (found is None)
        if cold is not None and found is not None:
            assert found.value == pytest.approx(cold.value, rel=1e-7)
            assert np.allclose(found.feet, cold.feet, atol=1e-5)


def test_what_costs_as_much_as_it_is_worth_is_no_plan() -> None:
    problem = PROBLEMS["leap"]
    tables = Tables(problem)
    _, _, _, here = next(walk(problem, tables, 1))
    assert tables.tried(here.cells, here.choice, here.value * (1 - 1e-6), here) is None
    assert tables.tried(here.cells, here.choice, here.value * (1 + 1e-6), here) is not None


def test_feet_stand_on_their_polygons_and_swing_above_the_ground() -> None:
    problem = PROBLEMS["stones"]
    tables = Tables(problem)
    for _, choice, found, _ in walk(problem, tables, 40):
        if found is None:
            continue
        at = fixed(problem, found.cells)
        for number, step in enumerate(at.footsteps):
            foot = found.feet[:, step.foot]
            assert problem.polygons[choice[number][0]].excess(foot[step.touch]) < 1e-6
            ground = max(foot[step.lift - 1, 2], foot[step.touch, 2])
            assert (foot[list(step.cleared), 2] >= ground + problem.options.clearance_m - 1e-6).all()
            assert (foot[step.touch - 1 : step.leave] == foot[step.touch]).all()


def test_a_table_that_nobody_can_do_has_no_plan() -> None:
    """Standing still reaches no goal that is farther away than the legs are long."""
    problem = PROBLEMS["leap"]
    stand = np.ones((cell_count(problem), 4), dtype=bool)
    assert Tables(problem).tried(stand, (), np.inf) is None
