"""Strategies of GR(1) specifications are accepted exactly when they win; every kind of damage is noticed."""

from __future__ import annotations

import json
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gr1_specs import random_specification
from naive_gr1 import Game, solve_naively
from surefoot.errors import InputError
from surefoot.logic import Specification, read_specification, write_structuredslugs
from surefoot.logic.strategy_file import load_strategy, save_strategy
from surefoot.logic.transducer import Semantics
from surefoot.verify import verify_path

Json = dict[str, Any]

LIFT = """
[INPUT]
call
[OUTPUT]
floor:0...2
door
[ENV_INIT]
!call
[SYS_INIT]
floor = 0
[ENV_TRANS]
call & floor != 2 -> call'
[SYS_TRANS]
floor' <= floor + 1
floor <= floor' + 1
door -> floor' = floor
[ENV_LIVENESS]
call
[SYS_LIVENESS]
door' & floor' = 2
floor' = 0
"""
STUBBORN = """
[INPUT]
wall
[OUTPUT]
x:0...3
[SYS_INIT]
x = 0
[SYS_TRANS]
x' <= x + 1
x <= x' + 1
wall' -> x' != 2
[ENV_LIVENESS]
wall
[SYS_LIVENESS]
x = 3
"""


def written(folder: Path, text: str, name: str = "spec.structuredslugs") -> Specification:
    path = folder / name
    path.write_text(text)
    return read_specification(path)


def saved(folder: Path, spec: Specification, semantics: Semantics = "slugs") -> tuple[Path, bool]:
    """Solve naively and save the strategy of whoever wins; return also whether that is the system."""
    answer = solve_naively(spec, semantics=semantics)
    path = folder / "strategy.json"
    save_strategy(path, answer.strategy, spec, semantics=semantics)
    return path, answer.realizable


def changed(path: Path, change: Callable[[Json], None]) -> Path:
    """Save a strategy with some change under another name."""
    value = json.loads(path.read_text())
    change(value)
    other = path.with_name("changed.json")
    other.write_text(json.dumps(value))
    return other


@pytest.mark.parametrize(("text", "realizable"), [(LIFT, True), (STUBBORN, False)])
@pytest.mark.parametrize("semantics", ["slugs", "robotics"])
def test_strategies_of_both_players_are_accepted(
    tmp_path: Path, text: str, realizable: bool, semantics: Semantics
) -> None:
    path, system_wins = saved(tmp_path, written(tmp_path, text), semantics)
    assert system_wins is realizable
    report = verify_path(path)
    assert (report.kind, report.accepted, report.findings) == ("gr1-strategy", True, ())
    assert report.counts["checked_states"] == load_strategy(path).transducer.nodes


@settings(max_examples=120, deadline=None)
@given(st.integers(0, 2**32), st.sampled_from(["slugs", "robotics"]), st.sampled_from(["wins", "loses"]))
def test_strategies_of_random_specifications_are_accepted(
    tmp_path_factory: pytest.TempPathFactory, seed: int, semantics: Semantics, dead_end: Any
) -> None:
    folder = tmp_path_factory.getbasetemp()
    spec = written(folder, write_structuredslugs(random_specification(random.Random(seed))))
    answer = solve_naively(spec, semantics=semantics, env_dead_end=dead_end)
    path = folder / "random.json"
    save_strategy(path, answer.strategy, spec, semantics=semantics, env_dead_end=dead_end)
    assert verify_path(path).findings == ()


