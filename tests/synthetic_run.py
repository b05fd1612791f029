"""A run that nobody walked: the pendulum's closed forms along a rectangle, with an obstacle that hides for a while.

It has the shape of a real log and smooth orbits, which is all that pictures need.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from surefoot.compute import sha256_of

OMEGA = 3.15585
CELL_M = 2.70351
FINE_M = CELL_M / 26
ROWS = ["######", "#....#", "#.##.#", "#....#", "######"]
SCENARIO = f"""\
format: 1
kind: biped
map: room.yaml
grid: {{cell_size_m: {CELL_M}}}
start: {{position_m: [{1.5 * CELL_M}, {3.5 * CELL_M}], heading: east}}
goals: [{{position_m: [{4.5 * CELL_M}, {3.5 * CELL_M}]}}, {{position_m: [{1.5 * CELL_M}, {1.5 * CELL_M}]}}]
obstacles: [{{start_m: [{4.5 * CELL_M}, {1.5 * CELL_M}],
             forbidden: [{{rectangle_m: [{CELL_M}, {3 * CELL_M}, {3 * CELL_M}, {4 * CELL_M}]}}]}}]
sensor: {{range_m: 10.82}}
belief_regions: [{{rectangles_m: [[{CELL_M}, {CELL_M}, {3 * CELL_M}, {2 * CELL_M}]]}}]
"""
FREE = [[row, column] for row, line in enumerate(ROWS) for column, sign in enumerate(line) if sign == "."]


def write_scene(folder: Path, more: str = "") -> Path:
    """Write map and scenario; return the scenario's path."""
    pixels = b"".join(bytes(0 if sign == "#" else 254 for sign in line for _ in range(10)) * 10 for line in ROWS)
    (folder / "room.pgm").write_bytes(b"P5\n60 50\n255\n" + pixels)
    (folder / "room.yaml").write_text(
        f"image: room.pgm\nmode: trinary\nresolution: {CELL_M / 10}\norigin: [0, 0, 0]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.25\n"
    )
    (folder / "room_mission.yaml").write_text(SCENARIO + more)
    return folder / "room_mission.yaml"


def write_plan(folder: Path) -> Path:
    """Write a plan.json with what pictures read; return the plan's folder."""
    plan = folder / "plan"
    plan.mkdir()
    document = {
        "kind": "biped-plan",
        "format": 1,
        "scenario": {"path": "../room_mission.yaml", "sha256": sha256_of(folder / "room_mission.yaml")},
        "map": {
            "path": "../room.yaml",
            "sha256": sha256_of(folder / "room.yaml"),
            "image_path": "../room.pgm",
            "image_sha256": sha256_of(folder / "room.pgm"),
        },
        "grid": {
            "rows": 5,
            "columns": 6,
            "north_west_m": [0.0, 5 * CELL_M],
            "cell_size_m": CELL_M,
            "origin_m": [0.0, 0.0],
            "rotation_rad": 0.0,
            "free": FREE,
        },
        "walking": {
            "apex_speed_mps": [0.2, 0.7],
            "steering_speed_max_mps": 0.4,
            "switch_speed_max_mps": 1.1,
            "safety_distance_m": 0.52,
            "fine_cells": 26,
            "fine_cell_m": FINE_M,
            "side_band_cells": 6,
        },
        "robot": {"name": "digit", "omega_radps": OMEGA, "foot_half_length_m": 0.11, "foot_half_width_m": 0.05},
        "start": {"cell": [1, 1], "heading": "east", "fine": {"row": 13, "column": 13}, "moved_m": 0.0},
        "goals": [[1, 4], [3, 1]],
        "obstacles": [{"start": [3, 4], "domain": [cell for cell in FREE if cell not in ([1, 1], [1, 2])]}],
    }
    (plan / "plan.json").write_text(json.dumps(document))
    return plan


def write_run(folder: Path, *, laps: int = 2, more: str = "") -> Path:
    """Write a scene, with more lines in its scenario, its plan and a run around the pillar; return the run's folder."""
    write_scene(folder, more)
    write_plan(folder)
    run = folder / "run"
    run.mkdir()
    (run / "run.jsonl").write_text("".join(json.dumps(record) + "\n" for record in records(laps, SCENARIO + more)))
    return run


