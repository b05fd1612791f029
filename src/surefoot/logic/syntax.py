"""Specifications as values: expressions, variables, conjuncts with their source lines.

Expressions are graphs without cycles, not trees: a buffer of a slugsin file appears as one object that several others
hold. They may be deeper than Python's stack. So nobody recurses over an expression, and nodes are compared by identity;
``postorder`` gives every node once, operands before operators, to be keyed by ``id``.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

NAME_PATTERN = r"[A-Za-z_][A-Za-z0-9_.]*(?:@0\.-?[0-9]+\.-?[0-9]+|@[0-9]+)?"
"""A name, perhaps with the ending of a bit of an integer."""
NAME = re.compile(NAME_PATTERN)
COMPARISONS = ("=", "!=", "<", "<=", ">", ">=")


@dataclass(frozen=True, slots=True, eq=False)
class Constant:
    """True or false."""

    value: bool


@dataclass(frozen=True, slots=True, eq=False)
class Atom:
    """A Boolean variable, or one bit of an integer (see ``Variable.bits``); primed: its next value."""

    name: str
    primed: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Not:
    """Negation."""

    operand: Expression


@dataclass(frozen=True, slots=True, eq=False)
class And:
    """Conjunction of two or more."""

    operands: tuple[Expression, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Or:
    """Disjunction of two or more."""

    operands: tuple[Expression, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Xor:
    """Exclusive or of two or more: an odd number of them holds."""

    operands: tuple[Expression, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Implies:
    """Implication."""

    left: Expression
    right: Expression


@dataclass(frozen=True, slots=True, eq=False)
class Iff:
    """Equivalence."""

    left: Expression
    right: Expression


@dataclass(frozen=True, slots=True, eq=False)
class Number:
    """An integer constant."""

    value: int


@dataclass(frozen=True, slots=True, eq=False)
class Integer:
    """The value of an integer variable; primed: its next value."""

    name: str
    primed: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Sum:
    """The exact sum of two or more integers; nothing overflows."""

    operands: tuple[Term, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Comparison:
    """A comparison of two integers; the operator is one of ``COMPARISONS``."""

    operator: str
    left: Term
    right: Term


Term = Number | Integer | Sum
Expression = Constant | Atom | Not | And | Or | Xor | Implies | Iff | Comparison
Node = Expression | Term


@dataclass(frozen=True, slots=True)
class Variable:
    """A Boolean variable, or an integer one with both limits.

    Attributes:
        name: as in the file.
        lower: the least value; None for a Boolean.
        upper: the greatest value; None for a Boolean.
    """

    name: str
    lower: int | None = None
    upper: int | None = None

    @property
    def is_boolean(self) -> bool:
        """Whether it is a Boolean."""
        return self.lower is None

    @property
    def values(self) -> range:
        """All its values; those of a Boolean are 0 and 1."""
        if self.lower is None or self.upper is None:
            return range(2)
        return range(self.lower, self.upper + 1)

    @property
    def bits(self) -> tuple[str, ...]:
        """Names of its bits, the least significant first: of ``value - lower``, named as slugs does.

        A Boolean is its own bit; an integer with a single value has none.
        """
        if self.lower is None or self.upper is None:
            return (self.name,)
        count = (self.upper - self.lower).bit_length()
        first = f"{self.name}@0.{self.lower}.{self.upper}"
        return tuple(first if k == 0 else f"{self.name}@{k}" for k in range(count))

    def shown(self, value: int) -> str:
        """Return an assignment for a person: ``x = 3``, ``door`` or ``!door``."""
        if self.is_boolean:
            return self.name if value else f"!{self.name}"
        return f"{self.name} = {value}"


@dataclass(frozen=True, slots=True, eq=False)
class Conjunct:
    """One line of a section.

    Attributes:
        section: the section in capitals, such as ``ENV_TRANS``.
        expression: what it says.
        text: the line as written, without its comment.
        line: in the file, counted from 1; 0 for one that stands in no file (see ``range_conjuncts``).
        column: where the text begins, counted from 1.
    """

    section: str
    expression: Expression
    text: str
    line: int = 0
    column: int = 1


@dataclass(frozen=True, slots=True, eq=False)
class Specification:
    """A GR(1) specification: if the environment keeps its part, the system keeps its own.

    The lines of INIT and TRANS are conjoined; each line of LIVENESS is a goal of its own. Limits of integers are not
    among the conjuncts; see ``range_conjuncts``. The sections of the repair papers come last: the hard ones are safety
    that a repair must not touch; the other two speak about repairs alone.

    Attributes:
        inputs: variables of the environment.
        outputs: variables of the system.
        source: the file.
        sha256: its hash; empty when it was not read from a file.
    """

    inputs: tuple[Variable, ...]
    outputs: tuple[Variable, ...]
    env_init: tuple[Conjunct, ...] = ()
    sys_init: tuple[Conjunct, ...] = ()
    env_trans: tuple[Conjunct, ...] = ()
    sys_trans: tuple[Conjunct, ...] = ()
    env_liveness: tuple[Conjunct, ...] = ()
    sys_liveness: tuple[Conjunct, ...] = ()
    env_trans_hard: tuple[Conjunct, ...] = ()
    sys_trans_hard: tuple[Conjunct, ...] = ()
    change_cons: tuple[Conjunct, ...] = ()
    not_allowed_repair: tuple[Conjunct, ...] = ()
    source: Path | None = None
    sha256: str = ""
    _by_name: dict[str, Variable] = field(init=False, repr=False, default_factory=dict)

    def __post_init__(self) -> None:
        """Index the variables by name."""
        self._by_name.update({variable.name: variable for variable in self.variables})

    @property
    def variables(self) -> tuple[Variable, ...]:
        """Inputs, then outputs."""
        return self.inputs + self.outputs

    @property
    def environment_safety(self) -> tuple[Conjunct, ...]:
        """What the environment has to keep at every step, hard lines included."""
        return self.env_trans + self.env_trans_hard

    @property
    def system_safety(self) -> tuple[Conjunct, ...]:
        """What the system has to keep at every step, hard lines included."""
        return self.sys_trans + self.sys_trans_hard

    @property
    def conjuncts(self) -> tuple[Conjunct, ...]:
        """Every line, section by section."""
        return tuple(conjunct for name in SECTIONS for conjunct in getattr(self, name.lower()))

    def variable(self, name: str) -> Variable | None:
        """Return the variable of that name."""
        return self._by_name.get(name)


SECTIONS = (
    "ENV_INIT",
    "SYS_INIT",
    "ENV_TRANS",
    "SYS_TRANS",
    "ENV_LIVENESS",
    "SYS_LIVENESS",
    "ENV_TRANS_HARD",
    "SYS_TRANS_HARD",
    "CHANGE_CONS",
    "NOT_ALLOWED_REPAIR",
)


def children(node: Node) -> tuple[Node, ...]:
    """Return the operands of a node in their order."""
    if isinstance(node, And | Or | Xor | Sum):
        return node.operands
    if isinstance(node, Implies | Iff | Comparison):
        return (node.left, node.right)
    return (node.operand,) if isinstance(node, Not) else ()


def postorder(roots: Iterable[Node]) -> list[Node]:
    """Return every node below the roots once, operands before operators, without recursion."""
    order: list[Node] = []
    seen: set[int] = set()
    stack: list[tuple[Node, bool]] = [(root, False) for root in reversed(list(roots))]
    while stack:
        node, expanded = stack.pop()
        if expanded:
            order.append(node)
        elif id(node) not in seen:
            seen.add(id(node))
            stack.append((node, True))
            stack.extend((child, False) for child in reversed(children(node)) if id(child) not in seen)
    return order


def atoms(roots: Iterable[Node]) -> frozenset[tuple[str, bool]]:
    """Return (name, primed) of all variables and bits that occur."""
    return frozenset((node.name, node.primed) for node in postorder(roots) if isinstance(node, Atom | Integer))


def bit_owners(specification: Specification) -> dict[str, tuple[Variable, int]]:
    """Return the integer and the position of every bit name."""
    return {
        bit: (variable, position)
        for variable in specification.variables
        if not variable.is_boolean
        for position, bit in enumerate(variable.bits)
    }
