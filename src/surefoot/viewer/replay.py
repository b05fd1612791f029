"""``surefoot view --html``: a run, or a foothold plan, as one file that anyone can open."""

from __future__ import annotations

from pathlib import Path

from surefoot.errors import InputError
from surefoot.viewer.foothold_motion import read_motion
from surefoot.viewer.foothold_scene import FootholdScene
from surefoot.viewer.quadruped_run import is_quadruped_run
from surefoot.viewer.recording import write_recording
from surefoot.viewer.run_scene import RunScene
from surefoot.viewer.sources import RunSource, read_run_source
from surefoot.viewer.strategy_page import write_strategy_page
from surefoot.viewer.timeline import Timeline, curves_of, timeline

RATE_HZ = 12.0


def write_motion(path: Path, out: Path) -> Path:
    """Write the page of whatever is at a path: a run, a foothold plan, or a plan with its strategy.

    Args:
        path: the folder or the file.
        out: the HTML file.

    Raises:
        InputError: it cannot be read, or holds nothing that a page shows.
        BackendMissing: viser is not installed.
    """
    if (path.is_file() and path.suffix.lower() == ".json") or is_quadruped_run(path):
        motion = read_motion(path)
        return write_recording(out, lambda scene: FootholdScene(scene, motion))
    if (path / "plan.json").is_file() and not (path / "run.jsonl").is_file():
        return write_strategy_page(path, out)
    return write_replay(path, out)


def write_replay(run_dir: Path, path: Path, rate_hz: float = RATE_HZ) -> Path:
    """Write a run as one self-contained page with a time slider, a play button and places to look from.

    Args:
        run_dir: the folder of the run.
        path: of the HTML file.
        rate_hz: frames a second.

    Raises:
        InputError: the run cannot be read, or holds no step.
        BackendMissing: viser is not installed.
    """
    source, times = read_timeline(run_dir, rate_hz)
    return write_recording(path, lambda scene: RunScene(scene, source, times))


def read_timeline(run_dir: Path, rate_hz: float = RATE_HZ) -> tuple[RunSource, Timeline]:
    """Read a run and sample it.

    Raises:
        InputError: the run cannot be read, or holds no step.
    """
    source = read_run_source(run_dir)
    if not source.run.steps:
        raise InputError("holds no step, so there is nothing to replay", source=run_dir / "run.jsonl")
    return source, timeline(source, curves_of(source.run.steps, rate_hz))
