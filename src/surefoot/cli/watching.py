"""``surefoot run --view``: the live view of a run beside the run itself."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import typer

from surefoot.errors import InputError


@contextmanager
def watched(run_dir: Path, port: int | None, *, wanted: bool) -> Iterator[None]:
    """Serve what is walked inside to this machine's browsers, and after the answer go on until Ctrl-C.

    Args:
        run_dir: the folder of the run that the block walks.
        port: to listen on; None takes any free one.
        wanted: whether there is a live view at all.

    Raises:
        InputError: a port is given without a view, or it is in use.
    """
    if not wanted:
        if port is not None:
            raise InputError("--port belongs to --view; give both or only --view")
        yield
        return
    from surefoot.viewer.live.beside import watching

    with watching(run_dir, port) as view:
        print(f"open {view.address} with a browser of this machine", file=sys.stderr, flush=True)
        try:
            yield
        except typer.Exit:
            sys.stdout.flush()
            with suppress(KeyboardInterrupt):
                print("the view goes on until Ctrl-C", file=sys.stderr, flush=True)
                view.wait()
            raise
