"""A specification as the solvers see it: bits, and safety rules split into their smallest conjuncts."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from surefoot.logic.lower import Lowering, range_conjuncts
from surefoot.logic.syntax import (
    And,
    Atom,
    Conjunct,
    Constant,
    Expression,
    Node,
    Specification,
    children,
    postorder,
)


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """One rule over bits.

    Attributes:
        formula: built of Constant, Atom, Not, And, Or and Xor over bit atoms; nodes are shared.
        origin: the line that it comes from.
        current: the bits that it reads now, as a mask over the bits of the game.
        following: the bits that it reads in the next state, as a mask.
    """

    formula: Expression
    origin: Conjunct
    current: int
    following: int


@dataclass(frozen=True, slots=True, eq=False)
class BitGame:
    """A specification over bits.

    Attributes:
        spec: where it comes from.
        bits: names, inputs first, in the order of the declarations.
        inputs: how many of them are inputs.
        groups: for every variable of the specification the numbers of its bits.
        env_init, sys_init, env_trans, sys_trans: conjuncts, ranges included.
        justices, goals: liveness of the environment and of the system, one part a line.
    """

    spec: Specification
    bits: tuple[str, ...]
    inputs: int
    groups: tuple[tuple[int, ...], ...]
    env_init: tuple[Part, ...]
    sys_init: tuple[Part, ...]
    env_trans: tuple[Part, ...]
    sys_trans: tuple[Part, ...]
    justices: tuple[Part, ...]
    goals: tuple[Part, ...]

    @property
    def input_mask(self) -> int:
        """The mask of the inputs."""
        return (1 << self.inputs) - 1

    @property
    def read(self) -> int:
        """The mask of the bits whose present value some rule reads; the others cannot matter for what comes."""
        mask = 0
        for part in (*self.env_trans, *self.sys_trans, *self.justices, *self.goals):
            mask |= part.current
        return mask


def bit_game(spec: Specification) -> BitGame:
    """Lower a specification to bits."""
    groups, bits = _groups(spec)
    splitter = _Splitter(Lowering(spec), {name: number for number, name in enumerate(bits)})
    ranges = range_conjuncts(spec)

    def section(name: str, given: Iterable[Conjunct]) -> tuple[Part, ...]:
        rules = [*given, *(rule for rule in ranges if rule.section == name)]
        return tuple(part for rule in rules for part in splitter.split(rule))

    return BitGame(
        spec=spec,
        bits=bits,
        inputs=sum(len(variable.bits) for variable in spec.inputs),
        groups=groups,
        env_init=section("ENV_INIT", spec.env_init),
        sys_init=section("SYS_INIT", spec.sys_init),
        env_trans=section("ENV_TRANS", spec.environment_safety),
        sys_trans=section("SYS_TRANS", spec.system_safety),
        justices=tuple(splitter.whole(rule) for rule in spec.env_liveness),
        goals=tuple(splitter.whole(rule) for rule in spec.sys_liveness),
    )


def _groups(spec: Specification) -> tuple[tuple[tuple[int, ...], ...], tuple[str, ...]]:
    bits: list[str] = []
    groups = []
    for variable in (*spec.inputs, *spec.outputs):
        groups.append(tuple(range(len(bits), len(bits) + len(variable.bits))))
        bits.extend(variable.bits)
    return tuple(groups), tuple(bits)


class _Splitter:
    """Lowers conjuncts, takes conjunctions apart, and knows which bits every shared node reads."""

    def __init__(self, lowering: Lowering, numbers: dict[str, int]) -> None:
        self._lowering = lowering
        self._numbers = numbers
        self._reads: dict[int, tuple[int, int]] = {}
        self._kept: list[Expression] = []  # ids stay unique while their nodes live

    def whole(self, rule: Conjunct) -> Part:
        """Return a rule as one part."""
        formula = self._lowering.boolean(rule.expression)
        current, following = self._reads_of(formula)
        return Part(formula, rule, current, following)

    def split(self, rule: Conjunct) -> list[Part]:
        """Return the parts whose conjunction is the rule, without the true ones."""
        pending, parts = [self._lowering.boolean(rule.expression)], []
        seen: set[int] = set()
        while pending:
            formula = pending.pop()
            if id(formula) in seen:
                continue
            seen.add(id(formula))
            if isinstance(formula, And):
                pending.extend(reversed(formula.operands))
            elif not (isinstance(formula, Constant) and formula.value):
                parts.append(Part(formula, rule, *self._reads_of(formula)))
        return parts

    def _reads_of(self, formula: Expression) -> tuple[int, int]:
        if id(formula) not in self._reads:
            self._kept.append(formula)
            for node in postorder([formula]):
                if id(node) not in self._reads:
                    self._reads[id(node)] = self._node_reads(node)
        return self._reads[id(formula)]

    def _node_reads(self, node: Node) -> tuple[int, int]:
        if isinstance(node, Atom):
            bit = 1 << self._numbers[node.name]
            return (0, bit) if node.primed else (bit, 0)
        current = following = 0
        for child in children(node):
            now, then = self._reads[id(child)]
            current, following = current | now, following | then
        return current, following


def bits_of(mask: int) -> list[int]:
    """Return the numbers of the bits that a mask contains, rising."""
    numbers = []
    while mask:
        lowest = mask & -mask
        numbers.append(lowest.bit_length() - 1)
        mask ^= lowest
    return numbers


def mask_of(numbers: Sequence[int]) -> int:
    """Return the mask of some bits."""
    mask = 0
    for number in numbers:
        mask |= 1 << number
    return mask
