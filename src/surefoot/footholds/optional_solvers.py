"""Solvers of standard forms that are optional: SCIP, and with a licence of one's own Gurobi and MOSEK."""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np
import scipy.sparse as sp

from surefoot.errors import BackendMissing
from surefoot.footholds.form import FormAnswer, StandardForm
from surefoot.footholds.rows import Array

_GAP = 1e-6


def _module(name: str, install: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError as problem:
        raise BackendMissing(name, install) from problem


def _ranges(form: StandardForm) -> tuple[Array, Array]:
    """Return lower and upper bounds of the unknowns."""
    low, high = np.full(len(form.cost.linear), -np.inf), np.full(len(form.cost.linear), np.inf)
    low[form.binaries], high[form.binaries] = 0.0, 1.0
    return low, high


class ScipSolver:
    """SCIP: decides feasibility of programs with binaries; of quadratic costs it finds no optimum in useful time.

    Raises:
        BackendMissing: pyscipopt is not installed.
    """

    name = "scip"
    optimises = False

    def __init__(self) -> None:
        self.scip = _module("pyscipopt", "pip install 'surefoot[scip]'")

    def solve(self, form: StandardForm, time_limit_s: float) -> FormAnswer:
        """Decide the feasibility of a form."""
        model = self.scip.Model()
        model.hideOutput()
        model.setParam("limits/time", float(time_limit_s))
        model.setParam("numerics/feastol", 1e-9)
        model.setParam("parallel/maxnthreads", 1)
        low, high = _ranges(form)
        kinds = np.full(len(low), "C")
        kinds[form.binaries] = "B"
        unknowns = [
            model.addVar(vtype=str(kind), lb=a if np.isfinite(a) else None, ub=b if np.isfinite(b) else None)
            for kind, a, b in zip(kinds, low, high, strict=True)
        ]
        matrix = form.rows.matrix
        for row, (lower, upper) in enumerate(zip(form.rows.lower, form.rows.upper, strict=True)):
            part = slice(matrix.indptr[row], matrix.indptr[row + 1])
            terms = zip(matrix.data[part], matrix.indices[part], strict=True)
            total = self.scip.quicksum(float(factor) * unknowns[place] for factor, place in terms)
            if part.start == part.stop:
                if lower > 0 or upper < 0:
                    return FormAnswer(False, None, np.inf, np.inf)
                continue
            if lower == upper:
                model.addCons(total == float(lower))
                continue
            if np.isfinite(lower):
                model.addCons(total >= float(lower))
            if np.isfinite(upper):
                model.addCons(total <= float(upper))
        model.optimize()
        if model.getStatus() == "infeasible":
            return FormAnswer(False, None, np.inf, np.inf)
        if not model.getNSols():
            return FormAnswer(None, None, np.inf, -np.inf)
        best = model.getBestSol()
        found = np.array([model.getSolVal(best, one) for one in unknowns])
        return FormAnswer(True, found, form.cost.at(found), -np.inf)


class GurobiSolver:
    """Gurobi, which needs a licence of one's own: the one that comes with the package is too small for these programs.

    Raises:
        BackendMissing: gurobipy is not installed.
    """

    name = "gurobi"
    optimises = True

    def __init__(self) -> None:
        self.gurobi = _module("gurobipy", "pip install gurobipy (and a licence of your own)")

    def solve(self, form: StandardForm, time_limit_s: float) -> FormAnswer:
        """Minimise a form."""
        grb = self.gurobi.GRB
        with self.gurobi.Env(params={"OutputFlag": 0, "Threads": 1, "TimeLimit": time_limit_s}) as env:
            model = self.gurobi.Model(env=env)
            low, high = _ranges(form)
            kinds = np.full(len(low), grb.CONTINUOUS)
            kinds[form.binaries] = grb.BINARY
            unknowns = model.addMVar(len(low), lb=low, ub=high, vtype=kinds)
            model.setObjective(
                unknowns @ (0.5 * sp.csr_matrix(form.cost.hessian)) @ unknowns
                + form.cost.linear @ unknowns
                + form.cost.constant
            )
            for chosen, limit, sense in _sided(form):
                model.addMConstr(form.rows.matrix[chosen], unknowns, sense, limit)
            model.Params.MIPGap = _GAP
            model.optimize()
            if model.Status == grb.INFEASIBLE:
                return FormAnswer(False, None, np.inf, np.inf)
            if not model.SolCount:
                return FormAnswer(None, None, np.inf, -np.inf)
            bound = float(model.ObjBound) if model.IsMIP else float(model.ObjVal)
            return FormAnswer(True, np.array(unknowns.X), float(model.ObjVal), bound)


def _sided(form: StandardForm) -> tuple[tuple[Any, Array, str], ...]:
    """Return rows, limits and senses of equations, lower and upper bounds."""
    rows = form.rows
    upper, lower = np.isfinite(rows.upper) & ~rows.equal, np.isfinite(rows.lower) & ~rows.equal
    return (
        (rows.equal, rows.lower[rows.equal], "="),
        (upper, rows.upper[upper], "<"),
        (lower, rows.lower[lower], ">"),
    )


class MosekSolver:
    """MOSEK, which needs a licence.

    Raises:
        BackendMissing: mosek is not installed.
    """

    name = "mosek"
    optimises = True

    def __init__(self) -> None:
        self.mosek = _module("mosek", "pip install mosek (and a licence of your own)")

    def solve(self, form: StandardForm, time_limit_s: float) -> FormAnswer:
        """Minimise a form."""
        mosek, rows = self.mosek, form.rows
        size = len(form.cost.linear)
        with mosek.Env() as env, env.Task() as task:
            task.appendvars(size)
            task.appendcons(len(rows.lower))
            low, high = _ranges(form)
            task.putvarboundslice(0, size, self._keys(low, high), _finite(low), _finite(high))
            task.putconboundslice(
                0, len(rows.lower), self._keys(rows.lower, rows.upper), _finite(rows.lower), _finite(rows.upper)
            )
            matrix = rows.matrix.tocoo()
            task.putaijlist(matrix.row, matrix.col, matrix.data)
            quadratic = sp.tril(form.cost.hessian).tocoo()
            task.putqobj(quadratic.row, quadratic.col, quadratic.data)
            task.putclist(range(size), form.cost.linear)
            task.putcfix(form.cost.constant)
            task.putvartypelist(form.binaries, [mosek.variabletype.type_int] * len(form.binaries))
            task.putdouparam(mosek.dparam.optimizer_max_time, float(time_limit_s))
            task.putdouparam(mosek.dparam.mio_tol_rel_gap, _GAP)
            task.putintparam(mosek.iparam.num_threads, 1)
            task.optimize()
            kind = mosek.soltype.itg if len(form.binaries) else mosek.soltype.itr
            status = task.getsolsta(kind)
            if status in (mosek.solsta.prim_infeas_cer,) or task.getprosta(kind) == mosek.prosta.prim_infeas:
                return FormAnswer(False, None, np.inf, np.inf)
            if status not in (mosek.solsta.optimal, mosek.solsta.integer_optimal, mosek.solsta.prim_feas):
                return FormAnswer(None, None, np.inf, -np.inf)
            found = np.array(task.getxx(kind))
            value = form.cost.at(found)
            bound = task.getdouinf(mosek.dinfitem.mio_obj_bound) if len(form.binaries) else value
            return FormAnswer(True, found, value, float(bound))

    def _keys(self, low: Array, high: Array) -> list[Any]:
        key = self.mosek.boundkey
        return [
            (key.fx if a == b else key.ra if np.isfinite(b) else key.lo)
            if np.isfinite(a)
            else (key.up if np.isfinite(b) else key.fr)
            for a, b in zip(low, high, strict=True)
        ]


def _finite(values: Array) -> Array:
    return np.nan_to_num(values, posinf=0.0, neginf=0.0)
