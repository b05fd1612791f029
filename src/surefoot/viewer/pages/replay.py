"""``surefoot view --html``: a run, or a foothold plan, as one file that anyone can open."""

from __future__ import annotations

from pathlib import Path

from surefoot.errors import InputError
from surefoot.viewer.browser.recording import write_recording
from surefoot.viewer.kinds import is_quadruped_run
from surefoot.viewer.pages.strategy import write_strategy_page
from surefoot.viewer.remarks import Say, silent
from surefoot.viewer.robots.bodies import Body, chosen_body
from surefoot.viewer.scenes.footholds import FootholdScene
from surefoot.viewer.scenes.run import RunScene
from surefoot.viewer.sources.foothold_motion import read_motion
from surefoot.viewer.sources.ground import read_run_ground
from surefoot.viewer.sources.timeline import RATE_HZ, read_timeline


def write_motion(path: Path, out: Path, body: Body | None = None, say: Say = silent) -> Path:
    """Write the page of whatever is at a path: a run, a foothold plan, or a plan with its strategy.

    Args:
        path: the folder or the file.
        out: the HTML file.
        body: of the robot; None takes its own meshes if they are installed, else the simple body.
        say: is told what is drawn otherwise than it was planned.

    Raises:
        InputError: it cannot be read, or holds nothing that a page shows.
        BackendMissing: viser is not installed, or meshes are asked for and are not.
    """
    if (path.is_file() and path.suffix.lower() == ".json") or is_quadruped_run(path):
        return write_quadruped(path, out, body, say)
    if (path / "plan.json").is_file() and not (path / "run.jsonl").is_file():
        if body is not None:
            raise InputError("--body belongs to runs and foothold plans; this plan is shown without a robot")
        return write_strategy_page(path, out)
    return write_replay(path, out, body=body, say=say)


def write_quadruped(path: Path, out: Path, body: Body | None, say: Say) -> Path:
    """Write a foothold plan, or the run of a quadruped on the ground that it went over, as one page."""
    motion = read_motion(path)
    ground = read_run_ground(path, say) if path.is_dir() else None
    chosen = chosen_body(motion.robot, biped=False, asked=body)
    for note in write_recording(out, lambda scene: FootholdScene(scene, motion, chosen, ground)):
        say(note)
    return out


def write_replay(
    run_dir: Path, path: Path, rate_hz: float = RATE_HZ, body: Body | None = None, say: Say = silent
) -> Path:
    """Write a biped's run as one self-contained page with a time slider, a play button and places to look from.

    Args:
        run_dir: the folder of the run.
        path: of the HTML file.
        rate_hz: frames a second.
        body: of the robot; None takes its own meshes if they are installed, else the simple body.
        say: is told what is drawn otherwise than it was logged.

    Raises:
        InputError: the run cannot be read, or holds no step.
        BackendMissing: viser is not installed, or meshes are asked for and are not.
    """
    source, times = read_timeline(run_dir, rate_hz)
    chosen = chosen_body(source.plan.scenario.robot, biped=True, asked=body)
    for note in write_recording(path, lambda scene: RunScene(scene, source, times, chosen)):
        say(note)
    return path
