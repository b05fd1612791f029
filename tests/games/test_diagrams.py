"""Every back end of decision diagrams, by one test class."""

from __future__ import annotations

from itertools import product
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surefoot.errors import InputError, LimitExceeded
from surefoot.games.diagram_backends import diagrams
from surefoot.games.diagrams import Backend, Diagrams

VARIABLES = 5
Formula = Any
VALUATIONS = list(product([False, True], repeat=VARIABLES))


def formulas() -> st.SearchStrategy[Formula]:
    leaves = st.integers(0, VARIABLES - 1) | st.booleans()
    return st.recursive(
        leaves,
        lambda below: st.tuples(st.just("not"), below) | st.tuples(st.sampled_from(["and", "or", "xor"]), below, below),
        max_leaves=12,
    )


def value(formula: Formula, valuation: tuple[bool, ...]) -> bool:
    if isinstance(formula, bool):
        return formula
    if isinstance(formula, int):
        return valuation[formula]
    sides = [value(part, valuation) for part in formula[1:]]
    return {"not": lambda: not sides[0], "and": lambda: all(sides), "or": lambda: any(sides)}.get(
        formula[0], lambda: sides[0] != sides[1]
    )()


def built(manager: Diagrams, formula: Formula) -> Any:
    if isinstance(formula, bool):
        return manager.true if formula else manager.false
    if isinstance(formula, int):
        return manager.variable(formula)
    sides = [built(manager, part) for part in formula[1:]]
    if formula[0] == "not":
        return ~sides[0]
    operation = {"and": manager.conjoin, "or": manager.unite, "xor": manager.differ}[formula[0]]
    return operation(sides[0], sides[1])


def holds(manager: Diagrams, function: Any, valuation: tuple[bool, ...]) -> bool:
    while (parts := manager.cofactors(function)) is not None:
        function = parts[2] if valuation[parts[0]] else parts[1]
    return bool(function == manager.true)


def truth(manager: Diagrams, function: Any) -> list[bool]:
    return [holds(manager, function, valuation) for valuation in VALUATIONS]


@pytest.fixture(params=["oxidd", "cudd"], scope="class")
def backend(request: pytest.FixtureRequest) -> Backend:
    if request.param == "cudd":
        pytest.importorskip("dd.cudd", reason="dd with CUDD is not installed")
    chosen: Backend = request.param
    return chosen


class TestEveryBackend:
    @settings(max_examples=150, deadline=None)
    @given(formula=formulas())
    def test_a_set_is_what_the_formula_says(self, backend: Backend, formula: Formula) -> None:
        manager = diagrams(VARIABLES, backend=backend)
        function = built(manager, formula)
        expected = [value(formula, valuation) for valuation in VALUATIONS]
        assert truth(manager, function) == expected
        assert manager.count(function, VARIABLES) == sum(expected)
        picked = manager.pick(function)
        assert (picked is None) == (not any(expected))
        if picked is not None:
            assert all(
                value(formula, valuation)
                for valuation in VALUATIONS
                if all(valuation[index] == wanted for index, wanted in picked.items())
            )

    @settings(max_examples=100, deadline=None)
    @given(left=formulas(), right=formulas(), chosen=st.sets(st.integers(0, VARIABLES - 1)))
    def test_projection(self, backend: Backend, left: Formula, right: Formula, chosen: set[int]) -> None:
        manager = diagrams(VARIABLES, backend=backend)
        one, two, cube = built(manager, left), built(manager, right), manager.cube(chosen)
        both = manager.conjoin(one, two)
        assert manager.and_exists(one, two, cube) == manager.exists(both, cube)
        expected = [
            any(
                value(left, other) and value(right, other)
                for other in VALUATIONS
                if all(other[k] == valuation[k] for k in range(VARIABLES) if k not in chosen)
            )
            for valuation in VALUATIONS
        ]
        assert truth(manager, manager.exists(both, cube)) == expected

    @settings(max_examples=60, deadline=None)
    @given(formula=formulas(), order=st.permutations(range(VARIABLES)))
    def test_renaming_happens_all_at_once(self, backend: Backend, formula: Formula, order: list[int]) -> None:
        manager = diagrams(VARIABLES, backend=backend)
        renamed = manager.rename(built(manager, formula), manager.renaming(list(enumerate(order))))
        expected = [value(formula, tuple(valuation[new] for new in order)) for valuation in VALUATIONS]
        assert truth(manager, renamed) == expected

    def test_equal_sets_are_equal_and_hash_alike(self, backend: Backend) -> None:
        manager = diagrams(2, backend=backend)
        a, b = manager.variable(0), manager.variable(1)
        assert ~manager.unite(a, b) == manager.conjoin(~a, ~b)
        assert len({~manager.unite(a, b), manager.conjoin(~a, ~b)}) == 1

    def test_sizes_count_nodes(self, backend: Backend) -> None:
        manager = diagrams(3, backend=backend)
        parity = manager.differ(manager.variable(0), manager.differ(manager.variable(1), manager.variable(2)))
        assert 3 <= manager.size(parity) <= 6
        assert manager.nodes() >= 3


def test_the_node_limit_ends_a_computation() -> None:
    half = 14
    manager = diagrams(2 * half, node_limit=2000)

    def grow() -> None:
        equal = manager.true
        for k in range(half):
            equal = manager.conjoin(equal, ~manager.differ(manager.variable(k), manager.variable(half + k)))

    with pytest.raises(LimitExceeded, match="2000 decision diagram nodes"):
        grow()


def test_an_unknown_back_end_is_refused() -> None:
    with pytest.raises(InputError, match="oxidd, cudd"):
        diagrams(1, backend="buddy")  # type: ignore[arg-type]
