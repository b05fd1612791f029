"""Compares the values of a foothold plan with its problem file, keys that it leaves out with docs/formats.md 5."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np

from surefoot.documents import read_yaml
from surefoot.robots.quadruped import quadruped, quadruped_names

_LIMITS = {"gap", "first_plan", "time_limit_s"}
_PLAIN = {"step_s": 0.025, "gravity_mps2": 9.81}
_LEVEL = [0.0, 0.0, 0.0]
_OPTIONS: dict[str, Any] = {
    "clearance_m": 0.05, "collision": False, "collision_windows": 30, "moment_balance": False, "tilt_max_rad": 0.35,
    "com_support_m": None, "joint_reach": False, "pitch_keyframe": False, "cell_s": 0.1, "min_dwell_cells": 1,
}  # fmt: skip
_WEIGHTS = {
    "position": 1000.0, "orientation": 1000.0, "foot": 1000.0, "acceleration": 10.0, "angular_acceleration": 10.0,
    "foot_acceleration": 0.5, "force": 0.1,
}  # fmt: skip
_LEG = {
    "joint_reference_rad": (0.0, 0.72, -1.44), "base_torque_max_nm": 30.0, "link_m": 0.213, "hip_offset_m": 0.0955,
}  # fmt: skip
_CYCLE = ((0.0, 0.45, 0.5, 0.95), ("LF_RH", "STANCE", "RF_LH", "STANCE"))
_OTHER_GAITS: dict[str, tuple[list[str], list[float]]] = {
    "walk-2.25s": (
        ["STANCE", "LF_RF_RH", "STANCE", "RF_LH_RH", "STANCE", "LF_RF_LH", "STANCE", "LF_LH_RH", "STANCE"],
        [0.0, 0.05, 0.55, 0.6, 1.1, 1.15, 1.65, 1.7, 2.2, 2.25],
    ),
    "leap-1.5s": (["STANCE", "LH_RH", "FLY", "LF_RF", "STANCE"], [0.0, 0.5, 0.65, 0.85, 1.0, 1.5]),
}


def differing_keys(path: Path, values: dict[str, Any], free: dict[str, Any] | None) -> list[str]:
    """Return the keys whose values are not those of a problem file.

    Args:
        path: the problem file.
        values: the values of the plan.
        free: what plans of a free gait add; None for a gait that was given.
    """
    given = _filled(read_yaml(path).value, {})
    expected: dict[str, Any] = {key: given.get(key, default) for key, default in _PLAIN.items()}
    expected["robot"] = _robot(given["robot"], path.parent)
    expected["options"] = _filled(given.get("options"), _OPTIONS)
    expected["weights"] = _filled(given.get("weights"), _WEIGHTS)
    expected["free_regions"] = given.get("free_regions", [])
    expected["goal"] = _filled(given["goal"], {"rpy_rad": _LEVEL})
    start = _filled(given["start"], {"rpy_rad": _LEVEL})
    expected["start"] = {"feet_m": _nominal_feet(start, expected["robot"]), **start}
    used = {**values, "options": {"joint_reach": False, **values["options"]}}
    wrong = [key for key, value in expected.items() if not _agrees(value, used[key])]
    if not _same_gait(given, values, free, path.parent):
        wrong.append("gait")
    return wrong + (["polygons"] if not _same_polygons(given["polygons"], values["polygons"]) else [])


def _filled(given: Any, defaults: dict[str, Any]) -> dict[str, Any]:
    said = {key: value for key, value in (given or {}).items() if value is not None}
    return {key: value for key, value in {**defaults, **said}.items() if key not in _LIMITS}


def _robot(name: str, folder: Path) -> dict[str, Any]:
    if name in quadruped_names():
        known = quadruped(name)
        return {key: getattr(known, key) for key in known.__slots__ if key != "source"}
    said = _filled(read_yaml(folder / name).value, _LEG)
    return {key: value for key, value in said.items() if key != "format"}


def _nominal_feet(start: dict[str, Any], robot: dict[str, Any]) -> list[list[float]]:
    (a, b, c), (x, y, z) = start["rpy_rad"], robot["foot_reference_m"]
    roll = np.array([[1, 0, 0], [0, math.cos(a), -math.sin(a)], [0, math.sin(a), math.cos(a)]])
    pitch = np.array([[math.cos(b), 0, math.sin(b)], [0, 1, 0], [-math.sin(b), 0, math.cos(b)]])
    yaw = np.array([[math.cos(c), -math.sin(c), 0], [math.sin(c), math.cos(c), 0], [0, 0, 1]])
    feet = np.array([[x, y, z], [x, -y, z], [-x, y, z], [-x, -y, z]]) @ (yaw @ pitch @ roll).T
    nominal: list[list[float]] = (feet + np.array(start["position_m"], dtype=float)).tolist()
    return nominal


def _same_gait(given: dict[str, Any], values: dict[str, Any], free: dict[str, Any] | None, folder: Path) -> bool:
    asked = given["gait"]
    if asked == "free":
        return free is not None and _agrees(given["horizon_s"], free["horizon_s"])
    if free is not None or values["gait"] == "free":
        return False
    modes, times = _gait(asked, folder)
    return list(modes) == list(values["gait"]["modes"]) and _agrees(times, values["gait"]["switching_times_s"])


def _gait(asked: Any, folder: Path) -> tuple[list[str], list[float]]:
    if isinstance(asked, dict):
        return asked["modes"], asked["switching_times_s"]
    known = named_gait(asked)
    if known is not None:
        return known
    text = re.sub(r"[;#][^\n]*", "", (folder / asked).read_text(encoding="utf-8", errors="replace"))
    return _listed(text, "modeSequence"), [float(time) for time in _listed(text, "switchingTimes")]


def named_gait(name: str) -> tuple[list[str], list[float]] | None:
    """Return modes and switching times of a gait with a name; None where no gait is called so."""
    trot = re.fullmatch(r"trot-([123])s(-mirrored)?", name)
    if trot is None:
        return _OTHER_GAITS.get(name)
    cycles, (offsets, modes) = int(trot[1]), _CYCLE
    turned = modes[2:] + modes[:2] if trot[2] else modes
    return list(turned) * cycles, [k + part for k in range(cycles) for part in offsets] + [float(cycles)]


def _listed(text: str, name: str) -> list[str]:
    block = re.search(name + r"\s*\{([^{}]*)\}", text)
    return re.findall(r"\[\d+\]\s*(\S+)", block[1] if block else "")


def _same_polygons(given: Any, used: Any) -> bool:
    if len(given) != len(used):
        return False
    for said, one in zip(given, used, strict=True):
        friction = said.get("friction")
        if _corners(said) != _corners(one) or not _agrees(0.6 if friction is None else friction, one["friction"]):
            return False
    return True


def _corners(polygon: dict[str, Any]) -> set[tuple[float, ...]]:
    return {tuple(round(float(x), 9) + 0.0 for x in corner) for corner in polygon["vertices_m"]}


def _agrees(given: Any, used: Any) -> bool:
    """Return whether what is expected is what was used; what has no value has to have none."""
    if isinstance(given, dict):
        return all(key in used and _agrees(value, used[key]) for key, value in given.items())
    if isinstance(given, list | tuple):
        return len(given) == len(used) and all(_agrees(a, b) for a, b in zip(given, used, strict=True))
    if given is None or isinstance(given, bool | str) or isinstance(used, bool | str):
        return bool(given == used) and type(given) is type(used)
    return math.isclose(float(given), float(used), rel_tol=1e-12, abs_tol=1e-9)
