"""Synthesis from specification texts: the semantics that slugs has, strategies, limits, the choice of the engine."""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import pytest
from gr1_grid_oracle import random_game

from surefoot.compute import Deadline
from surefoot.games import synthesize
from surefoot.games.synthesis import EngineName
from surefoot.logic import Specification, parse_slugsin, parse_structuredslugs, read_specification
from surefoot.logic.strategy_file import save_strategy
from surefoot.logic.writers import write_structuredslugs
from surefoot.verdict import Answer
from surefoot.verify import verify_path

DATA = Path(__file__).parents[3] / "shared" / "data" / "specs"
ENGINES: tuple[EngineName, ...] = ("symbolic", "explicit")
UNREALIZABLE = {
    "unrealizable1",
    "example_outermost_fixed_point_unrealizability",
    "abstract_counterstrategy_example",
}
ONLY_BY_DEFAULT = {"semantics_diference", "optimisticRecoveryTest"}


@pytest.fixture(params=ENGINES)
def engine(request: pytest.FixtureRequest) -> EngineName:
    chosen: EngineName = request.param
    return chosen


def spec_of(text: str) -> Specification:
    return parse_structuredslugs(text, Path("text.structuredslugs"))


def test_outputs_may_see_the_next_inputs(engine: EngineName) -> None:
    spec = parse_slugsin("[INPUT]\na\n[OUTPUT]\nb\n[SYS_TRANS]\n! ^ a' b'\n", Path("text.slugsin"))
    assert synthesize(spec, engine=engine).verdict


def test_outputs_cannot_see_the_inputs_after_the_next(engine: EngineName) -> None:
    spec = parse_slugsin("[INPUT]\na\n[OUTPUT]\nb\n[SYS_TRANS]\n! ^ a' b\n", Path("text.slugsin"))
    assert synthesize(spec, engine=engine).verdict.answer is Answer.FALSE


def test_an_environment_dead_end_counts_as_asked(engine: EngineName) -> None:
    spec = spec_of("[INPUT]\na\n[OUTPUT]\nb\n[ENV_TRANS]\nb -> (a' & !a')\n[SYS_LIVENESS]\na & !a\n[SYS_INIT]\nb\n")
    assert synthesize(spec, engine=engine, env_dead_end="wins").verdict
    assert synthesize(spec, engine=engine, env_dead_end="loses").verdict.answer is Answer.FALSE


def test_a_sum_that_exceeds_the_range_in_env_trans_is_a_dead_end(engine: EngineName) -> None:
    spec = spec_of("[INPUT]\nx:0...3\n[OUTPUT]\nb\n[ENV_TRANS]\nx' = x + 1\n[SYS_LIVENESS]\nb & !b\n")
    assert synthesize(spec, engine=engine).verdict
    assert synthesize(spec, engine=engine, env_dead_end="loses").verdict.answer is Answer.FALSE


def test_goals_are_transitions(engine: EngineName) -> None:
    changes = "[INPUT]\na\n[OUTPUT]\nb\n[SYS_LIVENESS]\n(b & !b') | (a & !a' & b & b')\n"
    assert synthesize(spec_of(changes), engine=engine).verdict
    assert not synthesize(spec_of(changes + "[SYS_TRANS]\nb' <-> b\n"), engine=engine).verdict


def test_liveness_lines_are_goals_of_their_own(engine: EngineName) -> None:
    spec = spec_of("[INPUT]\n[OUTPUT]\nb\n[SYS_LIVENESS]\nb\n!b\n")
    answer = synthesize(spec, engine=engine)
    assert answer.strategy is not None
    assert answer.strategy.nodes == 2


def test_a_strategy_is_deterministic_and_the_same_every_time(engine: EngineName) -> None:
    spec = random_game(random.Random(3))
    one, two = synthesize(spec, engine=engine), synthesize(spec, engine=engine)
    first, second = one.strategy or one.counter_strategy, two.strategy or two.counter_strategy
    assert first is not None
    assert second is not None
    for name in ("values", "memory", "first", "successors", "initial"):
        np.testing.assert_array_equal(getattr(first, name), getattr(second, name))


def test_saved_strategies_of_both_players_pass_the_checker(tmp_path: Path, engine: EngineName) -> None:
    winners = set()
    for seed in range(60):
        source = random.Random(10_000 + seed)
        path = tmp_path / f"random{seed}.structuredslugs"
        path.write_text(write_structuredslugs(random_game(source)))
        spec, dead_end = read_specification(path), source.choice(["wins", "loses"])
        semantics = source.choice(["slugs", "robotics"])
        answer = synthesize(spec, semantics=semantics, env_dead_end=dead_end, engine=engine)  # type: ignore[arg-type]
        machine = answer.strategy or answer.counter_strategy
        assert machine is not None
        winners.add(machine.player)
        saved = tmp_path / f"random{seed}.json"
        save_strategy(saved, machine, spec, semantics=semantics, env_dead_end=dead_end)  # type: ignore[arg-type]
        assert verify_path(saved).accepted, f"seed {seed}"
    assert winners == {"system", "environment"}


def test_limits_are_answers_not_errors() -> None:
    text = "[INPUT]\nx:0...200\n[OUTPUT]\ny:0...200\n[SYS_TRANS]\ny' + y' != x' + x + 1\n[SYS_LIVENESS]\nx = y\n"
    late = synthesize(spec_of(text), deadline=Deadline.after(0.0))
    small = synthesize(spec_of(text), node_limit=1100, engine="symbolic")
    for answer, limit in ((late, "time limit"), (small, "nodes")):
        assert answer.verdict.answer is Answer.UNKNOWN
        assert limit in (answer.verdict.limit or "")
        assert answer.strategy is answer.counter_strategy is None


def test_the_choice_of_the_engine_is_reported() -> None:
    spec = spec_of("[INPUT]\na\n[OUTPUT]\nb\n[SYS_LIVENESS]\nb\n")
    assert synthesize(spec, engine="explicit").engine == "explicit"
    automatic = synthesize(spec)
    assert automatic.engine in ENGINES
    assert automatic.why_engine
    assert automatic.states == 2  # the present value of a matters to no rule


@pytest.mark.parametrize("option", [{"semantics": "tulip"}, {"engine": "magic"}, {"env_dead_end": "draws"}])
def test_unknown_options_are_refused(option: dict[str, str]) -> None:
    with pytest.raises(ValueError, match="is one of"):
        synthesize(spec_of("[INPUT]\n[OUTPUT]\nb\n"), **option)  # type: ignore[arg-type]


@pytest.mark.skipif(not DATA.is_dir(), reason="../shared/data/specs is not there")
@pytest.mark.parametrize("path", sorted(DATA.glob("*/*.s*")), ids=lambda path: path.stem)
def test_the_verdicts_of_slugs(path: Path) -> None:
    spec = read_specification(path)
    by_default = synthesize(spec, realizability_only=True, deadline=Deadline.after(120))
    assert by_default.verdict.answer is (Answer.FALSE if path.stem in UNREALIZABLE else Answer.TRUE)
    if path.parent.name == "slugs" and path.stem != "EvasionOnGrid_basicEvasion":
        robotics = synthesize(spec, semantics="robotics", realizability_only=True)
        if path.stem in UNREALIZABLE | ONLY_BY_DEFAULT:
            assert robotics.verdict.answer is Answer.FALSE
