"""Checks a foothold plan: every row of the whole model, the objective, and the bound, from the numbers alone."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from surefoot.errors import InputError
from surefoot.verify.findings import Ledger
from surefoot.verify.footholds.bound import gait_bound
from surefoot.verify.footholds.fall import falls
from surefoot.verify.footholds.file import BROKEN, FootholdFile, read_foothold_plan
from surefoot.verify.footholds.free import cells_problem, goal_without_ground, refutation_problem
from surefoot.verify.footholds.problem import differing_keys
from surefoot.verify.footholds.proof import proved_bound
from surefoot.verify.footholds.reach import left_to_steps
from surefoot.verify.footholds.rows import cost, gravity_cost, jacobians, references, violations

RESIDUAL_MAX = 1e-6
_CLOSE = 1e-6


def check_footholds(path: Path, ledger: Ledger) -> None:
    """Check a plan file and note what is wrong with it.

    Raises:
        InputError: the file, or the problem file that it names, cannot be read or has changed.
    """
    plan = read_foothold_plan(path)
    try:
        _check(plan, ledger)
    except BROKEN as problem:
        raise InputError(f"holds values that cannot be evaluated ({type(problem).__name__})", source=path) from problem


def _check(plan: FootholdFile, ledger: Ledger) -> None:
    verdict = plan.answer.get("verdict")
    ledger.counts.update(verdict=verdict, samples=len(plan.contacts), footsteps=len(plan.steps))
    _check_values(plan, ledger)
    if plan.free is not None:
        _check_free(plan, plan.free, ledger)
    elif verdict == "feasible":
        _check_motion(plan, ledger)
        _check_bound(plan, ledger)
    elif verdict == "infeasible":
        _check_refutation(plan, ledger)
    else:
        ledger.refuse("footholds, verdict", "claims nothing that could be checked", "answer.verdict")


def _check_values(plan: FootholdFile, ledger: Ledger) -> None:
    if plan.values["samples"] != len(plan.contacts):
        ledger.refuse("footholds, values", f"the gait has {len(plan.contacts)} samples", "values.samples")
    if plan.problem is not None:
        for key in differing_keys(plan.problem, plan.values, plan.free):
            ledger.refuse("footholds, problem", f"is not what {plan.problem.name} says", f"values.{key}")


def _check_motion(plan: FootholdFile, ledger: Ledger) -> None:
    if not plan.arrays:
        ledger.refuse("footholds, motion", "a feasible verdict needs a motion", "motion")
        return
    worst = violations(plan)
    for family, amount in worst.items():
        if not amount <= RESIDUAL_MAX:
            ledger.refuse(f"footholds, {family}", f"is violated by {amount:.3g}", "motion")
    objective = cost(plan)
    ledger.counts.update(max_residual=max(worst.values()), objective=objective)
    claimed = plan.answer.get("objective")
    if not _near(claimed, objective):
        ledger.refuse("footholds, objective", f"is {objective:.9g}, not {claimed}", "answer.objective")


def _check_free(plan: FootholdFile, free: dict[str, Any], ledger: Ledger) -> None:
    """Check a plan whose gait was found: motion, gait, and the bound over all gaits, or infeasibility."""
    if plan.answer.get("verdict") == "infeasible":
        if goal_without_ground(plan):
            ledger.counts.update(refuted_by="a foot without ground at the goal")
            return
        problem = refutation_problem(plan, free.get("refutation"))
        ledger.counts.update(refuted_by="rays of the relaxation")
        if problem:
            ledger.refuse("footholds, refutation", problem, "free.refutation")
        return
    if plan.answer.get("verdict") != "feasible":
        ledger.refuse("footholds, verdict", "claims nothing that could be checked", "answer.verdict")
        return
    _check_motion(plan, ledger)
    problem = cells_problem(plan)
    if problem:
        ledger.refuse("footholds, gait", problem, "values.gait")
        return
    if not math.isclose(len(plan.contacts) * plan.number("step_s"), float(free["horizon_s"]), abs_tol=_CLOSE):
        ledger.refuse("footholds, gait", "does not last as long as the problem says", "values.gait")
    _check_gait_bound(plan, free.get("bound"), ledger)


def _check_gait_bound(plan: FootholdFile, kept: Any, ledger: Ledger) -> None:
    claimed = plan.answer.get("bound")
    if not plan.arrays:
        return
    if claimed is None:
        _check_no_gap(plan, ledger)
        return
    if kept is None:
        ledger.refuse("footholds, bound", "has no multipliers that prove it", "free.bound")
        return
    bound = gait_bound(plan, kept, float(claimed))
    ledger.counts.update(bound=bound)
    if not float(claimed) <= bound + _CLOSE * abs(bound):
        ledger.refuse("footholds, bound", f"the multipliers give {bound:.9g}, not {claimed}", "answer.bound")
    _check_gap(plan, float(claimed), ledger)


def _near(claimed: object, found: float) -> bool:
    return isinstance(claimed, int | float) and math.isclose(claimed, found, rel_tol=_CLOSE, abs_tol=_CLOSE)


def _check_bound(plan: FootholdFile, ledger: Ledger) -> None:
    claimed = plan.answer.get("bound")
    if not plan.arrays:
        return
    if claimed is None:
        _check_no_gap(plan, ledger)
        return
    bound, problem = _proved(plan)
    ledger.counts.update(bound=bound if np.isfinite(bound) else None)
    if problem:
        ledger.refuse("footholds, proof", problem, "proof")
    elif not float(claimed) <= bound + _CLOSE * abs(bound):
        ledger.refuse("footholds, bound", f"the proof gives {bound:.9g}, not {claimed}", "answer.bound")
    _check_gap(plan, float(claimed), ledger)


def _check_gap(plan: FootholdFile, bound: float, ledger: Ledger) -> None:
    objective = cost(plan)
    gap = (objective - bound) / objective
    if not math.isclose(float(plan.answer.get("gap", math.nan)), gap, abs_tol=_CLOSE):
        ledger.refuse("footholds, gap", f"is {gap:.3g}", "answer.gap")
    net, claimed = objective - gravity_cost(plan), plan.answer.get("net_gap")
    if claimed is not None and (
        net <= 0 or not math.isclose(float(claimed) * net, objective - bound, abs_tol=_CLOSE * objective)
    ):
        ledger.refuse("footholds, gap", f"is not {claimed} without the gravity cost", "answer.net_gap")


def _check_no_gap(plan: FootholdFile, ledger: Ledger) -> None:
    for key in ("gap", "net_gap"):
        if plan.answer.get(key) is not None:
            ledger.refuse("footholds, gap", "needs a bound", f"answer.{key}")


def _proved(plan: FootholdFile) -> tuple[float, str]:
    try:
        with np.errstate(over="raise"):
            return proved_bound(plan)
    except BROKEN as problem:
        return -np.inf, f"cannot be evaluated ({type(problem).__name__}: {str(problem)[:80]})"


def _check_refutation(plan: FootholdFile, ledger: Ledger) -> None:
    if left_to_steps(plan) is None:
        ledger.counts.update(refuted_by="intervals")
        return
    if falls(plan):
        ledger.counts.update(refuted_by="a base that falls")
        return
    bound, problem = _proved(plan)
    limit = impossible(plan)
    ledger.counts.update(refuted_by="multipliers", bound=bound if np.isfinite(bound) else None)
    if problem:
        ledger.refuse("footholds, refutation", problem, "proof")
    elif bound < limit:
        ledger.refuse(
            "footholds, refutation", f"the proof bounds the cost by {bound:.3g} only, below {limit:.3g}", "proof"
        )


def impossible(plan: FootholdFile) -> float:
    """Return a cost that no motion of the problem reaches (docs/footholds.md)."""
    values, robot = plan.values, plan.values["robot"]
    w = {name: float(x) for name, x in values["weights"].items()}
    g, dt, size, mass = plan.number("gravity_mps2"), plan.number("step_s"), len(plan.contacts), float(robot["mass_kg"])
    places = [corner for one in values["polygons"] for corner in one["vertices_m"]]
    places += [*values["start"]["feet_m"], values["start"]["position_m"], values["goal"]["position_m"]]
    arm = float(np.linalg.norm(robot["foot_reference_m"]) + np.linalg.norm(robot["foot_reach_m"]))
    flights = "".join("." if held else "x" for held in map(np.any, plan.contacts)).split(".")
    fall = g * (max(map(len, flights)) * dt) ** 2
    span = float(np.linalg.norm(np.ptp(np.array(places, dtype=float), axis=0))) + 4 * arm + fall
    rate = 2 * span / dt**2
    push = max(float(np.linalg.norm(np.linalg.inv(j), 2)) for j in jacobians(plan)) * float(
        np.linalg.norm(robot["torque_max_nm"])
    )
    spin = 2 * float(robot["base_torque_max_nm"]) / min(robot["inertia_kgm2"])
    angle = float(np.abs(references(plan)[1]).max()) + spin * (size * dt) ** 2
    squares = (w["position"] + 4 * w["foot"]) * span**2 + (w["acceleration"] + 4 * w["foot_acceleration"]) * rate**2
    squares += w["force"] * ((mass * (rate + g)) ** 2 + 4 * push**2)
    squares += 3 * w["orientation"] * angle**2 + 3 * w["angular_acceleration"] * spin**2
    return float(2 * size * squares)
