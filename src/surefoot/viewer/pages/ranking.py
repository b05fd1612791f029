"""A page that says what a ranking is: its goals and layers, how many states each holds, and a play.

A ranking lists no states. Where it is small it is listed and becomes the page of any strategy (``gr1``).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from pathlib import Path

import numpy as np

from surefoot.compute import sha256_of, write_text_whole
from surefoot.errors import InputError
from surefoot.games.ranking_player import Bits, RankingPlayer
from surefoot.logic import read_specification
from surefoot.logic.ranking import Ranking
from surefoot.logic.ranking_file import SavedRanking
from surefoot.logic.syntax import Specification
from surefoot.verify.gr1.sets import Sets, Translator

STEPS = 60
SEED = 0
MOST_LAYERS = 60
"""How many layers of a goal are shown, the first ones."""

_ALL = 1
"""The row that holds always."""
_STYLE = """
  body { font: 15px/1.45 system-ui, sans-serif; margin: 1em; color: #222; max-width: 72em; }
  h1 { font-size: 1.25em; } h2 { font-size: 1.05em; margin: 1.2em 0 0.4em; }
  table { border-collapse: collapse; }
  th, td { padding: 0.15em 0.7em; border-bottom: 1px solid #ddd; text-align: right; }
  th { color: #555; font-weight: 500; } .out { color: #0072b2; } .changed { font-weight: 700; }
  td:has(.bar) { text-align: left; }
  .bar { display: inline-block; height: 0.7em; background: #0072b2; }
"""


def write_ranking_page(path: Path, saved: SavedRanking, out: Path) -> Path:
    """Write what a ranking is as one page that opens from a file.

    Args:
        path: of the ranking, for its name and for messages.
        saved: what stands there.
        out: the HTML file.

    Raises:
        InputError: the ranking cannot be played.
    """
    ranking = saved.ranking
    goals, justices = _lines(saved)
    states = _States(ranking)
    facts = [
        f"Winning states: {_number(states(ranking.winning))} of {_number(states(_ALL))}.",
        f"Goals: {len(ranking.goals)}; layers: {len(ranking.layers)}; rows of decision diagrams: "
        f"{len(ranking.variable)}.",
        "From a state in a layer every move of the environment has an answer into a lower layer, or one that stays "
        "and waits for the environment to keep a promise; from the lowest layer the goal is met.",
    ]
    body = [f"<h1>{escape(path.name)}: a ranking, a strategy of the system by layers</h1>"]
    body += [f"<p>{fact}</p>" for fact in facts]
    body += [_variables(ranking)]
    for number, text in enumerate(goals):
        body += [f"<h2>Goal {number}{f': {escape(text)}' if text else ''}</h2>"]
        body += [_layers(ranking, states, number, justices)]
    try:
        body += [_play(ranking)]
    except ValueError as problem:
        raise InputError(f"cannot be played: {problem}; check it with: surefoot verify", source=path) from problem
    head = f'<meta charset="utf-8"><title>{escape(path.name)}</title><style>{_STYLE}</style>'
    write_text_whole(
        out, f'<!doctype html>\n<html lang="en"><head>{head}</head>\n<body>\n' + "\n".join(body) + "\n</body></html>\n"
    )
    return out


def _lines(saved: SavedRanking) -> tuple[list[str], list[str]]:
    """Return the texts of goals and promises, empty ones where the specification is not at hand any more."""
    ranking, origin = saved.ranking, saved.origin
    path, goals, justices = origin.specification_path, [""] * len(ranking.goals), [""] * len(ranking.justices)
    if not path.is_file() or sha256_of(path) != origin.specification_sha256:
        return goals, justices
    specification = read_specification(path)
    for texts, lines in ((goals, specification.sys_liveness), (justices, specification.env_liveness)):
        if len(lines) == len(texts):
            texts[:] = [f"{line.text} (line {line.line})" for line in lines]
    return goals, justices


class _States:
    """Counts states, of variables that have one of their values; the sets are those of the checker."""

    def __init__(self, ranking: Ranking) -> None:
        bits = self._bits = len(ranking.order)
        place = np.empty(bits, dtype=np.int64)
        place[ranking.order] = np.arange(bits)
        self._sets = Sets(2 * bits)
        sides = ranking.variables[: ranking.inputs], ranking.variables[ranking.inputs :]
        translator = Translator(Specification(*sides), self._sets, place.tolist())
        self._valid = translator.in_range(ranking.variables, primed=False)
        self._rows = self._sets.load(ranking.variable, ranking.low, ranking.high)

    def __call__(self, row: int) -> int:
        """Return how many states the diagram of a row holds; about, if they are very many."""
        one = self._sets.conjoin((int(self._rows[row]), self._valid))
        return round(self._sets.share(one) * 2.0**self._bits)


def _variables(ranking: Ranking) -> str:
    rows = []
    for number, one in enumerate(ranking.variables):
        side = "input" if number < ranking.inputs else "output"
        span = "false, true" if one.is_boolean else f"{one.values[0]} to {one.values[-1]}"
        rows.append([escape(one.name), side, span])
    return f"<details><summary>{len(rows)} variables</summary>{_table(('name', 'side', 'values'), rows)}</details>"


def _layers(ranking: Ranking, states: _States, goal: int, justices: Sequence[str]) -> str:
    first, last = int(ranking.first[goal]), int(ranking.first[goal + 1])
    most, before, rows = max(states(int(ranking.layers[last - 1])), 1), 0, []
    for number, layer in enumerate(range(first, min(last, first + MOST_LAYERS))):
        held = states(int(ranking.layers[layer]))
        waits = int(ranking.waits_for[layer])
        named = "" if waits < 0 else escape(justices[waits]) or f"promise {waits}"
        bar = f'<span class="bar" style="width:{12 * held / most:.2f}em"></span>'
        rows.append([str(number), _number(held - before), _number(held), named, bar])
        before = held
    more = f"<p>{last - first - MOST_LAYERS} more layers are left out.</p>" if last - first > MOST_LAYERS else ""
    head = ("layer", "new states", "states up to here", "may wait for", "")
    return _table(head, rows) + more


def _play(ranking: Ranking) -> str:
    """Return a play against an environment that moves at random, as a table."""
    player, source = RankingPlayer(ranking), np.random.default_rng(SEED)
    rows: list[list[str]] = []
    state: Bits | None = None
    memory, before, ended = 0, None, ""
    while len(rows) < STEPS:
        inputs = player.inputs(state, {}, source)
        if inputs is None:
            ended = "<p>The environment has no move here.</p>"
            break
        if state is None:
            begun = player.start(inputs)
            if begun is None:
                raise ValueError("it has no start for some initial inputs")
            memory, state = begun
        else:
            memory, state = player.answer(memory, state, inputs)
        values = player.decoded(state)
        rows.append([str(len(rows)), *_marked(ranking, values, before), str(player.pursued(memory, state))])
        before = values
    head = ("step", *(escape(one.name) for one in ranking.variables), "pursues goal")
    told = f"The environment moves at random (seed {SEED}); surefoot simulate plays on. Outputs are blue."
    return f"<h2>A play</h2><p>{told}</p>{_table(head, rows)}{ended}"


def _marked(ranking: Ranking, values: tuple[int, ...], before: tuple[int, ...] | None) -> list[str]:
    """Return values as cells, what changed in bold."""
    cells = []
    for number, (one, value) in enumerate(zip(ranking.variables, values, strict=True)):
        names = ["out"] if number >= ranking.inputs else []
        names += ["changed"] if before is not None and before[number] != value else []
        text = ("true" if value else "false") if one.is_boolean else str(value)
        cells.append(f'<span class="{" ".join(names)}">{text}</span>' if names else text)
    return cells


def _table(head: Iterable[str], rows: Iterable[Sequence[str]]) -> str:
    top = "".join(f"<th>{name}</th>" for name in head)
    body = "".join("<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>\n" for row in rows)
    return f"<table><thead><tr>{top}</tr></thead><tbody>\n{body}</tbody></table>"


def _number(count: int) -> str:
    return f"{count:,}" if count < 10**12 else f"{count:.3g}"
