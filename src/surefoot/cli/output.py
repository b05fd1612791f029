"""What commands print: one JSON object, or a few aligned lines; progress goes to standard error."""

from __future__ import annotations

import dataclasses
import json
import math
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer

from surefoot.cli.failures import ExitCode

AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output, and nothing else.")]
Say = Callable[[str], None]
PICTURES = (".png",)


def to_write(*suffixes: str) -> Callable[[Path | None], Path | None]:
    """Return what looks at an option that names a file to write, before any work is done.

    Args:
        suffixes: that the file may have; none means any.
    """

    def looked_at(path: Path | None) -> Path | None:
        if path is not None:
            from surefoot.compute import check_writable

            check_writable(path, suffixes)
        return path

    return looked_at


def apart(*paths: Path | None) -> None:
    """Refuse, before any work is done, a file to write that is one to read, or to write otherwise.

    Args:
        paths: of the file that is read, then of those that are written; None: not wished for.
    """
    seen: set[Path] = set()
    for path in (path for path in paths if path is not None):
        if path.resolve() in seen:
            from surefoot.errors import InputError

            raise InputError("is named twice, and what it holds would be lost; choose another name", source=path)
        seen.add(path.resolve())


def answer(value: object, lines: Sequence[str], *, yes: bool, as_json: bool) -> None:
    """Print an answer and end the command with exit code 0 or 1.

    Args:
        value: a dataclass or a mapping, for the JSON object.
        lines: the same for a person.
        yes: whether the answer is yes.
        as_json: which of the two is wanted.
    """
    print(json.dumps(jsonable(value)) if as_json else "\n".join(lines))
    raise typer.Exit(int(ExitCode.YES if yes else ExitCode.NO))


def counted(number: int, noun: str) -> str:
    """Return a number with its noun, in the plural unless it is 1."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


def facts(pairs: Mapping[str, object]) -> list[str]:
    """Return one line per fact, with the values in one column."""
    width = max((len(name) for name in pairs), default=0)
    return [f"  {name:<{width}}  {_written(value)}" for name, value in pairs.items()]


def _written(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.3g}" if abs(value) < 100 else f"{value:.0f}"
    if isinstance(value, tuple | list):
        return ", ".join(map(_written, value)) or "none"
    return str(value)


def jsonable(value: Any) -> Any:
    """Return a value made of what JSON knows; what is not finite becomes null."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {field.name: jsonable(getattr(value, field.name)) for field in dataclasses.fields(value)}
    if isinstance(value, Mapping):
        return {str(key): jsonable(inner) for key, inner in value.items()}
    if isinstance(value, tuple | list):
        return [jsonable(inner) for inner in value]
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    if value is None or isinstance(value, str | bool | int):
        return value
    if hasattr(value, "tolist"):
        return jsonable(value.tolist())
    return str(value) if isinstance(value, Path) else repr(value)


@contextmanager
def progress() -> Iterator[Say]:
    """Yield a function that tells what is being done, on standard error.

    On a terminal the last message stays beside a spinner; elsewhere each message is a line.
    """
    if not sys.stderr.isatty():
        yield lambda message: print(message, file=sys.stderr, flush=True)
        return
    from rich.console import Console

    console = Console(stderr=True)
    with console.status("starting") as status:

        def say(message: str) -> None:
            console.print(f"[dim]{message}[/dim]", highlight=False)
            status.update(message)

        yield say
