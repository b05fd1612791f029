"""Verifies a run folder: its plan's claims, the games that it plays, and every step that it walks."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

from surefoot.verify.findings import Ledger
from surefoot.verify.navigation.decisions import WAIT
from surefoot.verify.plan.action import read_action_table
from surefoot.verify.plan.check import open_plan, open_table
from surefoot.verify.runs.file import End, RunFile, Step, Turn, Unsafe, Violation, read_run
from surefoot.verify.runs.footing import check_feet, check_supports
from surefoot.verify.runs.motion import check_motion
from surefoot.verify.runs.posture import check_posture
from surefoot.verify.runs.push_file import Fall
from surefoot.verify.runs.pushed_steps import check_pushes
from surefoot.verify.runs.replay import Replayed, replay

MOST_IDLE_TURNS = 1000
"""A walk is given up when more decisions on end than this one brought no step."""


def check_run(folder: Path, ledger: Ledger) -> None:
    """Verify a run folder.

    Raises:
        InputError: a file is missing, truncated, stale or malformed.
    """
    run = read_run(folder)
    opened = open_plan(run.plan_folder, ledger)
    if ledger.total:
        return
    scene, claims = opened.scene, opened.claims
    table, actions = open_table(opened, ledger), read_action_table(opened.plan, claims, ledger)
    if table is None or actions is None:
        return
    if run.kinds != tuple(kind.members for kind in scene.obstacle_kinds):
        ledger.refuse("rules.md 4, kinds", "are not the scenario's", "run.jsonl line 1")
    _count_records(run, ledger)
    _check_length(run, ledger)
    _check_stop(run, ledger)
    done = replay(run, scene, claims, table, actions, ledger)
    check_motion(scene, claims, done.walked, ledger)
    falls = [record for record in run.records if isinstance(record, Fall)]
    check_pushes(scene, claims, done.walked, falls, run.pushing, ledger)
    check_posture(scene, claims, done.walked, ledger)
    check_feet(scene, done.walked, ledger)
    check_supports(scene, done.walked, ledger)
    ledger.counts["goals_reached"] = done.goals_reached
    ledger.counts["turns"] = done.quarter_turns
    _check_times(run, ledger)
    _check_end(run.end, done, run, ledger)


def _count_records(run: RunFile, ledger: Ledger) -> None:
    """Count what the records say by themselves; a collision is refused, an unsafe stop is a failure of the mission."""
    steps = [record for record in run.records if isinstance(record, Step)]
    turns = [record for record in run.records if isinstance(record, Turn)]
    unsafe = [record for record in run.records if isinstance(record, Unsafe)]
    met = [record.line for record in turns if record.cell in record.obstacles]
    for before, after in pairwise(turns):
        entered = before.cell in after.obstacles and before.cell != after.cell
        if entered and after.line not in met:
            met.append(after.line)
    allowed = _lawless_turns(run)
    for line in (line for line in met if line not in allowed):
        text = "robot and obstacle share a cell, or the obstacle enters the cell that the robot has just left"
        ledger.refuse("rules.md 4, collision", text, f"run.jsonl line {line}")
    for record in unsafe:
        ledger.fail("rules.md 6, unsafe step", "no step satisfied the theorems", f"run.jsonl line {record.line}")
    ledger.counts["steps"] = len(steps)
    ledger.counts["decisions"] = len(turns)
    ledger.counts["collisions"] = len(met)
    ledger.counts["assumption_violations"] = sum(isinstance(record, Violation) for record in run.records)
    ledger.counts["unsafe_steps"] = len(unsafe)
    ledger.counts["waypoint_corrections"] = sum(record.lateral != 0 for record in steps)


def _lawless_turns(run: RunFile) -> set[int]:
    """Return the lines of the decisions before which an assumption was broken, or no strategy decided.

    What an obstacle does then is no fault of the robot's.
    """
    turns = [record for record in run.records if isinstance(record, Turn)]
    broken = {record.turn for record in run.records if isinstance(record, Violation)}
    lines = {record.line for record in turns if record.turn in broken}
    return lines | {after.line for before, after in pairwise(turns) if before.strategy < 0}


def _check_length(run: RunFile, ledger: Ledger) -> None:
    """Compare the number of steps with the header; a walk that ends early has to show why."""
    walked, rule = sum(isinstance(record, Step) for record in run.records), "formats.md 3, steps"
    ledger.counts["complete"] = run.end is not None and walked == run.steps
    if walked > run.steps:
        ledger.refuse(rule, f"{walked} steps are logged, and the header has {run.steps}", "run.jsonl line 1")
    unsafe = any(isinstance(record, Unsafe | Fall) for record in run.records)
    if walked < run.steps and run.end is not None and not unsafe and not _given_up(run):
        message = f"the walk ends after {walked} of {run.steps} steps, neither unsafe nor given up"
        ledger.refuse(rule, message, f"run.jsonl line {run.end.line}")


def _check_stop(run: RunFile, ledger: Ledger) -> None:
    """Refuse a walk that goes on after its fall or its unsafe stop, and a stop before another step than the next."""
    walked = sum(isinstance(record, Step) for record in run.records)
    for record in run.records:
        if not isinstance(record, Unsafe | Fall):
            continue
        name = "fall" if isinstance(record, Fall) else "unsafe"
        if record is not run.records[-1]:
            ledger.refuse(f"formats.md 3, {name}", "the walk goes on after it", f"run.jsonl line {record.line}")
        elif isinstance(record, Unsafe) and record.step != walked:
            message = f"step has to be {walked}, the next one, not {record.step}"
            ledger.refuse("formats.md 3, unsafe", message, f"run.jsonl line {record.line}")


def _given_up(run: RunFile) -> bool:
    """Return whether the robot did nothing but wait in the last decisions."""
    last = run.records[-MOST_IDLE_TURNS - 1 :]
    return len(last) > MOST_IDLE_TURNS and all(isinstance(record, Turn) and record.order >= WAIT for record in last)


def _check_times(run: RunFile, ledger: Ledger) -> None:
    """Refuse time that runs backwards."""
    last = 0.0
    for record in run.records:
        if not isinstance(record, Unsafe | Fall):
            if record.time_s < last - 1e-6:
                ledger.refuse("formats.md 3, time_s", "runs backwards", f"run.jsonl line {record.line}")
            last = record.time_s


def _check_end(end: End | None, done: Replayed, run: RunFile, ledger: Ledger) -> None:
    """Compare the end record with what was counted; a log without one is incomplete."""
    if end is None:
        message = "is missing: the run was cut short, and was checked as far as it goes"
        ledger.refuse("formats.md 3, end record", message, "the last line of run.jsonl")
        return
    if not done.whole:
        return
    where = f"run.jsonl line {end.line}"
    last = max((r.time_s for r in run.records if isinstance(r, Turn | Step)), default=0.0)
    own = {
        "steps": (end.steps, len(done.walked)),
        "turns_coarse": (end.turns_coarse, done.turns),
        "goals_reached": (list(end.goals_reached), done.goals_reached),
    }
    for name, (found, counted) in own.items():
        if found != counted:
            ledger.refuse("formats.md 3, end record", f"{name} is {counted}, not {found}", where)
    if end.time_s < last - 1e-6:
        ledger.refuse("formats.md 3, end record", "time_s lies before the last record", where)
