"""Reader of saved step regions, written from docs/formats.md; nothing in a file is trusted."""

from __future__ import annotations

import hashlib
import math
import zipfile
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot.compute import sha256_of
from surefoot.errors import InputError
from surefoot.verify.artefacts import LARGEST_ARRAYS_BYTES, read_fields
from surefoot.verify.values import Fields

KIND = "step-region"
LARGEST_CELLS = 200_000_000
MOST_OMEGAS = 1024
READINGS = ("rate", "inside_phi", "jump")
ARRAYS = {
    "first_masks": "uint64",
    "first_target": "bool",
    "first_won": "bool",
    "second_masks": "uint64",
    "second_target": "bool",
    "second_won": "bool",
}
Array = NDArray[Any]


@dataclass(frozen=True, slots=True)
class RegionFile:
    """A step region as it was read; lengths in m, velocities in m/s, exact decimals where bounds are compared.

    Attributes:
        path: of the JSON file.
        length: of the step.
        window: of the velocity at the next apex.
        half_width: of the target.
        first_foot: about which the first half step turns.
        reading: of the disturbance.
        bound: its two bounds.
        tau: sampling time.
        x0: centre of the first column.
        v0: centre of the first row.
        dx: width of a cell.
        dv: height of a cell.
        omegas: of the first and of the second half step.
        tube: omega, least and greatest apex velocity of the guard's manifolds.
        cells: the recorded counts.
        arrays: of the npz file.
    """

    path: Path
    length: Fraction
    window: tuple[Fraction, Fraction]
    half_width: Fraction
    first_foot: float
    reading: str
    bound: tuple[float, float]
    tau: float
    x0: Fraction
    v0: Fraction
    dx: Fraction
    dv: Fraction
    omegas: tuple[tuple[float, ...], tuple[float, ...]]
    tube: tuple[float, float, float]
    cells: Fields
    arrays: dict[str, Array]

    @property
    def shape(self) -> tuple[int, int]:
        """Columns and rows."""
        columns, rows = self.arrays["first_won"].shape
        return int(columns), int(rows)


def read_region(path: Path) -> RegionFile:
    """Read a step region and check its hashes.

    Args:
        path: its JSON file or its npz file.

    Raises:
        InputError: a file is missing, truncated, stale or of another version.
    """
    document = path.with_suffix(".json")
    fields = read_fields(document, KIND)
    step, settings = fields.mapping("transition"), fields.mapping("settings")
    grid, disturbance = settings.mapping("grid"), settings.mapping("disturbance")
    length = _decimal(step, "step_length_m")
    x0, v0 = -_decimal(grid, "behind_m", least=0), _decimal(grid, "slowest_mps")
    dx, dv = _decimal(grid, "x_step_m"), _decimal(grid, "v_step_mps")
    columns = math.floor((length + _decimal(grid, "beyond_m", least=0) - x0) / dx) + 1
    rows = math.floor((_decimal(grid, "fastest_mps") - v0) / dv) + 1
    if not 0 < columns * rows <= LARGEST_CELLS:
        raise grid.wrong("x_step_m", f"asks for {columns * rows} cells; at most {LARGEST_CELLS} are checked")
    omegas = _omegas(settings.mapping("omegas"), step)
    arrays = _arrays(fields, document.parent, (columns, rows), -(-len(omegas[0]) // 64))
    low, high = step.numbers("apex_velocity_mps", 2)
    guard = settings.mapping("guard")
    return RegionFile(
        path=document,
        length=length,
        window=(Fraction(repr(low)), Fraction(repr(high))),
        half_width=_decimal(settings, "target_half_width_m"),
        first_foot=step.number("first_foot_m"),
        reading=disturbance.text("reading", among=READINGS),
        bound=(disturbance.number("first", least=0), disturbance.number("second", least=0)),
        tau=float(_decimal(settings, "tau_s")),
        x0=x0,
        v0=v0,
        dx=dx,
        dv=dv,
        omegas=omegas,
        tube=(guard.number("omega_radps"), guard.number("slowest_mps"), guard.number("fastest_mps")),
        cells=fields.mapping("cells"),
        arrays=arrays,
    )


def _decimal(fields: Fields, name: str, *, least: float | None = None) -> Fraction:
    value = fields.number(name)
    if value < (least or 0.0) or (least is None and value == 0) or value > 1e6:
        raise fields.wrong(name, "has to be above 0" if least is None else f"has to be at least {least:g}")
    return Fraction(repr(value))


def _omegas(fields: Fields, step: Fields) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return the omegas of both halves; those of the second are scaled when the CoM stays level."""
    low, high, by = (_decimal(fields, name) for name in ("low_radps", "high_radps", "step_radps"))
    count = math.floor((high - low) / by) + 1
    if not 1 <= count <= MOST_OMEGAS:
        raise fields.wrong("step_radps", f"has to give 1 to {MOST_OMEGAS} omegas")
    values = tuple(float(low + k * by) * fields.number("scale", least=1e-6) for k in range(count))
    factor = 1.0
    if step.flag("level_com"):
        height, change = step.number("apex_height_m", least=1e-6), step.number("height_change_m")
        if change >= height:
            raise step.wrong("height_change_m", "has to be below the apex height")
        factor = math.sqrt(height / (height - change))
    return values, tuple(value * factor for value in values)


def _arrays(fields: Fields, folder: Path, shape: tuple[int, int], words: int) -> dict[str, Array]:
    place = fields.mapping("arrays")
    name = place.text("path")
    if Path(name).name != name:
        raise place.wrong("path", "has to name a file beside this one")
    path = folder / name
    try:
        if sha256_of(path) != place.text("sha256"):
            raise place.wrong("sha256", f"does not fit {name}")
        with zipfile.ZipFile(path) as archive:
            if sum(item.file_size for item in archive.infolist()) > LARGEST_ARRAYS_BYTES:
                raise InputError(f"unpacks to more than {LARGEST_ARRAYS_BYTES} bytes", source=path)
        with np.load(path, allow_pickle=False) as archive:
            found: dict[str, Array] = {key: archive[key] for key in ARRAYS if key in archive.files}
    except (OSError, ValueError, zipfile.BadZipFile, EOFError, KeyError, NotImplementedError) as problem:
        raise InputError("is not a whole npz file of plain arrays", source=path) from problem
    for key, kind in ARRAYS.items():
        wanted = (*shape, words) if kind == "uint64" else shape
        if key not in found or found[key].dtype != np.dtype(kind) or found[key].shape != wanted:
            raise InputError(f"has to be an array of {wanted} of {kind}", source=path, key=key)
    digest = hashlib.sha256()
    for key in ("first_masks", "second_masks"):
        digest.update(found[key].astype("<u8").tobytes())
    if digest.hexdigest() != fields.text("masks_sha256"):
        raise fields.wrong("masks_sha256", "does not fit the masks")
    return found
