"""Certificates of rankings: from every layer, whatever the environment does, the play gets further.

What is checked, for all winning states at once: the start is winning; whatever next inputs the environment may choose,
there is an answer that keeps the system's safety and meets the goal, or leads into a lower layer, or stays in the layer
while the justice that the layer waits for does not hold. So a fair play meets every goal again and again, however
one of these answers is picked. States and lines are translated afresh from the specification (``gr1_sets``).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from surefoot.logic.syntax import Conjunct
from surefoot.verify.findings import Ledger
from surefoot.verify.gr1._kernels import FALSE, TRUE, Column, below
from surefoot.verify.gr1.file import Ints
from surefoot.verify.gr1.ranking_file import RankingFile, read_ranking
from surefoot.verify.gr1.sets import Sets, Translator

_MANY_NODES = 1_500_000
_RULE = "formats.md 4, rankings"


def check_ranking(path: Path, ledger: Ledger, specification_path: Path | None = None) -> None:
    """Verify a saved ranking.

    Args:
        path: its JSON file.
        ledger: takes what is wrong, and counts.
        specification_path: where the specification is; None: where the ranking says.

    Raises:
        InputError: a file is missing, malformed, or the specification is another one.
        LimitExceeded: the diagrams grow too large.
    """
    found = read_ranking(path, specification_path)
    check = _Check(found, ledger)
    if ledger.total:
        return
    ledger.counts |= {"player": "system", "semantics": found.semantics, "checked_states": check.states()}
    ledger.counts |= {"checked_layers": len(found.arrays["layers"])}
    check.rules()
    check.start()
    check.dead_ends()
    for goal in range(len(found.arrays["goals"])):
        check.goal(goal)


@dataclass(frozen=True, slots=True, eq=False)
class _Saved:
    """The sets of a file: of steps, and the layers both as present and as next states."""

    environment: list[int]
    system: list[int]
    goals: list[int]
    justices: list[int]
    layers: list[int]
    next_layers: list[int]
    winning: int
    next_winning: int


class _Check:
    """One ranking under examination."""

    def __init__(self, found: RankingFile, ledger: Ledger) -> None:
        self._found, self._ledger = found, ledger
        spec = self._spec = found.specification
        bits = len(found.arrays["order"])
        self._sets = sets = Sets(2 * bits)
        place: Ints = np.empty(bits, dtype=np.int64)
        place[found.arrays["order"]] = np.arange(bits)
        self._translator = Translator(spec, sets, place.tolist())
        self._saved = self._load()
        self._inputs = self._next_bits(self._translator.places(spec.inputs))
        self._outputs = self._next_bits(self._translator.places(spec.outputs))
        self._valid = self._translator.in_range(spec.variables, primed=False)
        self._next_inputs_valid = self._translator.in_range(spec.inputs, primed=True)
        self._next_outputs_valid = self._translator.in_range(spec.outputs, primed=True)
        self._env = [*self._each(spec.environment_safety), self._next_inputs_valid]
        self._sys = [*self._each(spec.system_safety), self._next_outputs_valid]
        self._mentioned = [sets.mentioned(rule) for rule in self._saved.system]

    def states(self) -> int:
        """Return how many states are winning, about."""
        share = self._sets.share(self._sets.conjoin((self._saved.winning, self._valid)))
        return round(share * 2.0 ** len(self._found.arrays["order"]))

    def rules(self) -> None:
        """Check that the rules, goals and justices in the file are those of the specification.

        The environment's may not be told apart by less than all its lines, for a player picks inputs by them.
        """
        saved, spec = self._saved, self._spec
        here = self._sets.conjoin((self._valid, self._next_inputs_valid))
        self._same_rules("environment", saved.environment, self._env, here)
        self._same_rules("system", saved.system, self._sys, self._sets.conjoin((here, self._next_outputs_valid)))
        goals = [self._translator.translate(line.expression) for line in spec.sys_liveness] or [TRUE]
        justices = [self._translator.translate(line.expression) for line in spec.env_liveness]
        everywhere = self._sets.conjoin((here, self._next_outputs_valid))
        for name, given, wanted, lines in (
            ("goals", saved.goals, goals, spec.sys_liveness),
            ("justices", saved.justices, justices, spec.env_liveness),
        ):
            if len(given) != len(wanted):
                self._ledger.refuse(_RULE, f"there are {len(wanted)} {name} in the specification, not {len(given)}")
            for k, (one, other) in enumerate(zip(given, wanted, strict=False)):
                apart = self._sets.conjoin((self._sets.differ(one, other), everywhere))
                rule = self._line(lines[k]) if lines else _RULE
                self._none(apart, rule, f"the {name} of the file say something else")

    def _same_rules(self, name: str, given: list[int], wanted: list[int], here: int) -> None:
        wider = [self._sets.conjoin((here, one ^ 1, *given)) for one in wanted]
        narrower = [self._sets.conjoin((here, one ^ 1, *wanted)) for one in given]
        message = f"the rules of the {name} in the file are not those of the specification"
        self._none(self._sets.unite([*wider, *narrower]), _RULE, message)

    def start(self) -> None:
        """Check that the system wins from every start that the environment may choose."""
        spec, sets, saved = self._spec, self._sets, self._saved
        env_init, sys_init = sets.conjoin(self._each(spec.env_init)), sets.conjoin(self._each(spec.sys_init))
        valid_inputs = self._translator.in_range(spec.inputs, primed=False)
        start, allowed = sets.conjoin((env_init, valid_inputs)), sets.conjoin((sys_init, self._valid))
        whole = sets.conjoin((start, self._valid))
        for name, own, where in (("env_init", env_init, valid_inputs), ("sys_init", sys_init, whole)):
            kept = int(self._rows[int(self._found.arrays[name])])
            apart = sets.conjoin((sets.differ(own, kept), where))
            self._none(apart, _RULE, f"{name} of the file is not that of the specification")
        if self._found.semantics == "robotics":
            lost = sets.conjoin((start, allowed, saved.winning ^ 1))
        else:
            outputs = np.roll(self._outputs, -1)  # the present values stand just before the next ones
            lost = sets.conjoin((start, sets.project(sets.conjoin((allowed, saved.winning)), TRUE, outputs) ^ 1))
        self._none(lost, _RULE, "the ranking has no winning start here")

    def dead_ends(self) -> None:
        """Check that the environment has a move in every winning state, where that is asked for."""
        if self._found.env_dead_end == "loses":
            mentioned = [self._sets.mentioned(rule) for rule in self._env]
            moves = self._some(self._saved.winning, self._env, mentioned, self._inputs)
            stuck = self._sets.conjoin((self._saved.winning, self._valid, moves ^ 1))
            self._none(stuck, "env_dead_end: loses", "the environment has no move here")

    def goal(self, goal: int) -> None:
        """Check the layers of one goal."""
        sets, saved, arrays = self._sets, self._saved, self._found.arrays
        promise = saved.goals[goal]
        of_states = not sets.mentioned(promise)[1::2].any()
        first, last = int(arrays["first"][goal]), int(arrays["first"][goal + 1])
        outside = sets.conjoin((saved.winning, saved.layers[last - 1] ^ 1))
        self._none(outside, _RULE, "no layer of a goal holds this winning state")
        below = next_below = FALSE
        for layer in range(first, last):
            mark, reached = sets.mark, saved.layers[layer]
            self._none(sets.conjoin((below, reached ^ 1)), _RULE, "a layer does not contain the one before")
            self._none(sets.conjoin((reached, saved.winning ^ 1)), _RULE, "a layer is not within the winning states")
            here = sets.conjoin((reached, below ^ 1, self._valid))
            done = sets.conjoin((here, promise)) if of_states else FALSE
            further = [next_below]
            if not of_states:
                further.append(sets.conjoin((promise, saved.next_winning)))
            if (justice := int(arrays["waits_for"][layer])) >= 0:
                further.append(sets.conjoin((saved.next_layers[layer], saved.justices[justice] ^ 1)))
            self._forced(done, saved.next_winning, "has no answer that stays in the winning states")
            self._forced(sets.conjoin((here, done ^ 1)), sets.unite(further), "has no answer that gets further")
            below, next_below = reached, saved.next_layers[layer]
            if sets.mark - mark > _MANY_NODES:
                sets.release(mark)

    def _forced(self, here: int, target: int, message: str) -> None:
        """Check that from some states, whatever the environment does, an answer leads to the target."""
        if here == FALSE:
            return
        sets = self._sets
        answered = self._some(sets.conjoin((target, here)), self._saved.system, self._mentioned, self._outputs)
        self._none(sets.conjoin((here, answered ^ 1, *self._env)), _RULE, f"the ranking {message} to the next inputs")

    def _some(
        self, target: int, rules: Sequence[int], mentioned: Sequence[NDArray[np.bool_]], bits: NDArray[np.bool_]
    ) -> int:
        """Return where some values of bits keep all rules and lead to a target; each bit goes once nothing needs it."""
        left = bits.copy()
        if not rules:
            return self._sets.project(target, TRUE, left)
        for k, rule in enumerate(rules):
            needed = np.any(mentioned[k + 1 :], axis=0) if k + 1 < len(rules) else np.zeros_like(left)
            now = left & ~needed
            target = self._sets.project(target, rule, now)
            left &= needed
        return target

    def _none(self, one: int, rule: str, message: str) -> None:
        """Refuse a set that ought to be empty, with one of its states."""
        if one != FALSE:
            valuation = self._sets.some(one)
            where = self._translator.words(valuation, primed=False)
            if any(variable % 2 for variable in valuation):
                where += f" -> {self._translator.words(valuation, primed=True)}"
            self._ledger.refuse(rule, message, where)

    def _load(self) -> _Saved:
        arrays = {name: array.astype(np.int32) for name, array in self._found.arrays.items()}
        table = tuple(arrays[name] for name in ("variable", "low", "high"))
        self._rows = self._sets.load(*table)
        states = [*arrays["layers"], arrays["winning"], arrays["env_init"], arrays["sys_init"]]
        kept = np.zeros(len(table[0]), dtype=np.bool_)
        kept[:2] = kept[states] = True
        below(arrays["low"], arrays["high"], kept)
        variable, low, high = self._next_states(table, kept)
        number = np.cumsum(kept) - 1
        following = self._sets.load(variable, low, high)
        environment, system, goals, justices, layers = (
            self._rows[arrays[name]].tolist() for name in ("environment", "system", "goals", "justices", "layers")
        )
        return _Saved(
            environment,
            system,
            goals,
            justices,
            layers,
            next_layers=following[number[arrays["layers"]]].tolist(),
            winning=int(self._rows[arrays["winning"]]),
            next_winning=int(following[number[arrays["winning"]]]),
        )

    def _next_states(self, table: tuple[Column, ...], kept: NDArray[np.bool_]) -> tuple[Column, ...]:
        """Return the rows of sets of states as a table about next states."""
        number = (np.cumsum(kept) - 1).astype(np.int32)
        variable = table[0][kept]
        if (variable[2:] % 2).any():
            self._ledger.refuse(_RULE, "a set of states speaks of next values")
        return (variable | 1, number[table[1][kept]], number[table[2][kept]])

    def _each(self, lines: Iterable[Conjunct]) -> list[int]:
        return [self._translator.translate(line.expression) for line in lines]

    def _next_bits(self, places: Sequence[int]) -> NDArray[np.bool_]:
        found = np.zeros(2 * len(self._found.arrays["order"]), dtype=np.bool_)
        found[2 * np.asarray(places, dtype=np.int64) + 1] = True
        return found

    @staticmethod
    def _line(conjunct: Conjunct) -> str:
        text = conjunct.text if len(conjunct.text) <= 100 else f"{conjunct.text[:97]}..."
        return f"line {conjunct.line}: {text}"
