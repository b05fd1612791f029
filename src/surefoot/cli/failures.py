"""From exceptions to one line on standard error and an exit code; a traceback only when it is asked for."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from enum import IntEnum

import typer

from surefoot.errors import AssumptionViolated, BackendMissing, InputError, LimitExceeded, UnsafeStepError


class ExitCode(IntEnum):
    """What the process tells the shell."""

    YES = 0
    NO = 1
    BAD_INPUT = 2
    UNKNOWN = 3
    INTERNAL = 4
    INTERRUPTED = 130


@dataclass(slots=True)
class Outcome:
    """The exit code that a command ended with."""

    code: int = ExitCode.YES


@contextmanager
def explained(*, as_json: bool) -> Iterator[Outcome]:
    """Turn whatever a command raises into a message and an exit code.

    Args:
        as_json: whether the message is an object on standard output instead of a line on standard error.
    """
    outcome = Outcome()
    try:
        yield outcome
        if outcome.code == ExitCode.INTERRUPTED:  # typer turns the signal into this exit code
            _say_interrupted(as_json=as_json)
    except KeyboardInterrupt:
        outcome.code = _say_interrupted(as_json=as_json)
    except BrokenPipeError:
        # Whoever read our output has gone; point it elsewhere, or the interpreter complains when it flushes at its end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except Exception as problem:
        if os.environ.get("SUREFOOT_DEBUG") == "1":
            raise
        code = _code_of(problem)
        outcome.code = _say(_message_of(problem, code), code, as_json=as_json)


def _code_of(problem: Exception) -> ExitCode:
    if isinstance(problem, typer.Abort):
        return ExitCode.INTERRUPTED
    if isinstance(problem, InputError | BackendMissing | typer.TyperException) or _concerns_a_file(problem):
        return ExitCode.BAD_INPUT
    if isinstance(problem, LimitExceeded | MemoryError):
        return ExitCode.UNKNOWN
    if isinstance(problem, UnsafeStepError | AssumptionViolated):
        return ExitCode.NO
    return ExitCode.INTERNAL


def _concerns_a_file(problem: Exception) -> bool:
    return isinstance(problem, OSError) and problem.filename is not None and problem.strerror is not None


def _message_of(problem: Exception, code: ExitCode) -> str:
    if isinstance(problem, typer.Abort):
        return "interrupted"
    if isinstance(problem, typer.TyperException):
        return _usage(problem)
    if isinstance(problem, OSError) and _concerns_a_file(problem):
        return f"{problem.filename}: {problem.strerror}"
    if isinstance(problem, MemoryError):
        return "the memory limit was reached"
    if code is ExitCode.INTERNAL:
        what = " ".join(str(problem).split())
        return (
            f"sorry, this is a bug in Surefoot ({type(problem).__name__}: {what[:300]}); "
            "run the command again with SUREFOOT_DEBUG=1 in the environment to see the traceback, and report it"
        )
    return str(problem)


def _usage(problem: typer.TyperException) -> str:
    message = problem.format_message() if hasattr(problem, "format_message") else str(problem)
    context = getattr(problem, "ctx", None)
    hint = f" (try: {context.command_path} --help)" if context is not None else ""
    return f"{' '.join(message.split())}{hint}"


def _say_interrupted(*, as_json: bool) -> int:
    if as_json:
        return _say("interrupted", ExitCode.INTERRUPTED, as_json=True)
    print("interrupted", file=sys.stderr)
    return int(ExitCode.INTERRUPTED)


def _say(message: str, code: ExitCode, *, as_json: bool) -> int:
    if as_json:
        print(json.dumps({"error": message, "exit_code": int(code)}))
    else:
        print("\n".join(f"error: {line}" for line in message.splitlines()), file=sys.stderr)
    return int(code)
