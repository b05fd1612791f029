"""The blocks of the file of a quadruped's terrain, as docs/formats.md lists them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from surefoot.documents import FormatOne
from surefoot.footholds.problem_blocks import Block, Metres, PolygonBlock

Side = Annotated[int, Field(ge=3, le=9)]
Index = Annotated[int, Field(ge=-1000, le=1000)]
Place = tuple[Metres, Metres]


class LaidBlock(Block):
    """How a terrain lies on the scan that its polygons come from."""

    yaw_deg: Annotated[float, Field(ge=-360, le=360, description="of the x axis, counter-clockwise from the scan's")]
    scan: Annotated[str, Field(max_length=4096, description="file of `surefoot terrain segment`")] = ""
    sha256: Annotated[str, Field(max_length=64, description="of that file")] = ""


class TerrainBlock(Block):
    """The terrain of a quadruped."""

    format: FormatOne
    kind: Literal["quadruped-terrain"]
    name: Annotated[str, Field(min_length=1, max_length=100)] = "terrain"
    robot: Annotated[str | None, Field(max_length=100, description="go2 or chotu; default: that of the classes")] = None
    classes: Annotated[str, Field(min_length=1, max_length=4096, description="a set of classes, or a file of rules")]
    cell_m: Annotated[float | None, Field(ge=0.1, le=5, description="side of a cell; default: that of the classes")] = (
        None
    )
    grid: Annotated[tuple[Side, Side], Field(description="rows and columns of a local grid, both odd")] = (3, 3)
    origin_m: Annotated[Place | None, Field(description="corner of the map with the least x and y")] = None
    cells: Annotated[
        tuple[Annotated[int, Field(ge=1, le=200)], Annotated[int, Field(ge=1, le=200)]] | None,
        Field(description="rows and columns of the map; default: as many as hold all polygons"),
    ] = None
    margin_m: Annotated[
        float | None, Field(ge=0, le=0.1, description="what was taken off the polygons; default: that of the classes")
    ] = None
    polygons: Annotated[
        tuple[PolygonBlock, ...] | str,
        Field(description="polygons, or a file of `surefoot terrain segment`", union_mode="left_to_right"),
    ]
    requests: Annotated[
        tuple[tuple[Index, Index], ...] | None,
        Field(description="cells [row, column] of a local grid to ask for; default: front row, rear corners"),
    ] = None
    yaw: Annotated[bool, Field(description="whether the robot turns in place, by 90 degrees")] = False
    directions: Annotated[
        tuple[Literal["forward", "backward", "left", "right"], ...] | None,
        Field(min_length=1, max_length=4, description="which way a robot that turns may walk; default: all four"),
    ] = None
    start_m: Annotated[Place | None, Field(description="where the robot starts")] = None
    goal_m: Annotated[Place | None, Field(description="where it is to go")] = None
    laid: Annotated[
        LaidBlock | None, Field(description="written by `surefoot terrain lay`: how the polygons were turned")
    ] = None
