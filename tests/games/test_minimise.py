"""Minimised strategies play the same plays with no two nodes alike."""

from __future__ import annotations

import numpy as np

from surefoot.games.minimise import minimised
from surefoot.logic import Variable
from surefoot.logic.transducer import Transducer


def ring(values: list[int], memory: list[int]) -> Transducer:
    """Return a strategy without inputs that shows the values in turn, for ever."""
    nodes = len(values)
    return Transducer(
        player="system",
        variables=(Variable("x", 0, 9),),
        inputs=0,
        values=np.array(values)[:, None],
        memory=np.array(memory),
        first=np.arange(nodes + 1),
        successors=np.roll(np.arange(nodes), -1),
        initial=np.array([0]),
    )


def shown(machine: Transducer, steps: int) -> list[int]:
    node, values = int(machine.initial[0]), []
    for _ in range(steps):
        values.append(int(machine.values[node, 0]))
        node = int(machine.after(node)[0])
    return values


def test_nodes_that_differ_in_memory_alone_are_merged() -> None:
    machine = ring([1, 2, 3] * 4, list(range(12)))
    smaller = minimised(machine)
    assert smaller.nodes == 3
    assert shown(smaller, 20) == shown(machine, 20)


def test_nodes_that_part_ways_later_are_kept_apart() -> None:
    machine = ring([1, 1, 1, 1, 2], [0] * 5)
    assert minimised(machine) is machine


def test_a_strategy_without_nodes_stays() -> None:
    machine = Transducer(
        player="system",
        variables=(Variable("x", 0, 9),),
        inputs=0,
        values=np.zeros((0, 1), dtype=np.int32),
        memory=np.zeros(0, dtype=np.int32),
        first=np.zeros(1, dtype=np.int64),
        successors=np.zeros(0, dtype=np.int32),
        initial=np.zeros(0, dtype=np.int32),
    )
    assert minimised(machine).nodes == 0
