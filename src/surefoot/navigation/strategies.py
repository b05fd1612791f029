"""Executable strategies of both games, as saved in a plan folder (docs/formats.md, section 2)."""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot.compute import written_whole
from surefoot.errors import InputError
from surefoot.frames import Direction
from surefoot.navigation.action_game import FineState
from surefoot.navigation.navigation_game import Order
from surefoot.navigation.obstacles import ObstacleState

Decision = tuple[int, int, tuple[int, ...], int, int]
"""Cell, heading, visible cells, hidden mask, goal index."""

NAVIGATION_ARRAYS = ("cell", "heading", "visible", "hidden", "goal", "order", "domain")
ACTION_ARRAYS = ("row", "column", "heading", "stance", "mode", "context", "action")
LARGEST_STRATEGY_BYTES = 2_000_000_000


@dataclass(frozen=True, slots=True)
class NavigationStrategy:
    """Which order to give, by what the robot knows.

    Attributes:
        orders: order codes by decision.
        goals: cells, visited in this order for ever.
        domain: cells of the obstacle domain, bit by bit.
        obstacles: number of obstacles.
    """

    orders: Mapping[Decision, int]
    goals: tuple[int, ...]
    domain: tuple[int, ...]
    obstacles: int

    def first_order(self) -> Order:
        """Return the order at the start, which is the first decision."""
        return Order.of(next(iter(self.orders.values())))

    def advance(self, goal: int, cell: int) -> int:
        """Return the index of the next goal when a move, or the start, brings the robot into a cell."""
        return (goal + 1) % len(self.goals) if cell == self.goals[goal] else goal

    def decide(self, cell: int, heading: Direction, state: ObstacleState, goal: int) -> Order:
        """Return the order in a cell, ``goal`` having advanced already.

        Raises:
            KeyError: if the strategy never comes there.
        """
        return Order.of(self.orders[cell, int(heading), state.visible, state.hidden, goal])

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return the arrays of ``navigation.npz``."""
        rows = len(self.orders)
        width = (len(self.domain) + 7) // 8
        visible = np.full((rows, self.obstacles), -1, np.int32)
        hidden = np.zeros((rows, width), np.uint8)
        for row, (_, _, cells, mask, _) in enumerate(self.orders):
            visible[row, : len(cells)] = cells
            hidden[row] = np.frombuffer(mask.to_bytes(width, "little"), np.uint8)
        return {
            "cell": np.array([key[0] for key in self.orders], np.int32),
            "heading": np.array([key[1] for key in self.orders], np.int8),
            "visible": visible,
            "hidden": hidden,
            "goal": np.array([key[4] for key in self.orders], np.int16),
            "order": np.array(list(self.orders.values()), np.int8),
            "domain": np.array(self.domain, np.int32),
        }


@dataclass(frozen=True, slots=True)
class ActionStrategy:
    """Which walking action to take, by fine state.

    Attributes:
        actions: action codes by state.
    """

    actions: Mapping[FineState, int]

    def decide(self, state: FineState) -> int:
        """Return the action in a state.

        Raises:
            KeyError: if the strategy never comes there.
        """
        return self.actions[state]

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return the arrays of ``action.npz``."""
        states = np.array(list(self.actions), np.int16).reshape(-1, 6)
        columns = {name: states[:, number].copy() for number, name in enumerate(ACTION_ARRAYS[:-1])}
        return {**columns, "action": np.array(list(self.actions.values()), np.int16)}


def save_arrays(path: Path, arrays: Mapping[str, NDArray[Any]]) -> None:
    """Write arrays as a compressed npz, whole or not at all."""
    with written_whole(path) as stream:
        np.savez_compressed(stream, allow_pickle=False, **arrays)


def load_navigation_strategy(path: Path, goals: tuple[int, ...]) -> NavigationStrategy:
    """Read ``navigation.npz``.

    Raises:
        InputError: if the file is not one.
    """
    arrays = load_arrays(path, NAVIGATION_ARRAYS)
    visible, hidden = arrays["visible"], arrays["hidden"]
    if visible.ndim != 2 or hidden.ndim != 2:
        raise InputError("visible and hidden must be matrices, one row a decision", source=path)
    keys = zip(
        arrays["cell"].tolist(),
        arrays["heading"].tolist(),
        (tuple(cell for cell in row if cell >= 0) for row in visible.tolist()),
        (int.from_bytes(row.tobytes(), "little") for row in hidden),
        arrays["goal"].tolist(),
        strict=True,
    )
    orders = dict(zip(keys, arrays["order"].tolist(), strict=True))
    return NavigationStrategy(orders, goals, tuple(arrays["domain"].tolist()), visible.shape[1])


def load_action_strategy(path: Path) -> ActionStrategy:
    """Read ``action.npz``.

    Raises:
        InputError: if the file is not one.
    """
    arrays = load_arrays(path, ACTION_ARRAYS)
    columns = [arrays[name].tolist() for name in ACTION_ARRAYS]
    return ActionStrategy({FineState(*row[:6]): row[6] for row in zip(*columns, strict=True)})


def load_arrays(path: Path, names: tuple[str, ...]) -> dict[str, NDArray[Any]]:
    """Read named arrays of equal length (``domain`` apart) from an npz, without pickle.

    Raises:
        InputError: if the file is missing, damaged or lacks an array.
    """
    try:
        with zipfile.ZipFile(path) as archive_file:
            size = sum(member.file_size for member in archive_file.infolist())
        if size > LARGEST_STRATEGY_BYTES:
            raise InputError(f"unpacks to {size} bytes; at most {LARGEST_STRATEGY_BYTES} are allowed", source=path)
        with np.load(path, allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in names}
    except (OSError, ValueError, KeyError, zipfile.BadZipFile, EOFError) as problem:
        raise InputError(f"is not a whole strategy file with the arrays {', '.join(names)}", source=path) from problem
    lengths = {len(array) for name, array in arrays.items() if name != "domain"}
    if len(lengths) != 1:
        raise InputError("its arrays differ in length", source=path)
    return arrays
