"""Plan files: one JSON object with every array of the model, the polygon of every footstep, and the proof."""

from __future__ import annotations

import datetime
import json
import os
from pathlib import Path
from typing import Any

from surefoot.compute import sha256_of, write_text_whole
from surefoot.footholds.bound_file import bound_document
from surefoot.footholds.cells import with_gait
from surefoot.footholds.gaits import FreeGait, Gait
from surefoot.footholds.problem import Problem
from surefoot.footholds.refute import refutation_document
from surefoot.footholds.solve import FreeAnswer, Solution

KIND = "foothold-plan"
FORMAT = 1


def write_plan(path: Path, problem: Problem, solution: Solution) -> None:
    """Save an answer; whole or not at all."""
    write_text_whole(path, json.dumps(plan_document(problem, solution, path.parent)) + "\n")


def plan_document(problem: Problem, solution: Solution, folder: Path) -> dict[str, Any]:
    """Return a plan file's object (docs/formats.md)."""
    from surefoot import __version__

    free = None
    if isinstance(problem.gait, FreeGait):
        free = _free(problem, solution)
        gait = None if solution.free is None else solution.free.gait
        problem = problem if gait is None else with_gait(problem, gait)
    source = None
    if problem.source is not None:
        source = {"path": os.path.relpath(problem.source, folder), "sha256": sha256_of(Path(problem.source))}
    return {
        "kind": KIND,
        "format": FORMAT,
        "surefoot": __version__,
        "made": datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        "problem": source,
        "values": values_of(problem),
        "answer": answer_of(solution),
        "motion": None if solution.plan is None else _motion(problem, solution),
        "proof": None if solution.proof is None else _proof(solution),
        **({} if free is None else {"free": free}),
    }


def _free(problem: Problem, solution: Solution) -> dict[str, Any]:
    """Return what a plan of a free gait adds (docs/formats.md)."""
    refutation = None if solution.free is None else solution.free.refutation
    return {
        "horizon_s": problem.gait.horizon_s,
        "bound": None if solution.free is None or solution.bound is None else bound_document(solution.free),
        "refutation": None if refutation is None else refutation_document(refutation),
    }


def answer_of(solution: Solution) -> dict[str, Any]:
    """Return what `surefoot footholds solve --json` prints, without the values."""
    explanation = solution.explanation
    return {
        "verdict": solution.verdict,
        "objective": solution.objective,
        "bound": solution.bound,
        "gap": solution.gap,
        "net_gap": solution.net_gap,
        "solve_ms": round(solution.solve_ms, 3),
        "solve_cpu_ms": round(solution.solve_cpu_ms, 3),
        "certify_ms": round(solution.certify_ms, 3),
        "explain_ms": round(solution.explain_ms, 3),
        "nodes": solution.nodes,
        "max_residual": solution.max_residual,
        "residuals": solution.residuals,
        "certificate": solution.certificate,
        "explanation": None
        if explanation is None
        else {
            "text": explanation.text,
            "lacks": [
                {"family": x.family, "foot": x.foot, "step": x.step, "amount": x.amount, "unit": x.unit, "text": x.text}
                for x in explanation.lacks
            ],
            "polygons": list(explanation.polygons),
        },
        "limit": solution.limit,
        "notes": list(solution.notes),
        **({} if solution.free is None else _free_answer(solution.free)),
    }


def _free_answer(free: FreeAnswer) -> dict[str, Any]:
    gait = free.gait
    return {
        "gait": None
        if gait is None
        else {"modes": list(gait.modes), "switching_times_s": list(gait.switching_times_s)},
        "gait_from": free.origin or None,
        "templates_tried": free.templates_tried,
        "first_feasible_s": None if free.first_feasible_s is None else round(free.first_feasible_s, 4),
        "first_objective": free.first_objective,
    }


def values_of(problem: Problem) -> dict[str, Any]:
    """Return every value used, in the shape of a problem file with everything filled in."""
    robot, options, weights = problem.robot, problem.options, problem.weights
    return {
        "robot": {name: getattr(robot, name) for name in robot.__slots__ if name != "source"},
        **_gait_values(problem.gait),
        "step_s": problem.step_s,
        "samples": problem.samples,
        "start": {
            "position_m": problem.start_m.tolist(),
            "rpy_rad": problem.start_rpy_rad.tolist(),
            "feet_m": problem.feet_m.tolist(),
        },
        "goal": {"position_m": problem.goal_m.tolist(), "rpy_rad": problem.goal_rpy_rad.tolist()},
        "polygons": [{"vertices_m": one.vertices_m.tolist(), "friction": one.friction} for one in problem.polygons],
        "free_regions": [{"A": matrix.tolist(), "b": bound.tolist()} for matrix, bound in problem.free_regions],
        "options": {name: getattr(options, name) for name in options.__slots__},
        "weights": {name: getattr(weights, name) for name in weights.__slots__},
        "gravity_mps2": problem.gravity_mps2,
    }


def _gait_values(gait: Gait | FreeGait) -> dict[str, Any]:
    if isinstance(gait, FreeGait):
        return {"gait": "free", "horizon_s": gait.horizon_s}
    return {"gait": {"modes": list(gait.modes), "switching_times_s": list(gait.switching_times_s)}}


def _motion(problem: Problem, solution: Solution) -> dict[str, Any]:
    plan = solution.plan
    assert plan is not None
    arrays = {name: getattr(plan, name).tolist() for name in plan.__slots__ if name != "choice"}
    steps = [
        {"foot": step.foot, "step": step.step, "lift": step.lift, "touch": step.touch, "polygon": left[0]}
        for step, left in zip(problem.footsteps, plan.choice, strict=False)
    ]
    windows = [left[0] for left in plan.choice[len(steps) :]]
    return {"footsteps": steps, "window_regions": windows, **arrays}


def _proof(solution: Solution) -> dict[str, Any]:
    proof = solution.proof
    assert proof is not None
    return {
        "root": [list(left) for left in proof.root],
        "tree": proof.tree,
        "multipliers": proof.multipliers,
        "turning": proof.turning,
    }
