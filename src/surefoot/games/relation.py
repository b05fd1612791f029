"""The two moves of a game as partitioned relations, and the controllable predecessor.

    cpre(T) = { s : for all next inputs i that the environment's rules allow there are next outputs o
                    that the system's rules allow, with (s, i, o) in T }

A move is a chain of steps, one for each primed variable: conjoin the rules that mention it and quantify it away. A
variable with at most one next value (the robot's own update) is taken out of the rules of the others beforehand and
stands first in the chain; the most free one, the obstacle, stands last. facts: quantified in this order the relation
of a navigation game takes a third to a fifth of the time.

Source: Burch, Clarke and Long, "Symbolic model checking with partitioned transition relations", VLSI 1991;
Firman, Maoz and Ringert, Acta Informatica 57, 2020.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from surefoot.compute import Deadline
from surefoot.games.bits import BitGame, Part, bits_of, mask_of
from surefoot.games.diagrams import Diagrams, Set
from surefoot.logic.syntax import And, Atom, Constant, Expression, Node, Not, Or, Xor, children, postorder

_MERGED_NODES = 20_000


@dataclass(frozen=True, slots=True, eq=False)
class Rule:
    """A conjunct of a relation: its set and the primed bits that it mentions, as a mask."""

    relation: Set
    following: int


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """Conjoin the rules, then quantify the bits."""

    bits: tuple[int, ...]
    cube: Set
    rules: tuple[Set, ...]


class OutOfWork(Exception):  # noqa: N818 - a signal between the attempts of one engine
    """An attempt with one variable order has used up its share of work."""


class Encoder:
    """Turns formulas over bits into sets; shared nodes are built once."""

    def __init__(self, game: BitGame, order: Sequence[int], manager: Diagrams, deadline: Deadline) -> None:
        self.manager = manager
        self.deadline = deadline
        self.work = 0
        self._nodes = 0
        self.most_work: int | None = None
        self.place = {bit: place for place, bit in enumerate(order)}
        self._numbers = {name: number for number, name in enumerate(game.bits)}
        self._built: dict[int, Set] = {}
        self._kept: list[Expression] = []

    def now(self, bit: int) -> int:
        """Return the variable of a bit's present value."""
        return 2 * self.place[bit]

    def then(self, bit: int) -> int:
        """Return the variable of a bit's next value, just below."""
        return 2 * self.place[bit] + 1

    def spend(self, result: Set) -> Set:
        """Count new nodes as work, and give up past the deadline or the most work; return the result."""
        self.deadline.check("solving the game")
        nodes = self.manager.nodes()
        self.work += max(nodes - self._nodes, 0)
        self._nodes = nodes
        if self.most_work is not None and self.work > self.most_work:
            raise OutOfWork
        return result

    def set_of(self, formula: Expression) -> Set:
        """Return the set that a formula describes."""
        if id(formula) not in self._built:
            self._kept.append(formula)
            for node in postorder([formula]):
                if id(node) not in self._built:
                    self._built[id(node)] = self._combine(node)
                    self.deadline.check("building the relations")
        return self._built[id(formula)]

    def _combine(self, node: Node) -> Set:
        manager = self.manager
        if isinstance(node, Constant):
            return manager.true if node.value else manager.false
        if isinstance(node, Atom):
            bit = self._numbers[node.name]
            return manager.variable(self.then(bit) if node.primed else self.now(bit))
        operands = [self._built[id(child)] for child in children(node)]
        if isinstance(node, Not):
            return ~operands[0]
        if isinstance(node, And):
            return self.conjunction(operands)
        if isinstance(node, Or):
            return ~self.conjunction([~operand for operand in operands])
        if isinstance(node, Xor):
            result = operands[0]
            for operand in operands[1:]:
                result = manager.differ(result, operand)
            return result
        raise TypeError(f"a lowered formula has no {type(node).__name__}")

    def conjunction(self, sets: Iterable[Set]) -> Set:
        """Return the conjunction, pairs first: a balanced tree keeps the steps between small."""
        row = list(sets)
        while len(row) > 1:
            pairs = [self.manager.conjoin(*row[i : i + 2]) for i in range(0, len(row) - 1, 2)]
            row = pairs + row[2 * len(pairs) :]
        return row[0] if row else self.manager.true


class Move:
    """One side's rules, ready to be quantified over that side's next values."""

    def __init__(self, encoder: Encoder, groups: Sequence[tuple[int, ...]], parts: Sequence[Part]) -> None:
        self._encoder = encoder
        owned = mask_of([bit for group in groups for bit in group])
        together = _bounded_conjunctions(encoder, [encoder.set_of(part.formula) for part in parts])
        if len(together) == 1:
            self.steps: tuple[Step, ...] = (_step(encoder, tuple(bits_of(owned)), [Rule(together[0], owned)]),)
            self.always = encoder.manager.true
        else:
            rules = _merged(encoder, parts, owned)
            self.steps, rest = _chain(encoder, groups, rules)
            self.always = encoder.conjunction(rule.relation for rule in rest)
        self.rules = tuple(together)

    def some(self, target: Set) -> Set:
        """Return where some next values that the rules allow lead into the target."""
        manager, encoder = self._encoder.manager, self._encoder
        for step in self.steps:
            for rule in step.rules[:-1]:
                target = encoder.spend(manager.conjoin(target, rule))
            if step.rules:
                target = encoder.spend(manager.and_exists(target, step.rules[-1], step.cube))
            else:
                target = encoder.spend(manager.exists(target, step.cube))
        return manager.conjoin(target, self.always)


