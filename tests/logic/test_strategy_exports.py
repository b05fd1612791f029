"""Exported strategies behave as the strategy does."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gr1_specs import random_specification
from naive_gr1 import solve_naively
from surefoot.errors import InputError
from surefoot.logic import Specification, Transducer, parse_structuredslugs
from surefoot.logic.exports import bits_of, export
from surefoot.logic.plays import shortest_play
from surefoot.logic.strategy_file import load_strategy, save_strategy

ECHO = "[INPUT]\nx:1...3\n[OUTPUT]\ny:0...5\nq\n[SYS_TRANS]\ny' = x' + 1\nq' <-> !q\n[SYS_INIT]\ny = 0\n!q\n"
LATE = "[INPUT]\na\n[OUTPUT]\nn:0...3\n[SYS_INIT]\nn = 0\n[SYS_TRANS]\nn' = n + 1\n"
NEVER = "[INPUT]\na\n[OUTPUT]\nc\n[SYS_TRANS]\nc' -> a'\n[SYS_LIVENESS]\nc\n"


def solved(text: str) -> Transducer:
    return solve_naively(parse_structuredslugs(text)).strategy


class Circuit:
    """Runs an AIGER circuit in ASCII."""

    def __init__(self, text: str) -> None:
        lines = text.splitlines()
        _, _, inputs, latches, outputs, gates = (int(w) if w.isdigit() else 0 for w in lines[0].split())
        rows = [[int(w) for w in line.split()] for line in lines[1 : 1 + inputs + latches + outputs + gates]]
        self.inputs, rest = [row[0] for row in rows[:inputs]], rows[inputs:]
        self.latches, rest = rest[:latches], rest[latches:]
        self.outputs, self.gates = [row[0] for row in rest[:outputs]], rest[outputs:]
        self.state = [0] * latches
        assert all(gate > a >= b for gate, a, b in self.gates)

    def step(self, inputs: list[int]) -> list[int]:
        value = {0: 0, 1: 1}

        def drive(literal: int, bit: int) -> None:
            value[literal], value[literal ^ 1] = bit, 1 - bit

        for literal, bit in zip(self.inputs, inputs, strict=True):
            drive(literal, bit)
        for (literal, _), bit in zip(self.latches, self.state, strict=True):
            drive(literal, bit)
        for gate, a, b in self.gates:
            drive(gate, value[a] & value[b])
        self.state = [value[following] for _, following in self.latches]
        return [value[literal] for literal in self.outputs]


def check_circuit(transducer: Transducer, seed: int = 0) -> None:
    import random

    source = random.Random(seed)
    circuit = Circuit(export(transducer, "aiger"))
    width = len([b for v in transducer.variables[: transducer.inputs] for b in v.bits])
    options = transducer.initial.tolist()
    for _ in range(30):
        if not options:
            return
        node = source.choice(options)
        bits = bits_of(transducer, node)
        assert circuit.step(bits[:width]) == bits[width:]
        options = transducer.after(node).tolist()


def test_the_circuit_does_what_the_strategy_does() -> None:
    check_circuit(solved(ECHO))


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32))
def test_circuits_of_random_strategies(seed: int) -> None:
    import random

    answer = solve_naively(random_specification(random.Random(seed)))
    if answer.realizable:
        check_circuit(answer.strategy, seed)
    else:
        with pytest.raises(InputError, match="only strategies of the system"):
            export(answer.strategy, "aiger")


def test_slugs_json_lists_bits_and_successors() -> None:
    transducer = solved(ECHO)
    found = json.loads(export(transducer, "slugs-json"))
    assert found["variables"] == ["x@0.1.3", "x@1", "y@0.0.5", "y@1", "y@2", "q"]
    assert len(found["nodes"]) == transducer.nodes
    for name, node in found["nodes"].items():
        assert len(node["state"]) == 6
        assert sorted(node) == ["rank", "state", "trans"]
        assert node["trans"] == transducer.after(int(name)).tolist()


def test_hoa_has_one_edge_per_step_and_deterministic_labels() -> None:
    transducer = solved(ECHO)
    text = export(transducer, "hoa")
    head, body = text.split("--BODY--\n")
    assert f"States: {transducer.nodes + 1}" in head
    assert 'AP: 6 "x@0.1.3" "x@1" "y@0.0.5" "y@1" "y@2" "q"' in head
    assert "controllable-AP: 2 3 4 5" in head
    states = body.removesuffix("--END--\n").split("State: ")[1:]
    assert [int(block.split()[0]) for block in states] == list(range(transducer.nodes + 1))
    for block in states:
        labels = [line.split("]")[0] for line in block.splitlines()[1:]]
        assert len(labels) == len(set(labels)) == 3


def test_dot_shows_integers_as_integers() -> None:
    text = export(solved(ECHO), "dot")
    assert text.startswith("digraph")
    assert "x = 3, y = 4, q" in text
    assert "@" not in text


def test_there_is_no_other_format() -> None:
    with pytest.raises(InputError, match="vhdl is no export format; there are: dot, hoa, slugs-json, aiger"):
        export(solved(ECHO), "vhdl")


@pytest.mark.parametrize(("text", "steps", "loop"), [(LATE, 4, None), (NEVER, 1, 0)])
def test_the_shortest_play_of_a_counter_strategy(text: str, steps: int, loop: int | None) -> None:
    play = shortest_play(solved(text))
    assert (len(play.nodes), play.loop_from) == (steps, loop)


def test_a_start_without_outputs_is_a_play_without_steps() -> None:
    play = shortest_play(solved("[INPUT]\na\n[OUTPUT]\nc\n[SYS_INIT]\na\n"))
    assert (play.nodes, play.loop_from) == ((), None)


def specification(folder: Path, text: str) -> Specification:
    from surefoot.logic import read_specification

    path = folder / "spec.structuredslugs"
    path.write_text(text)
    return read_specification(path)


@pytest.mark.parametrize("text", [ECHO, LATE, NEVER, "[OUTPUT]\nc\n", "[INPUT]\na\n[OUTPUT]\nc\n[SYS_INIT]\na\n"])
def test_saved_strategies_are_loaded_as_they_were(tmp_path: Path, text: str) -> None:
    spec = specification(tmp_path, text)
    transducer = solve_naively(spec).strategy
    save_strategy(tmp_path / "deep" / "s.json", transducer, spec)
    loaded = load_strategy(tmp_path / "deep" / "s.json")
    assert loaded.origin.specification_path.resolve() == (tmp_path / "spec.structuredslugs").resolve()
    for name in ("values", "memory", "first", "successors", "initial", "moves", "initial_inputs"):
        one, other = getattr(transducer, name), getattr(loaded.transducer, name)
        assert (one is None) == (other is None)
        assert one is None or (one.shape == other.shape and (one == other).all())


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("nothing", "not whole JSON"),
        ("[]", "holds no JSON object"),
        ('{"kind": "gr1-strategy", "format": 1}', "is no whole strategy"),
        ("[" * 100_000, "not whole JSON"),
    ],
)
def test_what_is_no_strategy_is_bad_input(tmp_path: Path, text: str, complaint: str) -> None:
    path = tmp_path / "s.json"
    path.write_text(text)
    with pytest.raises(InputError, match=complaint):
        load_strategy(path)


def test_damaged_indices_are_bad_input(tmp_path: Path) -> None:
    spec = specification(tmp_path, ECHO)
    path = tmp_path / "s.json"
    save_strategy(path, solve_naively(spec).strategy, spec)
    value = json.loads(path.read_text())
    value["arrays"]["successors"][0] = 10**6
    path.write_text(json.dumps(value))
    with pytest.raises(InputError, match="successors names nodes that do not exist"):
        load_strategy(path)
