"""The infix notation of structuredslugs, by operator precedence.

From high to low: ``+``; comparisons; ``!`` and next; ``U W`` (not supported); ``&``; ``|``; ``^``; ``->``; ``<->``. All
binary operators associate to the left, ``->`` too, as in slugs: ``a -> b -> c`` is ``(a -> b) -> c``.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from surefoot.logic.building import FALSE, TRUE, Draft, finished, join
from surefoot.logic.prefix import looks_prefix, parse_prefix
from surefoot.logic.sections import LARGEST_TOKENS, LARGEST_VALUE, Line, Place, Scope, misplaced
from surefoot.logic.syntax import (
    COMPARISONS,
    NAME_PATTERN,
    And,
    Atom,
    Comparison,
    Constant,
    Expression,
    Iff,
    Implies,
    Integer,
    Node,
    Not,
    Number,
    Or,
    Sum,
    Variable,
    Xor,
    children,
    postorder,
)

_TOKEN = re.compile(
    rf"(?P<space>\s+)|(?P<name>{NAME_PATTERN}'?)|(?P<number>[0-9]+)"
    r"|(?P<symbol><-->|<->|-->|->|<=|>=|!=|==|<>|&&|\|\||/\\|\\/|\(\s*\)|\[\s*\]|[-!~&|^=<>+*/()\[\]])|(?P<bad>.)"
)
_SAME = {"~": "!", "&&": "&", "/\\": "&", "||": "|", "\\/": "|", "-->": "->", "<-->": "<->", "==": "="}
_POWER = {"<->": 1, "->": 2, "^": 3, "|": 4, "&": 5, "!": 7, "next": 7, "+": 9} | dict.fromkeys(COMPARISONS, 8)
_UNSUPPORTED = {"U", "W", "F", "G", "<>", "[]", "*", "/", "-"}
_CLOSING = {"(": ")", "[": "]"}
_OPERATORS = "operators are ! & | ^ -> <-> = != < <= > >= + ' next() X"
_UNPRIMED, _PRIMED = 1, 2


@dataclass(frozen=True, slots=True)
class Token:
    """A word of a line; ``kind`` is name, number, symbol or end."""

    kind: str
    text: str
    place: Place


@dataclass(slots=True)
class Operand:
    """An operand with what is known about it.

    Attributes:
        draft: the expression.
        is_number: whether it is an integer.
        mentions: bit set: 1 unprimed variables, 2 primed ones.
        place: where it begins.
    """

    draft: Draft
    is_number: bool
    mentions: int
    place: Place


def parse_infix(line: Line, scope: Scope) -> Expression:
    """Return the expression of one line; a line that only prefix notation can begin is read as such, as in slugs.

    Raises:
        InputError: with line and column.
    """
    if looks_prefix(line.text):
        return parse_prefix(line, scope)
    return _Reader(line, scope).read()


def tokens(line: Line, scope: Scope) -> list[Token]:
    """Return the words of a line, and one that ends it.

    Raises:
        InputError: a character belongs to no word.
    """
    found: list[Token] = []
    for match in _TOKEN.finditer(line.text):
        kind = match.lastgroup or "bad"
        if kind == "space":
            continue
        place = Place(line.place.source, line.place.line, line.place.column + match.start())
        text = match.group()
        if kind == "bad":
            raise place.error(f"{text!r} is no operator; {_OPERATORS}")
        if kind == "symbol":
            text = "".join(text.split())
            text = "next" if text == "()" else _SAME.get(text, text)
        elif kind == "name" and text in ("next", "X", *_UNSUPPORTED) and not _declares(scope, text):
            kind, text = "symbol", "next" if text == "X" else text
        found.append(Token(kind, text, place))
        if len(found) > LARGEST_TOKENS:
            raise place.error(f"the line is too long; at most {LARGEST_TOKENS} symbols are read")
    end = Place(line.place.source, line.place.line, line.place.column + len(line.text))
    return [*found, Token("end", "", end)]


def _declares(scope: Scope, name: str) -> bool:
    return name in scope.inputs or name in scope.outputs


class _Reader:
    """Reads one line with two stacks instead of recursion."""

    def __init__(self, line: Line, scope: Scope) -> None:
        self.scope = scope
        self.tokens = tokens(line, scope)
        self.operands: list[Operand] = []
        self.operators: list[Token] = []

    def read(self) -> Expression:
        """Return the whole line."""
        operand_next, before = True, self.tokens[0]
        position = 0
        while self.tokens[position].kind != "end":
            token = self.tokens[position]
            if operand_next:
                position, operand_next = self.operand(position)
            else:
                operand_next = self.operator(token, before)
                position += 1
            before = self.tokens[position - 1]
        return self.end(self.tokens[position], missing=operand_next)

    def operand(self, position: int) -> tuple[int, bool]:
        """Read where an operand may begin; return the next position and whether the operand is still to come."""
        token = self.tokens[position]
        if token.kind == "name":
            self.push_name(token)
            return position + 1, False
        if token.kind == "number":
            self.push_number(token, token.text, token.place)
            return position + 1, False
        if token.text == "-" and self.tokens[position + 1].kind == "number":
            self.push_number(self.tokens[position + 1], "-" + self.tokens[position + 1].text, token.place)
            return position + 2, False
        if token.text in ("!", "next", "(", "["):
            self.operators.append(token)
            return position + 1, True
        self.refuse_unsupported(token)
        raise token.place.error(f"a variable, a number or an opening bracket is missing before {token.text!r}")

    def push_name(self, token: Token) -> None:
        """Push a variable or a constant."""
        if token.text in ("TRUE", "FALSE"):
            self.operands.append(Operand(TRUE if token.text == "TRUE" else FALSE, False, 0, token.place))
            return
        primed = token.text.endswith("'")
        variable = self.scope.variable(token.text.rstrip("'"), primed, token.place)
        mentions = _PRIMED if primed else _UNPRIMED
        self.operands.append(Operand(variable, isinstance(variable, Integer), mentions, token.place))

    def push_number(self, token: Token, text: str, place: Place) -> None:
        """Push an integer constant."""
        if len(text) > 12 or abs(int(text)) > LARGEST_VALUE:
            raise token.place.error(f"{text[:20]} is too large; numbers lie within +-{LARGEST_VALUE}")
        self.operands.append(Operand(self.scope.leaves.number(int(text)), True, 0, place))

    def operator(self, token: Token, before: Token) -> bool:
        """Read where an operator or a closing bracket may stand; return whether an operand is to come."""
        if token.text in (")", "]"):
            self.close(token)
            return False
        self.refuse_unsupported(token)
        if token.kind != "symbol" or token.text not in _POWER or token.text in ("!", "next"):
            raise token.place.error(f"an operator is missing before {token.text[:60]!r}; {_OPERATORS}")
        power = _POWER[token.text]
        next_of_brackets = self.operators and self.operators[-1].text == "next" and before.text in (")", "]")
        if next_of_brackets and power > _POWER["next"]:
            raise token.place.error("next(..) before a comparison can be misread; write x' for the next value of x")
        self.apply_above(power)
        self.operators.append(token)
        return True

    def close(self, token: Token) -> None:
        """Close a bracket."""
        self.apply_above(0)
        if not self.operators or _CLOSING[self.operators[-1].text] != token.text:
            raise token.place.error(f"{token.text!r} closes no bracket")
        self.operators.pop()

    def end(self, token: Token, *, missing: bool) -> Expression:
        """Return the expression once all words are read."""
        if missing:
            what = f"after {self.operators[-1].text!r}" if self.operators else "in an empty expression"
            raise token.place.error(f"an operand is missing {what}")
        self.apply_above(0)
        if self.operators:
            raise self.operators[-1].place.error(f"{self.operators[-1].text!r} is never closed")
        operand = self.operands.pop()
        return self.as_boolean(operand)

    def apply_above(self, power: int) -> None:
        """Apply the waiting operators that bind at least as tightly, down to the innermost open bracket."""
        while self.operators and self.operators[-1].text not in _CLOSING:
            if _POWER[self.operators[-1].text] < power:
                return
            self.apply(self.operators.pop())

    def apply(self, token: Token) -> None:
        """Apply an operator to the operands on top of the stack."""
        right = self.operands.pop()
        if token.text == "!":
            draft: Draft = Not(self.as_boolean(right))
            self.operands.append(Operand(draft, False, right.mentions, right.place))
        elif token.text == "next":
            self.operands.append(self.next_of(right, token))
        else:
            left = self.operands.pop()
            self.operands.append(self.binary(token, left, right))

    def binary(self, token: Token, left: Operand, right: Operand) -> Operand:
        """Return two operands under a binary operator."""
        mentions = left.mentions | right.mentions
        if token.text == "+" or token.text in COMPARISONS:
            for side in (left, right):
                if not side.is_number:
                    raise side.place.error(f"{token.text!r} takes integers, and this is Boolean")
            if token.text == "+":
                return Operand(join("+", left.draft, right.draft), True, mentions, left.place)
            return Operand(self.comparison(token, left, right), False, mentions, left.place)
        if token.text in ("->", "<->"):
            kind = Implies if token.text == "->" else Iff
            draft: Draft = kind(self.as_boolean(left), self.as_boolean(right))
        else:
            self.want_boolean(left)
            self.want_boolean(right)
            draft = join(token.text, left.draft, right.draft)
        return Operand(draft, False, mentions, left.place)

    def comparison(self, token: Token, left: Operand, right: Operand) -> Comparison:
        """Return a comparison; equality with a value that a variable never has is refused."""
        a, b = finished(left.draft), finished(right.draft)
        for one, other, place in ((a, b, right.place), (b, a, left.place)):
            if isinstance(one, Integer) and isinstance(other, Number) and token.text in ("=", "!="):
                variable = self.known(one.name)
                if other.value not in variable.values:
                    limits = f"{variable.lower}...{variable.upper}"
                    raise place.error(f"{other.value} is out of range; {one.name} takes the values {limits}")
        return Comparison(token.text, a, b)  # type: ignore[arg-type]

    def known(self, name: str) -> Variable:
        """Return a declared variable."""
        return self.scope.inputs.get(name) or self.scope.outputs[name]

    def as_boolean(self, operand: Operand) -> Expression:
        """Return an operand as an expression."""
        self.want_boolean(operand)
        return finished(operand.draft)  # type: ignore[return-value]

    def want_boolean(self, operand: Operand) -> None:
        """Refuse an integer where a Boolean is needed."""
        if operand.is_number:
            raise operand.place.error("this is an integer; compare it, for instance with =, or write TRUE or FALSE")

    def next_of(self, operand: Operand, token: Token) -> Operand:
        """Return an operand with all its variables primed."""
        self.want_boolean(operand)
        if operand.mentions & _PRIMED:
            raise token.place.error("next of an expression that already has primes; formulas see one step ahead")
        if not operand.mentions:
            return operand
        for name in {node.name for node in postorder([finished(operand.draft)]) if isinstance(node, Atom | Integer)}:
            owner = self.scope.bits.get(name, name)
            problem = misplaced(self.scope.section, is_input=owner in self.scope.inputs, primed=True)
            if problem:
                raise token.place.error(f"{self.scope.section} {problem}, and {name}' is none")
        primed = _primed(finished(operand.draft), self.scope)
        return Operand(primed, False, _PRIMED, operand.place)

    def refuse_unsupported(self, token: Token) -> None:
        """Refuse the operators that parse in slugs and that nothing supports."""
        if token.kind == "symbol" and token.text in _UNSUPPORTED:
            raise token.place.error(f"the operator {token.text!r} is not supported; {_OPERATORS}")


def _primed(expression: Node, scope: Scope) -> Node:
    """Return the expression with every variable primed."""
    made: dict[int, Node] = {}
    for node in postorder([expression]):
        below = [made[id(child)] for child in children(node)]
        made[id(node)] = _rebuilt(node, below, scope)
    return made[id(expression)]


def _rebuilt(node: Node, below: list[Node], scope: Scope) -> Node:
    if isinstance(node, Atom):
        return scope.leaves.atom(node.name, True)
    if isinstance(node, Integer):
        return scope.leaves.integer(node.name, True)
    if isinstance(node, Constant | Number):
        return node
    if isinstance(node, Comparison):
        return Comparison(node.operator, below[0], below[1])  # type: ignore[arg-type]
    if isinstance(node, And | Or | Xor | Sum):
        return type(node)(tuple(below))  # type: ignore[arg-type]
    return type(node)(*below)  # type: ignore[arg-type]
