"""What a terrain file says of itself beyond its polygons: regions, shares, narrow things and their strips, warnings.

Written from formats.md 8. The file does not hold the cells of its regions, so that some measures are known within
bounds only: regions are disjoint, hold the cells below their polygons, and no cells but those of the scan.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely  # type: ignore[import-untyped]
from numpy.typing import NDArray

from surefoot.verify.findings import Ledger
from surefoot.verify.values import Fields
from surefoot.world.elevation import ElevationMap

Floats = NDArray[np.float64]
_CLOSE = 1e-6
_WHOLE = 1e-3
_LEAST_RISE_M, _NOISES = 0.03, 6.0
_LEAST_LENGTH_M, _LEAST_ON_LINE = 0.08, 0.9
_STRIP_M = 0.01
_SURE_CELLS = 1.5
"""By how much more than the margin a plain outline may lie inside a fitted one, at most: for bounds only."""


@dataclass(frozen=True, slots=True)
class Piece:
    """A polygon of the file: its region (-1 for a strip), vertices (n, 3), unit normal, area, and cells below it."""

    region: int
    points: Floats
    normal: Floats
    area_m2: float
    cells: int


def check_regions(fields: Fields, pieces: Sequence[Piece], ledger: Ledger) -> list[Fields]:
    """Check that regions and polygons name each other, and the sums over polygons; return the regions."""
    regions = fields.mappings("regions")
    members: dict[int, list[int]] = {}
    for number, piece in enumerate(pieces):
        members.setdefault(piece.region, []).append(number)
    for number, region in enumerate(regions):
        place, own = f"regions[{number}]", members.get(number, [])
        if list(region.wholes("polygons")) != own or not own:
            ledger.refuse("terrain, regions", "does not list the polygons that name it", f"{place}.polygons")
            continue
        if max(np.abs(np.array(region.numbers("normal", 3)) - pieces[k].normal).max() for k in own) > _CLOSE:
            ledger.refuse("terrain, regions", "has another plane than its polygons", f"{place}.normal")
        kept_m2 = sum(pieces[k].area_m2 for k in own)
        if not math.isclose(region.number("kept_m2"), kept_m2, rel_tol=_CLOSE):
            ledger.refuse("terrain, regions", f"its polygons measure {kept_m2:.6g} m2", f"{place}.kept_m2")
    if members and max(members) >= len(regions):
        ledger.refuse("terrain, regions", f"region {max(members)} is not there", "regions")
    stated = fields.mapping("statistics")
    if stated.whole("regions", least=0) != len(regions):
        ledger.refuse("terrain, regions", f"there are {len(regions)}", "statistics.regions")
    count = sum(len(own) for number, own in members.items() if number >= 0) / max(len(regions), 1)
    _same("pieces_per_region", stated, count, ledger)
    return regions


def check_shares(
    fields: Fields, scan: ElevationMap, pieces: Sequence[Piece], regions: Sequence[Fields], empty: int, ledger: Ledger
) -> None:
    """Check what shares of the scan became regions and polygons, as far as the polygons tell.

    Args:
        fields: of the file.
        scan: the heights.
        pieces: the polygons.
        regions: as ``check_regions`` returns them.
        empty: how many cells of the scan are dropouts, which regions may hold besides cells with data.
        ledger: takes the findings.
    """
    stated, cell_m2 = fields.mapping("statistics"), scan.resolution_m**2
    known = int(np.isfinite(scan.height_m).sum())
    sizes = [one.number("area_m2", least=0.0) * one.numbers("normal", 3)[2] / cell_m2 for one in regions]
    margin_m, below_regions = fields.mapping("options").number("margin_m", least=0.0), np.zeros(len(regions), np.int64)
    for piece in pieces:
        if (
            0 <= piece.region < len(regions) and margin_m >= scan.resolution_m / 2
        ):  # else polygons may pass the cells at their edges
            below_regions[piece.region] += piece.cells
    for number, (size, below) in enumerate(zip(sizes, below_regions, strict=True)):
        if abs(size - round(size)) > _WHOLE or round(size) < below:
            message = f"is no whole number of cells, or less than the {below} below its polygons"
            ledger.refuse("terrain, regions", message, f"regions[{number}].area_m2")
    total = sum(map(round, sizes))
    if total > known + empty:
        ledger.refuse("terrain, regions", "are larger than the scan", "regions")
    _between("ground_share", stated, (total - empty) / max(known, 1), min(total / max(known, 1), 1.0), ledger)
    flat_m2 = sum(piece.area_m2 * piece.normal[2] for piece in pieces if piece.region >= 0)
    least_m2 = _least_plain_m2(margin_m, scan.resolution_m, pieces)
    highest = flat_m2 / least_m2 if least_m2 > 0 else math.inf
    _between("kept_share", stated, flat_m2 / ((known + empty) * cell_m2), highest, ledger)


def _least_plain_m2(margin_m: float, cell_m: float, pieces: Sequence[Piece]) -> float:
    """Return an area that the margin surely leaves of the regions: what is deep inside their polygons."""
    inside = [shapely.Polygon(one.points[:, :2]) for one in pieces if one.region >= 0]
    return float(shapely.area(shapely.buffer(inside, -min(margin_m, cell_m / 4) - _SURE_CELLS * cell_m)).sum())


def check_narrow(fields: Fields, scan: ElevationMap, pieces: Sequence[Piece], ledger: Ledger) -> list[Fields]:
    """Check that narrow things stand out of the scan where they are said to, and that strips lie on them."""
    options, noise_m = fields.mapping("options"), fields.mapping("statistics").number("noise_m", least=0.0)
    widest_m = 2 * options.number("margin_m", least=0.0) + 2 * scan.resolution_m
    things = fields.mappings("narrow")
    for number, thing in enumerate(things):
        problem = _no_narrow_thing(thing, scan, widest_m, max(_LEAST_RISE_M, _NOISES * noise_m))
        if problem:
            ledger.refuse("terrain, narrow", problem, f"narrow[{number}]")
    strips = [(number, piece) for number, piece in enumerate(pieces) if piece.region < 0]
    if strips and not options.flag("keep_narrow"):
        ledger.refuse("terrain, strips", "are there, although options.keep_narrow is false", "polygons")
    lines = [np.array([thing.numbers("start_m", 3), thing.numbers("end_m", 3)]) for thing in things]
    used: list[int] = []
    for number, piece in strips:
        on = [k for k, line in enumerate(lines) if k not in used and _strip_of(piece.points, line)]
        used += on[:1]
        if not on:
            ledger.refuse("terrain, strips", "is no strip along a narrow thing of its own", f"polygons[{number}]")
    return things


def _no_narrow_thing(thing: Fields, scan: ElevationMap, widest_m: float, least_rise_m: float) -> str:
    """Return what is wrong with a narrow thing; empty when nothing is."""
    start, end = np.array(thing.numbers("start_m", 3)), np.array(thing.numbers("end_m", 3))
    cell_m, length_m, width_m = scan.resolution_m, thing.number("length_m"), thing.number("width_m")
    if abs(float(np.hypot(*(end - start)[:2])) + cell_m - length_m) > _CLOSE:
        return "is not as long as from one end to the other, and a cell"
    cells = width_m * length_m / cell_m**2
    if length_m < max(_LEAST_LENGTH_M, 2 * width_m) - _CLOSE or width_m <= 0 or abs(cells - round(cells)) > _WHOLE:
        return "is short, not twice as long as wide, or no whole number of cells"
    line = np.linspace(start, end, max(2, math.ceil(2 * length_m / cell_m)))
    half = max(1, math.ceil(widest_m / (2 * cell_m)))
    rises = np.array([_rise(scan, x, y, half) for x, y, _ in line])
    if not (rises >= least_rise_m - _CLOSE).mean() >= _LEAST_ON_LINE - 1 / len(line):
        return f"does not stand out of the scan by {least_rise_m:.3g} m along its centre line"
    rise_m = thing.number("rise_m")
    if rise_m < least_rise_m - _CLOSE or rise_m > _most_rise_m(scan, line, length_m, half) + _CLOSE:
        return f"does not rise by {rise_m:.3g} m"
    return ""


def _rise(scan: ElevationMap, x: float, y: float, half: int) -> float:
    """Return by how much a cell is above the lowest one in a square around it; infinite beside the void."""
    row, column = _cell(scan, x, y)
    rows, columns = scan.height_m.shape
    if not (0 <= row < rows and 0 <= column < columns) or np.isnan(scan.height_m[row, column]):
        return -math.inf
    around = scan.height_m[max(row - half, 0) : row + half + 1, max(column - half, 0) : column + half + 1]
    if around.shape != (2 * half + 1, 2 * half + 1) or np.isnan(around).any():
        return math.inf
    return float(scan.height_m[row, column] - around.min())


def _most_rise_m(scan: ElevationMap, line: Floats, length_m: float, half: int) -> float:
    """Return by how much anything about a line is at most above its surroundings; infinite beside the void."""
    corners = [
        _cell(scan, x + dx, y + dy)
        for x, y, _ in line[[0, -1]]
        for dx in (-length_m, length_m)
        for dy in (-length_m, length_m)
    ]
    (top, left), (bottom, right) = np.min(corners, axis=0) - 2 * half, np.max(corners, axis=0) + 2 * half
    rows, columns = scan.height_m.shape
    if top < 0 or left < 0 or bottom >= rows or right >= columns:
        return math.inf
    around = scan.height_m[top : bottom + 1, left : right + 1]
    return math.inf if np.isnan(around).any() else float(np.ptp(around))


def _cell(scan: ElevationMap, x: float, y: float) -> tuple[int, int]:
    (west, south), cell_m = scan.origin_m, scan.resolution_m
    return scan.height_m.shape[0] - 1 - math.floor((y - south) / cell_m), math.floor((x - west) / cell_m)


def _strip_of(points: Floats, line: Floats) -> bool:
    """Return whether a polygon is a strip 1 cm wide along a line, within its ends."""
    if len(points) != 4:
        return False
    along = line[1] - line[0]
    run_m = float(np.hypot(along[0], along[1]))
    way = along[:2] / max(run_m, _CLOSE)
    offsets = points - line[0]
    places = offsets[:, :2] @ way
    sides = offsets[:, :2] @ np.array([-way[1], way[0]])
    heights = offsets[:, 2] - along[2] * places / max(run_m, _CLOSE)
    return bool(
        np.abs(np.abs(sides) - _STRIP_M / 2).max() <= _CLOSE
        and np.abs(heights).max() <= _CLOSE
        and places.min() >= -_CLOSE
        and places.max() <= run_m + _CLOSE
    )


def check_warnings(fields: Fields, cell_m: float, things: Sequence[Fields], dropouts: int, ledger: Ledger) -> None:
    """Check that warnings that follow from the file are there, and no others of their kind.

    Args:
        fields: of the file.
        cell_m: side of the scan's cells.
        things: the narrow things.
        dropouts: below polygons.
        ledger: takes the findings.
    """
    stated, options = fields.mapping("statistics"), fields.mapping("options")
    said = [text for text in stated.items("warnings") if isinstance(text, str)]
    due: list[tuple[str, bool]] = [
        ("no ground is large, even and flat enough", not fields.items("polygons")),
        (f"{len(things)} narrow raised thing", bool(things)),
        ("show nothing narrower than that", cell_m > 0.03),
        ("is rough or noisy", stated.number("noise_m", least=0.0) > 0.015),
        ("is below half a cell", options.number("margin_m", least=0.0) < 0.5 * cell_m),
    ]
    for words, is_due in due:
        if is_due != any(words in text for text in said):
            message = f"{'lacks' if is_due else 'has no reason for'} the one with the words {words!r}"
            ledger.refuse("terrain, warnings", message, "statistics.warnings")
    counted = [int(text.split()[0]) for text in said if "dropout" in text and text.split()[0].isdigit()]
    if (dropouts > 0 and not counted) or any(count < dropouts for count in counted):
        message = f"hides dropouts: {dropouts} lie below polygons"
        ledger.refuse("terrain, warnings", message, "statistics.warnings")


def check_shares_of_regions(
    fields: Fields, outlines_m2: Sequence[tuple[float, float]], steep: int, ledger: Ledger
) -> None:
    """Check the shares of planar regions that were given.

    Args:
        fields: of the file.
        outlines_m2: of every region that is not too steep, the area before and after the margin.
        steep: how many regions are too steep.
        ledger: takes the findings.
    """
    stated, regions = fields.mapping("statistics"), fields.mappings("regions")
    plain_m2 = sum(after for _, after in outlines_m2)
    kept_m2 = sum(region.number("kept_m2") for region in regions)
    _same("kept_share", stated, kept_m2 / plain_m2 if plain_m2 else 0.0, ledger)
    _same("ground_share", stated, len(regions) / (len(outlines_m2) + steep), ledger)
    before = [area for area, _ in outlines_m2]
    for number, region in enumerate(regions):
        if not any(math.isclose(region.number("area_m2"), area, rel_tol=_CLOSE) for area in before):
            ledger.refuse("terrain, regions", "is as large as none that was given", f"regions[{number}].area_m2")
    said = [text for text in stated.items("warnings") if isinstance(text, str)]
    if bool(steep) != any(text.startswith(f"{steep} regions are steeper") for text in said):
        ledger.refuse("terrain, warnings", f"{steep} regions are too steep", "statistics.warnings")
    if fields.items("narrow"):
        ledger.refuse("terrain, narrow", "are not looked for in planar regions", "narrow")


def _same(key: str, stated: Fields, found: float, ledger: Ledger) -> None:
    if not math.isclose(stated.number(key), found, rel_tol=_CLOSE, abs_tol=_CLOSE):
        ledger.refuse("terrain, statistics", f"is {found:.6g}", f"statistics.{key}")


def _between(key: str, stated: Fields, low: float, high: float, ledger: Ledger) -> None:
    if not low - _CLOSE <= stated.number(key) <= high + _CLOSE:
        ledger.refuse("terrain, statistics", f"lies between {low:.4g} and {high:.4g}", f"statistics.{key}")
