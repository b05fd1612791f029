"""The navigation game explored by its readable rules, node by node, and assumption (c) by its definition."""

from __future__ import annotations

from itertools import product

from surefoot.frames import Direction
from surefoot.navigation import NavigationGame, NavigationProblem, ObstacleState, Order, Rules, allowed_orders

Place = tuple[int, int, ObstacleState]


def naive_turns(problem: NavigationProblem) -> dict[tuple[Place, int], frozenset[Place]]:
    """Return for every reachable decision and safe order the decisions that can follow."""
    rules = Rules(problem)
    queue = [(problem.start, int(problem.heading), rules.start())]
    met, turns = set(queue), {}
    for cell, heading, state in queue:
        for order in allowed_orders(problem.coarse, cell, Direction(heading)):
            if rules.is_lost(cell, order, state):
                continue
            arrival, facing = rules.arrival(cell, Direction(heading), order)
            after = {(arrival, int(facing), known) for known in rules.outcomes(cell, arrival, order, state)}
            turns[(cell, heading, state), order.code] = frozenset(after)
            queue += sorted(after - met, key=str)
            met |= after
    return turns


def built_turns(game: NavigationGame) -> dict[tuple[Place, int], frozenset[Place]]:
    """Return the same of a built game."""
    arena, turns = game.arena, {}

    def place(node: int) -> Place:
        return int(game.cell[node]), int(game.heading[node]), game.states[game.knowledge[node]]

    for node in (game.order < 0).nonzero()[0].tolist():
        for turn in arena.successors_of(node).tolist():
            order = int(game.order[turn])
            answer = arena.successors_of(turn)[0] if order >= 4 else turn
            turns[place(node), order] = frozenset(map(place, arena.successors_of(answer).tolist()))
    return turns


def naive_blocked(problem: NavigationProblem, cell: int, direction: Direction, state: ObstacleState) -> bool:
    """Return whether assumption (c) promises that a wait will not last, by the words of rules.md 4."""
    rules, coarse = Rules(problem), problem.coarse
    kinds = rules.kinds
    goal = int(coarse.target[cell, direction])
    for kind, visible, hidden in zip(kinds, state.visible, state.hidden, strict=True):
        domain = set(kinds.members(kind.within))
        threats = {x for x in domain if {cell, goal} & set(kinds.reach(kind, x))}
        seen = {x for x in domain if coarse.sees[cell, x]}

        def component(x: int, domain: set[int] = domain, step: object = kind) -> set[int]:
            found, queue = {x} - {cell}, [x] if x != cell else []
            for y in queue:
                near = set(kinds.members(step.beside[kinds.bit[y]])) - found - {cell}  # type: ignore[attr-defined]
                found |= near
                queue += near
            return found & domain

        if any(x in threats and component(x) - threats for x in visible):
            return True
        believed = kinds.members(hidden)
        if any(x in threats for x in believed) and all((component(x) & seen) - threats for x in believed):
            return True
    return False


def true_situations(problem: NavigationProblem, decide: object) -> tuple[int, list[object]]:
    """Walk the product of a strategy, what it knows, and where all obstacles truly are.

    Returns:
        how many situations there are, and those from which no goal can be reached any more.
    """
    rules = Rules(problem)
    kinds, coarse = rules.kinds, problem.coarse
    slots = [(number, kind) for number, kind in enumerate(kinds) for _ in kind.obstacles]
    starts = tuple(problem.obstacles[obstacle].start for kind in kinds for obstacle in kind.obstacles)
    goal = 1 % len(problem.goals) if problem.start == problem.goals[0] else 0
    queue = [(problem.start, problem.heading, rules.start(), goal, starts)]
    before: dict[object, list[object]] = {queue[0]: []}
    alive: list[object] = []
    for situation in queue:
        cell, heading, state, goal, truth = situation
        order: Order = decide(cell, heading, state, goal)  # type: ignore[operator]
        arrival, facing = rules.arrival(cell, heading, order)
        advanced = not order.waits and arrival == problem.goals[goal]
        if advanced:
            alive.append(situation)
        after_goal = (goal + 1) % len(problem.goals) if advanced else goal
        view = arrival if problem.view == "post" else cell
        known = {after.visible: after for after in rules.outcomes(cell, arrival, order, state)}
        ways = [kinds.reach(kind, x, cell if order.waits else None) for (_, kind), x in zip(slots, truth, strict=True)]
        for moved in product(*ways):
            columns: list[list[int]] = [[] for _ in kinds]
            for (number, _), x in zip(slots, moved, strict=True):
                if coarse.sees[view, x]:
                    columns[number].append(x)
            after = known[tuple(tuple(sorted(column)) for column in columns)]
            for (number, _), x in zip(slots, moved, strict=True):
                assert coarse.sees[view, x] or after.hidden[number] >> kinds.bit[x] & 1, "the belief lost an obstacle"
                assert order.waits or x not in (cell, arrival), "a collision"
            told = tuple(x for _, x in sorted(zip((n for n, _ in slots), moved, strict=True)))
            reached = (arrival, facing, after, after_goal, told)
            if reached not in before:
                before[reached] = []
                queue.append(reached)
            before[reached].append(situation)
    found = set(alive)
    for good in alive:
        for earlier in before[good]:
            if earlier not in found:
                found.add(earlier)
                alive.append(earlier)
    return len(queue), [situation for situation in queue if situation not in found]
