"""``surefoot run`` for a quadruped: what is special about its command line and its answer."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from surefoot.cli.output import answer, facts, progress
from surefoot.errors import InputError

if TYPE_CHECKING:
    from surefoot.missions.quadruped.mission import QuadrupedAnswer, QuadrupedOrder

_LARGEST_BYTES = 64_000_000
_FINDINGS = 5
_KIND = re.compile(rb"""["']?kind["']?\s*:\s*["']?quadruped-terrain\b""")


def is_quadruped(path: Path) -> bool:
    """Return whether a file is the terrain of a quadruped, or a segmented one; what cannot be read is neither."""
    from surefoot.skills.segmented import is_segmented

    try:
        with path.open("rb") as stream:
            text = stream.read(_LARGEST_BYTES)
    except OSError:
        return False
    return bool(_KIND.search(text)) or is_segmented(path)


def place(text: str | None, option: str) -> tuple[float, float] | None:
    """Read X,Y in metres."""
    if text is None:
        return None
    try:
        x, y = map(float, text.split(","))
    except ValueError as problem:
        raise InputError(f"{text!r} is no place; it needs X,Y in metres of the map, such as 4.2,0", key=option) from (
            problem
        )
    if not (abs(x) < 1e4 and abs(y) < 1e4):
        raise InputError("needs places within 10 km", key=option)
    return x, y


def answer_quadruped(order: QuadrupedOrder, output: Path, *, as_json: bool) -> None:
    """Walk the mission and print its answer."""
    from surefoot.missions.quadruped.mission import run_quadruped

    with progress() as say:
        walked = run_quadruped(order, output, say)
    answer(walked, _lines(walked), yes=walked.succeeded, as_json=as_json)


def _lines(walked: QuadrupedAnswer) -> list[str]:
    from surefoot.cli.obstacle_words import barrier_lines

    head = "The goal was reached" if walked.reached else f"The goal was NOT reached: {walked.why_not}"
    more = len(walked.findings) - _FINDINGS
    return [
        f"{head} ({walked.out})",
        *barrier_lines(walked.blocked_by),
        *facts(
            {
                "transitions": walked.transitions,
                "strategies made at run time": walked.repairs,
                "skills found, before setting out and on the way": walked.new_skills,
                "strategy from skills at hand, longest [ms]": walked.resynthesis_ms,
                "strategy with new skills, longest [ms]": walked.repair_ms,
                "strategies before setting out, in all [ms]": walked.prepared_ms,
                "programs against their certificates": walked.contradictions,
                "of these, done in another gait": walked.other_gaits,
                "targets without a pose to stand in": walked.no_stance,
                "stepped in place": walked.settled,
                "left its own cell, an obstacle": walked.left,
                "motions withdrawn before they began": walked.withdrawn,
                "programs stopped by a limit": walked.limits,
                "assumptions seen broken": walked.violations,
                "other ways asked for": walked.detours,
                "walked for [s]": walked.walked_s,
                "idle, waiting for the planner [s]": walked.idle_s,
                "of that, for new skills [s]": walked.idle_for_checks_s,
                "before the first motion [s]": walked.first_s,
                "solving a program, mean [ms]": walked.solve_ms_mean,
                "solving a program, 95 % below [ms]": walked.solve_ms_p95,
                "re-targeting, mean [ms]": walked.retarget_ms_mean,
                "polygons, variables, binaries": (
                    walked.polygons_mean,
                    walked.continuous_mean,
                    walked.binaries_mean,
                ),
                "log verified": walked.verified,
            }
        ),
        *(f"  not verified: {finding}" for finding in walked.findings[:_FINDINGS]),
        *([f"  and {more} more; all of them: surefoot verify {walked.out}"] if more > 0 else []),
    ]
