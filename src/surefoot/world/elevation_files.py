"""Heights from grey pictures and from NumPy files."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import InputError
from surefoot.world import pictures
from surefoot.world.elevation import MAX_CELLS, ElevationMap, elevation_map

_GREY_TOLERANCE = 2
_LIMIT_BYTES = 8 * MAX_CELLS
_NAMES = ("height_m", "elevation", "heights", "height", "z")
Range = tuple[float, float]


def read_picture(
    path: Path,
    resolution_m: float | None,
    height_range_m: Range | None,
    origin_m: tuple[float, float],
    no_data: int | None = None,
) -> ElevationMap:
    """Read a grey picture: black is the lower end of the height range, white the upper one.

    Pixels that are less than half opaque, or of the grey level ``no_data``, hold no data. 8 and 16 bits
    are told apart by the file.
    """
    if resolution_m is None:
        raise _required("resolution", path, "metres per pixel")
    if height_range_m is None:
        raise _required("height-range", path, "the heights of black and of white in metres")
    with pictures.opened(path) as picture:
        if picture.width * picture.height > MAX_CELLS:
            raise InputError(f"has more than {MAX_CELLS} pixels; cut or shrink it", source=path)
        values = np.asarray(picture)
    grey, hidden = _grey(values, path)
    white = 255.0 if values.dtype == np.uint8 else 65535.0
    low, high = height_range_m
    notes = [] if no_data is not None else _suspicious(grey[~hidden])
    if no_data is not None:
        hidden = hidden | (grey == no_data)
    heights = low + grey / white * (high - low)
    heights[hidden] = np.nan
    step_m = (high - low) / white
    if step_m > 0.01:
        notes.append(f"one grey level is {step_m * 1000:.0f} mm; heights are no finer than that")
    reading: dict[str, object] = {
        "as": "picture",
        "resolution_m": resolution_m,
        "height_range_m": [low, high],
        "origin_m": list(origin_m),
        "no_data": no_data,
    }
    return elevation_map(heights, resolution_m, origin_m, source=path, reading=reading, notes=tuple(notes))


def _suspicious(grey: NDArray[np.float64]) -> list[str]:
    """Return a warning when black looks like a mark for missing data: it is common, and no level is near it."""
    black = grey == 0
    others = grey[~black]
    if not others.size or black.mean() < 0.01 or others.min() < 10:
        return []
    return [
        f"{black.mean():.0%} of the pixels are black and the next level is {others.min():.0f}; if black means that "
        "nothing was measured, say --no-data 0, else it is ground at the lower end of the range"
    ]


def _grey(values: NDArray[np.generic], path: Path) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return grey levels and which pixels hold no data; refuse colours."""
    if values.ndim == 2:
        return values.astype(np.float64), np.zeros(values.shape, np.bool_)
    channels = values.shape[2]
    colours = values[..., : channels - 1 if channels in (2, 4) else channels].astype(np.int64)
    hidden = values[..., -1].astype(np.int64) < 128 if channels in (2, 4) else np.zeros(values.shape[:2], np.bool_)
    spread = np.ptp(colours, axis=2)
    spread[hidden] = 0
    if (spread > _GREY_TOLERANCE).any():
        raise InputError("is a colour picture; heights have to be grey levels, or an array in npy or npz", source=path)
    return colours.mean(axis=2), hidden


