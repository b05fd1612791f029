"""The prefix notation of slugsin: ``! & | ^ 0 1``, primes, and buffers ``$ N f0 .. fN-1`` with references ``? i``."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from surefoot.logic.building import FALSE, TRUE, Draft, finished, join
from surefoot.logic.sections import LARGEST_TOKENS, Line, Place, Scope
from surefoot.logic.syntax import NAME, Atom, Expression, Node, Not

_WORD = re.compile(r"[!&|^$?]|[^\s!&|^$?]+")
_OPERATORS = "operators are ! & | ^ $ ?"


@dataclass(slots=True)
class Frame:
    """An operator that waits for operands.

    Attributes:
        symbol: ``! & | ^`` or ``$``.
        place: where it stands.
        wanted: how many operands it takes.
        drafts: what has been read; for a buffer its finished entries.
    """

    symbol: str
    place: Place
    wanted: int
    drafts: list[Draft] = field(default_factory=list)


def looks_prefix(text: str) -> bool:
    """Return whether a line, after negations, begins with a binary operator: only prefix notation does."""
    rest = text.lstrip("! \t")
    return rest[:1] in ("&", "|", "^", "$") and rest[:2] not in ("&&", "||")


def parse_prefix(line: Line, scope: Scope) -> Expression:
    """Return the expression of one line in prefix notation.

    Raises:
        InputError: with line and column.
    """
    reader = _Reader(line, scope)
    draft = reader.read()
    return finished(draft)  # type: ignore[return-value]


class _Reader:
    """Reads one line token by token, with a stack of operators instead of recursion."""

    def __init__(self, line: Line, scope: Scope) -> None:
        words = list(_WORD.finditer(line.text))
        if len(words) > LARGEST_TOKENS:
            raise line.place.error(f"the line is too long; at most {LARGEST_TOKENS} symbols are read")
        self.words = words
        self.line = line
        self.scope = scope
        self.position = 0
        self.frames: list[Frame] = []
        self.buffers: list[Frame] = []

    def read(self) -> Draft:
        """Return the whole line as one operand."""
        while self.position < len(self.words):
            place, word = self.place(), self.next()
            if word in "!&|^":
                self.frames.append(Frame(word, place, 1 if word == "!" else 2))
            elif word == "$":
                self.open_buffer(place)
            else:
                whole = self.give(self.operand(word, place))
                if whole is not None:
                    return self.end(whole)
        if not self.frames:
            raise self.line.place.error("an expression is missing")
        frame = self.frames[-1]
        raise frame.place.error(f"{frame.symbol!r} takes {frame.wanted} operands, but {len(frame.drafts)} follow")

    def place(self) -> Place:
        """Return where the next word stands."""
        start = self.words[self.position].start() if self.position < len(self.words) else len(self.line.text)
        return Place(self.line.place.source, self.line.place.line, self.line.place.column + start)

    def next(self) -> str:
        """Return the next word and step over it."""
        self.position += 1
        return self.words[self.position - 1].group()

    def number(self, what: str) -> int:
        """Return the number that follows."""
        place = self.place()
        word = self.next() if self.position < len(self.words) else ""
        if not re.fullmatch(r"[0-9]{1,9}", word):
            raise place.error(f"{what}, not {word[:60]!r}")
        return int(word)

    def open_buffer(self, place: Place) -> None:
        """Begin a buffer."""
        size = self.number("$ takes the number of its entries")
        if size < 1:
            raise place.error("a buffer has at least one entry")
        frame = Frame("$", place, size)
        self.frames.append(frame)
        self.buffers.append(frame)

    def operand(self, word: str, place: Place) -> Node:
        """Return a constant, a variable or an entry of the innermost buffer."""
        if word in ("0", "1"):
            return TRUE if word == "1" else FALSE
        if word == "?":
            return self.entry(place)
        primed = word.endswith("'")
        name = word[:-1] if primed else word
        if not NAME.fullmatch(name):
            raise place.error(f"{word[:60]!r} is neither an operator, a constant nor a name; {_OPERATORS}")
        found = self.scope.variable(name, primed, place)
        if not isinstance(found, Atom):
            raise place.error(f"{name} is an integer; prefix notation uses its bits, such as {name}@1")
        return found

    def entry(self, place: Place) -> Node:
        """Return an earlier entry of the innermost buffer."""
        index = self.number("? takes the number of an earlier entry of its buffer")
        if not self.buffers:
            raise place.error("? stands outside a buffer; buffers begin with $")
        known = len(self.buffers[-1].drafts)
        if index >= known:
            kind = "cyclic" if index == known else "forward"
            allowed = f"entries 0 .. {known - 1}" if known else "none yet"
            raise place.error(f"? {index} is a {kind} reference; allowed here are earlier entries: {allowed}")
        return finished(self.buffers[-1].drafts[index])

    def give(self, draft: Draft) -> Draft | None:
        """Hand an operand to the operators that wait; return the whole expression once none does."""
        while self.frames:
            frame = self.frames[-1]
            frame.drafts.append(finished(draft) if frame.symbol == "$" else draft)
            if len(frame.drafts) < frame.wanted:
                return None
            self.frames.pop()
            draft = self.close(frame)
        return draft

    def close(self, frame: Frame) -> Draft:
        """Return the value of an operator that has all its operands."""
        if frame.symbol == "$":
            self.buffers.pop()
            return frame.drafts[-1]
        if frame.symbol == "!":
            return Not(finished(frame.drafts[0]))  # type: ignore[arg-type]
        return join(frame.symbol, frame.drafts[0], frame.drafts[1])

    def end(self, whole: Draft) -> Draft:
        """Refuse what follows a complete expression."""
        if self.position < len(self.words):
            word = self.words[self.position].group()
            raise self.place().error(f"{word[:60]!r} follows a complete expression; one line holds one expression")
        return whole
