"""The solvers of standard forms: PIQP with branch and bound over the binaries, and HiGHS."""

from __future__ import annotations

import heapq
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import scipy.sparse as sp

from surefoot.errors import BackendMissing, InputError
from surefoot.footholds.form import FormAnswer, FormSolver, StandardForm
from surefoot.footholds.qp import solve_qp
from surefoot.footholds.rows import Array, Quantity, RowBuilder, stacked

_WHOLE = 1e-6


class PiqpSolver:
    """PIQP below a plain branch and bound over the binaries.

    Args:
        gap: relative gap at which it stops.
    """

    name = "piqp"
    optimises = True

    def __init__(self, gap: float = 1e-6) -> None:
        self.gap = gap

    def solve(self, form: StandardForm, time_limit_s: float) -> FormAnswer:
        """Solve a form; bounds are the values of the relaxations."""
        end = time.monotonic() + time_limit_s
        best: Array | None = None
        value, count = np.inf, 0
        heap: list[tuple[float, int, dict[int, float]]] = [(-np.inf, 0, {})]
        while heap and heap[0][0] < value * (1 - self.gap):
            if time.monotonic() > end:
                return FormAnswer(None if best is None else True, best, value, heap[0][0])
            _, _, pinned = heapq.heappop(heap)
            answer = solve_qp(form.cost, _pinned(form, pinned))
            if answer.feasible is None:
                return FormAnswer(None, best, value, -np.inf)
            if not answer.feasible or answer.value >= value * (1 - self.gap):
                continue
            broken = np.abs(answer.unknowns[form.binaries] - np.round(answer.unknowns[form.binaries]))
            if not len(broken) or broken.max() < _WHOLE:
                best, value = answer.unknowns, answer.value
                continue
            place = int(form.binaries[broken.argmax()])
            for choice in (1.0, 0.0):
                count += 1
                heapq.heappush(heap, (answer.value, count, {**pinned, place: choice}))
        if best is None:
            return FormAnswer(False, None, np.inf, np.inf)
        return FormAnswer(True, best, value, min(value, heap[0][0] if heap else value))


def _pinned(form: StandardForm, pinned: dict[int, float]) -> Any:
    if not pinned:
        return form.rows
    build = RowBuilder(len(form.cost.linear))
    places, values = np.array(list(pinned)), np.array(list(pinned.values()))
    build.add("region", values, values, [(1.0, Quantity.unknown(places))])
    return stacked([form.rows, build.rows()])


class HighsSolver:
    """HiGHS: exact for programs without binaries; decides feasibility of those with binaries (it has no MIQP).

    Args:
        minimise: whether programs without binaries are minimised too; else any feasible point is taken.
    """

    name = "highs"

    def __init__(self, *, minimise: bool = True) -> None:
        self.minimise = minimise
        self.optimises = False

    def solve(self, form: StandardForm, time_limit_s: float) -> FormAnswer:
        """Solve a form."""
        wants = self.minimise and not len(form.binaries)
        linear = form.cost.linear if wants else np.zeros(len(form.cost.linear))
        status, unknowns = run_highs(form, linear, time_limit_s, quadratic=wants)
        if status is None or unknowns is None:
            return FormAnswer(status, None, np.inf, np.inf if status is False else -np.inf)
        return FormAnswer(True, unknowns, form.cost.at(unknowns), -np.inf)


def run_highs(
    form: StandardForm, linear: Array, time_limit_s: float, *, quadratic: bool = False, gap: float = 1e-6
) -> tuple[bool | None, Array | None]:
    """Minimise a linear (or the form's quadratic) objective with HiGHS; return feasibility and a solution."""
    highspy = _highspy()
    model = highspy.HighsModel()
    lp = model.lp_
    matrix = sp.csc_matrix(form.rows.matrix)
    size = matrix.shape[1]
    lp.num_col_, lp.num_row_ = size, matrix.shape[0]
    lp.col_cost_ = linear
    low, high = np.full(size, -highspy.kHighsInf), np.full(size, highspy.kHighsInf)
    low[form.binaries], high[form.binaries] = 0.0, 1.0
    lp.col_lower_, lp.col_upper_ = low, high
    lp.row_lower_, lp.row_upper_ = form.rows.lower, form.rows.upper
    lp.a_matrix_.format_ = highspy.MatrixFormat.kColwise
    lp.a_matrix_.start_, lp.a_matrix_.index_, lp.a_matrix_.value_ = matrix.indptr, matrix.indices, matrix.data
    if len(form.binaries):
        kinds = np.array([highspy.HighsVarType.kContinuous] * size)
        kinds[form.binaries] = highspy.HighsVarType.kInteger
        lp.integrality_ = list(kinds)
    if quadratic:
        lower = sp.csc_matrix(sp.tril(form.cost.hessian))
        model.hessian_.dim_ = size
        model.hessian_.format_ = highspy.HessianFormat.kTriangular
        model.hessian_.start_, model.hessian_.index_, model.hessian_.value_ = lower.indptr, lower.indices, lower.data
    highs = highspy.Highs()
    highs.setOptionValue("output_flag", False)
    highs.setOptionValue("threads", 1)
    highs.setOptionValue("time_limit", float(time_limit_s))
    highs.setOptionValue("mip_rel_gap", gap)
    highs.setOptionValue("primal_feasibility_tolerance", 1e-9)
    highs.setOptionValue("mip_feasibility_tolerance", 1e-9)
    highs.passModel(model)
    highs.run()
    status = highs.getModelStatus()
    if status == highspy.HighsModelStatus.kInfeasible:
        return False, None
    found = highs.getInfo().primal_solution_status == highspy.SolutionStatus.kSolutionStatusFeasible
    if found:
        return True, np.array(highs.getSolution().col_value)
    return None, None


def _highspy() -> Any:
    try:
        import highspy
    except ImportError as problem:
        raise BackendMissing("highspy", "pip install highspy") from problem
    return highspy


def solver_of(name: str) -> FormSolver:
    """Return a solver by its name.

    Raises:
        InputError: there is none of that name.
        BackendMissing: it is not installed; the message says how to.
    """
    from surefoot.footholds.optional_solvers import GurobiSolver, MosekSolver, ScipSolver

    solvers: dict[str, Callable[[], FormSolver]] = {
        "piqp": PiqpSolver,
        "highs": HighsSolver,
        "scip": ScipSolver,
        "gurobi": GurobiSolver,
        "mosek": MosekSolver,
    }
    if name not in solvers:
        raise InputError(f"there is no solver {name!r}; there are: {', '.join(solvers)}")
    return solvers[name]()
