"""Solvers of the naive planner: fixpoints over sets of states, as they are defined."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from surefoot.verify.navigation.decisions import Decision
from surefoot.verify.plan.action import Core

Moves = dict[Decision, dict[int, list[tuple[Decision, bool]]]]
State = tuple[Core, int]
Option = tuple[int, int, list[tuple[int, bool]]]


def gr1(moves: Moves, broken: Callable[[Decision, int], int]) -> dict[Decision, int]:
    """Return winning orders for: if each justice holds infinitely often, goals are reached infinitely often."""
    number = {decision: place for place, decision in enumerate(moves)}
    options = [
        [
            (order, broken(decision, order), [(number[after], goal) for after, goal in answers])
            for order, answers in orders.items()
        ]
        for decision, orders in moves.items()
    ]
    winning = set(number.values())
    while True:
        orders = _attractor(options, winning)
        if len(orders) == len(winning):
            return {decision: orders[place] for decision, place in number.items() if place in orders}
        winning = set(orders)


def _attractor(options: list[list[Option]], winning: set[int]) -> dict[int, int]:
    """Return from where the robot reaches a goal inside the winning states, and its orders."""
    orders: dict[int, int] = {}
    while True:
        before = len(orders)
        for justice in range(4):
            orders |= _waiting(options, winning, orders, justice)
        if len(orders) == before:
            return orders


def _waiting(options: list[list[Option]], winning: set[int], reached: dict[int, int], justice: int) -> dict[int, int]:
    """Return from where the robot gets on, or waits while one justice is broken: a greatest fixpoint."""
    kept = winning - reached.keys()
    while True:
        found: dict[int, int] = {}
        for decision in kept:
            for order, breaks, after in options[decision]:
                if all(
                    (goal and o in winning) or o in reached or (breaks == justice and o in kept) for o, goal in after
                ):
                    found[decision] = order
                    break
        if len(found) == len(kept):
            return found
        kept = set(found)


def reached_from(start: Any, after: Callable[[Any], Iterable[Any]]) -> list[Any]:
    found = {start: None}
    queue = [start]
    for item in queue:
        for option in after(item):
            if option not in found:
                found[option] = None
                queue.append(option)
    return queue


def buchi(moves: dict[State, dict[int, list[tuple[State, bool]]]]) -> dict[State, int]:
    """Return actions that achieve orders infinitely often."""
    winning = set(moves)
    while True:
        actions: dict[State, int] = {}
        while True:
            grown = {}
            for state in winning:
                if state in actions:
                    continue
                for action, after in moves[state].items():
                    if all((done and option in winning) or (not done and option in actions) for option, done in after):
                        grown[state] = action
                        break
            if not grown:
                break
            actions.update(grown)
        if len(actions) == len(winning):
            return actions
        winning = set(actions)
