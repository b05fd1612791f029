"""Typed access to the values of an untrusted YAML or JSON file."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from surefoot.errors import InputError

LONGEST_LIST = 1_000_000
Rectangle = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Fields:
    """One mapping of a file, with the place where it stands.

    Attributes:
        values: the mapping.
        source: the file.
        place: dotted key of the mapping in the file, empty at the top.
        line: line of the file, for files of one record a line.
    """

    values: Mapping[str, object]
    source: Path
    place: str = ""
    line: int | None = None

    @classmethod
    def of(cls, value: object, source: Path, place: str = "", line: int | None = None) -> Fields:
        """Return a mapping as fields; anything else is bad input."""
        if not isinstance(value, dict) or not all(isinstance(key, str) for key in value):
            raise InputError("has to be a mapping with text keys", source=source, line=line, key=place or None)
        return cls(value, source, place, line)

    def wrong(self, name: str, allowed: str) -> InputError:
        """Return the error that says what is allowed under a key."""
        key = f"{self.place}.{name}" if self.place else name
        return InputError(allowed, source=self.source, line=self.line, key=key)

    def only(self, names: Iterable[str]) -> None:
        """Refuse every key that is not among the names."""
        known = tuple(names)
        for name in self.values:
            if name not in known:
                raise self.wrong(name, f"is not a known key; known here: {', '.join(known)}")

    def has(self, name: str) -> bool:
        """Return whether the key is there."""
        return name in self.values

    def get(self, name: str) -> object:
        """Return the value of a required key."""
        if name not in self.values:
            raise self.wrong(name, "is missing")
        return self.values[name]

    def number(self, name: str, default: float | None = None, *, least: float = -math.inf) -> float:
        """Return a finite number, not below ``least``."""
        if default is not None and name not in self.values:
            return default
        value = _number(self.get(name))
        if value is None or value < least:
            raise self.wrong(
                name, "has to be a finite number" + ("" if least == -math.inf else f", at least {least:g}")
            )
        return value

    def whole(self, name: str, default: int | None = None, *, least: int = -(2**31), most: int = 2**31) -> int:
        """Return a whole number in a range."""
        if default is not None and name not in self.values:
            return default
        value = self.get(name)
        if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
            raise self.wrong(name, f"has to be a whole number from {least} to {most}")
        return value

    def text(self, name: str, default: str | None = None, *, among: tuple[str, ...] = ()) -> str:
        """Return a text, if need be one among several."""
        if default is not None and name not in self.values:
            return default
        value = self.get(name)
        if not isinstance(value, str) or (among and value not in among):
            raise self.wrong(name, "has to be " + (f"one of {', '.join(among)}" if among else "a text"))
        return value

    def flag(self, name: str) -> bool:
        """Return true or false."""
        value = self.get(name)
        if not isinstance(value, bool):
            raise self.wrong(name, "has to be true or false")
        return value

    def items(self, name: str, *, optional: bool = False) -> list[object]:
        """Return a list."""
        if optional and name not in self.values:
            return []
        value = self.get(name)
        if not isinstance(value, list) or len(value) > LONGEST_LIST:
            raise self.wrong(name, "has to be a list")
        return value

    def numbers(
        self, name: str, count: int | None = None, default: tuple[float, ...] | None = None
    ) -> tuple[float, ...]:
        """Return a list of finite numbers, if need be of a given length."""
        if default is not None and name not in self.values:
            return default
        found = tuple(_number(value) for value in self.items(name))
        if (count is not None and len(found) != count) or None in found:
            raise self.wrong(name, f"has to be a list of {'' if count is None else f'{count} '}finite numbers")
        return tuple(value for value in found if value is not None)

    def wholes(self, name: str, count: int | None = None) -> tuple[int, ...]:
        """Return a list of whole numbers, if need be of a given length."""
        found = self.items(name)
        if (count is not None and len(found) != count) or not all(_is_whole(value) for value in found):
            raise self.wrong(name, f"has to be a list of {'' if count is None else f'{count} '}whole numbers")
        return tuple(value for value in found if isinstance(value, int))

    def point(self, name: str) -> tuple[float, float]:
        """Return a position [m]."""
        x, y = self.numbers(name, 2)
        return x, y

    def cell(self, name: str) -> tuple[int, int]:
        """Return a (row, column)."""
        row, column = self.wholes(name, 2)
        return row, column

    def cells(self, name: str) -> tuple[tuple[int, int], ...]:
        """Return a list of (row, column)."""
        found = []
        for pair in self.items(name):
            if not isinstance(pair, list) or len(pair) != 2 or not all(_is_whole(value) for value in pair):
                raise self.wrong(name, "has to be a list of [row, column]")
            found.append((int(pair[0]), int(pair[1])))
        return tuple(found)

    def lists_of_cells(self, name: str) -> tuple[tuple[tuple[int, int], ...], ...]:
        """Return a list of lists of (row, column)."""
        return tuple(part.cells(name) for part in self._parts(name))

    def lists_of_wholes(self, name: str) -> tuple[tuple[int, ...], ...]:
        """Return a list of lists of whole numbers."""
        return tuple(part.wholes(name) for part in self._parts(name))

    def _parts(self, name: str) -> list[Fields]:
        """Return the entries of a list, each under the list's name."""
        return [Fields({name: value}, self.source, self.place, self.line) for value in self.items(name)]

    def mapping(self, name: str, *, optional: bool = False) -> Fields:
        """Return a mapping inside this one."""
        value = {} if optional and name not in self.values else self.get(name)
        return Fields.of(value, self.source, f"{self.place}.{name}" if self.place else name, self.line)

    def mappings(self, name: str, *, optional: bool = False) -> list[Fields]:
        """Return a list of mappings inside this one."""
        place = f"{self.place}.{name}" if self.place else name
        found = self.items(name, optional=optional)
        return [Fields.of(value, self.source, f"{place}[{index}]", self.line) for index, value in enumerate(found)]

    def rectangle(self, name: str) -> Rectangle:
        """Return two opposite corners, x0, y0, x1, y1 [m]."""
        x0, y0, x1, y1 = self.numbers(name, 4)
        return x0, y0, x1, y1

    def rectangles(self, name: str) -> tuple[Rectangle, ...]:
        """Return a list of rectangles."""
        place = f"{self.place}.{name}" if self.place else name
        return tuple(
            Fields({f"[{index}]": value}, self.source, place, self.line).rectangle(f"[{index}]")
            for index, value in enumerate(self.items(name))
        )


def _number(value: object) -> float | None:
    """Return a finite number; a text such as 1e-3 is one in YAML 1.2."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return None
    try:
        found = float(value)
    except (ValueError, OverflowError):
        return None
    return found if math.isfinite(found) else None


def _is_whole(value: object) -> bool:
    """Return whether a value is a whole number of moderate size."""
    return isinstance(value, int) and not isinstance(value, bool) and abs(value) < 2**31
