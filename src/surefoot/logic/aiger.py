"""Strategies of the system as circuits in the ASCII format of AIGER.

Inputs of the circuit are the input bits, outputs the output bits of the same step; latches hold the node, plus one, in
binary, so that their reset value 0 is "before the first step". After inputs that the environment had promised never to
choose, the circuit outputs zeros and starts anew.

Source: Biere, "The AIGER And-Inverter Graph (AIG) Format", 2007.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from surefoot.errors import InputError
from surefoot.logic.transducer import Transducer

LARGEST_EDGES = 500_000


@dataclass(slots=True)
class _Circuit:
    """And gates over literals: 0 is false, 1 is true, an odd literal is a negation."""

    variables: int
    gates: list[tuple[int, int, int]] = field(default_factory=list)
    known: dict[tuple[int, int], int] = field(default_factory=dict)

    def both(self, a: int, b: int) -> int:
        """Return the literal of a conjunction."""
        a, b = max(a, b), min(a, b)
        if b == 0 or a ^ 1 == b:
            return 0
        if b == 1 or a == b:
            return a
        if (a, b) not in self.known:
            self.variables += 1
            self.known[a, b] = 2 * self.variables
            self.gates.append((2 * self.variables, a, b))
        return self.known[a, b]

    def all_of(self, literals: Iterable[int]) -> int:
        """Return the literal of a conjunction of many, as a balanced tree."""
        level = list(literals)
        while len(level) > 1:
            level = [
                self.both(level[k], level[k + 1]) if k + 1 < len(level) else level[k] for k in range(0, len(level), 2)
            ]
        return level[0] if level else 1

    def any_of(self, literals: Iterable[int]) -> int:
        """Return the literal of a disjunction of many."""
        return self.all_of(literal ^ 1 for literal in literals) ^ 1


def to_aiger(transducer: Transducer) -> str:
    """Return a strategy of the system as an AIGER circuit in ASCII.

    Raises:
        InputError: it is a strategy of the environment, or too large.
    """
    if transducer.player != "system":
        raise InputError("only strategies of the system are exported as circuits; try dot, hoa or slugs-json")
    if len(transducer.successors) > LARGEST_EDGES:
        raise InputError(f"the circuit is too large; at most {LARGEST_EDGES} steps are exported")
    inputs = [bit for v in transducer.variables[: transducer.inputs] for bit in v.bits]
    outputs = [bit for v in transducer.variables[transducer.inputs :] for bit in v.bits]
    width = transducer.nodes.bit_length()
    input_literals = [2 * (k + 1) for k in range(len(inputs))]
    latches = [2 * (len(inputs) + k + 1) for k in range(width)]
    circuit = _Circuit(len(inputs) + width)
    taken = _taken(transducer, circuit, input_literals, latches)
    by_target: dict[int, list[int]] = {}
    for target, condition in taken:
        by_target.setdefault(target, []).append(condition)
    entered = {target: circuit.any_of(conditions) for target, conditions in by_target.items()}
    following = [circuit.any_of(c for t, c in entered.items() if (t + 1) >> k & 1) for k in range(width)]
    bits = {target: _bits(transducer, target)[len(inputs) :] for target in entered}
    driven = [circuit.any_of(c for t, c in entered.items() if bits[t][k]) for k in range(len(outputs))]
    header = f"aag {circuit.variables} {len(inputs)} {width} {len(outputs)} {len(circuit.gates)}"
    lines = [header, *map(str, input_literals)]
    lines += [f"{latch} {literal}" for latch, literal in zip(latches, following, strict=True)]
    lines += [*map(str, driven), *(f"{gate} {a} {b}" for gate, a, b in circuit.gates)]
    lines += [f"i{k} {name}" for k, name in enumerate(inputs)] + [f"o{k} {name}" for k, name in enumerate(outputs)]
    return "\n".join([*lines, ""])


def _taken(transducer: Transducer, circuit: _Circuit, inputs: list[int], latches: list[int]) -> list[tuple[int, int]]:
    """Return (target, literal that holds when it is entered) for the initial nodes and all edges."""
    decoded: dict[tuple[int, ...], int] = {}

    def reads(target: int) -> int:
        bits = tuple(_bits(transducer, target)[: len(inputs)])
        if bits not in decoded:
            decoded[bits] = circuit.all_of(_literals(inputs, bits))
        return decoded[bits]

    taken: list[tuple[int, int]] = []
    for code in range(transducer.nodes + 1):
        here = circuit.all_of(_literals(latches, [code >> k & 1 for k in range(len(latches))]))
        targets = transducer.initial if code == 0 else transducer.after(code - 1)
        taken += [(target, circuit.both(here, reads(target))) for target in targets.tolist()]
    return taken


def _literals(variables: list[int], bits: Iterable[int]) -> list[int]:
    return [variable ^ (1 - bit) for variable, bit in zip(variables, bits, strict=True)]


def _bits(transducer: Transducer, node: int) -> list[int]:
    found: list[int] = []
    for variable, value in zip(transducer.variables, transducer.values[node].tolist(), strict=True):
        found += [(value - variable.values[0]) >> k & 1 for k in range(len(variable.bits))]
    return found
