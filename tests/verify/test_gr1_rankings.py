"""Rankings: accepted exactly when they win, played as they were certified, and every kind of damage is noticed."""

from __future__ import annotations

import json
import random
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gr1_specs import random_specification
from surefoot.compute import sha256_of
from surefoot.errors import InputError
from surefoot.games import synthesize
from surefoot.games.ranking_listing import listed
from surefoot.games.ranking_player import RankingPlayer
from surefoot.logic import Conjunct, Evaluator, Specification, read_specification, write_structuredslugs
from surefoot.logic.ranking import Ranking
from surefoot.logic.ranking_file import load_ranking, save_ranking
from surefoot.logic.strategy_file import save_strategy
from surefoot.logic.transducer import Semantics
from surefoot.verify import verify_path
from surefoot.verify.gr1._kernels import FALSE
from surefoot.verify.gr1.sets import Sets, Translator

Arrays = dict[str, Any]

LIFT = """
[INPUT]
call
speed:1...3
[OUTPUT]
floor:0...4
door
[ENV_INIT]
!call
[SYS_INIT]
floor = 0
[ENV_TRANS]
call & floor != 2 -> call'
speed' <= speed + 1
[SYS_TRANS]
floor' <= floor + 1
floor <= floor' + 1
door -> floor' = floor
door' & speed' = 3 -> floor' != 3
floor = 4 -> !door
[ENV_LIVENESS]
call
speed = 3
[SYS_LIVENESS]
door' & floor' = 2
floor = 0
floor + speed' = 7
"""


def spec_from(text: str, folder: Path) -> Specification:
    path = folder / "game.structuredslugs"
    path.write_text(text)
    return read_specification(path)


def ranked(spec: Specification, semantics: Semantics = "slugs") -> Ranking | None:
    answer = synthesize(spec, form="ranking", semantics=semantics)
    assert (answer.ranking is not None) == bool(answer.verdict)
    return answer.ranking


def broken_lines(spec: Specification, now: dict[str, int], after: dict[str, int]) -> list[Conjunct]:
    evaluate = Evaluator(spec)
    return [line for line in spec.system_safety if not evaluate(line.expression, now, after)]


def random_play(spec: Specification, ranking: Ranking, steps: int, seed: int) -> list[dict[str, int]]:
    """Return the states of a play against random inputs; it ends where there are none."""
    player, source = RankingPlayer(ranking), np.random.default_rng(seed)
    inputs = player.inputs(None, {}, source)
    assert inputs is not None
    begun = player.start(inputs)
    assert begun is not None
    memory, state = begun
    names = [v.name for v in spec.variables]
    play = [dict(zip(names, player.decoded(state), strict=True))]
    while len(play) < steps and (inputs := player.inputs(state, {}, source)) is not None:
        memory, state = player.answer(memory, state, inputs)
        play.append(dict(zip(names, player.decoded(state), strict=True)))
    return play


def test_a_ranking_is_accepted_saved_and_played(tmp_path: Path) -> None:
    spec = spec_from(LIFT, tmp_path)
    ranking = ranked(spec)
    assert ranking is not None
    files = save_ranking(tmp_path / "lift.json", ranking, spec)
    assert [file.name for file in files] == ["lift.json", "lift.npz"]
    report = verify_path(tmp_path / "lift.json")
    assert report.accepted, report.findings
    again = load_ranking(tmp_path / "lift.json").ranking
    assert all(np.array_equal(a, b) for a, b in zip(ranking.arrays().values(), again.arrays().values(), strict=True))
    play = random_play(spec, again, 400, seed=1)
    steps = list(pairwise(play))
    assert not any(broken_lines(spec, *step) for step in steps)
    evaluate = Evaluator(spec)
    for goal in spec.sys_liveness:
        assert sum(bool(evaluate(goal.expression, *step)) for step in steps) > 5


@pytest.mark.parametrize("semantics", ["slugs", "robotics"])
def test_rankings_of_random_specifications_are_accepted_and_keep_their_promises(
    tmp_path: Path, semantics: Semantics
) -> None:
    accepted = 0
    for seed in range(60):
        path = tmp_path / f"{seed}.structuredslugs"
        path.write_text(write_structuredslugs(random_specification(random.Random(seed), most_outputs=3)))
        spec = read_specification(path)
        ranking = ranked(spec, semantics)
        if ranking is None:
            continue
        save_ranking(tmp_path / "r.json", ranking, spec, semantics=semantics)
        report = verify_path(tmp_path / "r.json")
        assert report.accepted, (seed, report.findings)
        accepted += 1
        transducer = listed(ranking, semantics)
        assert transducer is not None
        save_strategy(tmp_path / "s.json", transducer, spec, semantics=semantics)
        assert verify_path(tmp_path / "s.json").accepted, seed
        if semantics == "slugs" and RankingPlayer(ranking).inputs(None, {}, None) is not None:
            play = random_play(spec, ranking, 20, seed)
            assert not any(broken_lines(spec, now, after) for now, after in pairwise(play))
    assert accepted > 20


