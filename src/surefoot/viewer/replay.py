"""``surefoot view run/ --html``: a run as one file that anyone can open."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from surefoot.errors import InputError
from surefoot.viewer.run_scene import RunScene
from surefoot.viewer.page import server, write_page
from surefoot.viewer.sources import read_run_source
from surefoot.viewer.timeline import timeline

RATE_HZ = 12.0


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
    source = read_run_source(run_dir)
    if not source.run.steps:
        raise InputError("holds no step, so there is nothing to replay", source=run_dir / "run.jsonl")
    times = timeline(source, rate_hz)
    with server() as running:
        scene = RunScene(running.scene, source, times)
        scene.show(0)
        serializer = running.get_scene_serializer()
        pauses_s = np.diff(times.time_s, append=times.time_s[-1] + 1.0)
        for frame in range(times.frames):
            scene.show(frame)
            serializer.insert_sleep(max(0.0, float(pauses_s[frame])))
        write_page(path, serializer, scene.cameras())
    return path
