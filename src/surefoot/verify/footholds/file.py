"""Reads foothold plans, from docs/formats.md; nothing in the file is trusted."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import InputError
from surefoot.verify.artefacts import checked_file, read_fields
from surefoot.verify.values import Fields

Array = NDArray[np.float64]
LEGS = ("LF", "RF", "LH", "RH")
BODY = (
    "base_m", "base_velocity_mps", "base_acceleration_mps2", "rpy_rad", "rpy_rate_radps", "rpy_acceleration_radps2",
)  # fmt: skip
FEET = ("feet_m", "feet_velocity_mps", "feet_acceleration_mps2", "forces_n")
MOST_SAMPLES = 2000
MOST_WINDOWS = 10_000
BROKEN = (KeyError, TypeError, ValueError, IndexError, AttributeError, ArithmeticError, RuntimeError)
"""What reading values of a file raises when they are not what docs/formats.md says."""


@dataclass(frozen=True, slots=True)
class Step:
    """A swing of a foot (first swing sample, first stance sample, first sample of the next swing), and its polygon."""

    foot: int
    lift: int
    touch: int
    leave: int


@dataclass(frozen=True, slots=True, eq=False)
class FootholdFile:
    """What a plan file says.

    Attributes:
        path: of the file.
        values: the problem with everything filled in.
        answer: verdict, objective, bound and so on.
        contacts: which feet are in contact when, derived from the gait, shape (N, 4).
        steps: derived from the contacts, by foot and then by time.
        arrays: of the motion; empty without one.
        polygons: the polygon of every step, as the file says.
        regions: the free region of every foot and window.
        proof: as it stands in the file.
        free: what plans of a free gait add, as it stands in the file; None for a gait that was given.
        problem: the problem file, whose hash is right; None when the plan names none.
    """

    path: Path
    values: dict[str, Any]
    answer: dict[str, Any]
    contacts: NDArray[np.bool_]
    steps: tuple[Step, ...]
    arrays: dict[str, Array]
    polygons: tuple[int, ...]
    regions: tuple[int, ...]
    proof: dict[str, Any] | None
    free: dict[str, Any] | None = None
    problem: Path | None = None

    def number(self, *keys: str) -> float:
        """Return a number of the values."""
        here: Any = self.values
        for key in keys:
            here = here[key]
        return float(here)


def read_foothold_plan(path: Path) -> FootholdFile:
    """Read a plan file and the problem file that it was made from.

    Raises:
        InputError: it is no foothold plan, is not whole, or the problem file has changed.
    """
    fields = read_fields(path, "foothold-plan")
    try:
        return _read(path, fields)
    except BROKEN as problem:
        raise InputError(
            f"is no whole foothold plan ({type(problem).__name__}: {str(problem)[:80]})", source=path
        ) from problem


def _read(path: Path, fields: Fields) -> FootholdFile:
    values: dict[str, Any] = dict(fields.mapping("values").values)
    answer: dict[str, Any] = dict(fields.mapping("answer").values)
    if not 1 <= int(values["options"]["collision_windows"]) <= MOST_WINDOWS:
        raise ValueError("collision_windows")
    contacts = _contacts(values)
    steps = _steps(contacts)
    arrays: dict[str, Array] = {}
    polygons: tuple[int, ...] = ()
    regions: tuple[int, ...] = ()
    motion = fields.get("motion")
    if motion is not None:
        arrays, polygons, regions = _motion(motion, contacts, steps)
        _only_indices(polygons, len(values["polygons"]), "polygon")
        _only_indices(regions, len(values["free_regions"]), "window_regions")
    proof = fields.get("proof")
    free = dict(fields.mapping("free").values) if fields.has("free") and fields.get("free") is not None else None
    problem = checked_file(fields.mapping("problem"), path.parent) if fields.get("problem") is not None else None
    proof = proof if isinstance(proof, dict) else None
    return FootholdFile(path, values, answer, contacts, steps, arrays, polygons, regions, proof, free, problem)


def _contacts(values: dict[str, Any]) -> NDArray[np.bool_]:
    """Derive the contact table: sample i has the mode whose half-open interval holds i dt; sample 0 is stance."""
    step_s = float(values["step_s"])
    if values["gait"] == "free":
        size = round(float(values["horizon_s"]) / step_s)
        if not 4 <= size <= MOST_SAMPLES:
            raise ValueError(f"{size} samples")
        return np.ones((size, 4), dtype=bool)
    times, modes = values["gait"]["switching_times_s"], values["gait"]["modes"]
    size = round(float(times[-1]) / step_s)
    if not 4 <= size <= MOST_SAMPLES:
        raise ValueError(f"{size} samples")
    table = np.zeros((size, 4), dtype=bool)
    for i in range(size):
        current = max(k for k in range(len(modes)) if round(float(times[k]) / step_s) <= i)
        name = modes[current]
        table[i] = [i == 0 or name == "STANCE" or leg in name.split("_") for leg in LEGS]
    return table


def _steps(contacts: NDArray[np.bool_]) -> tuple[Step, ...]:
    found = []
    size = len(contacts)
    for foot in range(4):
        i = 0
        while i < size:
            if contacts[i, foot]:
                i += 1
                continue
            end = i
            while end < size and not contacts[end, foot]:
                end += 1
            leave = end
            while leave < size and contacts[leave, foot]:
                leave += 1
            if end < size:
                found.append(Step(foot, i, end, leave))
            i = end
    return tuple(found)


def _motion(
    motion: Any, contacts: NDArray[np.bool_], steps: tuple[Step, ...]
) -> tuple[dict[str, Array], tuple[int, ...], tuple[int, ...]]:
    size = len(contacts)
    arrays = {}
    for names, shape in ((BODY, (size, 3)), (FEET, (size, 4, 3))):
        for name in names:
            array = np.array(motion[name], dtype=float)
            if array.shape != shape or not np.isfinite(array).all():
                raise ValueError(f"{name} has to hold {shape} finite numbers")
            arrays[name] = array
    said = [(int(s["foot"]), int(s["lift"]), int(s["touch"])) for s in motion["footsteps"]]
    if said != [(s.foot, s.lift, s.touch) for s in steps]:
        raise ValueError("the footsteps are not those of the gait")
    return (
        arrays,
        tuple(int(s["polygon"]) for s in motion["footsteps"]),
        tuple(int(s) for s in motion["window_regions"]),
    )


def _only_indices(found: tuple[int, ...], count: int, name: str) -> None:
    if any(not 0 <= index < count for index in found):
        raise ValueError(f"{name} has to count from 0 to {count - 1}")
