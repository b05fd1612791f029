"""The shortest play of a counter-strategy, for JSON and in words, with the lines that decide it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from surefoot.cli.gr1 import conjunct_object

if TYPE_CHECKING:
    from surefoot.logic import Conjunct, Specification, Transducer

MOST_LINES = 2000


def play_object(specification: Specification, counter: Transducer) -> dict[str, object]:
    """Return the shortest play of a strategy of the environment.

    ``steps``: inputs and outputs of every step. ``loop_from``: the step to which the play returns for ever, with
    ``never_met``, the goal that never holds on the loop. Or ``last_move``: inputs that leave the system no answer, with
    ``because``, lines of the system that leave none.
    """
    from surefoot.logic.plays import shortest_play

    lasso = shortest_play(counter)
    steps = [_step(counter, node) for node in lasso.nodes]
    found: dict[str, object] = {"steps": steps, "loop_from": lasso.loop_from, "last_move": None}
    if lasso.loop_from is not None:
        loop = [*lasso.nodes[lasso.loop_from :], lasso.nodes[lasso.loop_from]]
        return found | {"never_met": [conjunct_object(c) for c in _never_met(specification, counter, loop)]}
    names = [variable.name for variable in specification.inputs]
    if not lasso.nodes:
        row = [] if counter.initial_inputs is None else counter.initial_inputs.tolist()
        move = dict(zip(names, row, strict=True))
        lines, current, following, primed = specification.sys_init, move, {}, False
    else:
        row = [] if counter.moves is None else counter.moves[lasso.nodes[-1]].tolist()
        move = dict(zip(names, row, strict=True)) if all(value > -(2**31) for value in row) else {}
        if row and not move:
            return found | {"last_move": None, "because": []}
        current, following, primed = counter.valuation(lasso.nodes[-1]), move, True
        lines = specification.system_safety
    because = _blocking(specification, lines, current, following, primed=primed)
    return found | {"last_move": _typed(specification, move), "because": [conjunct_object(c) for c in because]}


def play_words(specification: Specification, play: Mapping[str, Any]) -> list[str]:
    """Return a play, as ``play_object`` gives it, for a person."""
    lines = [
        f"  {place}: environment {in_words(specification, step['inputs'])};"
        f" system {in_words(specification, step['outputs'])}"
        for place, step in enumerate(play["steps"])
    ]
    if play["loop_from"] is not None:
        never_met = [_line(item) for item in play["never_met"]]
        return [*lines, f"  and again from {play['loop_from']}, for ever; never met:", *never_met]
    if play["last_move"] is None:
        return [*lines, "  the environment has no move, which counts as its win"]
    move = in_words(specification, play["last_move"])
    lines.append(f"  {len(play['steps'])}: environment {move}; the system has no answer")
    because = [_line(item) for item in play["because"]]
    return [*lines, "  because of:", *because] if because else lines


def _line(item: Mapping[str, Any]) -> str:
    return f"    {item['section']}, line {item['line']}: {item['text'][:90]}"


def in_words(specification: Specification, values: Mapping[str, int]) -> str:
    """Return some values in words, variables in the order of the specification."""
    shown = [v.shown(int(values[v.name])) for v in specification.variables if v.name in values]
    return ", ".join(shown) or "(nothing)"


def _step(counter: Transducer, node: int) -> dict[str, object]:
    values = counter.values[node].tolist()
    typed = {v.name: _shown(v.is_boolean, value) for v, value in zip(counter.variables, values, strict=True)}
    names = list(typed)
    return {
        "inputs": {name: typed[name] for name in names[: counter.inputs]},
        "outputs": {name: typed[name] for name in names[counter.inputs :]},
    }


def _shown(is_boolean: bool, value: int) -> bool | int:
    return bool(value) if is_boolean else value


def _typed(specification: Specification, values: Mapping[str, int]) -> dict[str, bool | int]:
    return {v.name: _shown(v.is_boolean, values[v.name]) for v in specification.variables if v.name in values}


def _never_met(specification: Specification, counter: Transducer, loop: Sequence[int]) -> list[Conjunct]:
    """Return the goals that hold on no step of a loop."""
    from surefoot.logic import Evaluator

    evaluate = Evaluator(specification)
    steps = [(counter.valuation(a), counter.valuation(b)) for a, b in pairwise(loop)]
    return [
        goal
        for goal in specification.sys_liveness
        if not any(bool(evaluate(goal.expression, now, after)) for now, after in steps)
    ]


def _blocking(
    specification: Specification,
    lines: Sequence[Conjunct],
    current: Mapping[str, int],
    following: Mapping[str, int],
    *,
    primed: bool,
) -> list[Conjunct]:
    """Return lines of the system that leave it no answer, each of them needed; none when there are too many to try."""
    import numpy as np

    from surefoot.errors import LimitExceeded
    from surefoot.logic import Evaluator
    from surefoot.verify.gr1.choices import Choices

    evaluator = Evaluator(specification)
    now = {name: np.array([value]) for name, value in current.items()}
    after = {name: np.array([value]) for name, value in following.items()}

    def blocks(kept: Sequence[Conjunct]) -> bool:
        choices = Choices(evaluator, [c.expression for c in kept], specification.outputs, primed=primed)
        return not choices.count(now, after, 1)[0]

    if len(lines) > MOST_LINES:
        return []
    try:
        if not blocks(lines):
            return []
        return _minimal(list(lines), blocks)
    except LimitExceeded:
        return []


def _minimal(lines: list[Conjunct], blocks: Callable[[Sequence[Conjunct]], bool]) -> list[Conjunct]:
    """Return a subset that blocks and of which every line is needed: large pieces are dropped first."""
    size = len(lines) // 2
    while size >= 1:
        place = 0
        while place < len(lines):
            kept = lines[:place] + lines[place + size :]
            if blocks(kept):
                lines = kept
            else:
                place += size
        size //= 2
    return lines
