"""A run as it is walked: the scene of its replay, served to this machine's browsers while the log grows."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from surefoot.missions.biped.run_log import MAX_LINE
from surefoot.viewer.browser.page import HOST, server
from surefoot.viewer.browser.recording import Moving
from surefoot.viewer.live.logs import Growing, growing
from surefoot.viewer.live.look import LookPanel
from surefoot.viewer.live.panel import LivePanel
from surefoot.viewer.sources.timeline import RATE_HZ

_TICK_S = 1 / RATE_HZ
_POLL_S = 0.4
_READING_SHARE = 0.25
"""Of the time, at most this much is spent on reading a log again."""

State = tuple[int, int, int] | None


def state_of(log: Path) -> State:
    """Return what changes whenever a log does; None when there is none."""
    if not log.is_file():
        return None
    status = log.stat()
    return status.st_ino, status.st_size, status.st_mtime_ns


@contextmanager
def serving(run_dir: Path, port: int | None, ignored: State = None) -> Iterator[tuple[str, LiveView]]:
    """Yield the address of a live view of a run, and the view, which shows something once it runs.

    Args:
        run_dir: the folder of the run; its log may still be missing.
        port: to listen on; None takes any free one.
        ignored: the state of an older log in that folder, which is not shown.

    Raises:
        BackendMissing: viser is not installed.
        InputError: the port is in use.
    """
    with server(port) as running:
        yield f"http://{HOST}:{running.get_port()}", LiveView(running, run_dir, ignored)


class LiveView:
    """Follows a log and shows it.

    Args:
        running: a viser server.
        run_dir: the folder of the run.
        ignored: the state of an older log in that folder, which is not shown.
    """

    def __init__(self, running: Any, run_dir: Path, ignored: State = None) -> None:
        self.running, self.log = running, run_dir / "run.jsonl"
        self.seen = ignored
        self.growing: Growing | None = None
        self.moving: Moving | None = None
        self.panel, self.look = LivePanel(running), LookPanel(running)

    def run(self, stop: threading.Event) -> None:
        """Follow and show until a stop is asked for.

        Raises:
            InputError: the log holds something else than a run.
        """
        next_poll_s = 0.0
        while not stop.is_set():
            began_s = time.monotonic()
            if began_s >= next_poll_s:
                self.poll()
                read_s = time.monotonic() - began_s
                next_poll_s = began_s + max(_POLL_S, read_s / _READING_SHARE)
            if self.moving is not None:
                self._show(self.moving)
            stop.wait(max(0.0, _TICK_S - (time.monotonic() - began_s)))

    def _show(self, moving: Moving) -> None:
        begin_s, end_s = float(moving.time_s[0]), float(moving.time_s[-1])
        now_s = begin_s + self.panel.advance(end_s - begin_s)
        frame = max(int(np.searchsorted(moving.time_s, now_s, side="right")) - 1, 0)
        with self.running.atomic():
            moving.show(frame)
        self.panel.say(moving.caption(frame))
        self.look.go_along()

    def poll(self) -> None:
        """Read the log if it has changed.

        Raises:
            InputError: it holds something else than a run.
        """
        seen = state_of(self.log)
        if seen is None or seen == self.seen or not _begun(self.log):
            return
        self.growing, self.seen = growing(self.log, self.growing), seen
        moving, before = self.growing.read(self.running.scene), self.moving
        self.moving = moving
        if moving is None:
            self.panel.wait()
        elif moving is not before:
            self.look.look_from(moving.cameras)


def _begun(log: Path) -> bool:
    """Return whether the first line of a log is whole."""
    with log.open("rb") as stream:
        return stream.readline(MAX_LINE).endswith(b"\n")


def follow(run_dir: Path, port: int | None, say: Callable[[str], None]) -> None:
    """Serve a run while its log grows, until the process is interrupted.

    Args:
        run_dir: the folder of the run.
        port: to listen on; None takes any free one.
        say: is told where the view is.

    Raises:
        BackendMissing: viser is not installed.
        InputError: the log cannot be read, or the port is in use.
    """
    with serving(run_dir, port) as (address, view):
        view.poll()
        say(address)
        view.run(threading.Event())