def read_array(
    path: Path,
    resolution_m: float | None,
    height_range_m: Range | None,
    origin_m: tuple[float, float],
    name: str | None,
) -> ElevationMap:
    """Read an array of heights [m], row 0 in the north; whole numbers may be scaled by a height range.

    An npz file may carry ``resolution_m`` and ``origin_m`` beside its array of heights.
    """
    values, chosen, carried = _load(path, name)
    if resolution_m is None and "resolution_m" in carried:
        resolution_m = _number(carried["resolution_m"], "resolution_m", path)
        if origin_m == (0.0, 0.0) and "origin_m" in carried:
            origin_m = _pair(carried["origin_m"], path)
    if resolution_m is None:
        raise _required("resolution", path, "metres per cell")
    if values.dtype.kind not in "fiu":
        raise InputError(f"has to hold real numbers, not {values.dtype}", source=path, key=chosen)
    heights = values.astype(np.float64)
    if height_range_m is not None:
        if values.dtype not in (np.uint8, np.uint16):
            raise InputError(
                f"is only allowed for pictures and arrays of uint8 or uint16; these are {values.dtype}, "
                "taken as metres",
                source=path,
                key="height-range",
            )
        heights = height_range_m[0] + heights / (255 if values.dtype == np.uint8 else 65535) * (
            height_range_m[1] - height_range_m[0]
        )
    reading = {
        "as": "array",
        "name": chosen,
        "resolution_m": resolution_m,
        "height_range_m": None if height_range_m is None else list(height_range_m),
        "origin_m": list(origin_m),
    }
    return elevation_map(heights, resolution_m, origin_m, source=path, reading=reading)


def _load(path: Path, name: str | None) -> tuple[NDArray[np.generic], str | None, dict[str, NDArray[np.generic]]]:
    """Return the array of heights, its name, and the small arrays beside it."""
    if not path.is_file():
        raise InputError("there is no such file", source=path)
    try:
        if path.suffix.lower() == ".npz":
            with zipfile.ZipFile(path) as archive:
                if sum(item.file_size for item in archive.infolist()) > _LIMIT_BYTES:
                    raise InputError(f"unpacks to more than {_LIMIT_BYTES // 10**6} MB", source=path)
            with np.load(path, allow_pickle=False) as loaded:
                return _chosen({key: loaded[key] for key in loaded.files}, name, path)
        if path.stat().st_size > _LIMIT_BYTES + 1024:
            raise InputError(f"is larger than {_LIMIT_BYTES // 10**6} MB", source=path)
        with path.open("rb") as stream:
            array = np.lib.format.read_array(stream, allow_pickle=False)
    except (OSError, ValueError, zipfile.BadZipFile, EOFError, KeyError, NotImplementedError) as problem:
        raise InputError("is no whole npy or npz file of plain arrays", source=path) from problem
    if name is not None:
        raise InputError("is only allowed for bags and npz files", source=path, key="layer")
    return _table(array, path, None), None, {}


def _chosen(
    arrays: dict[str, NDArray[np.generic]], name: str | None, path: Path
) -> tuple[NDArray[np.generic], str, dict[str, NDArray[np.generic]]]:
    tables = [key for key, value in arrays.items() if value.ndim == 2]
    if name is None:
        known = [key for key in _NAMES if key in tables] or tables
        if not known or (len(tables) > 1 and known[0] not in _NAMES):
            raise InputError(
                f"holds {len(tables)} tables ({', '.join(tables) or 'none'}); name one with --layer", source=path
            )
        name = known[0]
    if name not in arrays:
        raise InputError(f"holds no array {name!r}; there are {', '.join(arrays) or 'none'}", source=path, key="layer")
    return _table(arrays[name], path, name), name, arrays


def _table(array: NDArray[np.generic], path: Path, name: str | None) -> NDArray[np.generic]:
    if array.ndim != 2:
        raise InputError(
            f"heights have to be a table of rows and columns, not of shape {array.shape}", source=path, key=name
        )
    return array


def _number(value: NDArray[np.generic], key: str, path: Path) -> float:
    if value.size != 1 or value.dtype.kind not in "fiu":
        raise InputError("has to be one number", source=path, key=key)
    return float(value.reshape(-1)[0].item())


def _pair(value: NDArray[np.generic], path: Path) -> tuple[float, float]:
    if value.size != 2 or value.dtype.kind not in "fiu":
        raise InputError("has to be two numbers", source=path, key="origin_m")
    x, y = value.reshape(-1)
    return float(x.item()), float(y.item())


def _required(key: str, path: Path, meaning: str) -> InputError:
    return InputError(f"is required for {path.name}: {meaning}", key=key)
