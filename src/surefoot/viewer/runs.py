"""The pictures of a run."""

from __future__ import annotations

from pathlib import Path

from surefoot.viewer.maps.beliefs import draw_beliefs
from surefoot.viewer.maps.paths import draw_path
from surefoot.viewer.sources.plans import read_run_source
from surefoot.viewer.steps.keyframes import draw_keyframes
from surefoot.viewer.steps.phase_space import draw_phase_space


def draw_run(run_dir: Path, out: Path) -> tuple[Path, ...]:
    """Draw everything that a run has to show; what it has none of (such as obstacles) is left out.

    The run of a quadruped has pictures of its own.
    """
    from surefoot.viewer.kinds import is_quadruped_run
    from surefoot.viewer.terrain.runs import draw_quadruped_run

    if is_quadruped_run(run_dir):
        return draw_quadruped_run(run_dir, out)
    source = read_run_source(run_dir)
    pictures = [draw_path(source, out / "map.png")]
    if source.run.turns:
        pictures.append(draw_beliefs(source, out / "belief.png"))
    if source.run.steps:
        pictures.append(draw_phase_space(source, out / "phase_space.png"))
        pictures.append(draw_keyframes(source, out / "keyframes.png"))
    return tuple(pictures)
