"""A biped's run as curves in time: what replays, live views and recordings show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import InputError
from surefoot.frames import Cell
from surefoot.missions.biped.run_log import Step, Turn
from surefoot.viewer.sources.cells import centre_m, floor_m, heights_of
from surefoot.viewer.sources.plans import RunSource, read_run_source
from surefoot.viewer.sources.steps import step_curves
from surefoot.walking import Trajectory

Array = NDArray[np.float64]
RATE_HZ = 12.0


@dataclass(frozen=True, slots=True, eq=False)
class Timeline:
    """A run, sampled; arrays of points have the shape (n, 3), map coordinates.

    Attributes:
        time_s: ascending, shape (n,).
        com_m, left_foot_m, right_foot_m: where they are.
        yaw_rad: heading of the step, shape (n,).
        step: index of the step among the run's steps, shape (n,).
        turns: the decisions, ascending in time.
        turn: index of the decision in force, shape (n,).
        obstacles_m: where every obstacle stands, shape (n, obstacles, 3): it glides from cell to cell during a turn.
    """

    time_s: Array
    com_m: Array
    left_foot_m: Array
    right_foot_m: Array
    yaw_rad: Array
    step: NDArray[np.int64]
    turns: tuple[Turn, ...]
    turn: NDArray[np.int64]
    obstacles_m: Array

    @property
    def frames(self) -> int:
        """Return how many moments there are."""
        return len(self.time_s)


def curves_of(steps: Sequence[Step], rate_hz: float) -> tuple[Trajectory, ...]:
    """Return the curves of every step, about so many samples a second."""
    return tuple(step_curves(step, rate_hz) for step in steps)


def timeline(source: RunSource, curves: Sequence[Trajectory]) -> Timeline:
    """Put a run together; where the robot stands there are no samples.

    Args:
        source: the run, with at least one step.
        curves: of its steps, ``curves_of``.
    """
    steps, turns = source.run.steps, source.run.turns
    time_s = np.concatenate([_begin_s(step) + one.time_s for step, one in zip(steps, curves, strict=True)])
    counts = [len(one.time_s) for one in curves]
    starts_s = np.array([turn.time_s for turn in turns])
    turn = np.clip(np.searchsorted(starts_s, time_s, side="right") - 1, 0, None)
    return Timeline(
        time_s=time_s,
        com_m=np.concatenate([one.com_m for one in curves]),
        left_foot_m=np.concatenate([one.left_foot_m for one in curves]),
        right_foot_m=np.concatenate([one.right_foot_m for one in curves]),
        yaw_rad=np.repeat([step.yaw_rad for step in steps], counts),
        step=np.repeat(np.arange(len(steps)), counts),
        turns=tuple(turns),
        turn=turn,
        obstacles_m=_obstacles(source, turns, time_s),
    )


def _begin_s(step: Step) -> float:
    return step.time_s - (step.rise_s or 0.0)


def _obstacles(source: RunSource, turns: Sequence[Turn], time_s: Array) -> Array:
    """Return where the obstacles are: in a turn's cell when it begins, and on the way to the next one's."""
    count = len(turns[0].obstacles) if turns else 0
    if count == 0:
        return np.zeros((len(time_s), 0, 3))
    starts_s, heights = np.array([turn.time_s for turn in turns]), heights_of(source.plan)
    cells = [[Cell(*cell) for cell in turn.obstacles] for turn in turns]
    places = np.array([[(*centre_m(source.plan, cell), floor_m(heights, cell)) for cell in turn] for turn in cells])
    axes = [np.interp(time_s, starts_s, places[:, one, axis]) for one in range(count) for axis in range(3)]
    return np.stack(axes, axis=1).reshape(len(time_s), count, 3)


def read_timeline(run_dir: Path, rate_hz: float = RATE_HZ) -> tuple[RunSource, Timeline]:
    """Read a run and sample it.

    Raises:
        InputError: the run cannot be read, or holds no step.
    """
    source = read_run_source(run_dir)
    if not source.run.steps:
        raise InputError("holds no step, so there is nothing to replay", source=run_dir / "run.jsonl")
    return source, timeline(source, curves_of(source.run.steps, rate_hz))
