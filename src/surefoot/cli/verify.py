"""``surefoot verify``: check a saved artefact with code that shares nothing with what made it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from surefoot.cli.output import AsJson, answer, facts, jsonable

if TYPE_CHECKING:
    from surefoot.verify import Report


def verify(
    path: Annotated[
        Path, typer.Argument(help="A plan or a run, its folder or its file; or a strategy.", show_default=False)
    ],
    spec: Annotated[
        Path | None, typer.Option(help="The specification of a strategy, if it is not where it was.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Verify a plan, a run or a strategy from its files alone.

    The rules are derived again from scenario and map, the strategies are
    checked in every state that they can reach, and the steps of a run are
    integrated again. A strategy of a specification is checked in its explicit
    product with it: safety at every step, every goal on every fair cycle.

    Examples:
      surefoot verify plan/
      surefoot verify run/ --json
      surefoot verify strategy.json --spec spec.structuredslugs

    Exit code 0: accepted; 1: refused, with every finding; 2: the files cannot
    be read.
    """
    from surefoot.verify import verify_path

    report = verify_path(path, spec)
    answer(_object(report), _lines(report, path), yes=report.accepted, as_json=as_json)


def _object(report: Report) -> object:
    """Return the JSON object of a report; a strategy's answers the question that was asked about it."""
    if report.kind not in ("gr1-strategy", "gr1-ranking"):
        return report
    violation = str(report.findings[0]) if report.findings else None
    asked = {"holds": report.accepted, "checked_states": report.counts.get("checked_states"), "violation": violation}
    return asked | jsonable(report)


def _lines(report: Report, path: Path) -> list[str]:
    head = f"{path}: {report.kind} {'accepted' if report.accepted else 'REFUSED'}"
    findings = [f"  {finding.rule}: {finding.message} ({finding.where})" for finding in report.findings]
    return [head, *findings, *facts(report.counts)]
