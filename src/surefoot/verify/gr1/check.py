"""Certificates of GR(1) strategies: the explicit product of a saved strategy with its specification.

For the system: the strategy answers every move of the environment, keeps the system's safety at every reachable step,
and every cycle that meets all justices meets every goal. For the environment, the dual: its moves are allowed, every
answer of the system is followed up, every cycle meets all justices, and no component of the graph meets all goals.
Cycles are judged by strongly connected components: nothing depends on how the strategy was found or what its memory
means.

Source: Bloem, Jobstmann, Piterman, Pnueli and Sa'ar, JCSS 78, 2012, for what a strategy has to satisfy.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from surefoot.logic.syntax import Conjunct, Variable
from surefoot.verify.findings import Ledger
from surefoot.verify.gr1.choices import Choices, Columns
from surefoot.verify.gr1.file import NO_MOVE, Ints, StrategyFile, read_strategy
from surefoot.verify.gr1.liveness import check_environment_liveness, check_system_liveness
from surefoot.verify.gr1.rules import CHUNK, Edges, Rules


def check_strategy(path: Path, ledger: Ledger, specification_path: Path | None = None) -> None:
    """Verify a saved strategy or counter-strategy.

    Args:
        path: its JSON file.
        ledger: takes what is wrong, and counts.
        specification_path: where the specification is; None: where the strategy says.

    Raises:
        InputError: a file is missing, malformed, or the specification is another one.
        LimitExceeded: the product is too large to be walked.
    """
    strategy = read_strategy(path, specification_path)
    rules = Rules(strategy.specification, strategy.values)
    seen = _reachable(strategy)
    nodes = np.flatnonzero(seen)
    edges = _edges(strategy, nodes)
    ledger.counts |= {"player": strategy.player, "semantics": strategy.semantics, "checked_states": len(nodes)}
    ledger.counts |= {"checked_steps": len(edges.sources), "unreachable_states": len(seen) - len(nodes)}
    _check_ranges(rules, nodes, ledger)
    if ledger.total:
        return
    if strategy.player == "system":
        _check_system(strategy, rules, nodes, edges, ledger)
    else:
        _check_environment(strategy, rules, nodes, edges, ledger)


def _check_system(strategy: StrategyFile, rules: Rules, nodes: Ints, edges: Edges, ledger: Ledger) -> None:
    specification = strategy.specification
    _check_system_start(strategy, rules, ledger)
    for conjunct in specification.environment_safety:
        _require_edges(rules, conjunct, edges, ledger, "the step answers inputs that the environment may not choose")
    for conjunct in specification.system_safety:
        _require_edges(rules, conjunct, edges, ledger, "the step breaks the system's safety")
    inputs = len(specification.inputs)
    _require_distinct(rules, strategy.values[edges.targets, :inputs], edges, ledger, "two answers to the same inputs")
    safety = [conjunct.expression for conjunct in specification.environment_safety]
    choices = Choices(rules.evaluator, safety, specification.inputs, primed=True)
    wanted = _counted(rules, choices, nodes)
    given = np.bincount(edges.sources, minlength=len(strategy.values))[nodes]
    for place in np.flatnonzero(given < wanted)[:20]:
        node = int(nodes[place])
        missing = _missing(rules, choices, strategy, node, specification.inputs)
        ledger.refuse("formats.md 4, successors", f"no answer to the next inputs: {missing}", rules.shown(node))
    dead = nodes[wanted == 0]
    ledger.counts["environment_dead_ends"] = len(dead)
    if strategy.env_dead_end == "loses":
        for node in dead[:20].tolist():
            ledger.refuse("env_dead_end: loses", "the environment has no move here", rules.shown(node))
    check_system_liveness(rules, edges, len(strategy.values), ledger)


def _check_system_start(strategy: StrategyFile, rules: Rules, ledger: Ledger) -> None:
    """Check that every start that the environment may choose has its initial node."""
    specification, initial = strategy.specification, strategy.initial
    for conjunct in (*specification.env_init, *specification.sys_init):
        _require_nodes(rules, conjunct, initial, ledger)
    chosen: Sequence[Variable] = specification.inputs
    wanted = [conjunct.expression for conjunct in specification.env_init]
    if strategy.semantics == "robotics":
        chosen = specification.variables
        wanted += [conjunct.expression for conjunct in specification.sys_init]
    choices = Choices(rules.evaluator, wanted, chosen, primed=False)
    starts = strategy.values[initial, : len(chosen)]
    distinct = len(np.unique(starts, axis=0)) if starts.size else min(1, len(starts))
    if distinct < len(starts):
        ledger.refuse("formats.md 4, initial", "two initial nodes answer the same start")
    if distinct < int(choices.count({}, {}, 1)[0]):
        known = set(map(tuple, starts.tolist()))
        for choice in choices.listed({}, {}):
            if tuple(choice[variable.name] for variable in chosen) not in known:
                words = _words(chosen, choice)
                ledger.refuse("formats.md 4, initial", f"no initial node for the start: {words}")
                break


def _check_environment(strategy: StrategyFile, rules: Rules, nodes: Ints, edges: Edges, ledger: Ledger) -> None:
    specification = strategy.specification
    _check_environment_start(strategy, rules, ledger)
    inputs = specification.inputs
    safety = [conjunct.expression for conjunct in specification.environment_safety]
    possible = _counted(rules, Choices(rules.evaluator, safety, inputs, primed=True), nodes)
    idle = (strategy.moves[nodes] == NO_MOVE).all(axis=1) if inputs else possible == 0
    stuck, moving, possible = nodes[idle], nodes[~idle], possible[idle]
    has_answers = np.bincount(edges.sources, minlength=len(strategy.values))
    for place, node in enumerate(stuck.tolist()):
        if strategy.env_dead_end == "wins" or possible[place] or has_answers[node]:
            ledger.refuse("formats.md 4, moves", "the environment gives up although that loses", rules.shown(node))
    moves = {variable.name: strategy.moves[moving, k] for k, variable in enumerate(inputs)}
    _check_moves(rules, moving, moves, ledger)
    for conjunct in specification.system_safety:
        _require_edges(rules, conjunct, edges, ledger, "the step is an answer that the system may not give")
    _check_answers(strategy, rules, moving, moves, edges, ledger)
    check_environment_liveness(rules, edges, len(strategy.values), ledger)


def _check_moves(rules: Rules, nodes: Ints, moves: Columns, ledger: Ledger) -> None:
    """Check that the environment's moves are in range and keep its safety."""
    for variable in rules.specification.inputs:
        out = (moves[variable.name] < variable.values[0]) | (moves[variable.name] > variable.values[-1])
        for node in nodes[out][:20].tolist():
            ledger.refuse("range", f"the move gives {variable.name} a value that it cannot have", rules.shown(node))
    for conjunct in rules.specification.environment_safety:
        holds = np.broadcast_to(rules.evaluator(conjunct.expression, rules.columns(nodes), moves), nodes.shape)
        for node in nodes[~holds][:20].tolist():
            ledger.refuse(rules.line(conjunct), "the move breaks the environment's safety", rules.shown(node))


