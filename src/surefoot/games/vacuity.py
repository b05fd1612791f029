"""Ways in which a strategy wins for the wrong reason, with the lines responsible.

Three are looked for: nothing may begin (a false initial condition); the environment runs into a dead end of its own
safety; or the system brings about that the environment cannot keep its justices, and need not do its work.

Source: Maoz and Ringert, "On well-separation of GR(1) specifications", FSE 2016, here along one strategy.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from surefoot.compute import Deadline
from surefoot.errors import LimitExceeded
from surefoot.games.attempts import attempt
from surefoot.games.bits import bit_game
from surefoot.games.cores import minimal
from surefoot.games.partial import substituted
from surefoot.games.solution import FOREVER
from surefoot.logic.building import FALSE
from surefoot.logic.evaluate import Evaluator
from surefoot.logic.syntax import Conjunct, Specification, bit_owners
from surefoot.logic.transducer import Transducer


def vacuities(
    specification: Specification, strategy: Transducer, *, deadline: Deadline = FOREVER
) -> tuple[tuple[str, str, tuple[Conjunct, ...]], ...]:
    """Return in which ways a strategy of the system wins for the wrong reason.

    Args:
        specification: what it was made for.
        strategy: of the system.
        deadline: when to stop searching for the lines responsible; the ways are found all the same.

    Returns:
        (kind, sentence, lines) with the kinds ``false_initial``, ``env_dead_end`` and ``falsified_assumption``.
    """
    found: list[tuple[str, str, tuple[Conjunct, ...]]] = []
    if not len(strategy.initial):
        lines = _contradiction(specification, specification.env_init, deadline)
        found.append(("false_initial", "no initial state is allowed, so every strategy wins", lines))
        return tuple(found)
    dead = np.flatnonzero(np.diff(strategy.first) == 0)
    if len(dead):
        node = int(dead[0])
        lines = _contradiction(specification, _next_inputs(specification, strategy, node), deadline)
        sentence = (
            f"the environment has no move in {len(dead)} states that are reached, such as: {strategy.shown(node)}"
        )
        found.append(("env_dead_end", sentence, lines))
    hopeless, lines = _hopeless(specification, strategy, dead)
    if len(hopeless):
        sentence = (
            f"the system can win by keeping the environment from its justices, from {len(hopeless)} states on, "
            f"such as: {strategy.shown(int(hopeless[0]))}"
        )
        found.append(("falsified_assumption", sentence, lines))
    return tuple(found)


def _next_inputs(specification: Specification, strategy: Transducer, node: int) -> tuple[Conjunct, ...]:
    """Return what the environment's safety says in one state, about next inputs written without primes."""
    values = strategy.valuation(node)
    for bit, (variable, position) in bit_owners(specification).items():
        values[bit] = (values[variable.name] - variable.values[0]) >> position & 1
    return tuple(
        replace(line, expression=substituted(line.expression, values, {}, unprime=True))
        for line in specification.environment_safety
    )


def _contradiction(
    specification: Specification, lines: tuple[Conjunct, ...], deadline: Deadline
) -> tuple[Conjunct, ...]:
    """Return a minimal set of conditions on the inputs that contradict each other; none when that takes too long.

    A specification whose system may not begin at all is realizable exactly when nothing may begin.
    """
    never = Conjunct("SYS_INIT", FALSE, "FALSE")
    question = Specification(specification.inputs, specification.outputs, sys_init=(never,))

    def contradict(kept: tuple[Conjunct, ...]) -> bool:
        asked = bit_game(replace(question, env_init=kept))
        solved, result = attempt(asked, robotics=False, env_dead_end="wins", deadline=deadline)
        return solved.wins_initially(result.winning, robotics=False)

    try:
        return minimal(lines, contradict) if contradict(lines) else ()
    except LimitExceeded:
        return ()


def _hopeless(
    specification: Specification, strategy: Transducer, dead: NDArray[np.int64]
) -> tuple[NDArray[np.int64], tuple[Conjunct, ...]]:
    """Return the nodes from which no play of the strategy keeps all justices, and justices that fail there.

    Dead ends, and nodes that only lead to them, are not counted: they have a warning of their own.
    """
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import connected_components

    justices = specification.env_liveness
    if not justices:
        return np.zeros(0, dtype=np.int64), ()
    nodes = strategy.nodes
    sources = np.repeat(np.arange(nodes), np.diff(strategy.first))
    targets = strategy.successors
    graph = csr_matrix((np.ones(len(targets), dtype=np.int8), targets, strategy.first), shape=(nodes, nodes))
    count, component = connected_components(graph, directed=True, connection="strong")
    inside = component[sources] == component[targets]
    holds = [_on_edges(specification, strategy, justice, sources) for justice in justices]
    fair = np.zeros(count, dtype=np.bool_)
    fair[component[sources[inside]]] = True
    for justice in holds:
        met = np.zeros(count, dtype=np.bool_)
        met[component[sources[inside & justice]]] = True
        fair &= met
    hopeful = fair[component]
    hopeful[dead] = True
    hopeful = _leads_to(hopeful, sources, targets)
    hopeless = np.flatnonzero(~hopeful)
    there = ~hopeful[sources] & inside
    lines = tuple(line for line, justice in zip(justices, holds, strict=True) if not (justice & there).any())
    return hopeless, lines or justices


def _leads_to(goal: NDArray[np.bool_], sources: NDArray[np.int64], targets: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Return from which nodes a goal can be reached."""
    reached = goal.copy()
    while True:
        grown = reached.copy()
        grown[sources[reached[targets]]] = True
        if (grown == reached).all():
            return reached
        reached = grown


def _on_edges(
    specification: Specification, strategy: Transducer, line: Conjunct, sources: NDArray[np.int64]
) -> NDArray[np.bool_]:
    """Return on which steps of a strategy a line holds."""
    columns = {v.name: strategy.values[:, k] for k, v in enumerate(strategy.variables)}
    now = {name: column[sources] for name, column in columns.items()}
    after = {name: column[strategy.successors] for name, column in columns.items()}
    found = Evaluator(specification)(line.expression, now, after)
    return np.broadcast_to(found, sources.shape)
