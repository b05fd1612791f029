"""Floors and stairs on the coarse grid (docs/rules.md, section 2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import InputError
from surefoot.frames import Cell, Direction
from surefoot.world.flights import Flight, Stairs, flight_of
from surefoot.world.floors import Floor, FloorPlan
from surefoot.world.grid import CoarseGrid

__all__ = ["Floor", "HeightMap", "Profile", "Stairs", "make_heights"]

SAME_HEIGHT_M = 1e-6


@dataclass(frozen=True, slots=True)
class Profile:
    """How the floor rises in a stairs cell.

    Attributes:
        up: the axis; fine cells are counted along it.
        heights_m: height at the centre of every fine cell, relative to the border where the axis enters the cell.
        gain_m: height gained over the whole cell.
        admissible: for every fine cell, whether a foot may stand at its centre: no riser is nearer than 0.10 m.
    """

    up: Direction
    heights_m: tuple[float, ...]
    gain_m: float
    admissible: tuple[bool, ...]


@dataclass(frozen=True, slots=True, eq=False)
class HeightMap:
    """The heights of a coarse grid.

    Attributes:
        profiles: index 0 is None, flat; equal profiles are shared.
        profile_of: (rows, columns) index into the profiles.
        base_m: (rows, columns) floor height of a flat cell; of a stairs cell, the height at the border where its
            axis enters.
    """

    profiles: tuple[Profile | None, ...]
    profile_of: NDArray[np.int16]
    base_m: NDArray[np.float64]

    def profile(self, cell: Cell) -> Profile | None:
        """Return the profile of a cell on the grid, None for a flat one."""
        return self.profiles[int(self.profile_of[cell.row, cell.column])]

    def passable(self, grid: CoarseGrid, cell: Cell, direction: Direction) -> bool:
        """Return whether the robot can walk from a cell to its neighbour in a direction.

        Both cells have to be free, the heights on both sides of their border have to agree, and the direction has to be
        parallel to the axis of every stairs cell among the two.
        """
        target = cell.neighbour(direction)
        if not (grid.is_free(cell) and grid.is_free(target)):
            return False
        out_m, in_m = self._border_m(cell, direction), self._border_m(target, direction.opposite)
        return out_m is not None and in_m is not None and abs(out_m - in_m) <= SAME_HEIGHT_M

    def height_at(self, grid: CoarseGrid, point_world_m: tuple[float, float]) -> float:
        """Return the height of the floor under a point; off the grid that of the nearest cell.

        In a stairs cell it is the height at the centre of the fine cell that holds the point.
        """
        across, down = grid.place(point_world_m)
        column = int(np.clip(np.floor(across), 0, grid.columns - 1))
        row = int(np.clip(np.floor(down), 0, grid.rows - 1))
        base_m, profile = float(self.base_m[row, column]), self.profile(Cell(row, column))
        if profile is None:
            return base_m
        along = {
            Direction.NORTH: row + 1 - down,
            Direction.EAST: across - column,
            Direction.SOUTH: down - row,
            Direction.WEST: column + 1 - across,
        }[profile.up]
        count = len(profile.heights_m)
        return base_m + profile.heights_m[int(np.clip(np.floor(along * count), 0, count - 1))]

    def _border_m(self, cell: Cell, side: Direction) -> float | None:
        """Return the height at a side of a cell, None when the axis of the cell does not cross that side."""
        base_m, profile = float(self.base_m[cell.row, cell.column]), self.profile(cell)
        if profile is None or side == profile.up.opposite:
            return base_m
        return base_m + profile.gain_m if side == profile.up else None


def make_heights(
    grid: CoarseGrid, fine_cells: int, floors: tuple[Floor, ...] = (), stairs: tuple[Stairs, ...] = ()
) -> HeightMap:
    """Give every cell of a grid its floor height or its height profile.

    Args:
        grid: the coarse grid; only its free cells have to make sense.
        fine_cells: fine cells per side of a coarse cell.
        floors: rectangles at a height; everywhere else the floor is at 0.
        stairs: flights of stairs; floors that lie under one do not matter, except just before its lower edge.

    Returns:
        The heights; blocked cells are flat, at the floor height of their centre.

    Raises:
        InputError: a value is out of range, a flat cell has two heights, a flight does not span a cell across, has a
            riser nearer than 0.10 m to a cell outside it, does not end at the height of the floor beyond it, meets no
            free cell, or meets one of another flight. The key is ``heights.floors[i]`` or ``heights.stairs[i]``.

    Source: docs/rules.md, section 2.
    """
    if fine_cells < 1:
        raise InputError(f"has to be at least 1, not {fine_cells!r}", key="walking.fine_cells")
    plan = FloorPlan(grid, floors)
    owner: dict[Cell, int] = {}
    profiles: dict[Profile | None, int] = {None: 0}
    profile_of = np.zeros((grid.rows, grid.columns), np.int16)
    base_m = np.zeros((grid.rows, grid.columns))
    for number, given in enumerate(stairs):
        flight = flight_of(grid, plan, given, f"heights.stairs[{number}]")
        for cell in flight.cells:
            if cell in owner:
                raise flight.wrong(
                    f"meets {tuple(cell)}, a cell of heights.stairs[{owner[cell]}]; a cell has one flight"
                )
            owner[cell] = number
            base_m[cell], profile = _profile(grid, flight, cell, fine_cells)
            profile_of[cell] = profiles.setdefault(profile, len(profiles))
    for row, column in np.ndindex(grid.rows, grid.columns):
        cell = Cell(row, column)
        if cell not in owner:
            base_m[cell] = plan.flat_m(cell) if grid.is_free(cell) else plan.center_m(cell)
    profile_of.setflags(write=False)
    base_m.setflags(write=False)
    return HeightMap(tuple(profiles), profile_of, base_m)


def _profile(grid: CoarseGrid, flight: Flight, cell: Cell, fine_cells: int) -> tuple[float, Profile]:
    """Return the height at the border where the axis enters a stairs cell, and the cell's profile."""
    begin_m = flight.entry_m(cell)
    size_m = grid.cell_size_m
    centers_m = begin_m + (np.arange(fine_cells, dtype=np.float64) + 0.5) * (size_m / fine_cells)
    below = flight.risers_before(begin_m)
    heights_m = (flight.risers_to(centers_m) - below) * flight.riser_m
    gain_m = (flight.risers_before(begin_m + size_m) - below) * flight.riser_m
    admissible = flight.clearance_m(centers_m) >= flight.least_clearance_m
    profile = Profile(flight.up, tuple(heights_m.tolist()), gain_m, tuple(admissible.tolist()))
    return flight.foot_m + below * flight.riser_m, profile
