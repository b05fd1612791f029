"""Both engines and a naive oracle decide thousands of random specifications alike; strategies are certified."""

from __future__ import annotations

import random
from collections.abc import Iterator
from pathlib import Path

import pytest

from gr1_specs import random_specification
from naive_gr1 import Game, decide_naively
from surefoot.games import EnvDeadEnd, synthesize
from surefoot.logic import read_specification, write_structuredslugs
from surefoot.logic.strategy_file import save_strategy
from surefoot.logic.transducer import Semantics
from surefoot.verify import verify_path

SIZE = 250
BATCHES = [0, 1, *(pytest.param(batch, marks=pytest.mark.campaign) for batch in range(2, 8))]
SEMANTICS: tuple[Semantics, Semantics] = ("slugs", "robotics")


def drawn(batch: int) -> Iterator[tuple[Game, int]]:
    """Yield games with their reachable states; of those with few every other one is left out."""
    source = random.Random(batch)
    kept = 0
    while kept < SIZE:
        game = Game(random_specification(source, most_outputs=4), env_dead_end="loses" if kept % 8 == 7 else "wins")
        reachable = len(game.reachable())
        if reachable > 10 or source.random() < 0.5:
            kept += 1
            yield game, reachable


@pytest.mark.parametrize("batch", BATCHES)
def test_engines_agree_with_the_oracle(batch: int, capsys: pytest.CaptureFixture[str]) -> None:
    unrealizable = large = assuming = 0
    for place, (game, reachable) in enumerate(drawn(batch)):
        spec, semantics = game.spec, SEMANTICS[place % 2]
        dead_end: EnvDeadEnd = "wins" if game.dead_end_won else "loses"
        expected = decide_naively(game, semantics=semantics)
        for engine in ("explicit", "symbolic"):
            answer = synthesize(
                spec,
                semantics=semantics,
                engine=engine,
                env_dead_end=dead_end,
                realizability_only=True,
            )
            assert answer.engine == engine
            assert bool(answer.verdict) == expected, (engine, semantics, dead_end, write_structuredslugs(spec))
        unrealizable += not expected
        large += reachable > 10
        assuming += bool(spec.env_trans or spec.env_liveness)
    shares = unrealizable / SIZE, large / SIZE, assuming / SIZE
    with capsys.disabled():
        print(
            f" {SIZE} specifications: {shares[0]:.0%} unrealizable, {shares[1]:.0%} with more than 10 reachable states,"
            f" {shares[2]:.0%} with assumptions"
        )
    assert shares[0] >= 0.25
    assert shares[1] >= 0.5
    assert shares[2] >= 1 / 3


@pytest.mark.parametrize("engine", ["explicit", "symbolic"])
def test_strategies_of_both_players_are_certified(engine: str, tmp_path: Path) -> None:
    source = random.Random(2023)
    seen = {True: 0, False: 0}
    for place in range(120):
        path = tmp_path / "spec.structuredslugs"
        path.write_text(write_structuredslugs(random_specification(source, most_outputs=3)))
        spec = read_specification(path)
        semantics = SEMANTICS[place % 2]
        answer = synthesize(spec, semantics=semantics, engine=engine)  # type: ignore[arg-type]
        strategy = answer.strategy or answer.counter_strategy
        assert strategy is not None
        save_strategy(tmp_path / "strategy.json", strategy, spec, semantics=semantics)
        report = verify_path(tmp_path / "strategy.json")
        assert report.findings == (), path.read_text()
        assert (report.counts["player"] == "system") == bool(answer.verdict)
        seen[bool(answer.verdict)] += 1
    assert min(seen.values()) >= 25
