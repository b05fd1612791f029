"""A run as it is walked: the scene of its replay, served to this machine's browsers while the log grows."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from surefoot.errors import InputError
from surefoot.missions.run_log import Run, read_run
from surefoot.viewer.live_panel import LivePanel
from surefoot.viewer.page import HOST, server
from surefoot.viewer.replay import RATE_HZ
from surefoot.viewer.run_scene import RunScene
from surefoot.viewer.sources import RunSource, read_run_source
from surefoot.viewer.timeline import curves_of, timeline
from surefoot.walking import Trajectory

_TICK_S = 1 / RATE_HZ
_POLL_S = 0.4


@contextmanager
def serving(run_dir: Path, port: int | None) -> Iterator[tuple[str, LiveView]]:
    """Yield the address of a live view of a run, and the view, which shows something once it runs.

    Args:
        run_dir: the folder of the run; its log may still be missing.
        port: to listen on; None takes any free one.

    Raises:
        BackendMissing: viser is not installed.
        InputError: the port is in use.
    """
    with server(port) as running:
        yield f"http://{HOST}:{running.get_port()}", LiveView(running, run_dir)


@contextmanager
def watching(run_dir: Path, port: int | None) -> Iterator[str]:
    """Yield the address of a live view that runs beside the caller.

    Args:
        run_dir: the folder of the run that the caller is about to walk.
        port: to listen on; None takes any free one.

    Raises:
        BackendMissing: viser is not installed.
        InputError: the port is in use.
    """
    stop = threading.Event()
    with serving(run_dir, port) as (address, view):

        def run() -> None:
            while not stop.is_set():
                with suppress(InputError):  # what an older version left in the folder, until the run replaces it
                    view.run(stop)
                stop.wait(_POLL_S)

        thread = threading.Thread(target=run, daemon=True)
        thread.start()
        try:
            yield address
        finally:
            stop.set()
            thread.join()


class LiveView:
    """Follows a log and shows it.

    Args:
        running: a viser server.
        run_dir: the folder of the run.
    """

    def __init__(self, running: Any, run_dir: Path) -> None:
        self.running, self.log = running, run_dir / "run.jsonl"
        self.seen: tuple[int, int] | None = None
        self.source: RunSource | None = None
        self.scene: RunScene | None = None
        self.curves: tuple[Trajectory, ...] = ()
        self.panel = LivePanel(running)

    def run(self, stop: threading.Event) -> None:
        """Follow and show until a stop is asked for.

        Raises:
            InputError: the log holds something else than a run.
        """
        polled_s = -_POLL_S
        while not stop.is_set():
            began_s = time.monotonic()
            if began_s - polled_s >= _POLL_S:
                self._poll()
                polled_s = time.monotonic()
            if self.scene is not None:
                self._show(self.scene)
            stop.wait(max(0.0, _TICK_S - (time.monotonic() - began_s)))

    def _show(self, scene: RunScene) -> None:
        begin_s, end_s = float(scene.time_s[0]), float(scene.time_s[-1])
        now_s = begin_s + self.panel.advance(end_s - begin_s)
        frame = int(np.searchsorted(scene.time_s, now_s, side="right")) - 1
        with self.running.atomic():
            scene.show(max(frame, 0))
        self.panel.show(scene.caption(max(frame, 0)))

    def _poll(self) -> None:
        """Read the log if it has changed and ends with a whole line."""
        if not self.log.is_file():
            return
        status = self.log.stat()
        seen = (status.st_ino, status.st_size)
        if seen == self.seen or not _ends_a_line(self.log):
            return
        run, self.seen = read_run(self.log), seen
        if run.steps:
            self._take(run)

    def _take(self, run: Run) -> None:
        if self.source is None or self.scene is None or not _continues(run, self.source.run):
            self.source = replace(read_run_source(self.log.parent), run=run)
            self.curves = curves_of(run.steps, RATE_HZ)
            self.running.scene.reset()
            self.scene = RunScene(self.running.scene, self.source, timeline(self.source, self.curves))
            self.panel.look_from(self.scene.cameras())
            return
        self.source = replace(self.source, run=run)
        self.curves += curves_of(run.steps[len(self.curves) :], RATE_HZ)
        self.scene.grow(self.source, timeline(self.source, self.curves))


def _ends_a_line(log: Path) -> bool:
    with log.open("rb") as stream:
        stream.seek(0, 2)
        if stream.tell() == 0:
            return False
        stream.seek(-1, 2)
        return stream.read() == b"\n"


def _continues(run: Run, before: Run) -> bool:
    """Return whether a log is a longer state of another one, not one that replaced it."""
    return run.header == before.header and run.steps[: len(before.steps)] == before.steps


def follow(run_dir: Path, port: int | None, say: Any) -> None:
    """Serve a run while its log grows, until the process is interrupted.

    Args:
        run_dir: the folder of the run.
        port: to listen on; None takes any free one.
        say: is told where the view is.

    Raises:
        BackendMissing: viser is not installed.
        InputError: there is no run, or the port is in use.
    """
    if not (run_dir / "run.jsonl").is_file():
        raise InputError("does not exist; --follow needs the folder of a run (run.jsonl)", source=run_dir / "run.jsonl")
    with serving(run_dir, port) as (address, view):
        say(address)
        view.run(threading.Event())