def records(laps: int, scenario: str) -> Iterator[dict[str, Any]]:
    """Yield the records of a run log."""
    nowhere = {"sha256": "0" * 64}
    yield {
        "record": "header",
        "kind": "biped-run",
        "format": 1,
        "surefoot": "0.1.0",
        "versions": {"python": "3.11"},
        "scenario": {"path": "../room_mission.yaml", "sha256": hashlib.sha256(scenario.encode()).hexdigest()},
        "map": {"path": "../room.yaml", **nowhere},
        "plan": {"path": "../plan/plan.json", **nowhere},
        "seed": 7,
        "policy": "random",
        "steps": 1000,
        "kinds": [[0]],
        "breaks_assumptions": False,
    }
    walker = Walker()
    number = 0
    for lap in range(laps):
        for turn, order in enumerate(ORDERS):
            yield {"record": "turn", "turn": lap * len(ORDERS) + turn, "time_s": walker.time_s, **decision(turn)}
            for change_deg, cells in order:
                step = walker.step(math.radians(change_deg), cells * FINE_M)
                yield {"record": "step", "step": number, "turn": lap * len(ORDERS) + turn, **step}
                number += 1
    yield {
        "record": "end",
        "steps": number,
        "turns_coarse": laps * len(ORDERS),
        "goals_reached": [laps, laps],
        "time_s": walker.time_s,
    }


STRAIGHT = [(0.0, 4.0)] * 5 + [(0.0, 3.0), (0.0, 3.0), (0.0, 3.0)]
TURN_A = [(-22.5, 3.9), (-22.5, 2.7), (-22.5, 3.9), (-22.5, 3.0)]
CORNER = [(0.0, 4.0)] * 4 + [*TURN_A, (0.0, 3.0), (0.0, 3.0)]
ORDERS = [STRAIGHT, STRAIGHT, CORNER, STRAIGHT, CORNER, STRAIGHT, STRAIGHT, CORNER, STRAIGHT, CORNER]
PATH = [[1, 1], [1, 2], [1, 3], [1, 4], [2, 4], [3, 4], [3, 3], [3, 2], [3, 1], [2, 1]]
HEADINGS = ["east"] * 4 + ["south"] * 2 + ["west"] * 3 + ["north"]
HIDDEN = {1: [[3, 3]], 2: [[3, 2], [3, 3]], 3: [[3, 1], [3, 2], [3, 3]], 4: [[2, 1], [3, 1], [3, 2]]}


def decision(turn: int) -> dict[str, Any]:
    """Return the fields of a turn: the obstacle walks ahead, and hides behind the pillar in turns 1 to 4."""
    ahead = PATH[(turn + 5) % len(PATH)]
    hidden = HIDDEN.get(turn, [])
    return {
        "cell": PATH[turn],
        "heading": HEADINGS[turn],
        "goal": 0 if turn < 3 else 1,
        "obstacles": [ahead],
        "visible": [[] if hidden else [ahead]],
        "hidden": [hidden],
        "order": f"move {HEADINGS[(turn + 1) % 10]}",
        "strategy": 0,
    }


