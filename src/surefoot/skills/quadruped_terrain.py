"""The terrain of a quadruped: polygons on a lattice of cells, with robot, classes and the size of local grids."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from surefoot.errors import InputError
from surefoot.footholds.terrain import Polygon
from surefoot.skills.classes import ClassSet
from surefoot.skills.measures import Ground, Measured
from surefoot.skills.patches import Rectangle
from surefoot.skills.values import Cell, Direction

Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Laid:
    """How the frame of a terrain lies on the scan that its polygons come from; both share their origin.

    Attributes:
        yaw_deg: of the terrain's x axis, counter-clockwise from that of the scan.
        scan: the file of the polygons before they were turned.
        sha256: of that file.
    """

    yaw_deg: float
    scan: str = ""
    sha256: str = ""


@dataclass(frozen=True, eq=False)
class QuadrupedTerrain:
    """A terrain and how it is looked at. Row 0 of the map lies ahead (large x), column 0 to the left (large y).

    Attributes:
        name: of the terrain.
        robot: name of the robot.
        classes: the classes of its cells.
        cell_m: side of a cell.
        grid: rows and columns of a local grid, both odd.
        origin_m: the corner of the map with the least x and y.
        cells: rows and columns of the map.
        polygons: where a foot may stand.
        margin_m: what was taken off their edges.
        requests: cells of a local grid that may be asked for; None for those of ``grid.requests_of``.
        start_m: where the robot starts; None if it may start anywhere.
        goal_m: where it is to go; None if nobody said.
        source: the file that it was read from.
        yaw: whether the robot turns in place (IX-F); else it always faces along x.
        directions: which way it may walk if it turns, seen from the robot.
        laid: how it lies on a scan; None where nobody laid it.
        polygons_from: the file that its polygons were read from, if its own does not hold them.
    """

    name: str
    robot: str
    classes: ClassSet
    cell_m: float
    grid: tuple[int, int]
    origin_m: Point
    cells: tuple[int, int]
    polygons: tuple[Polygon, ...]
    margin_m: float
    requests: tuple[Cell, ...] | None = None
    start_m: Point | None = None
    goal_m: Point | None = None
    source: Path | None = None
    yaw: bool = False
    directions: tuple[Direction, ...] = tuple(Direction)
    laid: Laid | None = None
    polygons_from: Path | None = None

    @cached_property
    def ground(self) -> Ground:
        """The polygons, ready to be measured."""
        return Ground(self.polygons, self.margin_m, self.classes.measures)

    @cached_property
    def measured(self) -> dict[Cell, Measured]:
        """The measures of every cell of the map."""
        rows, columns = self.cells
        return {(r, c): self.ground.measure(self.square_m((r, c))) for r in range(rows) for c in range(columns)}

    def with_polygons(self, polygons: tuple[Polygon, ...], untouched: Iterable[Cell]) -> QuadrupedTerrain:
        """Return the terrain with other polygons; the measures of cells around which nothing changed are kept."""
        changed = replace(self, polygons=polygons)
        kept = {cell: self.measured[cell] for cell in untouched}
        measured = {
            cell: kept[cell] if cell in kept else changed.ground.measure(changed.square_m(cell))
            for cell in self.measured
        }
        vars(changed)["measured"] = measured  # the cached property
        return changed

    def centre_m(self, cell: Cell) -> Point:
        """Return the centre of a cell of the map."""
        (x, y), (rows, columns) = self.origin_m, self.cells
        return x + (rows - cell[0] - 0.5) * self.cell_m, y + (columns - cell[1] - 0.5) * self.cell_m

    def square_m(self, cell: Cell) -> Rectangle:
        """Return the ground plan of a cell of the map."""
        half = self.cell_m / 2
        return Rectangle(-half, -half, half, half).moved(*self.centre_m(cell))

    def cell_at(self, place_m: Point) -> Cell:
        """Return the cell of the map that holds a place; a side belongs to the cell with the larger coordinates.

        Raises:
            InputError: it lies outside of the map.
        """
        (x, y), (rows, columns) = self.origin_m, self.cells
        row = rows - 1 - int((place_m[0] - x) // self.cell_m)
        column = columns - 1 - int((place_m[1] - y) // self.cell_m)
        if not (0 <= row < rows and 0 <= column < columns):
            east, north = x + rows * self.cell_m, y + columns * self.cell_m
            raise InputError(
                f"({place_m[0]:g}, {place_m[1]:g}) lies outside of the map; "
                f"allowed are x from {x:g} to {east:g} and y from {y:g} to {north:g}"
            )
        return row, column
