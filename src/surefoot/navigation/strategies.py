"""Executable strategies of both games, as saved in a plan folder (docs/formats.md, section 2)."""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot.compute import written_whole
from surefoot.errors import InputError
from surefoot.frames import Direction
from surefoot.navigation.action_game import FineState
from surefoot.navigation.navigation_rules import Order
from surefoot.navigation.obstacles import ObstacleState

NAVIGATION_ARRAYS = ("cell", "heading", "visible", "hidden", "goal", "order", "domain")
ACTION_ARRAYS = ("row", "column", "heading", "stance", "mode", "context", "action")
LARGEST_STRATEGY_BYTES = 2_000_000_000


@dataclass(frozen=True, slots=True, eq=False)
class NavigationStrategy:
    """Which order to give, by what the robot knows: N decisions, the start first.

    Attributes:
        cell: (N,) the robot's cell.
        heading: (N,) its heading.
        state: (N,) index into ``states``.
        goal: (N,) index of the goal pursued.
        order: (N,) the order's code.
        states: what is known of the obstacles.
        goals: cells, visited in this order for ever.
        domain: cells that the masks of ``states`` speak of, bit by bit.
        kinds: the numbers of the obstacles of each kind.
    """

    cell: NDArray[np.int32]
    heading: NDArray[np.int8]
    state: NDArray[np.int32]
    goal: NDArray[np.int16]
    order: NDArray[np.int8]
    states: tuple[ObstacleState, ...]
    goals: tuple[int, ...]
    domain: tuple[int, ...]
    kinds: tuple[tuple[int, ...], ...]
    _number: dict[ObstacleState, int] = field(init=False, repr=False)
    _sorted: NDArray[np.int64] = field(init=False, repr=False)
    _place: NDArray[np.int64] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        codes = self._code(self.cell.astype(np.int64), self.heading, self.state, self.goal)
        place = np.argsort(codes, kind="stable")
        object.__setattr__(self, "_number", {state: number for number, state in enumerate(self.states)})
        object.__setattr__(self, "_sorted", codes[place])
        object.__setattr__(self, "_place", place)

    def _code(self, cell: Any, heading: Any, state: Any, goal: Any) -> Any:
        return ((cell * 4 + heading) * len(self.states) + state) * len(self.goals) + goal

    @property
    def size(self) -> int:
        """The number of decisions N."""
        return len(self.order)

    def first_order(self) -> Order:
        """Return the order at the start, which is the first decision."""
        return Order.of(int(self.order[0]))

    def advance(self, goal: int, cell: int) -> int:
        """Return the index of the next goal when a move, or the start, brings the robot into a cell."""
        return (goal + 1) % len(self.goals) if cell == self.goals[goal] else goal

    def decide(self, cell: int, heading: Direction, state: ObstacleState, goal: int) -> Order:
        """Return the order in a cell, ``goal`` having advanced already.

        Raises:
            KeyError: if the strategy never comes there.
        """
        code = self._code(cell, int(heading), self._number[state], goal)
        found = int(np.searchsorted(self._sorted, code))
        if found == len(self._sorted) or self._sorted[found] != code:
            raise KeyError((cell, heading, state, goal))
        return Order.of(int(self.order[self._place[found]]))

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return the arrays of ``navigation.npz``."""
        width = (len(self.domain) + 7) // 8
        columns = np.cumsum([0, *map(len, self.kinds)])
        visible = np.full((len(self.states), columns[-1]), -1, np.int32)
        hidden = np.zeros((len(self.states), len(self.kinds), width), np.uint8)
        for row, state in enumerate(self.states):
            for kind, (cells, mask) in enumerate(zip(state.visible, state.hidden, strict=True)):
                visible[row, columns[kind] : columns[kind] + len(cells)] = cells
                hidden[row, kind] = np.frombuffer(mask.to_bytes(width, "little"), np.uint8)
        return {
            "cell": self.cell,
            "heading": self.heading,
            "visible": visible[self.state],
            "hidden": hidden[self.state],
            "goal": self.goal,
            "order": self.order,
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


def load_navigation_strategy(
    path: Path, goals: tuple[int, ...], kinds: tuple[tuple[int, ...], ...]
) -> NavigationStrategy:
    """Read ``navigation.npz``.

    Args:
        path: the file.
        goals: cells, visited in this order.
        kinds: the numbers of the obstacles of each kind.

    Raises:
        InputError: if the file is not one, or not for these kinds of obstacles.
    """
    arrays = load_arrays(path, NAVIGATION_ARRAYS)
    visible, hidden = arrays["visible"], arrays["hidden"]
    obstacles, width = sum(map(len, kinds)), (len(arrays["domain"]) + 7) // 8
    if visible.shape[1:] != (obstacles,) or hidden.shape[1:] != (len(kinds), width) or not len(visible):
        raise InputError(
            f"visible must have {obstacles} columns and hidden {len(kinds)} x {width} bytes in every row, at least one",
            source=path,
        )
    flat = np.hstack([visible.astype("<i4").view(np.uint8).reshape(len(visible), -1), hidden.reshape(len(hidden), -1)])
    _, first, state = np.unique(flat, axis=0, return_index=True, return_inverse=True)
    states = tuple(_state(visible[row].tolist(), hidden[row], kinds) for row in first.tolist())
    return NavigationStrategy(
        arrays["cell"],
        arrays["heading"],
        state.reshape(-1).astype(np.int32),
        arrays["goal"],
        arrays["order"],
        states,
        goals,
        tuple(arrays["domain"].tolist()),
        kinds,
    )


def _state(visible: list[int], hidden: NDArray[np.uint8], kinds: tuple[tuple[int, ...], ...]) -> ObstacleState:
    """Return an obstacle state from its row of a file."""
    columns = iter(visible)
    return ObstacleState(
        tuple(tuple(cell for cell in islice(columns, len(kind)) if cell >= 0) for kind in kinds),
        tuple(int.from_bytes(row.tobytes(), "little") for row in hidden),
    )


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
