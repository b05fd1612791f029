"""A slow, small planner for tests: it plays both games by the checker's own rules, and can be told to break some.

It knows flat floors; the games are solved in naive_games.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from naive_games import Moves, State, buchi, gr1, reached_from

from surefoot.compute import sha256_of
from surefoot.frames import Direction
from surefoot.verify.navigation.assumption import Assumption
from surefoot.verify.navigation.belief import Abstraction, Known, Obstacles, Turned, abstraction_of
from surefoot.verify.navigation.claims import ORDERS, Claims
from surefoot.verify.navigation.decisions import WAIT, Decision
from surefoot.verify.navigation.play import arrival, order_allowed, start_decision
from surefoot.verify.plan.action import Core, follows, start_core
from surefoot.verify.plan.moves import FINE, NOWHERE, Rules, allowed, booked, landed, moved, outcome_limits, rules_of
from surefoot.verify.scene.derived import Scene, derive_scene, fine_distance_m
from surefoot.verify.scene.scenario import HEADINGS, WALKING_KEYS, read_scenario

Booking = Callable[[tuple[float, ...]], Any]


@dataclass
class Cheats:
    """Which rules the naive planner breaks.

    Attributes:
        collisions: False drops the collision rule.
        obstacles: the obstacles as the planner takes them, instead of the scene's.
        booking: where the steps of a turn end.
    """

    collisions: bool = True
    obstacles: Callable[[Scene, Abstraction], Obstacles] = Obstacles
    booking: Booking = booked


_ACTIONS: dict[tuple[Any, ...], dict[str, Any]] = {}
"""Action strategies that were planned already; they do not depend on the obstacles."""


def write_map(folder: Path, picture: list[str], pixels: int, resolution_m: float) -> Path:
    """Write a map whose cells are drawn as text: # is occupied."""
    rows = [
        "".join(("0 " if sign == "#" else "254 ") * pixels for sign in line) for line in picture for _ in range(pixels)
    ]
    size = f"{len(picture[0]) * pixels} {len(rows)}"
    (folder / "map.pgm").write_text(f"P2\n{size}\n255\n" + "\n".join(rows) + "\n")
    thresholds = "mode: trinary\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.25\n"
    path = folder / "map.yaml"
    path.write_text(f"image: map.pgm\nresolution: {resolution_m}\norigin: [0.0, 0.0, 0.0]\n{thresholds}")
    return path


def write_plan(scenario_path: Path, folder: Path, cheats: Cheats | None = None) -> Path:
    """Plan a scenario and write the plan's folder."""
    cheats = cheats or Cheats()
    scene = derive_scene(read_scenario(scenario_path))
    document = _document(scene, scenario_path, folder)
    claims = _claims(scene, document)
    folder.mkdir(exist_ok=True)
    np.savez(folder / "navigation.npz", **_navigation(scene, claims, cheats))
    key = (claims.contexts, claims.fine, claims.heading, cheats.booking)
    if key not in _ACTIONS:
        _ACTIONS[key] = _action(scene, claims, cheats)
    np.savez(folder / "action.npz", **_ACTIONS[key])
    write_document(folder, document)
    return folder


def write_document(folder: Path, document: dict[str, Any]) -> None:
    """Write plan.json with the hashes of the arrays beside it."""
    document["files"] = {name: sha256_of(folder / name) for name in ("navigation.npz", "action.npz")}
    (folder / "plan.json").write_text(json.dumps(document))


def _document(scene: Scene, scenario_path: Path, folder: Path) -> dict[str, Any]:
    scenario, frame, robot = scene.scenario, scene.frame, scene.robot
    walking: dict[str, Any] = {name: scenario.walking[name] for name in WALKING_KEYS}
    walking = {name: list(value) if isinstance(value, tuple) else value for name, value in walking.items()}
    walking["fine_cell_m"] = frame.cell_size_m / walking["fine_cells"]
    start = _cell_at(scene, scenario.start_m)
    fine = _fine_at(scene, start, walking["fine_cell_m"], scenario.start_m)
    return {
        "kind": "biped-plan",
        "format": 1,
        "surefoot": "0.1.0",
        "made": "2026-01-01T00:00:00Z",
        "scenario": _named(scenario_path, folder),
        "map": {
            **_named(scene.floor.path, folder),
            "image_path": str(Path("..") / scene.floor.image_path.name),
            "image_sha256": sha256_of(scene.floor.image_path),
        },
        "realizable": True,
        "verified": True,
        "grid": {
            "rows": frame.rows,
            "columns": frame.columns,
            "north_west_m": list(frame.north_west_m),
            "cell_size_m": frame.cell_size_m,
            "origin_m": list(frame.origin_m),
            "rotation_rad": frame.rotation_rad,
            "free": [list(cell) for cell in scene.kinds],
        },
        "walking": walking,
        "robot": {
            name: getattr(robot, name)
            for name in [
                "name",
                "apex_height_m",
                "omega_radps",
                "foot_radius_m",
                "foot_half_length_m",
                "foot_half_width_m",
            ]
        },
        "profiles": [None],
        "contexts": [{"here": h, "order": ORDERS[o], "there": t} for h, o, t in sorted(scene.contexts)],
        "start": {
            "cell": list(start),
            "heading": HEADINGS[scenario.start_heading],
            "fine": {"row": fine[0], "column": fine[1]},
            "moved_m": fine_distance_m(scene, start, fine, scenario.start_m),
        },
        "goals": [list(_cell_at(scene, goal)) for goal in scenario.goals_m],
        "obstacles": _obstacles(scene),
        "kinds": [list(kind.members) for kind in scene.obstacle_kinds],
        "belief": {
            "abstraction": _belief(scene).method,
            "regions": [[list(scene.cell(cell)) for cell in sorted(region)] for region in _belief(scene).regions],
        },
        "statistics": {},
    }


