"""The generated members of the families are the stored ones, rule by rule."""

from __future__ import annotations

from pathlib import Path

import pytest

from surefoot.games import synthesize
from surefoot.games.families import genbuf
from surefoot.logic import parse_slugsin

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
