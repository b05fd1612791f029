"""``surefoot run --view``: the live view of a run beside the run itself."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import typer


@contextmanager
def watched(run_dir: Path, port: int | None, *, wanted: bool) -> Iterator[None]:
    """Serve what is walked inside to this machine's browsers, and after the answer go on until Ctrl-C.

    Args:
        run_dir: the folder of the run that the block walks.
        port: to listen on; None takes any free one.
        wanted: whether there is a live view at all.
    """
    if not wanted:
        yield
        return
    from surefoot.viewer.live import watching

    with watching(run_dir, port) as address:
        print(f"open {address} with a browser of this machine", file=sys.stderr, flush=True)
        try:
            yield
        except typer.Exit:
            sys.stdout.flush()
            with suppress(KeyboardInterrupt):
                print("the view goes on until Ctrl-C", file=sys.stderr, flush=True)
                while True:
                    time.sleep(3600)
            raise