def test_large_strategies_keep_their_arrays_beside_them(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("surefoot.logic.strategy_file.LARGEST_IN_JSON", 10)
    path, _ = saved(tmp_path, written(tmp_path, LIFT))
    assert path.with_suffix(".npz").is_file()
    assert verify_path(path).accepted
    assert load_strategy(path).transducer.nodes > 3
    path.with_suffix(".npz").write_bytes(b"broken")
    with pytest.raises(InputError, match=r"does not fit strategy\.npz"):
        verify_path(path)


# ---- mutations -------------------------------------------------------------------------------------------------------


def flip_value(value: Json, source: random.Random) -> None:
    rows = value["arrays"]["values"]
    row = source.choice(rows)
    column = source.randrange(len(row))
    row[column] = row[column] + source.choice((-1, 1))


def drop_successor(value: Json, source: random.Random) -> None:
    first, successors = value["arrays"]["first"], value["arrays"]["successors"]
    edge = source.randrange(len(successors))
    del successors[edge]
    value["arrays"]["first"] = [offset - (offset > edge) for offset in first]


def redirect_successor(value: Json, source: random.Random) -> None:
    arrays = value["arrays"]
    arrays["successors"][source.randrange(len(arrays["successors"]))] = source.randrange(len(arrays["memory"]))


def repeat_successor(value: Json, source: random.Random) -> None:
    first, successors = value["arrays"]["first"], value["arrays"]["successors"]
    edge = source.randrange(len(successors))
    successors.insert(edge, successors[edge])
    value["arrays"]["first"] = [offset + (offset > edge) for offset in first]


def drop_initial(value: Json, source: random.Random) -> None:
    initial = value["arrays"]["initial"]
    del initial[source.randrange(len(initial))]


def redirect_initial(value: Json, source: random.Random) -> None:
    initial = value["arrays"]["initial"]
    initial[source.randrange(len(initial))] = source.randrange(len(value["arrays"]["memory"]))


def change_move(value: Json, source: random.Random) -> None:
    row = source.choice(value["arrays"]["moves"])
    column = source.randrange(len(row))
    row[column] = row[column] + source.choice((-1, 1, 5))


def give_up(value: Json, source: random.Random) -> None:
    row = source.choice(value["arrays"]["moves"])
    row[:] = [-(2**31)] * len(row)


def start_elsewhere(value: Json, source: random.Random) -> None:
    row = value["arrays"]["initial_inputs"]
    row[source.randrange(len(row))] += source.choice((-1, 1, 5))


def swap_nodes(value: Json, source: random.Random) -> None:
    rows = value["arrays"]["values"]
    one, other = source.randrange(len(rows)), source.randrange(len(rows))
    rows[one], rows[other] = rows[other], rows[one]


FOR_ALL = [flip_value, drop_successor, redirect_successor, repeat_successor, drop_initial, redirect_initial, swap_nodes]
FOR_ENVIRONMENT = [change_move, give_up, start_elsewhere]


def wins(path: Path, spec: Specification) -> bool:
    """Judge a strategy naively: sets of nodes instead of components, enumeration instead of filters."""
    transducer = load_strategy(path).transducer
    game = Game(spec)
    rows = [tuple(row) for row in transducer.values.tolist()]
    system, inputs = transducer.player == "system", len(spec.inputs)
    starts = transducer.initial.tolist()
    first = list(dict.fromkeys(s[:inputs] for s in game.begins(spec.env_init)))
    allowed = game.begins(spec.sys_init)
    if system:
        if sorted(rows[n][:inputs] for n in starts) != sorted(first) or any(rows[n] not in allowed for n in starts):
            return False
    else:
        begin = tuple(transducer.initial_inputs.tolist() if transducer.initial_inputs is not None else ())
        wanted = [s for s in allowed if s[:inputs] == begin]
        if begin not in first or sorted({rows[n] for n in starts}) != sorted(wanted):
            return False
    seen, queue, edges = set(starts), list(starts), []
    for node in queue:
        targets = transducer.after(node).tolist()
        if rows[node] not in game.moves:
            return False
        given = [rows[t] for t in targets]
        if system:
            if sorted(row[:inputs] for row in given) != sorted(game.moves[rows[node]]):
                return False
            if any(row not in game.answers[rows[node], row[:inputs]] for row in given):
                return False
        else:
            assert transducer.moves is not None
            move = tuple(transducer.moves[node].tolist())
            if move not in game.moves[rows[node]] or sorted(given) != sorted(game.answers[rows[node], move]):
                return False
        edges += [(node, t) for t in targets]
        queue += [t for t in dict.fromkeys(targets) if t not in seen]
        seen |= set(targets)

    def marked(sets: list[set[Any]]) -> list[set[tuple[int, int]]]:
        return [{e for e in edges if (rows[e[0]], rows[e[1]]) in some} for some in sets]

    goals, justices = marked(game.goals), marked(game.justices)
    if system:
        return not any(lasting(set(edges) - goal, justices) for goal in goals)
    return not any(lasting(set(edges) - justice, []) for justice in justices) and not lasting(set(edges), goals)


def lasting(edges: set[tuple[int, int]], again: list[set[tuple[int, int]]]) -> bool:
    """Return whether a play can stay on some edges for ever and take an edge of each set again and again."""
    nodes = {node for edge in edges for node in edge}
    while True:
        before = nodes
        inside = {e for e in edges if e[0] in nodes and e[1] in nodes}
        for targets in [edge & inside for edge in again] or [inside]:
            reach = {source for source, _ in targets}
            while grown := {a for a, b in inside if b in reach} - reach:
                reach |= grown
            nodes = nodes & reach
            inside = {e for e in inside if e[0] in nodes and e[1] in nodes}
        if nodes == before:
            return bool(nodes)


@pytest.mark.parametrize(
    ("text", "mutation"),
    [(LIFT, mutation) for mutation in FOR_ALL] + [(STUBBORN, mutation) for mutation in FOR_ALL + FOR_ENVIRONMENT],
    ids=lambda value: value.__name__ if callable(value) else "system" if value is LIFT else "environment",
)
def test_mutated_strategies_are_refused(
    tmp_path: Path, text: str, mutation: Callable[[Json, random.Random], None]
) -> None:
    spec = written(tmp_path, text)
    path, _ = saved(tmp_path, spec)
    original = json.loads(path.read_text())
    refused = losing = 0
    for seed in range(25):
        mutant = changed(path, lambda value, seed=seed: mutation(value, random.Random(seed)))  # type: ignore[misc]
        if json.loads(mutant.read_text()) == original:
            continue
        try:
            accepted = verify_path(mutant).accepted
        except InputError:
            accepted = False
        winning = mutation is not repeat_successor and wins(mutant, spec)
        assert accepted == winning, f"seed {seed}"
        refused += not accepted
        losing += not winning
    assert refused == losing > 0


@settings(max_examples=150, deadline=None)
@given(st.integers(0, 2**32))
def test_mutants_of_random_strategies_are_judged_as_a_naive_judge_does(
    tmp_path_factory: pytest.TempPathFactory, seed: int
) -> None:
    folder, source = tmp_path_factory.getbasetemp(), random.Random(seed)
    spec = written(folder, write_structuredslugs(random_specification(source)))
    path, system_wins = saved(folder, spec)
    kinds = [flip_value, redirect_successor, drop_successor, redirect_initial, swap_nodes]
    kinds += [] if system_wins or not spec.inputs else [change_move]
    arrays = json.loads(path.read_text())["arrays"]
    if not arrays["successors"] or not arrays["initial"]:
        return
    mutation = source.choice(kinds)
    mutant = changed(path, lambda value: mutation(value, source))
    try:
        accepted = verify_path(mutant).accepted
    except InputError:
        accepted = False
    assert accepted == wins(mutant, spec)


def test_memory_does_not_matter(tmp_path: Path) -> None:
    path, _ = saved(tmp_path, written(tmp_path, LIFT))

    def forget(value: Json) -> None:
        value["arrays"]["memory"] = [0] * len(value["arrays"]["memory"])

    assert verify_path(changed(path, forget)).accepted


def test_a_finding_names_line_and_states_in_words(tmp_path: Path) -> None:
    spec = written(tmp_path, LIFT)
    path, _ = saved(tmp_path, spec)

    def stay(value: Json) -> None:
        for row in value["arrays"]["values"]:
            row[2] = 1

    report = verify_path(changed(path, stay))
    assert not report.accepted
    assert any("line 16: door -> floor' = floor" in str(finding) for finding in report.findings)
    assert any("floor = 0, door -> " in finding.where for finding in report.findings)


def test_dead_ends_of_the_environment_are_counted_and_refused_when_they_lose(tmp_path: Path) -> None:
    spec = written(tmp_path, "[INPUT]\nx:0...2\n[OUTPUT]\nc\n[ENV_INIT]\nx = 0\n[ENV_TRANS]\nx' = x + 1\n")
    path, _ = saved(tmp_path, spec)
    report = verify_path(path)
    assert report.accepted
    assert report.counts["environment_dead_ends"] == 1
    strict = verify_path(changed(path, lambda value: value.update(env_dead_end="loses")))
    assert "the environment has no move here" in str(strict.findings[0])


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (lambda v: v.update(format=2), "format: is not known"),
        (lambda v: v.update(player="both"), "player: has to be one of system, environment"),
        (lambda v: v["inputs"].append({"name": "z"}), "inputs: are not the variables of the specification"),
        (lambda v: v["arrays"].pop("first"), "arrays.first: is missing"),
        (lambda v: v["arrays"]["values"].append([1]), "arrays.values: has to be lists of whole numbers"),
        (lambda v: v["arrays"]["values"].append([0, 0, 0]), "arrays.values: has to have the shape"),
        (lambda v: v["arrays"]["successors"].__setitem__(0, 999), "arrays.successors: has to hold nodes from 0"),
        (lambda v: v["arrays"]["successors"].__setitem__(0, 0.5), "arrays.successors: has to hold whole numbers"),
        (lambda v: v["arrays"]["successors"].__setitem__(0, 2**70), "arrays.successors: has to"),
        (lambda v: v["arrays"]["first"].__setitem__(1, 10**9), "arrays.first: has to rise"),
        (lambda v: v["arrays"].update(values="many"), "arrays.values: has to be"),
    ],
)
def test_malformed_strategies_are_bad_input(tmp_path: Path, change: Callable[[Json], None], complaint: str) -> None:
    path, _ = saved(tmp_path, written(tmp_path, LIFT))
    with pytest.raises(InputError) as caught:
        verify_path(changed(path, change))
    assert complaint in str(caught.value)


