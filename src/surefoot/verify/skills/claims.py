"""Derives again what a library of skills says about its own making (docs/formats.md 11).

``fewest`` of a pair is a bound that depends on what was known when its turn came; only its range is checked, and of
times their sums.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from surefoot.verify.findings import Ledger
from surefoot.verify.values import Fields

_HANDLED = ("realizable", "repaired")
_PAIR_S, _CHECK_S, _SUM_S = 5e-6, 5e-5, 6e-4


def check_claims(library: Fields, verdicts: Mapping[str, str], ledger: Ledger) -> None:
    """Check what pairs say that was asked for them, and the numbers of the answer.

    Args:
        library: the file.
        verdicts: of every primitive, by name.
        ledger: takes the findings.
    """
    pairs = tuple(library.mappings("pairs"))
    for pair in pairs:
        problem = _asked_problem(pair, verdicts)
        if problem:
            ledger.refuse("skills, asked", problem, pair.place)
    answer = library.mapping("answer")
    for name, expected in _numbers(library, pairs, verdicts).items():
        given = None if answer.get(name) is None else answer.number(name)
        if (given is None) != (expected is None) or not math.isclose(given or 0.0, expected or 0.0, abs_tol=1e-9):
            ledger.refuse("skills, counts", f"{expected} was counted, not {given}", f"answer.{name}")
    checks = tuple(library.mappings("checks"))
    for name, times, each_s in (
        ("symbolic_s", [one.number("symbolic_s", least=0.0) for one in pairs], _PAIR_S),
        ("checks_s", [one.number("time_s", least=0.0) for one in checks], _CHECK_S),
    ):
        if abs(answer.number(name) - sum(times)) > each_s * len(times) + _SUM_S:
            ledger.refuse("skills, counts", f"the times add up to {sum(times):g} s", f"answer.{name}")
    answer.number("time_s", least=0.0)


def _asked_problem(pair: Fields, verdicts: Mapping[str, str]) -> str:
    """Return what is wrong with what a pair says that was asked for it; empty if nothing is."""
    asked, new = _names(pair, "asked"), _names(pair, "new")
    unknown = [one for one in asked if one not in verdicts]
    if unknown or len(set(asked)) != len(asked):
        return f"says that {unknown[0] if unknown else 'something twice'} was asked, which has no answer of its own"
    if new != [one for one in asked if verdicts[one] == "feasible"]:
        return "new skills are not those that were asked for and found"
    outcome, fewest = pair.text("outcome"), pair.whole("fewest", least=0)
    if outcome in _HANDLED and (outcome == "repaired") != bool(new):
        return f"is {outcome} with {len(new)} new skills"
    if fewest > (len(new) if outcome == "repaired" else 0):
        return f"needs at least {fewest} new skills, and has {len(new)}"
    return ""


def _names(fields: Fields, name: str) -> list[str]:
    return [str(one) for one in fields.items(name)]


def _numbers(library: Fields, pairs: Sequence[Fields], verdicts: Mapping[str, str]) -> dict[str, float | None]:
    """Return the numbers of the answer that follow from the rest of the file."""
    outcomes = [pair.text("outcome") for pair in pairs]
    causes = [pair.mapping("why").text("cause") for pair in pairs if pair.get("why") is not None]
    asked = [one for pair in pairs for one in _names(pair, "asked")]
    start = sum(verdicts.get(one) == "feasible" for one in _names(library, "start"))
    handled, repaired = sum(one in _HANDLED for one in outcomes), outcomes.count("repaired")
    in_need = repaired + len(outcomes) - handled
    return {
        "start_skills": start,
        "unrepairable_by_obstacles": causes.count("obstacle"),
        "unrepairable_by_physics": causes.count("physics"),
        "suggested": len(asked),
        "suggested_feasible": sum(verdicts.get(one) == "feasible" for one in asked),
        "fewest_new": sum(pair.whole("fewest") for pair in pairs if pair.text("outcome") == "repaired"),
        "exhaustive": _every(library) - start,
        "handled_as_the_paper_counts": handled / len(pairs) if pairs else None,
        "repaired_of_those_in_need": repaired / in_need if in_need else None,
    }


def _every(library: Fields) -> int:
    """Return how many primitives there are: directions times pairs of classes, and two turns per class."""
    classes = len(library.items("classes"))
    if not library.has("headings"):
        return int(4 * classes**2)
    return int(len(library.mapping("headings").items("directions")) * classes**2 + 2 * classes)
