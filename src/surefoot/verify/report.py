"""Verifies a saved artefact, whatever its kind."""

from __future__ import annotations

from pathlib import Path

from surefoot.errors import InputError
from surefoot.verify.findings import Ledger, Report


def verify_path(path: Path) -> Report:
    """Check a saved plan or run with code that shares nothing with what made it.

    Args:
        path: a plan folder or its ``plan.json``, a run folder or its ``run.jsonl``.

    Returns:
        Whether the artefact is accepted, what is wrong with it, and counts.

    Raises:
        InputError: files are missing, truncated, stale or of another format.
        LimitExceeded: the artefact is too large to be checked completely.
    """
    folder = path if path.is_dir() else path.parent
    ledger = Ledger()
    if (folder / "run.jsonl").is_file() and path.name != "plan.json":
        from surefoot.verify.run_check import check_run

        check_run(folder, ledger)
        return ledger.report("biped-run")
    if (folder / "plan.json").is_file():
        from surefoot.verify.plan_check import check_plan

        check_plan(folder, ledger)
        return ledger.report("biped-plan")
    raise InputError("holds neither plan.json nor run.jsonl", source=path)