def test_a_strategy_for_another_specification_is_bad_input(tmp_path: Path) -> None:
    path, _ = saved(tmp_path, written(tmp_path, LIFT))
    written(tmp_path, STUBBORN, "other.structuredslugs")
    with pytest.raises(InputError, match=r"is not the specification that strategy\.json was made for"):
        verify_path(path, tmp_path / "other.structuredslugs")
    (tmp_path / "spec.structuredslugs").rename(tmp_path / "moved.structuredslugs")
    with pytest.raises(InputError, match="say where it is with --spec"):
        verify_path(path)
    assert verify_path(path, tmp_path / "moved.structuredslugs").accepted


def test_free_inputs_are_counted_without_being_enumerated(tmp_path: Path) -> None:
    names = "\n".join(f"i{k}" for k in range(60))
    spec = written(tmp_path, f"[INPUT]\n{names}\n[OUTPUT]\nc\n[SYS_TRANS]\nc'\n")
    from surefoot.logic import Transducer

    zero = np.zeros(1, dtype=np.int32)
    values = np.ones((1, 61), dtype=np.int32)
    one = Transducer("system", spec.variables, 60, values, zero, np.array([0, 1]), zero, zero)
    path = tmp_path / "strategy.json"
    save_strategy(path, one, spec)
    report = verify_path(path)
    assert any("no answer to the next inputs" in finding.message for finding in report.findings)


def test_the_checker_uses_neither_the_compiler_to_bits_nor_a_solver() -> None:
    import surefoot.verify.gr1

    files = list(Path(surefoot.verify.gr1.__file__).parent.glob("*.py"))
    assert len(files) > 5
    for path in files:
        imports = [line for line in path.read_text().splitlines() if line.lstrip().startswith(("import", "from"))]
        assert not [line for line in imports if "lower" in line or "games" in line or "transducer" in line]