def _obstacles(scene: Scene) -> list[dict[str, Any]]:
    kind_of = {member: kind for kind in scene.obstacle_kinds for member in kind.members}
    return [
        {
            "start": list(_cell_at(scene, part.start_m)),
            "domain": [list(scene.cell(cell)) for cell in kind_of[number].domain],
            "speed_cells": part.speed_cells,
        }
        for number, part in enumerate(scene.scenario.obstacles)
    ]


def _belief(scene: Scene) -> Abstraction:
    """Return the scenario's abstraction; where the planner may choose, regions of the first cells of a domain."""
    return abstraction_of(scene) or Abstraction("regions", (frozenset(scene.obstacle_kinds[0].domain[:3]),))


def _named(path: Path, folder: Path) -> dict[str, str]:
    assert path.parent == folder.parent
    return {"path": f"../{path.name}", "sha256": sha256_of(path)}


def _cell_at(scene: Scene, point: tuple[float, float]) -> tuple[int, int]:
    return next(cell for cell in scene.kinds if scene.frame.holds(cell, point))


def _fine_at(scene: Scene, cell: tuple[int, int], fine_m: float, point: tuple[float, float]) -> tuple[int, int]:
    west, _, _, north = scene.frame.square(*cell)
    x, y = scene.frame.to_grid(np.array(point))
    return int((north - y) / fine_m), int((x - west) / fine_m)


def _claims(scene: Scene, document: dict[str, Any]) -> Claims:
    walking, start = document["walking"], document["start"]
    return Claims(
        profiles=(None,),
        contexts=tuple((c["here"], ORDERS.index(c["order"]), c["there"]) for c in document["contexts"]),
        kinds=scene.kinds,
        start=tuple(start["cell"]),
        heading=scene.scenario.start_heading,
        fine=(start["fine"]["row"], start["fine"]["column"]),
        goals=tuple(tuple(goal) for goal in document["goals"]),
        obstacles=tuple(tuple(part["start"]) for part in document["obstacles"]),
        belief=_belief(scene),
        walking={name: float(value) for name, value in walking.items() if not isinstance(value, list)},
        apex_speeds=tuple(walking["apex_speed_mps"]),
        straight=tuple(walking["straight_cells"]),
        turns=(tuple(walking["turn_a_cells"]), tuple(walking["turn_b_cells"])),
    )


def _navigation(scene: Scene, claims: Claims, cheats: Cheats) -> dict[str, Any]:
    obstacles = cheats.obstacles(scene, claims.belief)
    start = start_decision(scene, claims, obstacles)
    moves: Moves = {start: {}}
    turns: dict[tuple[Known, int, int, bool], Turned] = {}
    queue = [start]
    for decision in queue:
        for order in range(8):
            if not order_allowed(scene, claims, decision.cell, decision.heading, order):
                continue
            cell, heading, goal, reached = arrival(scene, claims, decision, order)
            meeting = (decision.known, decision.cell, cell, order >= WAIT)
            if meeting not in turns:
                turns[meeting] = obstacles.turn(*meeting[:3], waits=meeting[3])
            turned = turns[meeting]
            if turned.lost and cheats.collisions:
                continue
            after = [(Decision(cell, heading, known, goal), reached) for known in product(*turned.kinds)]
            moves[decision][order] = after
            for option, _ in after:
                if option not in moves:
                    moves[option] = {}
                    queue.append(option)
    assumption = Assumption(obstacles)
    orders = gr1(moves, lambda decision, order: _broken(scene, assumption, decision, order))
    assert start in orders, "the scenario of a test has to be realizable"
    return _rows(
        obstacles, orders, reached_from(start, lambda decision: [o for o, _ in moves[decision][orders[decision]]])
    )


