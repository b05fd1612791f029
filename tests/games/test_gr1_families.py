"""The generated members of the families are the stored ones, rule by rule."""

from __future__ import annotations

from pathlib import Path

import pytest

from surefoot.games import synthesize
from surefoot.games.families import genbuf, member
from surefoot.logic import Specification, parse_slugsin, read_specification
from surefoot.logic.syntax import Conjunct, Variable
from surefoot.verify.gr1.sets import Sets, Translator

DATA = Path(__file__).parents[3] / "shared" / "data" / "specs" / "gr1experiments"


def rules_of(text: str) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    section = ""
    for line in text.splitlines():
        if line.startswith("["):
            section = line.strip()
        elif line.strip() and not line.startswith("#"):
            found.setdefault(section, []).append(" ".join(line.split()))
    return {name: sorted(lines) for name, lines in found.items()}


@pytest.mark.skipif(not DATA.is_dir(), reason="../shared/data/specs is not there")
@pytest.mark.parametrize("senders", [2, 3, 5, 10])
def test_the_buffer_is_the_stored_one(senders: int) -> None:
    assert rules_of(genbuf(senders)) == rules_of((DATA / f"genbuf_{senders}.slugsin").read_text())


@pytest.mark.parametrize("senders", [4, 12])
def test_members_in_between_are_realizable(senders: int) -> None:
    assert synthesize(parse_slugsin(genbuf(senders), Path("genbuf.slugsin")), realizability_only=True).verdict


def test_a_buffer_has_two_senders() -> None:
    with pytest.raises(ValueError, match="at least 2 senders"):
        genbuf(1)


BUNNY = {
    "envkey": "envenvkey0",
    "syskey": "syssyskey0",
    **{name: f"pidglobal_{name}" for name in ("xt", "yt", "x", "y")},
}
SYNT = {"envkey": "envenvkey0", "count": "pid0_count", "decide_prev": "pidglobal_decide_prev1"}
SYNT |= {name: f"sys{name}" for name in ("syskey0", "syskey1")}
GLOBAL = ("pc0", "pc1", "pc2", "ps0", "ps1")
TWIN = {"hburst": "hburst{0}_0", "hmaster": "hmaster{0}_0", "stateG3": "stateG3_{0}_0"}


def stored_bit(family: str, variable: Variable, k: int) -> str:
    """Return how the stored members call a bit of a generated one."""
    name = variable.name
    if family == "jcss12":
        if name == "stateA1":
            return f"pidglobal_stateA1_{1 - k}_0"
        return "pidglobal_" + TWIN.get(name, name + "_0").format(k)
    if name in GLOBAL:
        return f"{name}_0"
    named = (BUNNY if family == "bunny" else SYNT).get(name, f"pidglobal_{name}")
    return f"{named}_{k}" if not variable.is_boolean else named


@pytest.mark.skipif(not DATA.is_dir(), reason="../shared/data/specs is not there")
@pytest.mark.parametrize(
    ("family", "size", "file"),
    [
        *(("bunny", size, f"bunny_many_goals_{size}") for size in (2, 4, 6, 8)),
        *(("jcss12", size, f"jcss12_{size}") for size in (2, 4)),
        *(("synt15", size, f"synt15_{size}") for size in (2, 4)),
    ],
)
def test_generated_members_mean_what_the_stored_ones_mean(family: str, size: int, file: str) -> None:
    """From every state that either can be in, both sides have the same steps, starts, justices and goals."""
    stored, made = read_specification(DATA / f"{file}.slugsin"), member(family, size)
    names = [variable.name for variable in stored.variables]
    place = [names.index(stored_bit(family, v, k)) for v in made.variables for k in range(len(v.bits))]
    assert sorted(place) == list(range(len(names)))
    sets = Sets(2 * len(names))
    old, new = Translator(stored, sets, range(len(names))), Translator(made, sets, place)

    def both(section: str) -> tuple[int, int]:
        def together(translator: Translator, spec: Specification) -> int:
            lines: tuple[Conjunct, ...] = getattr(spec, section)
            return sets.conjoin(translator.translate(line.expression) for line in lines)

        return together(old, stored), together(new, made)

    def same(pair: tuple[int, int], where: int) -> bool:
        return sets.conjoin((sets.differ(*pair), where)) == sets.conjoin((0, 1))

    fixed = ("pc0", "pc1") if family == "bunny" else ()
    still = [sets.variable(2 * names.index(f"{name}_0")) ^ 1 for name in fixed]
    here = sets.conjoin((new.in_range(made.variables, primed=False), *still))
    env_next = new.in_range(made.inputs, primed=True)
    sys_next = new.in_range(made.outputs, primed=True)
    env_old, env_new = both("env_trans")
    env_new = sets.conjoin((env_new, env_next))
    fox = [new.translate(line.expression) for line in made.env_init if line.text == "xt >= 1"]
    inside = sets.conjoin((here, *fox))
    assert same((env_old, env_new), inside)
    sys_old, sys_new = both("sys_trans")
    assert same((sys_old, sets.conjoin((sys_new, sys_next))), sets.conjoin((inside, env_new)))
    env_begin, sys_begin = both("env_init"), both("sys_init")
    assert same(env_begin, new.in_range(made.inputs, primed=False))
    assert same(sys_begin, here)
    for section in ("env_liveness", "sys_liveness"):
        pairs = zip(getattr(stored, section), getattr(made, section), strict=True)
        for one, other in pairs:
            assert same((old.translate(one.expression), new.translate(other.expression)), here)


@pytest.mark.parametrize(("family", "size"), [("bunny", 3), ("bunny", 12), ("jcss12", 3), ("synt15", 3), ("synt15", 7)])
def test_other_members_are_realizable(family: str, size: int) -> None:
    assert synthesize(member(family, size), realizability_only=True).verdict


def test_families_and_their_sizes_are_named() -> None:
    with pytest.raises(ValueError, match="the families are genbuf, bunny, jcss12, synt15"):
        member("arbiter", 2)
    for family in ("bunny", "jcss12", "synt15"):
        with pytest.raises(ValueError, match=r"at least .*2"):
            member(family, 1)
