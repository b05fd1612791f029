"""``surefoot verify``: check a saved artefact with code that shares nothing with what made it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from surefoot.cli.output import AsJson, answer, facts, jsonable, progress

if TYPE_CHECKING:
    from surefoot.verify import Report


def verify(
    path: Annotated[
        Path,
        typer.Argument(
            help="A plan, a run or a skill library (folder or file), a strategy, a region, terrain, or footholds.",
            show_default=False,
        ),
    ],
    spec: Annotated[
        Path | None, typer.Option(help="The specification of a strategy, if it is not where it was.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Verify what was saved from its files alone: plans, runs, strategies, regions, terrain, footholds, libraries.

    The rules are derived again from scenario and map, the strategies are
    checked in every state that they can reach, and the steps of a run are
    integrated again. A strategy of a specification is checked in its explicit
    product with it: safety at every step, every goal on every fair cycle.

    A log can be accepted and its mission can have failed: the robot fell, or
    stopped because no step was safe, and the log says so. REFUSED is a log, or
    any other artefact, that is wrong.

    Examples:
      surefoot verify plan/
      surefoot verify run/ --json
      surefoot verify strategy.json --spec spec.structuredslugs
      surefoot verify regions.json
      surefoot verify terrain.json
      surefoot verify footholds.json
      surefoot verify library/

    Exit code 0: accepted; 1: refused, with every finding, or a log of a failed
    mission; 2: the files cannot be checked: one is missing, is no whole file
    of its format, or does not fit the hash that was recorded for it.
    """
    from surefoot.verify import verify_path

    with progress() as say:
        say(f"verifying {path}")
        report = verify_path(path, spec)
    yes = report.accepted and not report.failures
    answer(_object(report), _lines(report, path), yes=yes, as_json=as_json)


def _object(report: Report) -> object:
    """Return the JSON object of a report; a strategy's answers the question that was asked about it.

    What is counted and what is said in words stand apart.
    """
    words = {name: value for name, value in report.counts.items() if isinstance(value, str)}
    counts = {name: value for name, value in report.counts.items() if name not in words}
    shown = jsonable(report) | {"counts": jsonable(counts), "about": words}
    if report.kind not in ("gr1-strategy", "gr1-ranking"):
        return shown
    violation = str(report.findings[0]) if report.findings else None
    asked = {"holds": report.accepted, "checked_states": report.counts.get("checked_states"), "violation": violation}
    return asked | shown


def _lines(report: Report, path: Path) -> list[str]:
    head = f"{path}: {report.kind} {'accepted' if report.accepted else 'REFUSED'}"
    failures = [f"  the mission FAILED: {failure}" for failure in report.failures]
    return [head, *(f"  {finding}" for finding in report.findings), *failures, *facts(report.counts)]
