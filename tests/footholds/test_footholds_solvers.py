"""One class of tests for every solver of the standard form."""

from __future__ import annotations

import os
from dataclasses import replace

import numpy as np
import pytest

from surefoot.errors import BackendMissing, InputError
from surefoot.footholds import solve
from surefoot.footholds.form import FormSolver, StandardForm, standard_form
from surefoot.footholds.generators import strips
from surefoot.footholds.model import whole_cost, whole_rows
from surefoot.footholds.solvers import solver_of

EASY = strips(2, bands=2, goal_x_m=0.25)


@pytest.fixture(params=["piqp", "highs", "scip", "gurobi", "mosek"])
def solver(request: pytest.FixtureRequest) -> FormSolver:
    licences = {"gurobi": "GRB_LICENSE_FILE", "mosek": "MOSEKLM_LICENSE_FILE"}
    if request.param in licences and licences[request.param] not in os.environ:
        pytest.skip(f"{request.param} needs a licence, which {licences[request.param]} would name")
    try:
        return solver_of(request.param)
    except BackendMissing as missing:
        pytest.skip(str(missing))


class TestSolvers:
    def test_finds_points_that_obey_the_rows(self, solver: FormSolver) -> None:
        form = standard_form(EASY)
        answer = solver.solve(form, 30.0)
        assert answer.feasible is True
        assert answer.unknowns is not None
        assert form.rows.excess(answer.unknowns).max() < 1e-5
        assert np.abs(answer.unknowns[form.binaries] - np.round(answer.unknowns[form.binaries])).max() < 1e-5
        best = solve(EASY)
        assert best.bound is not None
        assert answer.value >= best.bound * (1 - 1e-6)
        if solver.optimises:
            assert answer.value == pytest.approx(best.objective, rel=1e-4)

    def test_refutes_what_cannot_be(self, solver: FormSolver) -> None:
        far = replace(EASY, goal_m=np.array([0.9, 0.0, 0.29]))
        assert solver.solve(standard_form(far), 30.0).feasible is False

    def test_agrees_on_a_program_without_binaries(self, solver: FormSolver) -> None:
        if solver.name == "scip":
            pytest.skip("SCIP only decides feasibility here")
        small = replace(EASY, step_s=0.05)
        best = solve(small)
        assert best.plan is not None
        none = np.zeros(0, dtype=np.int64)
        form = StandardForm(whole_cost(small), whole_rows(small, best.plan.choice), none)
        answer = solver.solve(form, 60.0)
        assert answer.feasible is True
        assert answer.value == pytest.approx(best.objective, rel=1e-4)


def test_unknown_solvers_are_refused() -> None:
    with pytest.raises(InputError, match="piqp, highs"):
        solver_of("none")
