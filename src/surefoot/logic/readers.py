"""Readers of specification files: slugsin and structuredslugs."""

from __future__ import annotations

import hashlib
from pathlib import Path

from surefoot.errors import InputError
from surefoot.logic.infix import parse_infix
from surefoot.logic.prefix import parse_prefix
from surefoot.logic.sections import LARGEST_CHARACTERS, outline, specification
from surefoot.logic.syntax import Specification

_INFIX_ONLY = ("->", "=", "(", ")", "/\\", "\\/", "+", "<", ">", "...", ":")


def read_specification(path: Path) -> Specification:
    """Read a specification; its suffix tells the format, and where it does not, its content.

    Raises:
        InputError: the file cannot be read, is too large, or something in it is wrong; with line and column.
    """
    data = _bytes(path)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as problem:
        line = data.count(b"\n", 0, problem.start) + 1
        raise InputError("is no text in UTF-8", source=path, line=line) from problem
    sha256 = hashlib.sha256(data).hexdigest()
    if path.suffix == ".slugsin" or (path.suffix != ".structuredslugs" and not _needs_infix(text)):
        return parse_slugsin(text, path, sha256=sha256)
    return parse_structuredslugs(text, path, sha256=sha256)


def parse_slugsin(text: str, source: Path | None = None, *, sha256: str = "") -> Specification:
    """Return the specification of a slugsin text (prefix notation, Boolean variables).

    Raises:
        InputError: with line and column.
    """
    return specification(outline(text, source), parse_prefix, integers=False, sha256=sha256)


def parse_structuredslugs(text: str, source: Path | None = None, *, sha256: str = "") -> Specification:
    """Return the specification of a structuredslugs text (infix notation, Booleans and integers).

    Raises:
        InputError: with line and column.
    """
    return specification(outline(text, source), parse_infix, integers=True, sha256=sha256)


def _needs_infix(text: str) -> bool:
    """Return whether a text has something that prefix notation lacks."""
    code = "\n".join(line.split("#", 1)[0] for line in text.split("\n"))
    return any(symbol in code for symbol in _INFIX_ONLY)


def _bytes(path: Path) -> bytes:
    try:
        if not path.is_file():
            raise InputError("is no file" if path.exists() else "does not exist", source=path)
        if path.stat().st_size > LARGEST_CHARACTERS:
            raise InputError(f"is too large; at most {LARGEST_CHARACTERS} bytes are read", source=path)
        return path.read_bytes()
    except (OSError, ValueError) as problem:
        raise InputError("cannot be read", source=path) from problem
