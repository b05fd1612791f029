"""``surefoot verify``: check a saved artefact with code that shares nothing with what made it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from surefoot.cli.output import AsJson, answer, facts

if TYPE_CHECKING:
    from surefoot.verify import Report


def verify(
    path: Annotated[Path, typer.Argument(help="A plan or a run: its folder or its file.", show_default=False)],
    as_json: AsJson = False,
) -> None:
    """Verify a plan or a run from its files alone.

    The rules are derived again from scenario and map, the strategies are
    checked in every state that they can reach, and the steps of a run are
    integrated again.

    Examples:
      surefoot verify plan/
      surefoot verify run/ --json

    Exit code 0: accepted; 1: refused, with every finding; 2: the files cannot
    be read.
    """
    from surefoot.verify import verify_path

    report = verify_path(path)
    answer(report, _lines(report, path), yes=report.accepted, as_json=as_json)


def _lines(report: Report, path: Path) -> list[str]:
    head = f"{path}: {report.kind} {'accepted' if report.accepted else 'REFUSED'}"
    findings = [f"  {finding.rule}: {finding.message} ({finding.where})" for finding in report.findings]
    return [head, *findings, *facts(report.counts)]
