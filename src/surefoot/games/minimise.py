"""Listed strategies with fewer nodes: those that behave alike for ever are merged, whatever their memory says.

Partition refinement: nodes begin in one class if they show the same values (and the environment makes the same move),
and are told apart as long as their successors are in different classes. Sets of successor classes are compared by sums
of random numbers; a mistake, next to impossible, would not pass the certificate.

Source: Moore, "Gedanken-experiments on sequential machines", Automata Studies, 1956.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot.logic.transducer import Transducer

MOST_ROUNDS = 200


def minimised(machine: Transducer) -> Transducer:
    """Return a strategy with the same plays and no two nodes that behave alike; the same one if it has none."""
    found = _classes(machine)
    if found is None:
        return machine
    count = int(found.max()) + 1 if len(found) else 0
    if count == machine.nodes:
        return machine
    _, kept = np.unique(found, return_index=True)
    degree = np.diff(machine.first)[kept]
    first = np.concatenate([[0], np.cumsum(degree)])
    edges = np.repeat(machine.first[:-1][kept] - first[:-1], degree) + np.arange(first[-1])
    return replace(
        machine,
        values=machine.values[kept],
        memory=machine.memory[kept],
        first=first,
        successors=found[machine.successors[edges]],
        initial=found[machine.initial],
        moves=None if machine.moves is None else machine.moves[kept],
    )


def _classes(machine: Transducer) -> NDArray[np.int32] | None:
    """Return the class of every node; None if that takes too many rounds."""
    shown = machine.values if machine.moves is None else np.hstack([machine.values, machine.moves])
    found = _numbered(shown)
    source = np.random.default_rng(0)
    nodes, sources = machine.nodes, np.repeat(np.arange(machine.nodes), np.diff(machine.first))
    for _ in range(MOST_ROUNDS):
        marks = source.integers(0, 2**63, size=nodes, dtype=np.uint64)
        sums = np.zeros(nodes, dtype=np.uint64)
        np.add.at(sums, sources, marks[found[machine.successors]])
        finer = _numbered(np.column_stack([found.astype(np.uint64), sums]))
        if finer.max(initial=0) == found.max(initial=0):
            return finer
        found = finer
    return None


def _numbered(rows: NDArray[Any]) -> NDArray[np.int32]:
    """Return a number for every row, the same for equal ones, in the order of their first appearance."""
    _, first, inverse = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    rank = np.argsort(np.argsort(first))
    return rank[inverse.reshape(-1)].astype(np.int32)
