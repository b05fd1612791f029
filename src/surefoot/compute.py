"""Deadlines, artefacts that are written whole or not at all, and hashes of inputs."""

from __future__ import annotations

import hashlib
import multiprocessing
import os
import resource
import signal
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, Future, ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, TypeVar

from surefoot.errors import InputError, LimitExceeded

T = TypeVar("T")
R = TypeVar("R")


@dataclass(frozen=True, slots=True)
class Deadline:
    """A point in time after which work is given up.

    Attributes:
        end_s: on the monotonic clock; infinite means no deadline.
    """

    end_s: float = float("inf")

    @classmethod
    def after(cls, seconds: float | None) -> Deadline:
        """Return the deadline that many seconds from now; None means none."""
        return cls() if seconds is None else cls(time.monotonic() + seconds)

    @property
    def left_s(self) -> float | None:
        """Seconds that are left, at least 0; None without a deadline."""
        return None if self.end_s == float("inf") else max(self.end_s - time.monotonic(), 0.0)

    def check(self, work: str) -> None:
        """Raise LimitExceeded, naming the work, once the time is over."""
        if time.monotonic() > self.end_s:
            raise LimitExceeded(f"{work}: the time limit was reached")


@contextmanager
def process_pool(workers: int | None = None, *, preload: Sequence[str] = ()) -> Iterator[Executor]:
    """Yield an executor over processes; whatever still runs at the end of the block is stopped.

    Args:
        workers: how many processes; None means one per core that this process may use.
        preload: modules that are imported once for all workers, where no pool of this process was used before.
    """
    count = workers or len(os.sched_getaffinity(0))
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(list(preload))
    pool = ProcessPoolExecutor(count, context, _begin_work)
    try:
        yield pool
    finally:
        started, manager = list((pool._processes or {}).values()), pool._executor_manager_thread
        pool.shutdown(wait=False, cancel_futures=True)
        for process in started:
            process.terminate()
        if manager is not None:
            # Where it still runs when Python ends, Python may print a traceback. Typeshed has another class.
            manager.join()  # type: ignore[attr-defined]


def _begin_work() -> None:
    """Leave interruption and messages to the parent: what fails is an answer to it, and it stops its workers.

    A worker that is stopped, or whose parent has gone, would print tracebacks of the pool's own plumbing.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if os.environ.get("SUREFOOT_DEBUG") != "1":
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2)


def each_answer(
    executor: Executor, function: Callable[[T], R], items: Sequence[T], deadline: Deadline
) -> Iterator[tuple[int, R | None]]:
    """Yield the index of every item with its answer, as soon as each is known; None for what the deadline left open.

    Args:
        executor: any; ``process_pool()`` yields one, and so does a Dask client.
        function: of one item; it and the items have to be picklable.
        items: what to ask about.
        deadline: after it, what is not answered is given up.
    """
    places: dict[Future[R], int] = {executor.submit(function, item): index for index, item in enumerate(items)}
    try:
        for future in as_completed(places, timeout=deadline.left_s):
            yield places.pop(future), future.result()
    except TimeoutError:
        for future, index in sorted(places.items(), key=lambda pair: pair[1]):
            future.cancel()
            yield index, None


def check_writable(path: Path, suffixes: Sequence[str] = ()) -> None:
    """Refuse, before long work, a file that could not be written after it; nothing is made.

    Args:
        path: of the file.
        suffixes: one of which its name has to end with; empty where any will do.

    Raises:
        InputError: if it is a folder, has another suffix, or its folder cannot be written to or made.
    """
    if suffixes and path.suffix.lower() not in suffixes and not path.is_dir():
        raise InputError(f"has to end with {' or '.join(suffixes)}", source=path)
    if path.is_dir():
        raise InputError("is a folder; name a file", source=path)
    there = next(parent for parent in path.resolve().parents if parent.exists())
    if not there.is_dir() or not os.access(there, os.W_OK | os.X_OK):
        raise InputError(f"cannot be written: {there} is no folder that you may write to", source=path)


@contextmanager
def written_whole(path: Path) -> Iterator[IO[bytes]]:
    """Open a file that appears under its name only when the block ends without an error.

    Args:
        path: where the artefact belongs; its folder is made if it is missing.

    Raises:
        InputError: if it is a folder, or cannot be written.
    """
    if path.is_dir():
        raise InputError("is a folder; name a file", source=path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    except OSError as problem:
        raise InputError(f"cannot be written: {problem.strerror}", source=path) from problem
    temporary = Path(name)
    try:
        with os.fdopen(handle, "wb") as stream:
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
        temporary.chmod(0o644)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def write_text_whole(path: Path, text: str) -> None:
    """Write a text file whole or not at all."""
    with written_whole(path) as stream:
        stream.write(text.encode())


def sha256_of(path: Path) -> str:
    """Return the SHA-256 of a file as 64 hexadecimal digits."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def peak_memory_mb() -> float:
    """Return the largest resident size that this process has had [MB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e6
