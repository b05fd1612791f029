"""Plan files: one JSON object with every array of the model, the polygon of every footstep, and the proof."""

from __future__ import annotations

import datetime
import json
import os
from pathlib import Path
from typing import Any

from surefoot.compute import sha256_of, write_text_whole
from surefoot.footholds.problem import Problem
from surefoot.footholds.solve import Solution

KIND = "foothold-plan"
FORMAT = 1


def write_plan(path: Path, problem: Problem, solution: Solution) -> None:
    """Save an answer; whole or not at all."""
    write_text_whole(path, json.dumps(plan_document(problem, solution, path.parent)) + "\n")


def plan_document(problem: Problem, solution: Solution, folder: Path) -> dict[str, Any]:
    """Return a plan file's object (docs/formats.md)."""
    from surefoot import __version__

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
    }


def values_of(problem: Problem) -> dict[str, Any]:
    """Return every value used, in the shape of a problem file with everything filled in."""
    robot, options, weights = problem.robot, problem.options, problem.weights
    return {
        "robot": {name: getattr(robot, name) for name in robot.__slots__ if name != "source"},
        "gait": {"modes": list(problem.gait.modes), "switching_times_s": list(problem.gait.switching_times_s)},
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
