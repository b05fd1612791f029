"""Verifies a saved artefact, whatever its kind."""

from __future__ import annotations

from pathlib import Path

from surefoot.errors import InputError
from surefoot.verify.findings import Ledger, Report

VERIFIABLE = (
    "the folder of a plan (plan.json), of a run (run.jsonl) or of a skill library (library.json), or a file of a "
    "strategy, a region of a step, a terrain (also one that was laid, .yaml) or a foothold plan (.json)"
)


def verify_path(path: Path | str, specification: Path | None = None) -> Report:
    """Check a saved plan, run or strategy with code that shares nothing with what made it.

    Args:
        path: a plan folder or its ``plan.json``, a run folder or its ``run.jsonl``, or a strategy's JSON file.
        specification: where a strategy's specification is; None: where the strategy says.

    Returns:
        Whether the artefact is accepted, what is wrong with it, and counts.

    Raises:
        InputError: files are missing, truncated, stale or of another format.
        LimitExceeded: the artefact is too large to be checked completely.
    """
    path = Path(path)
    if not path.exists():
        raise InputError("does not exist", source=path)
    folder = path if path.is_dir() else path.parent
    ledger = Ledger()
    foothold_plan = _foothold_plan(path)
    if foothold_plan is not None:
        from surefoot.verify.footholds.check import check_footholds

        check_footholds(foothold_plan, ledger)
        return ledger.report("foothold-plan")
    if _kind(path) == "gr1-strategy":
        from surefoot.verify.gr1.check import check_strategy

        check_strategy(path, ledger, specification)
        return ledger.report("gr1-strategy")
    if _kind(path) == "gr1-ranking":
        from surefoot.verify.gr1.ranking import check_ranking

        check_ranking(path, ledger, specification)
        return ledger.report("gr1-ranking")
    library = path / "library.json" if path.is_dir() else path
    if specification is None and _kind(library) == "skill-library":
        from surefoot.verify.skills.library import check_library

        check_library(library, ledger)
        return ledger.report("skill-library")
    if _is_quadruped_terrain(path):
        from surefoot.verify.terrain.laid import check_laid_terrain

        check_laid_terrain(path, ledger)
        return ledger.report("quadruped-terrain")
    if _kind(path) == "terrain":
        from surefoot.verify.terrain.polygons import check_terrain

        check_terrain(path, ledger)
        return ledger.report("terrain")
    region = path.with_suffix(".json") if path.suffix == ".npz" else path
    if specification is None and _kind(region) == "step-region":
        from surefoot.verify.regions.check import check_region

        check_region(path, ledger)
        return ledger.report("step-region")
    if specification is not None:
        raise InputError("is no strategy, and only strategies have a specification", source=path)
    if (folder / "run.jsonl").is_file() and path.name != "plan.json":
        from surefoot.verify.quadruped.file import is_quadruped_run

        if is_quadruped_run(folder):
            from surefoot.verify.quadruped.run import check_quadruped_run

            check_quadruped_run(folder, ledger)
            return ledger.report("quadruped-run")
        from surefoot.verify.runs.check import check_run

        check_run(folder, ledger)
        return ledger.report("biped-run")
    if (folder / "plan.json").is_file():
        from surefoot.verify.plan.check import check_plan

        check_plan(folder, ledger)
        return ledger.report("biped-plan")
    if (folder / "checks.jsonl").is_file():
        message = "is a library of skills whose synthesis was interrupted; `surefoot skills synthesize` goes on with it"
        raise InputError(message, source=folder)
    raise InputError(f"is nothing that can be verified; that is {VERIFIABLE}", source=path)


def _kind(path: Path) -> str | None:
    """Return the kind of a JSON artefact that is no plan; None for everything else."""
    if path.suffix != ".json" or path.name == "plan.json" or not path.is_file():
        return None
    from surefoot.verify.artefacts import parse_json, read_bytes

    value = parse_json(read_bytes(path), path)
    kind = value.get("kind") if isinstance(value, dict) else None
    return kind if isinstance(kind, str) else None


def _is_quadruped_terrain(path: Path) -> bool:
    """Return whether a file seems to be the terrain of a quadruped, in YAML."""
    if path.suffix not in (".yaml", ".yml") or not path.is_file():
        return False
    with path.open("rb") as stream:
        return b"quadruped-terrain" in stream.read(4000)


def _foothold_plan(path: Path) -> Path | None:
    """Return the file of a foothold plan, which may be called plan.json like a biped's; None for everything else."""
    file = path / "plan.json" if path.is_dir() else path
    try:
        with file.open("rb") as stream:
            found = b'"foothold-plan"' in stream.read(200)
    except OSError:
        return None
    return file if found else None
