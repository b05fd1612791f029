"""Pictures of scenarios, plans and runs, good enough for a paper."""

from __future__ import annotations

from pathlib import Path

from surefoot.errors import InputError

__all__ = ["view_folder", "view_plan", "view_run", "view_scenario"]


def view_run(run_dir: Path, out: Path | None = None) -> tuple[Path, ...]:
    """Draw a run: the map with path and feet, the belief, the phase space, the keyframes.

    Args:
        run_dir: the folder of the run.
        out: where the pictures belong; None means the run's folder.

    Returns:
        The pictures that were written, PNG.

    Raises:
        InputError: if the run, its plan, scenario or map cannot be read.
    """
    from surefoot.viewer.runs import draw_run

    return draw_run(run_dir, run_dir if out is None else out)


def view_plan(plan_dir: Path, out: Path | None = None) -> tuple[Path, ...]:
    """Draw a plan: its grid, start, goals, where obstacles may be, belief regions, stairs.

    Args:
        plan_dir: the folder of the plan.
        out: the folder for the picture; None means the plan's folder.
    """
    from surefoot.viewer.plans import draw_plan

    return draw_plan(plan_dir, plan_dir if out is None else out)


def view_scenario(scenario: Path, out: Path | None = None) -> tuple[Path, ...]:
    """Draw a scenario: the same as for a plan, before there is one.

    Args:
        scenario: the scenario file.
        out: the folder for the picture; None means beside the scenario.
    """
    from surefoot.viewer.plans import draw_scenario

    return draw_scenario(scenario, scenario.parent if out is None else out)


def view_folder(path: Path, out: Path | None = None) -> tuple[Path, ...]:
    """Draw whatever stands at a path: the folder of a run or of a plan, or a scenario file."""
    if path.is_dir() and (path / "run.jsonl").is_file():
        return view_run(path, out)
    if path.is_dir() and (path / "plan.json").is_file():
        return view_plan(path, out)
    if path.is_file() and path.suffix.lower() in {".yaml", ".yml"}:
        return view_scenario(path, out)
    what = "is neither" if path.exists() else "does not exist; allowed are"
    raise InputError(
        f"{what} the folder of a run (with run.jsonl), the folder of a plan (with plan.json)"
        f"{' nor' if path.exists() else ' and'} a scenario (.yaml)",
        source=path,
    )