def _check_answers(
    strategy: StrategyFile, rules: Rules, nodes: Ints, moves: Columns, edges: Edges, ledger: Ledger
) -> None:
    """Check that the successors of a node are all answers to its move, once each."""
    specification, inputs = strategy.specification, len(strategy.specification.inputs)
    wrong = (strategy.values[edges.targets, :inputs] != strategy.moves[edges.sources]).any(axis=1)
    for place in np.flatnonzero(wrong)[:20].tolist():
        where = rules.shown(int(edges.sources[place]))
        ledger.refuse("formats.md 4, moves", "a successor has other inputs than the move", where)
    answers = strategy.values[edges.targets, inputs:]
    _require_distinct(rules, answers, edges, ledger, "the same answer twice")
    safety = [conjunct.expression for conjunct in specification.system_safety]
    choices = Choices(rules.evaluator, safety, specification.outputs, primed=True)
    wanted = _counted(rules, choices, nodes, moves)
    given = np.bincount(edges.sources, minlength=len(strategy.values))[nodes]
    for place in np.flatnonzero(given < wanted)[:20].tolist():
        node = int(nodes[place])
        here = {name: column[place : place + 1] for name, column in moves.items()}
        missing = _missing(rules, choices, strategy, node, specification.outputs, here)
        ledger.refuse("formats.md 4, successors", f"the system may also answer: {missing}", rules.shown(node))