def test_a_ranking_that_forgets_dead_ends_is_refused_where_they_lose(tmp_path: Path) -> None:
    text = "[INPUT]\nx:0...4\n[OUTPUT]\nc\n[ENV_INIT]\nx = 0\n[ENV_TRANS]\nx' = x + 1\n[SYS_LIVENESS]\nx = 5 - 0\n"
    spec = spec_from(text.replace("x = 5 - 0", "FALSE"), tmp_path)
    ranking = ranked(spec)
    assert ranking is not None
    save_ranking(tmp_path / "r.json", ranking, spec)
    assert verify_path(tmp_path / "r.json").accepted
    save_ranking(tmp_path / "r.json", ranking, spec, env_dead_end="loses")
    report = verify_path(tmp_path / "r.json")
    assert [finding.rule for finding in report.findings] == ["env_dead_end: loses"]


def everything_wins(arrays: Arrays) -> None:
    arrays["winning"] = 1
    arrays["layers"][arrays["first"][1:] - 1] = 1


def no_start(arrays: Arrays) -> None:
    arrays["winning"] = 0
    arrays["layers"][:] = 0


def fewer_layers(arrays: Arrays) -> None:
    kept = arrays["first"][1:] - 1
    arrays["layers"], arrays["waits_for"] = arrays["layers"][kept], arrays["waits_for"][kept]
    arrays["first"] = np.arange(len(kept) + 1)


def no_rules(arrays: Arrays) -> None:
    arrays["system"] = arrays["system"][:0]


def no_moves(arrays: Arrays) -> None:
    arrays["environment"] = np.zeros(1, dtype=np.int32)


def easy_goal(arrays: Arrays) -> None:
    arrays["goals"][0] = 1


def goal_missing(arrays: Arrays) -> None:
    last = arrays["first"][-2]
    arrays["goals"], arrays["first"] = arrays["goals"][:-1], arrays["first"][:-1]
    arrays["layers"], arrays["waits_for"] = arrays["layers"][:last], arrays["waits_for"][:last]


def waits_for_nothing(arrays: Arrays) -> None:
    arrays["waits_for"][:] = -1


def waits_for_another(arrays: Arrays) -> None:
    arrays["waits_for"] = np.where(arrays["waits_for"] >= 0, 1 - arrays["waits_for"], -1)


def starts_anywhere(arrays: Arrays) -> None:
    arrays["sys_init"] = 1


def speaks_of_next(arrays: Arrays) -> None:
    arrays["winning"] = int(np.flatnonzero(arrays["variable"][2:] % 2)[0]) + 2


DAMAGES = [
    everything_wins,
    no_start,
    fewer_layers,
    no_rules,
    no_moves,
    easy_goal,
    goal_missing,
    waits_for_nothing,
    waits_for_another,
    starts_anywhere,
    speaks_of_next,
]


def damaged(path: Path, damage: Callable[[Arrays], None]) -> None:
    """Damage the arrays of a ranking and make the hash fit again."""
    beside = path.with_suffix(".npz")
    with np.load(beside) as archive:
        arrays = {name: archive[name].copy() for name in archive.files}
    damage(arrays)
    np.savez(beside, **arrays)
    header = json.loads(path.read_text())
    header["arrays"]["sha256"] = sha256_of(beside)
    path.write_text(json.dumps(header))


@pytest.mark.parametrize("damage", DAMAGES, ids=lambda damage: damage.__name__)
def test_damaged_rankings_are_refused(tmp_path: Path, damage: Callable[[Arrays], None]) -> None:
    spec = spec_from(LIFT, tmp_path)
    ranking = ranked(spec)
    assert ranking is not None
    path = tmp_path / "r.json"
    save_ranking(path, ranking, spec)
    damaged(path, damage)
    report = verify_path(path)
    assert not report.accepted
    assert report.findings


def test_a_ranking_of_an_easier_specification_is_refused(tmp_path: Path) -> None:
    """Every line of the system and of the environment counts: a ranking made without it is not accepted."""
    whole = spec_from(LIFT, tmp_path)
    texts = ("floor' <= floor + 1", "door -> floor' = floor", "floor = 0\n[ENV_TRANS]", "call'", "floor = 4 -> !door")
    for text in texts:
        fewer = tmp_path / "fewer.structuredslugs"
        fewer.write_text(LIFT.replace(text, "TRUE" if "[" not in text else "TRUE\n[ENV_TRANS]"))
        ranking = ranked(read_specification(fewer))
        if ranking is not None:
            save_ranking(tmp_path / "r.json", ranking, whole)
            assert not verify_path(tmp_path / "r.json").accepted, text


