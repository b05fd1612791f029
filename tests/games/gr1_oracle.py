"""Slow, plain answers about small games: the fixpoint on sets, a strategy played to the end, every strategy tried."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import product
from typing import Literal

import numpy as np
from hypothesis import strategies as st

from surefoot.games import Arena, EnvDeadEnd, Solution

Update = Literal["before the choice", "after the choice"]


def make_arena(
    system: list[bool], edges: list[list[int]], lost: set[int], goals: list[set[int]], justices: list[set[int]]
) -> Arena:
    nodes = len(system)

    def masks(sets: list[set[int]]) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
        return np.array([[v in chosen for v in range(nodes)] for chosen in sets], dtype=np.bool_).reshape(
            len(sets), nodes
        )

    return Arena(
        system=np.array(system, dtype=np.bool_),
        first=np.concatenate(([0], np.cumsum([len(row) for row in edges], dtype=np.int64))),
        successors=np.array([target for row in edges for target in row], dtype=np.int32),
        lost=masks([lost])[0],
        goals=masks(goals),
        justices=masks(justices),
    )


@st.composite
def arenas(draw: st.DrawFn, most_nodes: int = 8, most_edges: int = 3, most_sets: int = 3) -> Arena:
    """Draw a small arena: dead ends, double edges, no goals and no justices included."""
    nodes = draw(st.integers(1, most_nodes))
    one = st.integers(0, nodes - 1)
    some = st.sets(one)
    return make_arena(
        system=draw(st.lists(st.booleans(), min_size=nodes, max_size=nodes)),
        edges=draw(st.lists(st.lists(one, max_size=most_edges), min_size=nodes, max_size=nodes)),
        lost=draw(st.sets(one, max_size=2)),
        goals=draw(st.lists(some, max_size=most_sets)),
        justices=draw(st.lists(some, max_size=most_sets)),
    )


def random_arena(seed: int, nodes: int = 60) -> Arena:
    """Return an arena of many layers: nodes in a ring, edges to near ones, few goals, few lost nodes."""
    rng = np.random.default_rng(seed)
    edges = [[int(v + step) % nodes for step in rng.integers(-3, 5, size=rng.integers(1, 4))] for v in range(nodes)]
    pick = [set(rng.choice(nodes, size=size, replace=False).tolist()) for size in (1, 3, 4, 40, 50)]
    return make_arena((rng.random(nodes) < 0.7).tolist(), edges, pick[0], pick[1:3], pick[3:])


def _sets(masks: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]) -> list[set[int]]:
    return [set(np.flatnonzero(row).tolist()) for row in masks]


def _greatest(body: Callable[[set[int]], set[int]], everything: set[int]) -> set[int]:
    current, following = everything, body(everything)
    while following != current:
        current, following = following, body(following)
    return current


def naive_winning(arena: Arena, env_dead_end: EnvDeadEnd) -> set[int]:
    """Return the winning nodes by the formula, letter for letter, on Python sets."""
    everything = set(range(arena.nodes))
    successors = {v: arena.successors_of(v).tolist() for v in everything}
    safe = everything - _sets(arena.lost[None])[0]
    goals = _sets(arena.goals) or [everything]
    justices = _sets(arena.justices) or [everything]

    def can_force(v: int, target: set[int]) -> bool:
        if arena.system[v]:
            return any(w in target for w in successors[v])
        return all(w in target for w in successors[v]) and (bool(successors[v]) or env_dead_end == "wins")

    def cpre(target: set[int]) -> set[int]:
        return {v for v in everything if can_force(v, target)}

    def mu_y(z: set[int], goal: set[int]) -> set[int]:
        y: set[int] = set()
        while True:
            base = (goal & cpre(z)) | cpre(y)
            grown = set().union(*(nu_x(base, justice) for justice in justices))
            if grown == y:
                return y
            y = grown

    def nu_x(base: set[int], justice: set[int]) -> set[int]:
        return _greatest(lambda x: safe & (base | (cpre(x) - justice)), everything)

    return _greatest(lambda z: set.intersection(*(mu_y(z, goal) for goal in goals)), everything)


def faults_of(arena: Arena, solution: Solution, env_dead_end: EnvDeadEnd, update: Update) -> list[str]:
    """Play a strategy from all nodes that it calls winning, against every environment, and say what goes wrong."""

    def move(memory: int, v: int) -> int:
        return int(solution.choice[memory, v])

    return _faults(arena, set(np.flatnonzero(solution.winning).tolist()), move, env_dead_end, update)


def some_strategy_wins(arena: Arena, start: int, env_dead_end: EnvDeadEnd) -> bool:
    """Try every strategy whose memory is a goal index."""
    memories = max(len(arena.goals), 1)
    places = [(m, v) for m in range(memories) for v in range(arena.nodes) if arena.system[v] and arena.degree[v]]
    for edges in product(*(range(arena.degree[v]) for _, v in places)):
        if not _faults(
            arena, {start}, _table(dict(zip(places, edges, strict=True))), env_dead_end, "before the choice"
        ):
            return True
    return False


def _table(edges: dict[tuple[int, int], int]) -> Callable[[int, int], int]:
    return lambda memory, v: edges.get((memory, v), -1)


def _faults(
    arena: Arena, starts: set[int], move: Callable[[int, int], int], env_dead_end: EnvDeadEnd, update: Update
) -> list[str]:
    goals, justices = _sets(arena.goals), _sets(arena.justices)
    faults: list[str] = []

    def visited(memory: int, v: int) -> int:
        return (memory + 1) % len(goals) if goals and v in goals[memory] else memory

    def following(memory: int, v: int) -> Iterator[tuple[int, int]]:
        after = visited(memory, v)
        row = arena.successors_of(v).tolist()
        if arena.system[v]:
            edge = move(after if update == "before the choice" else memory, v)
            if not 0 <= edge < len(row):
                faults.append(f"no move at node {v} with memory {memory}")
                return
            row = [row[edge]]
        elif not row and env_dead_end == "loses":
            faults.append(f"the environment is stuck at node {v}")
        for w in row:
            yield after, w

    plays: dict[tuple[int, int], set[tuple[int, int]]] = {}
    stack = [(0, v) for v in starts]
    while stack:
        state = stack.pop()
        if state not in plays:
            if arena.lost[state[1]]:
                faults.append(f"lost node {state[1]}")
            plays[state] = set(following(*state))
            stack.extend(plays[state])
    for g, goal in enumerate(goals):
        rest = {s: {t for t in targets if t[1] not in goal} for s, targets in plays.items() if s[1] not in goal}
        fair = [sorted(loop) for loop in _loops(rest) if all(loop & justice for justice in justices)]
        faults.extend(f"a fair loop through {loop} never visits goal {g}" for loop in fair)
    return faults


def _loops(graph: dict[tuple[int, int], set[tuple[int, int]]]) -> list[set[int]]:
    """Return the nodes of every strongly connected component that has an edge inside (Kosaraju)."""
    order: list[tuple[int, int]] = []
    seen: set[tuple[int, int]] = set()
    for root in graph:
        stack = [(root, iter(graph[root]))] if root not in seen else []
        seen.add(root)
        while stack:
            state, targets = stack[-1]
            fresh = next((t for t in targets if t not in seen), None)
            if fresh is None:
                order.append(state)
                stack.pop()
            else:
                seen.add(fresh)
                stack.append((fresh, iter(graph[fresh])))
    sources: dict[tuple[int, int], list[tuple[int, int]]] = {state: [] for state in graph}
    for state, following in graph.items():
        for target in following:
            sources[target].append(state)
    component: dict[tuple[int, int], int] = {}
    for number, root in enumerate(reversed(order)):
        pending = [root]
        while pending:
            state = pending.pop()
            if state not in component:
                component[state] = number
                pending.extend(s for s in sources[state] if s not in component)
    inside = {component[s] for s, targets in graph.items() for t in targets if component[s] == component[t]}
    return [{s[1] for s, number in component.items() if number == chosen} for chosen in sorted(inside)]
