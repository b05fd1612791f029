"""The command line: one short file per command.

Exit codes: 0 yes, 1 no (unrealizable, violated, mission not reached), 2 bad input, 3 unknown (a limit was reached),
4 our bug, 130 interrupted.
Nothing heavy is imported before a command needs it, so that ``surefoot --help`` answers at once.
"""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from typing import NoReturn

GARBAGE_AFTER = 50_000
"""Objects made before the youngest are looked through for garbage; Python's own number is 700."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code.

    Args:
        arguments: what stands after ``surefoot``; None takes them from the process.
    """
    # What is imported stays; to look through it for garbage again and again takes a tenth of a short command.
    gc.set_threshold(GARBAGE_AFTER)
    from surefoot.cli.failures import explained

    given = list(sys.argv[1:] if arguments is None else arguments)
    with explained(as_json="--json" in given) as outcome:
        from surefoot.cli.commands import app

        outcome.code = int(app(args=given or ["--help"], prog_name="surefoot", standalone_mode=False) or 0)
    if arguments is None and _still_working():
        _leave(outcome.code)
    return outcome.code


def _still_working() -> bool:
    """Return whether a solving thread was left behind, by a time limit or an interruption."""
    attempts = sys.modules.get("surefoot.games.attempts")
    return attempts is not None and bool(attempts.left_behind())


def _leave(code: int) -> NoReturn:
    """End the process without the interpreter's farewell, under which a thread in compiled code would crash."""
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError):
            stream.flush()
    os._exit(code)
