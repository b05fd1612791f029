"""Strategies in formats of other tools: DOT graphs, the JSON of slugs, and HOA automata."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator

from surefoot.errors import InputError
from surefoot.logic.aiger import to_aiger
from surefoot.logic.transducer import Transducer


def to_dot(transducer: Transducer) -> str:
    """Return a strategy as a graph for Graphviz; integers are shown as integers."""
    lines = ["digraph strategy {", "  node [shape=box];", '  start [shape=point, label=""];']
    for node in range(transducer.nodes):
        goal = "" if transducer.memory[node] < 0 else f"\\ngoal {transducer.memory[node]}"
        lines.append(f'  {node} [label="{transducer.shown(node)}{goal}"];')
    lines += [f"  start -> {node};" for node in transducer.initial.tolist()]
    for node in range(transducer.nodes):
        lines += [f"  {node} -> {target};" for target in transducer.after(node).tolist()]
    return "\n".join([*lines, "}", ""])


def to_slugs_json(transducer: Transducer) -> str:
    """Return a strategy as slugs prints explicit ones: a list of bits, and nodes with their bits and successors."""
    nodes = {
        str(node): {
            "rank": max(0, int(transducer.memory[node])),
            "state": bits_of(transducer, node),
            "trans": transducer.after(node).tolist(),
        }
        for node in range(transducer.nodes)
    }
    names = bit_names(transducer)
    return json.dumps({"version": 0, "slugs": "0.0.1", "variables": names, "nodes": nodes}, indent=1) + "\n"


def to_hoa(transducer: Transducer) -> str:
    """Return a strategy as a deterministic automaton whose labels are the next values of all bits.

    State 0 is before the first step. ``controllable-AP`` lists the bits of the player whose strategy it is, as in the
    synthesis competition.

    Source: Babiak et al., "The Hanoi Omega-Automata Format", CAV 2015.
    """
    names = bit_names(transducer)
    inputs = len([bit for variable in transducer.variables[: transducer.inputs] for bit in variable.bits])
    own = range(inputs, len(names)) if transducer.player == "system" else range(inputs)
    lines = [
        "HOA: v1",
        f"States: {transducer.nodes + 1}",
        "Start: 0",
        f"AP: {len(names)} " + " ".join(f'"{name}"' for name in names),
        "controllable-AP: " + " ".join(map(str, own)),
        "acc-name: all",
        "Acceptance: 0 t",
        "properties: trans-labels explicit-labels state-acc deterministic",
        "--BODY--",
        "State: 0",
        *(_labelled(transducer, node) for node in transducer.initial.tolist()),
    ]
    for node in range(transducer.nodes):
        lines.append(f"State: {node + 1}")
        lines += [_labelled(transducer, target) for target in transducer.after(node).tolist()]
    return "\n".join([*lines, "--END--", ""])


def _labelled(transducer: Transducer, target: int) -> str:
    literals = [f"{'' if bit else '!'}{place}" for place, bit in enumerate(bits_of(transducer, target))]
    return f"[{' & '.join(literals) or 't'}] {target + 1}"


def bit_names(transducer: Transducer) -> list[str]:
    """Return the names of all bits, inputs first."""
    return [bit for variable in transducer.variables for bit in variable.bits]


def bits_of(transducer: Transducer, node: int) -> list[int]:
    """Return the values of all bits in a node."""
    return list(_bits(transducer, node))


def _bits(transducer: Transducer, node: int) -> Iterator[int]:
    for variable, value in zip(transducer.variables, transducer.values[node].tolist(), strict=True):
        stored = value - variable.values[0]
        yield from (stored >> k & 1 for k in range(len(variable.bits)))


def export(transducer: Transducer, name: str) -> str:
    """Return a strategy in a named format.

    Raises:
        InputError: there is no such format, or the strategy does not fit it.
    """
    formats: dict[str, Callable[[Transducer], str]] = {
        "dot": to_dot,
        "hoa": to_hoa,
        "slugs-json": to_slugs_json,
        "aiger": to_aiger,
    }
    if name not in formats:
        raise InputError(f"{name} is no export format; there are: {', '.join(formats)}")
    return formats[name](transducer)
