"""What a specification demands, evaluated on the nodes and edges of a strategy."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surefoot.logic.evaluate import Evaluator
from surefoot.logic.syntax import Conjunct, Specification, Variable
from surefoot.verify.gr1.choices import Columns
from surefoot.verify.gr1.file import Ints

CHUNK = 100_000


@dataclass(frozen=True, slots=True, eq=False)
class Edges:
    """The steps of the reachable part of a strategy.

    Attributes:
        sources: (E,) nodes.
        targets: (E,) nodes.
    """

    sources: Ints
    targets: Ints


class Rules:
    """A specification over the node values of a strategy."""

    def __init__(self, specification: Specification, values: Ints) -> None:
        """Take a specification and (N, V) values."""
        self.specification = specification
        self.values = values
        self.evaluator = Evaluator(specification)

    def columns(self, nodes: Ints, variables: Iterable[Variable] | None = None) -> Columns:
        """Return the values of variables in some nodes, by name; of all variables by default."""
        wanted = None if variables is None else {variable.name for variable in variables}
        return {
            variable.name: self.values[nodes, k]
            for k, variable in enumerate(self.specification.variables)
            if wanted is None or variable.name in wanted
        }

    def in_range(self, nodes: Ints) -> NDArray[np.bool_]:
        """Return in which nodes every variable has one of its values."""
        lower = np.array([v.values[0] for v in self.specification.variables], dtype=np.int64)
        upper = np.array([v.values[-1] for v in self.specification.variables], dtype=np.int64)
        values = self.values[nodes]
        return np.asarray(((values >= lower) & (values <= upper)).all(axis=1), dtype=np.bool_)

    def on_nodes(self, conjunct: Conjunct, nodes: Ints) -> NDArray[np.bool_]:
        """Return in which nodes a conjunct without primes holds."""
        return np.broadcast_to(self.evaluator(conjunct.expression, self.columns(nodes)), nodes.shape)

    def on_edges(self, conjunct: Conjunct, edges: Edges) -> NDArray[np.bool_]:
        """Return on which steps a conjunct holds."""
        holds = np.ones(len(edges.sources), dtype=np.bool_)
        for start in range(0, len(holds), CHUNK):
            part = slice(start, start + CHUNK)
            current, following = self.columns(edges.sources[part]), self.columns(edges.targets[part])
            holds[part] = self.evaluator(conjunct.expression, current, following)
        return holds

    def shown(self, node: int) -> str:
        """Return the valuation of a node for a person."""
        pairs = zip(self.specification.variables, self.values[node].tolist(), strict=True)
        return ", ".join(variable.shown(value) for variable, value in pairs)

    def line(self, conjunct: Conjunct) -> str:
        """Return where a conjunct stands, for a person."""
        text = conjunct.text if len(conjunct.text) <= 100 else f"{conjunct.text[:97]}..."
        return f"line {conjunct.line}: {text}"