def _merged(encoder: Encoder, parts: Sequence[Part], owned: int) -> list[Rule]:
    """Conjoin the parts that mention the same primed bits of this side."""
    classes: dict[int, list[Set]] = {}
    for part in parts:
        classes.setdefault(part.following & owned, []).append(encoder.set_of(part.formula))
    return [
        Rule(relation, following)
        for following, sets in classes.items()
        for relation in _bounded_conjunctions(encoder, sets)
    ]


def _bounded_conjunctions(encoder: Encoder, sets: list[Set]) -> list[Set]:
    """Return sets with the same conjunction, as few as fit below the size that is still handy."""
    row = [(encoder.manager.size(one), one) for one in sets]
    done: list[Set] = []
    while len(row) > 1:
        following = []
        for i in range(0, len(row) - 1, 2):
            encoder.deadline.check("building the relations")
            merged = encoder.manager.conjoin(row[i][1], row[i + 1][1])
            size = encoder.manager.size(merged)
            if size > max(_MERGED_NODES, row[i][0] + row[i + 1][0]):
                done.extend((row[i][1], row[i + 1][1]))
            else:
                following.append((size, merged))
        row = following + ([row[-1]] if len(row) % 2 else [])
    return done + [one for _, one in row]


def _chain(
    encoder: Encoder, groups: Sequence[tuple[int, ...]], rules: list[Rule]
) -> tuple[tuple[Step, ...], list[Rule]]:
    """Return the steps in their order, and the rules that mention no primed bit of this side."""
    open_groups = [group for group in groups if group]
    steps: list[Step] = []
    open_groups, free = _without_rules(open_groups, rules)
    steps.extend(_step(encoder, group, []) for group in free)
    progress = True
    while progress:
        progress = False
        for group in list(open_groups):
            taken = _eliminate(encoder, group, rules)
            if taken is not None:
                own, rules = taken
                steps.append(_step(encoder, group, own))
                open_groups.remove(group)
                progress = True
    while open_groups:
        group = min(open_groups, key=lambda one: _freedom(encoder, one, rules))
        open_groups.remove(group)
        mask = mask_of(group)
        steps.append(_step(encoder, group, [rule for rule in rules if rule.following & mask]))
        rules = [rule for rule in rules if not rule.following & mask]
    return tuple(steps), rules


def _without_rules(
    groups: list[tuple[int, ...]], rules: Sequence[Rule]
) -> tuple[list[tuple[int, ...]], list[tuple[int, ...]]]:
    mentioned = 0
    for rule in rules:
        mentioned |= rule.following
    return (
        [group for group in groups if mask_of(group) & mentioned],
        [group for group in groups if not mask_of(group) & mentioned],
    )


def _step(encoder: Encoder, group: tuple[int, ...], own: Sequence[Rule]) -> Step:
    ordered = sorted(own, key=lambda rule: (rule.following.bit_count(), encoder.manager.size(rule.relation)))
    return Step(group, _primed_cube(encoder, group), tuple(rule.relation for rule in ordered))


def _primed_cube(encoder: Encoder, bits: Iterable[int]) -> Set:
    return encoder.manager.cube(encoder.then(bit) for bit in bits)


def _eliminate(encoder: Encoder, group: tuple[int, ...], rules: list[Rule]) -> tuple[list[Rule], list[Rule]] | None:
    """Take a variable with at most one next value out of the others' rules; None if it has more, or it does not pay.

    With F functional in v, (exists v. F and A and B) = (exists v. F and A) and (exists v. F and B).
    """
    manager, mask = encoder.manager, mask_of(group)
    mentioning = [rule for rule in rules if rule.following & mask]
    own = [rule for rule in mentioning if not rule.following & ~mask]
    update = encoder.conjunction(rule.relation for rule in own)
    if not own or not _is_functional(encoder, group, update):
        return None
    cube, others = _primed_cube(encoder, group), []
    for rule in mentioning:
        if rule.following & ~mask:
            without = manager.and_exists(rule.relation, update, cube)
            if manager.size(without) > 4 * (manager.size(rule.relation) + manager.size(update)) + 1000:
                return None
            others.append(replace(rule, relation=without, following=rule.following & ~mask))
    untouched = [rule for rule in rules if not rule.following & mask]
    return [Rule(update, mask)], untouched + others


def _is_functional(encoder: Encoder, group: tuple[int, ...], update: Set) -> bool:
    """Return whether a relation allows at most one value of a variable, whatever else holds."""
    manager = encoder.manager
    for bit in group:
        one = manager.variable(encoder.then(bit))
        others = _primed_cube(encoder, [other for other in group if other != bit])
        cube = _primed_cube(encoder, [bit])
        high = manager.exists(manager.and_exists(update, one, cube), others)
        low = manager.exists(manager.and_exists(update, ~one, cube), others)
        if manager.conjoin(high, low) != manager.false:
            return False
    return True


def _freedom(encoder: Encoder, group: tuple[int, ...], rules: Sequence[Rule]) -> float:
    """Return how many next values a variable has on average, by its own rules."""
    manager, mask = encoder.manager, mask_of(group)
    own = [rule.relation for rule in rules if rule.following & mask and not rule.following & ~mask]
    together = encoder.conjunction(own[:4])
    variables = 2 * len(encoder.place)
    domain = manager.exists(together, _primed_cube(encoder, group))
    whole = manager.count(domain, variables) >> len(group)
    return manager.count(together, variables) / whole if whole else 0.0


def primed(encoder: Encoder, bits: Iterable[int]) -> list[tuple[int, int]]:
    """Return the pairs (now, then) of bits, for a renaming into the next state."""
    return [(encoder.now(bit), encoder.then(bit)) for bit in bits]


def mentions(encoder: Encoder, mask: int, *, following: bool) -> Set:
    """Return the cube of the present or next values of the bits of a mask."""
    variable = encoder.then if following else encoder.now
    return encoder.manager.cube(variable(bit) for bit in bits_of(mask))
