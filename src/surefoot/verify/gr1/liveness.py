"""Justices and goals on the cycles of a strategy, by strongly connected components."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surefoot.verify.findings import Ledger
from surefoot.verify.gr1.rules import Edges, Rules

Flags = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Cycles:
    """The strongly connected components that some of the edges make.

    Attributes:
        component: (N,) the component of every node.
        of_edge: (E,) the component of every edge's source.
        inside: (E,) the edges in use that stay in their component: exactly those on cycles.
    """

    component: NDArray[np.int64]
    of_edge: NDArray[np.int64]
    inside: Flags

    def with_edge(self, edges: Flags | None = None) -> Flags:
        """Return which components have such an edge on a cycle."""
        found = np.zeros(int(self.component.max()) + 1 if len(self.component) else 0, dtype=np.bool_)
        found[self.of_edge[self.inside if edges is None else self.inside & edges]] = True
        return found


def check_system_liveness(rules: Rules, edges: Edges, nodes: int, ledger: Ledger) -> None:
    """Check that no cycle meets all justices and misses a goal.

    A goal is missed for ever exactly on the edges where it does not hold; a fair play that stays on them ends in one of
    their components, and takes an edge of every justice there again and again.
    """
    justices = [rules.on_edges(conjunct, edges) for conjunct in rules.specification.env_liveness]
    for goal in rules.specification.sys_liveness:
        cycles = _cycles(edges, ~rules.on_edges(goal, edges), nodes)
        bad = cycles.with_edge()
        for justice in justices:
            bad &= cycles.with_edge(justice)
        _refuse(rules, rules.line(goal), bad, cycles, ledger, "a fair cycle never meets this goal")


def check_environment_liveness(rules: Rules, edges: Edges, nodes: int, ledger: Ledger) -> None:
    """Check that every cycle meets all justices, and that no play meets all goals again and again."""
    for justice in rules.specification.env_liveness:
        cycles = _cycles(edges, ~rules.on_edges(justice, edges), nodes)
        _refuse(rules, rules.line(justice), cycles.with_edge(), cycles, ledger, "a cycle never meets this justice")
    cycles = _cycles(edges, np.ones(len(edges.sources), dtype=np.bool_), nodes)
    bad = cycles.with_edge()
    for goal in rules.specification.sys_liveness:
        bad &= cycles.with_edge(rules.on_edges(goal, edges))
    _refuse(rules, "SYS_LIVENESS", bad, cycles, ledger, "the system can meet all its goals again and again")


def _cycles(edges: Edges, use: Flags, nodes: int) -> Cycles:
    """Return the components of the graph of the edges in use."""
    from surefoot.verify.graphs import components

    order = np.argsort(edges.sources, kind="stable")
    counts = np.bincount(edges.sources, minlength=nodes)
    first = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
    component = components(first, edges.targets[order], use[order])
    of_edge = component[edges.sources]
    return Cycles(component, of_edge, use & (of_edge == component[edges.targets]))


def _refuse(rules: Rules, rule: str, bad: Flags, cycles: Cycles, ledger: Ledger, message: str) -> None:
    """Note bad components, each with one of its states."""
    for number in np.flatnonzero(bad)[:20].tolist():
        node = int(np.flatnonzero(cycles.component == number)[0])
        ledger.refuse(rule, message, rules.shown(node))
