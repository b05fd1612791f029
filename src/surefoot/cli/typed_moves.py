"""Moves that a person types: ``door=1 x=3``."""

from __future__ import annotations

from collections.abc import Sequence


def values_typed(line: str, known: Sequence[str]) -> tuple[dict[str, int], str]:
    """Return the values that a line names; and a sentence if it is no move, otherwise nothing.

    Args:
        line: words such as ``x=3`` or ``door``, parted by spaces or commas.
        known: the variables that may occur.
    """
    wanted: dict[str, int] = {}
    for word in line.replace(",", " ").split():
        name, _, value = word.partition("=")
        number = {"": 1, "true": 1, "false": 0}.get(value.lower())
        if number is None:
            try:
                number = int(value)
            except ValueError:
                return {}, f"{word} is no move; write name=value, such as door=1"
        wanted[name] = number
    for name in wanted:
        if name not in known:
            return {}, f"{name} is no variable; there are: {', '.join(known)}"
    return wanted, ""