class Walker:
    """Walks with the pendulum's closed forms and the desired feet of the papers."""

    def __init__(self) -> None:
        self.waypoint = complex(1.5 * CELL_M, 3.5 * CELL_M)
        self.heading = 1 + 0j
        self.com, self.foot, self.side, self.speed, self.time_s = (
            self.waypoint + 0.1j,
            self.waypoint + 0.235j,
            1,
            0.42,
            0.0,
        )

    def step(self, change_rad: float, length_m: float) -> dict[str, Any]:
        """Take the step whose next apex comes nearest to the desired feet; return its record's fields."""
        speeds = [0.2 + 0.01 * k for k in range(21 if change_rad else 51)]
        steps = [step for speed in speeds if (step := self.candidate(change_rad, length_m, speed))]
        step = min(steps, key=lambda step: self.cost(step, turning=bool(change_rad)))
        start, self.time_s = self.time_s, self.time_s + step["first_half_s"] + step["second_half_s"]
        self.waypoint, self.com, self.foot = (
            complex(*step[key][:2]) for key in ("next_waypoint_m", "next_com_m", "next_foot_m")
        )
        self.heading *= complex(math.cos(change_rad), math.sin(change_rad))
        self.speed, self.side = step["next_apex_speed_mps"], -self.side
        return {"time_s": start, **step}

    def cost(self, step: dict[str, Any], *, turning: bool) -> float:
        """Return the cost of Algorithm 1 with the papers' weights."""
        dy1, dy2 = (0.0 if turning else -0.1 * self.side), -0.135 * self.side
        weights = (7, 4) if turning else (1, 1)
        return float(weights[0] * abs(step["dy1_m"] - dy1) + weights[1] * abs(step["dy2_m"] - dy2))

    def candidate(self, change_rad: float, length_m: float, speed: float) -> dict[str, Any] | None:
        """Return the fields of a step to an apex speed, None when the orbits do not meet between the apexes."""
        velocity = self.heading * self.speed
        heading = self.heading * complex(math.cos(change_rad), math.sin(change_rad))
        com, foot, v = (self.com - self.waypoint) / heading, (self.foot - self.waypoint) / heading, velocity / heading
        next_x = length_m
        c = (com.real - foot.real) ** 2 + (speed**2 - v.real**2) / OMEGA**2
        switch_x = (c / (next_x - foot.real) + foot.real + next_x) / 2
        if not com.real <= switch_x <= next_x:
            return None
        switch_v = math.sqrt(v.real**2 + OMEGA**2 * ((switch_x - foot.real) ** 2 - (com.real - foot.real) ** 2))
        first_s = math.log((switch_x - foot.real + switch_v / OMEGA) / (com.real - foot.real + v.real / OMEGA)) / OMEGA
        second_s = math.asinh(OMEGA * (next_x - switch_x) / speed) / OMEGA
        switch_y, drift = orbit(com.imag, foot.imag, v.imag, first_s)
        next_foot_y = switch_y + drift / math.tanh(OMEGA * second_s) / OMEGA
        next_y = next_foot_y - drift / (OMEGA * math.sinh(OMEGA * second_s))

        def out(x: float, y: float) -> complex:
            return self.waypoint + heading * complex(x, y)

        return {
            "fine": {"row": 13, "column": 13, "heading": 4, "stance": 0, "mode": 1, "context": 0},
            "action": 5 if change_rad else 6,
            "outcome": {"sagittal": 0, "lateral": 0},
            "yaw_rad": math.atan2(heading.imag, heading.real),
            "heading_change_rad": change_rad,
            "length_m": length_m,
            "height_change_m": 0.0,
            "stance": "left" if self.side > 0 else "right",
            "waypoint_m": point(self.waypoint),
            "next_waypoint_m": point(out(length_m, 0)),
            "com_m": point(self.com, 0.985),
            "velocity_mps": plane(velocity),
            "foot_m": point(self.foot),
            "next_foot_m": point(out(next_x, next_foot_y)),
            "swing_from_m": point(self.foot),
            "swing_velocity_mps": [0.0, 0.0, 0.0],
            "swing_lift_m": point(self.foot),
            "omega_radps": OMEGA,
            "first_half_s": first_s,
            "second_half_s": second_s,
            "switch_m": plane(out(switch_x, switch_y)),
            "switch_velocity_mps": plane(heading * complex(switch_v, drift)),
            "next_com_m": point(out(next_x, next_y), 0.985),
            "next_velocity_mps": plane(heading * speed),
            "dy1_m": next_y,
            "dy2_m": next_foot_y - next_y,
            "apex_speed_mps": self.speed,
            "next_apex_speed_mps": speed,
            "next_heading_changes_rad": [0.0],
            "sign_alternates": True,
            "dy2_in_range": True,
        }


def orbit(position: float, foot: float, speed: float, time_s: float) -> tuple[float, float]:
    """Return position and speed of the pendulum after a time."""
    grown, swung = math.cosh(OMEGA * time_s), math.sinh(OMEGA * time_s)
    return (
        foot + (position - foot) * grown + speed / OMEGA * swung,
        (position - foot) * OMEGA * swung + speed * grown,
    )


def plane(value: complex) -> list[float]:
    """Return [x, y]."""
    return [value.real, value.imag]


def point(value: complex, height_m: float = 0.0) -> list[float]:
    """Return [x, y, z]."""
    return [value.real, value.imag, height_m]
