"""The limits of integers, as conjuncts: in INIT for all variables, in TRANS for primed ones only, as in slugs."""

from __future__ import annotations

from surefoot.logic.syntax import Comparison, Conjunct, Integer, Number, Specification, Variable


def range_conjuncts(specification: Specification) -> tuple[Conjunct, ...]:
    """Return the limits of all integers whose bits could hold other values too.

    Inputs give conjuncts of ENV_INIT and ENV_TRANS, outputs of SYS_INIT and SYS_TRANS. They stand in line 0.
    """
    found: list[Conjunct] = []
    for player, variables in (("ENV", specification.inputs), ("SYS", specification.outputs)):
        for section, primed in ((f"{player}_INIT", False), (f"{player}_TRANS", True)):
            found.extend(_limit(variable, section, primed) for variable in variables if _has_gaps(variable))
    return tuple(found)


def _has_gaps(variable: Variable) -> bool:
    return not variable.is_boolean and len(variable.values) != 2 ** len(variable.bits)


def _limit(variable: Variable, section: str, primed: bool) -> Conjunct:
    name = f"{variable.name}'" if primed else variable.name
    upper = variable.values[-1]
    return Conjunct(section, Comparison("<=", Integer(variable.name, primed), Number(upper)), f"{name} <= {upper}")
