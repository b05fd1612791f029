"""Is belief necessary? One scene with and without belief, under two readings (Shamsah et al., T-RO 2023, Fig. 16)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from surefoot.compute import Deadline
from surefoot.errors import LimitExceeded
from surefoot.games import environment_cannot_keep_assumptions, solve
from surefoot.navigation.belief import BeliefKind
from surefoot.navigation.coarse import CoarseMap
from surefoot.navigation.navigation_game import NavigationGame, build_navigation_game
from surefoot.navigation.navigation_rules import NavigationProblem
from surefoot.navigation.strategies import NavigationStrategy
from surefoot.navigation.synthesis import extract_navigation_strategy, solve_navigation
from surefoot.navigation.throughput import Throughput, throughput

Reading = Literal["natural", "paper"]
WITHOUT: tuple[BeliefKind, ...] = ("single", "unnarrowed")
"""One region over all free cells: what is seen narrows it, or does not."""


@dataclass(frozen=True, slots=True)
class BeliefAnswer:
    """What one kind of belief achieves under one reading.

    Attributes:
        reading: "natural" (the rules of the scenario) or "paper".
        belief: how hidden obstacles are tracked.
        realizable: whether the robot wins; None when a limit was reached.
        reason: why not, or which limit.
        decisions: nodes of the game at which the robot decides.
        turns: nodes at which an order is carried out.
        throughput: simulated turns against random obstacles; None without a strategy.
    """

    reading: Reading
    belief: BeliefKind
    realizable: bool | None
    reason: str | None
    decisions: int
    turns: int
    throughput: Throughput | None


def belief_study(
    problem: NavigationProblem,
    corners_hide: CoarseMap,
    turns: int,
    seed: int = 0,
    deadline: Deadline | None = None,
) -> tuple[BeliefAnswer, ...]:
    """Answer for a scene with its own belief and without belief, under both readings.

    The paper's reading: the robot looks before its own move, corners that a line of sight grazes hide, assumption (c)
    counts every threat that the robot sees or believes in, and the robot must not give an order after which the
    obstacles could not keep it.

    Args:
        problem: the scene, with its belief.
        corners_hide: its map with grazed corners that hide.
        turns: simulated turns for the throughput.
        seed: of the obstacles in them.
        deadline: when to give up.
    """
    limit = deadline or Deadline()
    papers = replace(problem, coarse=corners_hide, view="pre", escape_clause=False)
    readings: tuple[tuple[Reading, NavigationProblem], ...] = (("natural", problem), ("paper", papers))
    return tuple(
        _answer(reading, replace(scene, belief=belief), turns, seed, limit)
        for reading, scene in readings
        for belief in dict.fromkeys((problem.belief, *WITHOUT))
    )


def _answer(reading: Reading, problem: NavigationProblem, turns: int, seed: int, deadline: Deadline) -> BeliefAnswer:
    try:
        game = build_navigation_game(problem, deadline)
        reason, strategy = (
            _solved(game, deadline) if reading == "natural" else _solved_without_falsifying(game, deadline)
        )
    except LimitExceeded as limit:
        return BeliefAnswer(reading, problem.belief, None, str(limit), 0, 0, None)
    played = None if strategy is None else throughput(problem, strategy, turns, seed)
    return BeliefAnswer(reading, problem.belief, strategy is not None, reason, game.decisions, game.turns, played)


def _solved(game: NavigationGame, deadline: Deadline) -> tuple[str | None, NavigationStrategy | None]:
    verdict, strategy = solve_navigation(game, deadline)
    return None if verdict.witness is None else verdict.witness.reason, strategy


def _solved_without_falsifying(
    game: NavigationGame, deadline: Deadline
) -> tuple[str | None, NavigationStrategy | None]:
    """Solve a game in which no order may be given after which the obstacles cannot keep assumption (c)."""
    forced = environment_cannot_keep_assumptions(game.arena, np.arange(game.arena.nodes), deadline=deadline)
    lost = game.arena.lost.copy()
    lost[forced] = True
    lost &= (game.order >= 0) & (game.order < 8)
    careful = replace(game, arena=replace(game.arena, lost=lost))
    solution = solve(careful.arena, deadline=deadline)
    if not solution.winning[0]:
        return (
            f"the robot cannot reach its goals again and again without orders after which the obstacles could not keep "
            f"assumption (c); there are {int(lost.sum())} of them",
            None,
        )
    return None, extract_navigation_strategy(careful, solution)[0]
