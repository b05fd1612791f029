"""From physical states to symbols and back: local grids about the robot, terrain states of a whole map, requests.

Heights are relative to the ground that the robot stands on when the labels are made, at the centre of the grid. A move
between two cells of one class is therefore the same wherever these lie: ``high->high`` asks physics what ``flat->flat``
does (``physics.PhysicsOfClasses.crossing``).

Source: Zhou et al. 2025, III-A and IX-C.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from surefoot.errors import InputError
from surefoot.skills.classes import ClassSet
from surefoot.skills.headings import HEADINGS, Turning, turning_of
from surefoot.skills.measures import Measured
from surefoot.skills.obstacles import excesses, in_words
from surefoot.skills.patches import Rectangle
from surefoot.skills.quadruped_terrain import Point, QuadrupedTerrain
from surefoot.skills.values import OBSTACLE, Cell, TerrainState

_TURNS = ((1, 0), (0, 1), (-1, 0), (0, -1))


@dataclass(frozen=True, slots=True)
class SymbolicState:
    """An input state: where the robot is, where it is asked to go, and the classes of all cells."""

    robot: Cell
    request: Cell
    terrain: TerrainState


@dataclass(frozen=True, eq=False)
class LocalGrid:
    """Cells about a place, seen with a heading: the grounding of symbols.

    Attributes:
        terrain: where it lies.
        centre_m: centre of its middle cell.
        quarter_turns: heading in units of 90 degrees, counter-clockwise from +x.
    """

    terrain: QuadrupedTerrain
    centre_m: Point
    quarter_turns: int = 0

    @cached_property
    def state(self) -> TerrainState:
        """The class of every cell, heights relative to the ground in the middle.

        Raises:
            InputError: the middle cell is an obstacle.
        """
        if not self.standing:
            x, y = self.centre_m
            raise InputError(
                f"the robot's own cell, about ({x:g}, {y:g}), is an obstacle ({self._why()}); it has to stand on "
                f"ground of a class: {', '.join(self.terrain.classes.names)}"
            )
        return TerrainState(self.labels)

    @property
    def standing(self) -> bool:
        """Whether the robot can stand in the middle: whether that is no obstacle."""
        rows, columns = self.terrain.grid
        return self.labels[rows // 2][columns // 2] != OBSTACLE

    @cached_property
    def labels(self) -> tuple[tuple[str, ...], ...]:
        """The class of every cell; all are obstacles where the middle has no ground to stand on."""
        rows, columns = self.terrain.grid
        support = self._measured((rows // 2, columns // 2)).height_m
        return tuple(tuple(self._label((r, c), support) for c in range(columns)) for r in range(rows))

    def _why(self) -> str:
        """Return what makes the middle an obstacle."""
        rows, columns = self.terrain.grid
        measured = self._measured((rows // 2, columns // 2)).turned(self.quarter_turns)
        if math.isnan(measured.height_m):
            return "there is no ground in it"
        return in_words(excesses(self.terrain.classes, measured.seen_from(measured.height_m)))

    def _label(self, cell: Cell, support_m: float) -> str:
        measured = self._measured(cell).turned(self.quarter_turns)
        if math.isnan(support_m) or math.isnan(measured.height_m):
            return OBSTACLE
        return self.terrain.classes.classify(measured.seen_from(support_m))

    def _measured(self, cell: Cell) -> Measured:
        known = self.terrain.measured
        x, y = self.place_m(cell)
        (west, south), (rows, columns) = self.terrain.origin_m, self.terrain.cells
        side = self.terrain.cell_m
        row, column = rows - 0.5 - (x - west) / side, columns - 0.5 - (y - south) / side
        if abs(row - round(row)) < 1e-6 and abs(column - round(column)) < 1e-6:
            return known.get((round(row), round(column)), _NOTHING)
        if not (-0.5 <= row <= rows - 0.5 and -0.5 <= column <= columns - 0.5):
            return _NOTHING
        return self.terrain.ground.measure(self.square_m(cell))

    def place_m(self, cell: Cell) -> Point:
        """Return the centre of a cell in the world."""
        rows, columns = self.terrain.grid
        ahead, left = (rows // 2 - cell[0]) * self.terrain.cell_m, (columns // 2 - cell[1]) * self.terrain.cell_m
        c, s = _TURNS[self.quarter_turns % 4]
        return self.centre_m[0] + c * ahead - s * left, self.centre_m[1] + s * ahead + c * left

    def square_m(self, cell: Cell) -> Rectangle:
        """Return the ground plan of a cell: what its symbol stands for."""
        half = self.terrain.cell_m / 2
        return Rectangle(-half, -half, half, half).moved(*self.place_m(cell))

    def cell_at(self, place_m: Point) -> Cell:
        """Return the cell that holds a place; a side belongs to the cell behind it, or to its right.

        Raises:
            InputError: it lies outside of the grid.
        """
        side, (rows, columns) = self.terrain.cell_m, self.terrain.grid
        c, s = _TURNS[self.quarter_turns % 4]
        dx, dy = place_m[0] - self.centre_m[0], place_m[1] - self.centre_m[1]
        row = rows // 2 - math.ceil((c * dx + s * dy) / side - 0.5)
        column = columns // 2 - math.ceil((-s * dx + c * dy) / side - 0.5)
        if not (0 <= row < rows and 0 <= column < columns):
            raise InputError(f"({place_m[0]:g}, {place_m[1]:g}) lies outside of the {rows} x {columns} grid")
        return row, column

    def abstract(self, robot_m: Point, request_m: Point) -> SymbolicState:
        """Return the symbols of a physical state (the inverse grounding).

        Raises:
            InputError: a place lies outside of the grid, or the middle cell is an obstacle.
        """
        return SymbolicState(self.cell_at(robot_m), self.cell_at(request_m), self.state)

    def holds(self, state: SymbolicState, robot_m: Point, request_m: Point) -> bool:
        """Return whether a physical state is among those that symbols stand for (the grounding)."""
        return (
            _within(self.square_m(state.robot), robot_m)
            and _within(self.square_m(state.request), request_m)
            and state.terrain == self.state
        )


_NOTHING = Measured({}, math.nan)


def _within(square: Rectangle, place_m: Point) -> bool:
    x, y = place_m
    return square.west - 1e-9 <= x <= square.east + 1e-9 and square.south - 1e-9 <= y <= square.north + 1e-9


@dataclass(frozen=True, slots=True)
class TerrainSet:
    """What synthesis needs of a terrain: the possible terrain states, and what may be asked for in each.

    Attributes:
        name: of the terrain.
        cell_m: side of a cell.
        classes: the classes.
        robot: name of the robot.
        states: all different, in the order of the sweep.
        asked: cells that may be asked for in every state; None for those of ``requests_of``.
        turning: how a robot that turns sees the states; None for one that always faces ahead.
    """

    name: str
    cell_m: float
    classes: ClassSet
    robot: str
    states: tuple[TerrainState, ...]
    asked: tuple[Cell, ...] | None = None
    turning: Turning | None = None

    def requests(self, state: TerrainState) -> tuple[Cell, ...]:
        """Return the cells that may be asked for: never an obstacle."""
        cells = requests_of(state) if self.asked is None else self.asked
        return tuple(cell for cell in cells if state.label(cell) != OBSTACLE)

    def pairs(self) -> tuple[tuple[TerrainState, Cell], ...]:
        """Return every terrain state with each of its requests."""
        return tuple((state, cell) for state in self.states for cell in self.requests(state))


def requests_of(state: TerrainState) -> tuple[Cell, ...]:
    """Return the cells of the front row and the two corners of the rear row that are no obstacles."""
    rear = state.rows - 1
    cells = [(0, column) for column in range(state.columns)] + [(rear, 0), (rear, state.columns - 1)]
    return tuple(cell for cell in cells if state.label(cell) != OBSTACLE)


def terrain_set(terrain: QuadrupedTerrain, *, headings: Sequence[int] | None = None) -> TerrainSet:
    """Return the terrain states that a grid meets which is slid over the map in steps of one cell.

    Cells outside of the map are obstacles; places where the robot cannot stand are left out, and so are duplicates.

    Args:
        terrain: the map.
        headings: in quarter turns; None for all four where the robot turns (IX-F), else for one that faces along x.
    """
    rows, columns = terrain.cells
    headings = headings or (range(HEADINGS) if terrain.yaw else (0,))
    states: dict[TerrainState, None] = {}
    for turns in headings:
        for cell in ((r, c) for r in range(rows) for c in range(columns)):
            grid = LocalGrid(terrain, terrain.centre_m(cell), turns)
            if grid.standing:
                states.setdefault(grid.state)
    if not states:
        raise InputError(
            f"the robot can stand in none of the {rows * columns} cells of {terrain.name}: all are obstacles by the "
            f"rules of {terrain.classes.name}",
            source=terrain.source,
        )
    turning = turning_of(terrain.classes, terrain.directions) if terrain.yaw else None
    asked = terrain.requests
    return TerrainSet(terrain.name, terrain.cell_m, terrain.classes, terrain.robot, tuple(states), asked, turning)
