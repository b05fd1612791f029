"""A small field for missions of a quadruped: flat ground around a block of stones, and a library for it."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from calling import surefoot

HEAD = """format: 1
kind: quadruped-terrain
name: field
classes: unstructured-4
robot: go2
origin_m: [0, 0]
cells: [4, 3]
start_m: [0.4, 1.2]
goal_m: [2.8, 1.2]
polygons:
"""
PLATES = ((0.0, 0.0, 0.8, 2.4), (0.8, 0.0, 3.2, 0.8), (0.8, 1.6, 3.2, 2.4), (2.4, 0.8, 3.2, 1.6), (0.8, 0.8, 1.6, 1.6))
STONES = tuple(
    (1.6 + 0.2667 * i + 0.03, 0.8 + 0.2667 * j + 0.03, 1.6 + 0.2667 * i + 0.2367, 0.8 + 0.2667 * j + 0.2367)
    for i in range(3)
    for j in range(3)
)


def write_field(path: Path) -> Path:
    """Write the field: in the middle of the third row from the start stand dense stones."""
    lines = [
        f"  - vertices_m: [[{w:.4f}, {s:.4f}, 0], [{e:.4f}, {s:.4f}, 0], [{e:.4f}, {n:.4f}, 0], [{w:.4f}, {n:.4f}, 0]]"
        for w, s, e, n in (*PLATES, *STONES)
    ]
    path.write_text(HEAD + "\n".join(lines) + "\n")
    return path


def make_field(folder: Path) -> Path:
    """Make the field and its library in a folder."""
    write_field(folder / "field.yaml")
    code, said = surefoot(
        "skills", "synthesize", folder / "field.yaml", "-o", folder / "library", "--jobs", 2, "--json"
    )
    assert code == 0, said
    return folder


def walked(folder: Path, out: Path, *more: object, library: bool = True) -> dict[str, Any]:
    """Walk the field; return what ``--json`` prints."""
    skills = ["--library", folder / "library"] if library else []
    _, said = surefoot("run", folder / "field.yaml", *skills, "-o", out, *more, "--json")
    answer: dict[str, Any] = json.loads(said)
    return answer


def records(run: Path, name: str) -> list[dict[str, Any]]:
    """Return all records of a kind."""
    lines = (json.loads(line) for line in (run / "run.jsonl").read_text().splitlines())
    return [one for one in lines if one["record"] == name]


def doctored(run: Path, name: str, number: int, change: Callable[[dict[str, Any]], None]) -> None:
    """Change one record of a kind in a run log."""
    path = run / "run.jsonl"
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    change([one for one in lines if one["record"] == name][number])
    path.write_text("".join(json.dumps(one) + "\n" for one in lines))