def _check_environment_start(strategy: StrategyFile, rules: Rules, ledger: Ledger) -> None:
    """Check that the environment may start as it does, and that all answers of the system to it are followed up."""
    specification, initial = strategy.specification, strategy.initial
    inputs = len(specification.inputs)
    for conjunct in specification.sys_init:
        _require_nodes(rules, conjunct, initial, ledger)
    if strategy.semantics == "robotics":
        for conjunct in specification.env_init:
            _require_nodes(rules, conjunct, initial, ledger)
        if len(initial) != 1:
            ledger.refuse("formats.md 4, initial", "with robotics semantics the environment picks one initial state")
        return
    start = {v.name: strategy.initial_inputs[k : k + 1] for k, v in enumerate(specification.inputs)}
    for variable in specification.inputs:
        if int(start[variable.name][0]) not in variable.values:
            ledger.refuse("range", f"the start gives {variable.name} a value that it cannot have")
    for conjunct in specification.env_init:
        if not rules.evaluator(conjunct.expression, start).all():
            ledger.refuse(rules.line(conjunct), "the environment may not start with its initial inputs")
    if (strategy.values[initial, :inputs] != strategy.initial_inputs).any():
        ledger.refuse("formats.md 4, initial", "an initial node has other inputs than initial_inputs")
    wanted = [conjunct.expression for conjunct in specification.sys_init]
    choices = Choices(rules.evaluator, wanted, specification.outputs, primed=False)
    starts = strategy.values[initial, inputs:]
    distinct = len(np.unique(starts, axis=0)) if starts.size else min(1, len(starts))
    if distinct < int(choices.count(start, {}, 1)[0]):
        ledger.refuse("formats.md 4, initial", "the system may also start with other outputs")


def _counted(rules: Rules, choices: Choices, nodes: Ints, moves: Columns | None = None) -> Ints:
    """Return how many choices there are in each node."""
    counts = np.zeros(len(nodes), dtype=np.int64)
    for start in range(0, len(nodes), CHUNK):
        part = slice(start, start + CHUNK)
        following = {name: column[part] for name, column in (moves or {}).items()}
        counts[part] = choices.count(rules.columns(nodes[part]), following, len(nodes[part]))
    return counts


def _missing(
    rules: Rules,
    choices: Choices,
    strategy: StrategyFile,
    node: int,
    variables: Sequence[Variable],
    moves: Columns | None = None,
) -> str:
    """Return a choice that none of a node's successors has, in words."""
    after = strategy.successors[strategy.first[node] : strategy.first[node + 1]]
    columns = rules.columns(after, variables)
    known = set(zip(*(columns[variable.name].tolist() for variable in variables), strict=True))
    for choice in choices.listed(rules.columns(np.array([node])), moves or {}):
        if tuple(choice[variable.name] for variable in variables) not in known:
            return _words(variables, choice)
    return "(none)"


def _words(variables: Sequence[Variable], choice: dict[str, int]) -> str:
    return ", ".join(variable.shown(choice[variable.name]) for variable in variables) or "(there are none)"


def _check_ranges(rules: Rules, nodes: Ints, ledger: Ledger) -> None:
    """Check that every variable has one of its values in every node."""
    for node in nodes[~rules.in_range(nodes)][:20].tolist():
        ledger.refuse("range", "a variable has a value that it cannot have", rules.shown(node))


def _require_nodes(rules: Rules, conjunct: Conjunct, nodes: Ints, ledger: Ledger) -> None:
    for node in nodes[~rules.on_nodes(conjunct, nodes)][:20].tolist():
        ledger.refuse(rules.line(conjunct), "the initial state breaks this line", rules.shown(node))


def _require_edges(rules: Rules, conjunct: Conjunct, edges: Edges, ledger: Ledger, message: str) -> None:
    for place in np.flatnonzero(~rules.on_edges(conjunct, edges))[:20].tolist():
        source, target = int(edges.sources[place]), int(edges.targets[place])
        ledger.refuse(rules.line(conjunct), message, f"{rules.shown(source)} -> {rules.shown(target)}")


def _require_distinct(rules: Rules, labels: Ints, edges: Edges, ledger: Ledger, message: str) -> None:
    """Refuse two edges of one node with the same label."""
    keys = np.column_stack([edges.sources, labels])
    _, firsts, counts = np.unique(keys, axis=0, return_index=True, return_counts=True)
    for place in firsts[counts > 1][:20].tolist():
        ledger.refuse("formats.md 4, successors", message, rules.shown(int(edges.sources[place])))


def _reachable(strategy: StrategyFile) -> NDArray[np.bool_]:
    """Return which nodes a play can visit."""
    seen = np.zeros(len(strategy.values), dtype=np.bool_)
    frontier = np.unique(strategy.initial)
    while len(frontier):
        seen[frontier] = True
        after = np.unique(_edges(strategy, frontier).targets)
        frontier = after[~seen[after]]
    return seen


def _edges(strategy: StrategyFile, nodes: Ints) -> Edges:
    """Return all edges that leave some nodes."""
    counts = strategy.first[nodes + 1] - strategy.first[nodes]
    sources = np.repeat(nodes, counts)
    offsets = np.arange(int(counts.sum())) - np.repeat(np.cumsum(counts) - counts, counts)
    return Edges(sources, strategy.successors[np.repeat(strategy.first[nodes], counts) + offsets])
