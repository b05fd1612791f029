"""What the two slugs formats share: sections, declarations, comments, and which variables a section may use."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from surefoot.errors import InputError
from surefoot.logic.building import Leaves
from surefoot.logic.syntax import NAME, SECTIONS, Atom, Conjunct, Expression, Integer, Specification, Variable

LARGEST_CHARACTERS = 8_000_000
LARGEST_TOKENS = 1_000_000
MOST_LINES = 400_000
LARGEST_VALUE = 2**31 - 1
RESERVED = frozenset({"TRUE", "FALSE"})
_HEADER = re.compile(r"\[\s*([A-Za-z0-9_ ]*)\s*\]")
_INTEGER = re.compile(r"([^\s:]+)\s*:\s*(-?[0-9]{1,12})\s*\.\.\.\s*(-?[0-9]{1,12})")
_DECLARING = ("INPUT", "OUTPUT")


@dataclass(frozen=True, slots=True)
class Place:
    """Where in a file something stands, lines and columns counted from 1."""

    source: Path | None
    line: int
    column: int = 1

    def error(self, message: str) -> InputError:
        """Return the error that says what is wrong here."""
        return InputError(message, source=self.source or "specification", line=self.line, key=f"column {self.column}")


@dataclass(frozen=True, slots=True)
class Line:
    """A line of a section without its comment."""

    text: str
    place: Place


@dataclass(slots=True)
class Scope:
    """What an expression may mention: the declared variables, as far as the section allows them."""

    section: str
    inputs: dict[str, Variable]
    outputs: dict[str, Variable]
    bits: dict[str, str]
    leaves: Leaves

    def variable(self, name: str, primed: bool, place: Place) -> Atom | Integer:
        """Return the variable or the bit of that name.

        Raises:
            InputError: it is not declared, or may not stand in this section.
        """
        owner = self.bits.get(name, name)
        found = self.inputs.get(owner) or self.outputs.get(owner)
        if found is None:
            raise place.error(f"{name[:60]!r} is not declared; {self._declared()}")
        problem = misplaced(self.section, is_input=owner in self.inputs, primed=primed)
        if problem:
            raise place.error(f"{self.section} {problem}, and {name + (chr(39) if primed else '')} is none")
        if found.is_boolean or name in self.bits:
            return self.leaves.atom(name, primed)
        return self.leaves.integer(name, primed)

    def _declared(self) -> str:
        names = [*self.inputs, *self.outputs]
        return f"declared are: {', '.join(names[:8])}{', ...' if len(names) > 8 else ''}"


def misplaced(section: str, *, is_input: bool, primed: bool) -> str | None:
    """Return why a variable may not stand in a section; None when it may."""
    if section == "ENV_INIT" and (primed or not is_input):
        return "may use unprimed inputs only"
    if section == "SYS_INIT" and primed:
        return "may use unprimed variables only"
    if section in ("ENV_TRANS", "ENV_TRANS_HARD") and primed and not is_input:
        return "may use primed inputs and unprimed variables only"
    return None


ExpressionParser = Callable[[Line, Scope], Expression]


@dataclass(slots=True)
class Outline:
    """The lines of a file by section."""

    source: Path | None
    lines: dict[str, list[Line]] = field(default_factory=lambda: {name: [] for name in (*_DECLARING, *SECTIONS)})


def outline(text: str, source: Path | None) -> Outline:
    """Split a file into the lines of its sections.

    Raises:
        InputError: it is too large, or a line stands outside a known section.
    """
    if len(text) > LARGEST_CHARACTERS:
        raise Place(source, 1).error(f"the file is too large; at most {LARGEST_CHARACTERS} characters are read")
    if text.count("\n") >= MOST_LINES:
        raise Place(source, MOST_LINES).error(f"the file is too long; at most {MOST_LINES} lines are read")
    found = Outline(source)
    section: str | None = None
    for number, raw in enumerate(text.split("\n"), start=1):
        content = raw.split("#", 1)[0].rstrip()
        body = content.lstrip()
        if not body:
            continue
        place = Place(source, number, len(content) - len(body) + 1)
        header = _HEADER.fullmatch(body)
        if header and (header[1].strip() in found.lines or section in (None, *_DECLARING)):
            section = _known(header[1].strip(), found, place)
        elif section is None:
            raise place.error("stands before the first section; a file begins with a section such as [INPUT]")
        else:
            found.lines[section].append(Line(body, place))
    return found


def _known(name: str, found: Outline, place: Place) -> str:
    if name not in found.lines:
        raise place.error(f"[{name[:60]}] is no section; there are: {', '.join(found.lines)}")
    return name


def specification(found: Outline, parse: ExpressionParser, *, integers: bool, sha256: str) -> Specification:
    """Return the specification of an outline.

    Args:
        found: lines by section.
        parse: the expression of one line.
        integers: whether integers may be declared.
        sha256: hash of the file.

    Raises:
        InputError: something in it is wrong; the message names line and column.
    """
    taken: dict[str, Line] = {}
    inputs = [_declared(line, taken, integers=integers) for line in found.lines["INPUT"]]
    outputs = [_declared(line, taken, integers=integers) for line in found.lines["OUTPUT"]]
    if not inputs and not outputs:
        raise Place(found.source, 1).error("no variable is declared; [INPUT] and [OUTPUT] cannot both be empty")
    scope = _scope(inputs, outputs, taken)
    _refuse_unknown_sections(found, taken)
    sections: dict[str, tuple[Conjunct, ...]] = {}
    for name in SECTIONS:
        scope.section = name
        sections[name.lower()] = tuple(
            Conjunct(name, parse(line, scope), line.text, line.place.line, line.place.column)
            for line in found.lines[name]
        )
    return Specification(tuple(inputs), tuple(outputs), source=found.source, sha256=sha256, **sections)


def _refuse_unknown_sections(found: Outline, taken: dict[str, Line]) -> None:
    """Refuse what looks like a section and names neither one nor a variable in brackets."""
    for name in SECTIONS:
        for line in found.lines[name]:
            header = _HEADER.fullmatch(line.text)
            if header and header[1].strip() not in taken and header[1].strip() not in RESERVED:
                _known(header[1].strip(), found, line.place)


def _scope(inputs: list[Variable], outputs: list[Variable], taken: dict[str, Line]) -> Scope:
    bits = {bit: variable.name for variable in (*inputs, *outputs) if not variable.is_boolean for bit in variable.bits}
    for bit, owner in bits.items():
        if bit in taken:
            raise taken[bit].place.error(f"{bit} is the name of a bit of {owner} already")
    return Scope("", {v.name: v for v in inputs}, {v.name: v for v in outputs}, bits, Leaves())


def _declared(line: Line, taken: dict[str, Line], *, integers: bool) -> Variable:
    whole = _INTEGER.fullmatch(line.text)
    name = whole[1] if whole else line.text
    if not NAME.fullmatch(name):
        allowed = "a name, or a name with limits such as x:0...7" if integers else "a name"
        raise line.place.error(f"{line.text[:60]!r} declares nothing; allowed is {allowed}, one on each line")
    if whole and not integers:
        raise line.place.error("slugsin has Boolean variables only")
    if name in RESERVED:
        raise line.place.error(f"{name} is a constant and cannot be declared")
    if name in taken:
        raise line.place.error(f"{name} is declared already, in line {taken[name].place.line}")
    taken[name] = line
    if not whole:
        return Variable(name)
    lower, upper = int(whole[2]), int(whole[3])
    if lower > upper or max(abs(lower), abs(upper)) > LARGEST_VALUE:
        raise line.place.error(f"{name} has no value; the limits rise and lie within +-{LARGEST_VALUE}")
    return Variable(name, lower, upper)
