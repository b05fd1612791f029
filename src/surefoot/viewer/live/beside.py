"""A live view beside a run: in a process of its own, so that walking and planning are not slowed down by drawing."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from importlib.util import find_spec
from multiprocessing.connection import Connection
from pathlib import Path

from surefoot.errors import BackendFailed, BackendMissing, InputError
from surefoot.viewer.browser.page import INSTALL, free_port
from surefoot.viewer.live.view import State, serving, state_of

_NICE = 10
_LEAVE_S = 5.0
_AGAIN_S = 0.4


@dataclass(frozen=True, slots=True)
class Beside:
    """A live view that runs.

    Attributes:
        address: of its page.
        process: that serves it.
    """

    address: str
    process: multiprocessing.process.BaseProcess

    def wait(self) -> None:
        """Return when the view has ended."""
        self.process.join()


@contextmanager
def watching(run_dir: Path, port: int | None) -> Iterator[Beside]:
    """Yield a live view that runs beside the caller, and end it with the block.

    Args:
        run_dir: the folder of the run that the caller is about to walk; a log that is there already is not shown.
        port: to listen on; None takes any free one.

    Raises:
        BackendMissing: viser is not installed.
        InputError: the port is in use.
    """
    if find_spec("viser") is None:
        raise BackendMissing("viser", INSTALL)
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe()
    arguments = (run_dir, free_port(port), state_of(run_dir / "run.jsonl"), there)
    process = context.Process(target=_serve, args=arguments, daemon=True)
    _start(process)
    there.close()
    try:
        yield Beside(_address(here), process)
    finally:
        here.close()
        process.join(_LEAVE_S)
        if process.is_alive():
            process.terminate()
            process.join()


def _start(process: multiprocessing.process.BaseProcess) -> None:
    """Start a process that Ctrl-C does not end: it inherits what its parent ignores, from its first instruction on.

    Only the main thread, to which Ctrl-C comes, may say what is ignored.
    """
    if threading.current_thread() is not threading.main_thread():
        process.start()
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        process.start()
    finally:
        signal.signal(signal.SIGINT, before)


def _address(pipe: Connection) -> str:
    try:
        return str(pipe.recv())
    except EOFError as problem:
        raise BackendFailed("the live view did not start; try `surefoot view RUN --follow` beside the run") from problem


def _serve(run_dir: Path, port: int, ignored: State, pipe: Connection) -> None:
    """Serve until the other end of the pipe is closed; Ctrl-C is left to the caller."""
    os.nice(_NICE)
    stop = threading.Event()
    with serving(run_dir, port, ignored) as (address, view):
        pipe.send(address)
        threading.Thread(target=_wait_for_the_end, args=(pipe, stop), daemon=True).start()
        while not stop.is_set():
            with suppress(InputError):  # what is in the folder is no run yet, or none any more
                view.run(stop)
            stop.wait(_AGAIN_S)


def _wait_for_the_end(pipe: Connection, stop: threading.Event) -> None:
    with suppress(EOFError, OSError):
        pipe.recv()
    stop.set()
