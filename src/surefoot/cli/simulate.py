"""``surefoot simulate``: play a saved strategy, the other side random or typed."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from surefoot.cli.output import AsJson

if TYPE_CHECKING:
    import numpy as np

    from surefoot.logic import Specification, Transducer
    from surefoot.logic.strategy_file import SavedStrategy


def simulate(
    strategy: Annotated[Path, typer.Argument(help="A strategy file, from surefoot synth.", show_default=False)],
    steps: Annotated[int, typer.Option(min=1, max=1_000_000, help="How many steps.")] = 50,
    seed: Annotated[int, typer.Option(help="For the random side.")] = 0,
    typed: Annotated[bool, typer.Option("--typed", help="Read the other side's moves from standard input.")] = False,
    spec: Annotated[Path | None, typer.Option(help="The specification, to count the goals that are met.")] = None,
    as_json: AsJson = False,
) -> None:
    """Play a strategy. The other side moves at random, or as typed.

    A typed move names values, such as: door=1 x=3. What it leaves out is
    chosen at random; an empty line leaves all of it out.

    Examples:
      surefoot simulate strategy.json --steps 50
      surefoot simulate strategy.json --typed

    Exit code 0: played; 2: the strategy cannot be read.
    """
    import numpy as np

    from surefoot.logic.strategy_file import load_strategy

    saved = load_strategy(strategy)
    transducer = saved.transducer
    choose = _Chooser(transducer, np.random.default_rng(seed), typed=typed)
    visited: list[int] = []
    options = transducer.initial.tolist()
    ended: str | None = None
    while len(visited) < steps and ended is None:
        if not options:
            ended = _why_ended(transducer, visited)
        elif (node := choose(options)) is None:
            ended = "no more moves were typed"
        else:
            visited.append(node)
            if not as_json:
                print(f"{len(visited) - 1}: {_sides(transducer, node)}", flush=True)
            options = transducer.after(node).tolist()
    met = _goals_met(_specification(saved, spec), transducer, visited)
    if as_json:
        played = [{"values": transducer.valuation(node), "goal": int(transducer.memory[node])} for node in visited]
        print(json.dumps({"player": transducer.player, "steps": played, "ended": ended, "goals_met": met}))
    else:
        _print_end(ended, met)


def _print_end(ended: str | None, met: list[dict[str, object]] | None) -> None:
    if ended is not None:
        print(f"ended: {ended}")
    for goal in met or []:
        print(f"goal in line {goal['line']} met {goal['times']} times: {goal['text']}")


class _Chooser:
    """Picks one of the nodes that the other side may choose from."""

    def __init__(self, transducer: Transducer, source: np.random.Generator, *, typed: bool) -> None:
        self.transducer = transducer
        self.source = source
        self.typed = typed

    def __call__(self, options: list[int]) -> int | None:
        """Return the chosen node; None when nothing more is typed."""
        while self.typed:
            print("> ", end="", file=sys.stderr, flush=True)
            line = sys.stdin.readline()
            if not line:
                return None
            fitting, problem = self.fitting(options, line)
            if fitting:
                options = fitting
                break
            print(problem, file=sys.stderr)
        return int(self.source.choice(options))

    def fitting(self, options: list[int], line: str) -> tuple[list[int], str]:
        """Return the options that a typed move allows, and otherwise a sentence."""
        wanted: dict[str, int] = {}
        for word in line.replace(",", " ").split():
            name, _, value = word.partition("=")
            number = {"": 1, "true": 1, "false": 0}.get(value.lower())
            if number is None:
                try:
                    number = int(value)
                except ValueError:
                    return [], f"{word} is no move; write name=value, such as door=1"
            wanted[name] = number
        known = [variable.name for variable in self.transducer.variables]
        for name in wanted:
            if name not in known:
                return [], f"{name} is no variable; there are: {', '.join(known)}"
        columns = {name: known.index(name) for name in wanted}
        values = self.transducer.values
        found = [k for k in options if all(values[k, columns[name]] == wanted[name] for name in wanted)]
        return found, f"not allowed here; allowed are for instance: {self.some(options)}"

    def some(self, options: list[int]) -> str:
        """Return a few allowed moves for a person."""
        transducer = self.transducer
        side = slice(0, transducer.inputs) if transducer.player == "system" else slice(transducer.inputs, None)
        names = transducer.variables[side]
        rows = [transducer.values[node, side].tolist() for node in options[:5]]
        return "; ".join(" ".join(f"{v.name}={x}" for v, x in zip(names, row, strict=True)) for row in rows)


def _sides(transducer: Transducer, node: int) -> str:
    values = transducer.values[node].tolist()
    shown = [v.shown(value) for v, value in zip(transducer.variables, values, strict=True)]
    inputs, outputs = shown[: transducer.inputs], shown[transducer.inputs :]
    return f"environment {', '.join(inputs) or '(nothing)'}; system {', '.join(outputs) or '(nothing)'}"


def _why_ended(transducer: Transducer, visited: list[int]) -> str:
    if transducer.player == "system":
        return "the environment has no move"
    moves = transducer.initial_inputs if not visited else transducer.moves[visited[-1]]  # type: ignore[index]
    names = transducer.variables[: transducer.inputs]
    row = [] if moves is None else moves.tolist()
    shown = ", ".join(v.shown(value) for v, value in zip(names, row, strict=True) if value > -(2**31))
    return f"environment {shown or '(nothing)'}; the system has no answer"


def _specification(saved: SavedStrategy, given: Path | None) -> Specification | None:
    """Return the specification of a strategy if it is at hand."""
    from surefoot.errors import InputError
    from surefoot.logic import read_specification

    if given is None and not saved.specification_path.is_file():
        return None
    found = read_specification(given or saved.specification_path)
    if found.sha256 == saved.specification_sha256:
        return found
    if given is None:
        return None
    raise InputError("is not the specification that the strategy was made for: the hashes differ", source=given)


def _goals_met(
    specification: Specification | None, transducer: Transducer, visited: list[int]
) -> list[dict[str, object]] | None:
    """Return how often each goal of the system was met; None without the specification."""
    from surefoot.logic import Evaluator

    if specification is None:
        return None
    evaluate = Evaluator(specification)
    columns = {v.name: transducer.values[visited, k] for k, v in enumerate(transducer.variables)}
    now = {name: column[:-1] for name, column in columns.items()}
    after = {name: column[1:] for name, column in columns.items()}
    steps = max(0, len(visited) - 1)
    found: list[dict[str, object]] = []
    for goal in specification.sys_liveness:
        holds = evaluate(goal.expression, now, after)
        times = int(holds.sum()) if holds.ndim else int(holds) * steps
        found.append({"line": goal.line, "text": goal.text, "times": times})
    return found
