"""Two engines and brute force on random specifications: 2,000 of them, with the shares printed."""

from __future__ import annotations

import random
from collections import Counter

import pytest
from gr1_grid_oracle import Grid, random_game

from surefoot.games import EnvDeadEnd, synthesize
from surefoot.games.synthesis import EngineName, Semantics
from surefoot.verdict import Answer

SPECIFICATIONS = 2000
SEMANTICS: tuple[Semantics, ...] = ("slugs", "robotics")
DEAD_ENDS: tuple[EnvDeadEnd, ...] = ("wins", "loses")
ENGINES: tuple[EngineName, ...] = ("symbolic", "explicit")


def test_both_engines_agree_with_brute_force(capsys: pytest.CaptureFixture[str]) -> None:
    shares: Counter[str] = Counter()
    for seed in range(SPECIFICATIONS):
        source = random.Random(seed)
        spec = random_game(source)
        semantics, dead_end = source.choice(SEMANTICS), source.choice(DEAD_ENDS)
        grid = Grid.of(spec)
        expected = Answer.TRUE if grid.realizable(semantics, dead_end) else Answer.FALSE
        shares["unrealizable"] += expected is Answer.FALSE
        shares["more than 10 reachable states"] += grid.reachable() > 10
        shares["with assumptions"] += bool(spec.env_liveness)
        for engine in ENGINES:
            answer = synthesize(
                spec, semantics=semantics, env_dead_end=dead_end, engine=engine, realizability_only=True
            )
            assert answer.verdict.answer is expected, f"seed {seed}: {engine}, {semantics}, dead end {dead_end}"
    with capsys.disabled():
        print(f"\n{SPECIFICATIONS} random specifications:", {k: f"{v / SPECIFICATIONS:.0%}" for k, v in shares.items()})
    assert shares["unrealizable"] >= SPECIFICATIONS / 4
    assert shares["unrealizable"] <= 3 * SPECIFICATIONS / 4
    assert shares["more than 10 reachable states"] >= SPECIFICATIONS / 2
    assert shares["with assumptions"] >= SPECIFICATIONS / 3