def _broken(scene: Scene, assumption: Assumption, decision: Decision, order: int) -> int:
    """Return which justice an order breaks, -1 for none."""
    if order < WAIT:
        return -1
    target = scene.target(scene.cell(decision.cell), Direction(order - WAIT))
    return order - WAIT if assumption.blocked(decision.known, decision.cell, scene.index(target)) else -1


def _rows(obstacles: Obstacles, orders: dict[Decision, int], decisions: list[Decision]) -> dict[str, Any]:
    width, count = (len(obstacles.domain) + 7) // 8, len(decisions)
    seen, hidden = [], b""
    for decision in decisions:
        cells: list[int] = []
        for kind, part in zip(obstacles.kinds, decision.known, strict=True):
            cells += [*part.visible, *[-1] * (len(kind.members) - len(part.visible))]
            hidden += sum(1 << obstacles.place[cell] for cell in part.hidden).to_bytes(width, "little")
        seen.append(cells)
    return {
        "cell": np.array([d.cell for d in decisions], np.int32),
        "heading": np.array([d.heading for d in decisions], np.int8),
        "visible": np.array(seen, np.int32).reshape(count, sum(len(kind.members) for kind in obstacles.kinds)),
        "hidden": np.frombuffer(hidden, np.uint8).reshape(count, len(obstacles.kinds), width),
        "goal": np.array([d.goal for d in decisions], np.int16),
        "order": np.array([orders[d] for d in decisions], np.int8),
        "domain": np.array(obstacles.domain, np.int32),
    }


def _action(scene: Scene, claims: Claims, cheats: Cheats) -> dict[str, Any]:
    rules = rules_of(claims)
    rules = rules._replace(booked=np.stack([cheats.booking(lengths) for lengths in claims.turns]))
    starts = [(start_core(claims), c) for c in range(len(rules.order)) if follows(rules, c, 0, int(claims.heading))]
    moves: dict[State, dict[int, list[tuple[State, bool]]]] = {state: {} for state in starts}
    queue = list(starts)
    for state in queue:
        moves[state] = _options(rules, *state)
        for after in moves[state].values():
            for option, _ in after:
                if option not in moves:
                    moves[option] = {}
                    queue.append(option)
    actions = buchi(moves)
    assert all(state in actions for state in starts), "the fine grid of a test has to be realizable"
    states = list(actions)
    found = {
        name: np.array([state[0][place] for state in states], np.int16)
        for place, name in enumerate(("row", "column", "heading", "stance", "mode"))
    }
    found["context"] = np.array([state[1] for state in states], np.int16)
    found["action"] = np.array([actions[state] for state in states], np.int16)
    return found


def _options(rules: Rules, core: Core, context: int) -> dict[int, list[tuple[State, bool]]]:
    """Return the actions that are never lost, with all that may follow."""
    found: dict[int, list[tuple[State, bool]]] = {}
    order = int(rules.order[context])
    for action in range(6 + len(rules.straight)):
        if not allowed(rules, core[2], core[3], core[4], order, action):
            continue
        far, wide = outcome_limits(rules, core, rules.here[context], action)
        outcomes = [
            _outcome(rules, core, context, action, e, s) for e in range(-far, far + 1) for s in range(-wide, wide + 1)
        ]
        if all(outcomes):
            found[action] = [option for options in outcomes for option in options]
    return found


def _outcome(
    rules: Rules, core: Core, context: int, action: int, sagittal: int, lateral: int
) -> list[tuple[State, bool]]:
    after = moved(rules, core, int(rules.order[context]), action, sagittal, lateral)
    status, achieved, crossed = landed(rules, core, context, action, after)
    if status != FINE:
        return []
    n = int(rules.sizes[0])
    wrapped = (int(after[0]) % n, int(after[1]) % n, int(after[2]), int(after[3]), int(after[4]))
    if not achieved:
        return [((wrapped, context), False)]
    kind = int(rules.there[context] if crossed != NOWHERE else rules.here[context])
    last = int(crossed if crossed != NOWHERE else after[2] // rules.sizes[2])
    return [((wrapped, c), True) for c in range(len(rules.order)) if follows(rules, c, kind, last)]


def read_rows(folder: Path, name: str) -> dict[str, Any]:
    """Return the arrays of a strategy, to be changed."""
    with np.load(folder / name, allow_pickle=False) as archive:
        return {key: archive[key].copy() for key in archive.files}


def rewrite(folder: Path, name: str, arrays: dict[str, Any]) -> None:
    """Write changed arrays, with their hashes."""
    np.savez(folder / name, **arrays)
    write_document(folder, json.loads((folder / "plan.json").read_text()))
