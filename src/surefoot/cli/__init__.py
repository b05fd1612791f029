"""The command line: one short file per command.

Exit codes: 0 yes, 1 no (unrealizable, violated, mission not reached), 2 bad input, 3 unknown (a limit was reached),
4 our bug.
Nothing heavy is imported before a command needs it, so that ``surefoot --help`` answers at once.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code.

    Args:
        arguments: what stands after ``surefoot``; None takes them from the process.
    """
    from surefoot.cli.failures import explained

    given = list(sys.argv[1:] if arguments is None else arguments)
    with explained(as_json="--json" in given) as outcome:
        from surefoot.cli.commands import app

        outcome.code = int(app(args=given or ["--help"], prog_name="surefoot", standalone_mode=False) or 0)
    return outcome.code