def test_random_damage_never_wins_by_accident(tmp_path: Path) -> None:
    """Whatever is accepted after random damage still says what its specification says."""
    spec = spec_from(LIFT, tmp_path)
    ranking = ranked(spec)
    assert ranking is not None
    source = np.random.default_rng(0)
    refused = 0
    for _ in range(60):
        path = tmp_path / "r.json"
        save_ranking(path, ranking, spec)

        def damage(arrays: Arrays) -> None:
            name = ("layers", "low", "high", "waits_for", "goals", "system")[int(source.integers(6))]
            place = int(source.integers(len(arrays[name])))
            arrays[name][place] = int(source.integers(-1, len(arrays["variable"])))

        damaged(path, damage)
        try:
            report = verify_path(path)
        except InputError:
            refused += 1
            continue
        refused += not report.accepted
        if report.accepted:
            play = random_play(spec, load_ranking(path).ranking, 60, seed=3)
            assert not any(broken_lines(spec, now, after) for now, after in pairwise(play))
    assert refused > 40


@pytest.mark.parametrize(
    ("name", "value", "complaint"),
    [
        ("order", [0, 0, 1], "has to hold the bits"),
        ("low", [9], "has to name an earlier row"),
        ("first", [0, 1], "has to rise from 0"),
        ("layers", [10**6], "has to hold rows"),
    ],
)
def test_broken_rankings_are_bad_input(tmp_path: Path, name: str, value: list[int], complaint: str) -> None:
    spec = spec_from(LIFT, tmp_path)
    ranking = ranked(spec)
    assert ranking is not None
    path = tmp_path / "r.json"
    save_ranking(path, ranking, spec)
    damaged(path, lambda arrays: arrays.update({name: np.array(value, dtype=np.int32)}))
    with pytest.raises(InputError, match=complaint):
        verify_path(path)
    with pytest.raises(InputError):
        load_ranking(path)


def test_a_ranking_of_another_specification_is_bad_input(tmp_path: Path) -> None:
    spec = spec_from(LIFT, tmp_path)
    ranking = ranked(spec)
    assert ranking is not None
    save_ranking(tmp_path / "r.json", ranking, spec)
    (tmp_path / "game.structuredslugs").write_text(LIFT + "\n[SYS_TRANS]\ndoor\n")
    with pytest.raises(InputError, match=r"another version|hashes differ"):
        verify_path(tmp_path / "r.json")


@pytest.mark.parametrize("operator", ["=", "!=", "<", "<=", ">", ">="])
def test_integers_are_added_and_compared_as_numbers(tmp_path: Path, operator: str) -> None:
    lines = f"x + y {operator} z' + 2\nz {operator} x\n3 {operator} y + y + x"
    spec = spec_from(f"[INPUT]\nx:2...6\n[OUTPUT]\ny:0...4\nz:1...5\n[SYS_TRANS]\n{lines}\n", tmp_path)
    sets = Sets(2 * sum(len(v.bits) for v in spec.variables))
    translator = Translator(spec, sets, range(9))
    inside = translator.in_range(spec.variables, primed=False), translator.in_range(spec.variables, primed=True)
    evaluate = Evaluator(spec)
    x, y, z, later = (part.ravel() for part in np.meshgrid(range(2, 7), range(5), range(1, 6), range(1, 6)))
    for line in spec.sys_trans:
        truth = evaluate(line.expression, {"x": x, "y": y, "z": z}, {"x": x, "y": y, "z": later})
        found = sets.share(sets.conjoin((*inside, translator.translate(line.expression))))
        assert found == pytest.approx(truth.mean() * 5**6 / 8**6)
        for k in range(0, len(x), 7):
            values = zip((x[k] - 2, y[k], z[k] - 1), (0, 0, later[k] - 1), strict=True)
            bits = [(one >> b & 1, two >> b & 1) for one, two in values for b in range(3)]
            state = [
                sets.variable(2 * place + after) ^ (not bit)
                for place, pair in enumerate(bits)
                for after, bit in enumerate(pair)
            ]
            inside_line = sets.conjoin((*state, translator.translate(line.expression)))
            assert (inside_line != FALSE) == truth[k]


def test_integers_of_thousands_of_values_are_certified(tmp_path: Path) -> None:
    parts = ("[INPUT]\nx:0...900", "[OUTPUT]\ny:0...900", "[SYS_TRANS]\ny' = x'", "[SYS_LIVENESS]\ny < x' + 500")
    text = "\n".join((*parts, "[ENV_LIVENESS]\nx + y > 2\n"))
    spec = spec_from(text, tmp_path)
    ranking = ranked(spec)
    assert ranking is not None
    save_ranking(tmp_path / "ranking.json", ranking, spec)
    assert verify_path(tmp_path / "ranking.json").accepted


def test_a_ranking_of_too_many_moves_is_not_listed(tmp_path: Path) -> None:
    ranking = ranked(spec_from(LIFT, tmp_path))
    assert ranking is not None
    whole = listed(ranking)
    assert whole is not None
    assert listed(ranking, most=len(whole.successors)) is None
