"""``surefoot terrain``: from an elevation scan to polygons that a foot may stand on."""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from surefoot.cli.output import PICTURES, AsJson, answer, apart, facts, to_write
from surefoot.cli.terrain_lay import lay

if TYPE_CHECKING:
    from surefoot.world import ElevationMap, SegmentOptions, Terrain

app = typer.Typer(
    help="Terrain: segment an elevation scan into steppable polygons, and lay cells over them.", rich_markup_mode="rich"
)
app.command("lay")(lay)


@app.command("segment")
def segment(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="SCAN",
            help="Grey picture (PNG, PGM, BMP), npy, npz, a bag (folder, MCAP) with grid maps, planar regions (YAML).",
            show_default=False,
        ),
    ],
    resolution_m: Annotated[
        float | None, typer.Option("--resolution", help="Metres per pixel or cell; for pictures and arrays.")
    ] = None,
    height_range_m: Annotated[
        tuple[float, float] | None,
        typer.Option("--height-range", help="Heights of black and of white in metres; for pictures."),
    ] = None,
    origin_m: Annotated[
        tuple[float, float], typer.Option("--origin", help="World position of the lower-left corner.")
    ] = (0.0, 0.0),
    no_data: Annotated[
        int | None, typer.Option("--no-data", help="Grey level that means: nothing was measured.")
    ] = None,
    layer: Annotated[
        str | None, typer.Option(help="Layer of a grid map (default: elevation), or array of an npz file.")
    ] = None,
    topic: Annotated[str | None, typer.Option(help="Topic of a bag; may be left out when only one fits.")] = None,
    message: Annotated[int, typer.Option(help="Message on the topic; negative numbers count from the last.")] = -1,
    margin_m: Annotated[float, typer.Option("--margin", help="Distance kept from edges: the foot's radius.")] = 0.02,
    max_slope_deg: Annotated[float, typer.Option("--max-slope", help="Steepest ground, in degrees.")] = 30.0,
    max_error_m: Annotated[
        float, typer.Option("--max-error", help="Largest distance of ground from its polygon.")
    ] = 0.02,
    max_roughness_m: Annotated[
        float, typer.Option("--max-roughness", help="Largest standard deviation of heights about their plane.")
    ] = 0.015,
    min_area_m2: Annotated[float, typer.Option("--min-area", help="Smallest polygon, in square metres.")] = 0.002,
    fill_m: Annotated[float, typer.Option("--fill", help="Dropouts up to this width are bridged; 0: none.")] = 0.03,
    friction: Annotated[float, typer.Option(help="Friction coefficient written into the polygons.")] = 0.6,
    keep_narrow: Annotated[
        bool, typer.Option("--keep-narrow", help="Turn narrow raised things (bars) into strips 1 cm wide.")
    ] = False,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", callback=to_write(".json"), help="The terrain file to write.")
    ] = None,
    plot: Annotated[
        Path | None, typer.Option("--plot", callback=to_write(*PICTURES), help="A picture (PNG) to draw.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Turn a scan into convex, planar polygons that a foot may stand on.

    Holes stay holes, the foot margin is taken off every edge, and what is too
    steep, too rough, too small or too narrow is reported. The polygons of the
    file can be pasted into a problem of `surefoot footholds`.

    Examples:
      surefoot terrain segment stairs.png --resolution 0.02 --height-range 0 1.25 -o terrain.json --plot terrain.png
      surefoot terrain segment scan.npy --resolution 0.02 --json
      surefoot terrain segment bag/ --topic /elevation_map --layer elevation -o terrain.json
      surefoot terrain segment planar_regions.yaml --margin 0.03 -o terrain.json

    Exit code 0: there are polygons; 1: there is nothing to stand on; 2: the
    scan cannot be used.
    """
    from surefoot.world import SegmentOptions

    apart(source, output, plot)
    options = SegmentOptions(
        margin_m=margin_m,
        max_slope_deg=max_slope_deg,
        max_error_m=max_error_m,
        max_roughness_m=max_roughness_m,
        min_area_m2=min_area_m2,
        fill_m=fill_m,
        friction=friction,
        keep_narrow=keep_narrow,
    )
    begin = time.perf_counter()
    given = {"resolution": resolution_m, "height-range": height_range_m, "no-data": no_data, "layer": layer}
    terrain, scan, reading = _segmented(source, options, given, origin_m, topic, message)
    total_s = time.perf_counter() - begin
    if output is not None:
        from surefoot.world.terrain_file import write_terrain

        write_terrain(output, terrain, options, source, reading)
    if plot is not None:
        from surefoot.viewer.terrain.scan import draw_terrain

        draw_terrain(terrain, scan, plot, title=source.name, options=options)
    _say(terrain, output, plot, total_s, as_json=as_json)


def _segmented(
    source: Path,
    options: SegmentOptions,
    given: Mapping[str, object],
    origin_m: tuple[float, float],
    topic: str | None,
    message: int,
) -> tuple[Terrain, ElevationMap | None, Mapping[str, object]]:
    """Return the terrain, the scan when there is one, and how the input was read."""
    from surefoot.errors import InputError
    from surefoot.world import read_elevation, segment_terrain, terrain_of_regions
    from surefoot.world.planar_regions import carries_planar_regions, read_planar_regions

    if not source.exists():
        raise InputError("does not exist; give the path of a scan", source=source)
    if carries_planar_regions(source, topic):
        for name, value in given.items():
            if value is not None:
                raise InputError("is only allowed for scans; planar regions carry their own", key=name)
        regions = read_planar_regions(source, topic=topic, message=message)
        return terrain_of_regions(regions, options), None, {"as": "planar regions", "topic": topic, "message": message}
    scan = read_elevation(
        source,
        resolution_m=given["resolution"],  # type: ignore[arg-type]
        height_range_m=given["height-range"],  # type: ignore[arg-type]
        origin_m=origin_m,
        layer=given["layer"],  # type: ignore[arg-type]
        topic=topic,
        message=message,
        no_data=given["no-data"],  # type: ignore[arg-type]
    )
    from surefoot.world.scanned_terrain import warm_up

    warm_up()
    return segment_terrain(scan, options), scan, scan.reading


def _say(terrain: Terrain, output: Path | None, plot: Path | None, total_s: float, *, as_json: bool) -> None:
    from surefoot.world.terrain_file import statistics

    measured = statistics(terrain)
    shown = {name: value for name, value in measured.items() if name != "warnings"}
    lines = [
        f"{len(terrain.polygons)} polygons in {len(terrain.regions)} regions" + (f", in {output}" if output else ""),
        *facts(shown),
        *(f"  warning: {warning}" for warning in terrain.warnings),
    ]
    value = {
        "polygons": [
            {"vertices_m": polygon.vertices_m, "friction": polygon.friction, "region": polygon.region}
            for polygon in terrain.polygons
        ],
        **measured,
        "total_s": total_s,
        "narrow": terrain.narrow,
        "files": [str(file) for file in (output, plot) if file is not None],
    }
    answer(value, lines, yes=bool(terrain.polygons), as_json=as_json)
