"""``surefoot simulate``: play a saved strategy, the other side random or typed."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from surefoot.cli.gr1 import kind_of
from surefoot.cli.output import AsJson
from surefoot.errors import InputError

if TYPE_CHECKING:
    import numpy as np

    from surefoot.logic import Specification, Transducer
    from surefoot.logic.ranking import Ranking
    from surefoot.logic.syntax import Variable


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

    from surefoot.logic.ranking_file import SavedRanking, load_ranking
    from surefoot.logic.strategy_file import load_strategy

    source = np.random.default_rng(seed)
    show = _silent if as_json else _shown
    ranked = kind_of(strategy) == "gr1-ranking"
    saved = (load_ranking if ranked else load_strategy)(strategy)
    specification = _specification(saved.origin.specification_path, saved.origin.specification_sha256, spec)
    if isinstance(saved, SavedRanking):
        played = _ranked(strategy, saved.ranking, steps, source, typed, show)
    else:
        played = _listed(saved.transducer, steps, source, typed, show)
    met = _goals_met(specification, played)
    if as_json:
        rows = [dict(zip((v.name for v in played.variables), row, strict=True)) for row in played.rows]
        shown = [{"values": row, "goal": goal} for row, goal in zip(rows, played.goals, strict=True)]
        print(json.dumps({"player": played.player, "steps": shown, "ended": played.ended, "goals_met": met}))
    else:
        _print_end(played.ended, met)


@dataclass(frozen=True, slots=True)
class Played:
    """A play of a strategy.

    Attributes:
        player: whose strategy it is.
        variables: inputs, then outputs.
        rows: the values of all variables in every step.
        goals: the goal that is pursued from every step on.
        ended: why it ended early.
    """

    player: str
    variables: tuple[Variable, ...]
    rows: list[tuple[int, ...]]
    goals: list[int]
    ended: str | None


Show = Callable[[Sequence["Variable"], int, int, tuple[int, ...], str], None]


def _ranked(path: Path, ranking: Ranking, steps: int, source: np.random.Generator, typed: bool, show: Show) -> Played:
    from surefoot.cli.simulate_ranking import play_ranking

    def shown(number: int, row: tuple[int, ...], goal: int) -> None:
        show(ranking.variables, ranking.inputs, number, row, _aim("system", goal))

    try:
        rows, goals, ended = play_ranking(ranking, steps, source, typed=typed, show=shown)
    except ValueError as problem:
        raise InputError(f"cannot be played: {problem}; check it with: surefoot verify", source=path) from problem
    return Played("system", ranking.variables, rows, goals, ended)


def _listed(transducer: Transducer, steps: int, source: np.random.Generator, typed: bool, show: Show) -> Played:
    choose = _Chooser(transducer, source, typed=typed)
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
            row, goal = tuple(transducer.values[node].tolist()), int(transducer.memory[node])
            aim = _aim(transducer.player, goal)
            show(transducer.variables, transducer.inputs, len(visited) - 1, row, aim)
            options = transducer.after(node).tolist()
    rows = [tuple(transducer.values[node].tolist()) for node in visited]
    goals = [int(transducer.memory[node]) for node in visited]
    return Played(transducer.player, transducer.variables, rows, goals, ended)


def _aim(player: str, goal: int) -> str:
    """Return what a strategy is after, in words."""
    if goal < 0:
        return ""
    return f"pursues goal {goal}" if player == "system" else f"denies goal {goal}"


def _silent(variables: Sequence[Variable], inputs: int, number: int, row: tuple[int, ...], aim: str) -> None:
    """Print nothing."""


def _shown(variables: Sequence[Variable], inputs: int, number: int, row: tuple[int, ...], aim: str) -> None:
    words = [v.shown(value) for v, value in zip(variables, row, strict=True)]
    ours, theirs = ", ".join(words[:inputs]), ", ".join(words[inputs:])
    aimed = f" ({aim})" if aim else ""
    print(f"{number}: environment {ours or '(nothing)'}; system {theirs or '(nothing)'}{aimed}", flush=True)


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
        from surefoot.cli.typed_moves import values_typed

        known = [variable.name for variable in self.transducer.variables]
        wanted, problem = values_typed(line, known)
        if problem:
            return [], problem
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


def _why_ended(transducer: Transducer, visited: list[int]) -> str:
    if transducer.player == "system":
        return "the environment has no move"
    moves = transducer.initial_inputs if not visited else transducer.moves[visited[-1]]  # type: ignore[index]
    names = transducer.variables[: transducer.inputs]
    row = [] if moves is None else moves.tolist()
    shown = ", ".join(v.shown(value) for v, value in zip(names, row, strict=True) if value > -(2**31))
    return f"environment {shown or '(nothing)'}; the system has no answer"


def _specification(path: Path, sha256: str, given: Path | None) -> Specification | None:
    """Return the specification of a strategy if it is at hand."""
    from surefoot.logic import read_specification

    if given is None and not path.is_file():
        return None
    found = read_specification(given or path)
    if found.sha256 == sha256:
        return found
    if given is None:
        return None
    raise InputError("is not the specification that the strategy was made for: the hashes differ", source=given)


def _goals_met(specification: Specification | None, played: Played) -> list[dict[str, object]] | None:
    """Return how often each goal of the system was met; None without the specification."""
    import numpy as np

    from surefoot.logic import Evaluator

    if specification is None:
        return None
    evaluate = Evaluator(specification)
    values = np.array(played.rows, dtype=np.int64).reshape(len(played.rows), len(played.variables))
    now = {v.name: values[:-1, k] for k, v in enumerate(played.variables)}
    after = {v.name: values[1:, k] for k, v in enumerate(played.variables)}
    steps = max(0, len(values) - 1)
    found: list[dict[str, object]] = []
    for goal in specification.sys_liveness:
        holds = evaluate(goal.expression, now, after)
        times = int(holds.sum()) if holds.ndim else int(holds) * steps
        found.append({"line": goal.line, "text": goal.text, "times": times})
    return found
