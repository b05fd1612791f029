"""An obstacle that appears half way, in the cell that the robot would enter next (Zhou et al. 2025, X-C, Fig. 14)."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from surefoot.missions.bench.campaign import Campaign
from surefoot.missions.bench.quadruped_missions import Ended, Mission, walked, way_exists
from surefoot.missions.quadruped.mission import QuadrupedOrder
from surefoot.missions.quadruped.world import World
from surefoot.skills import generated, read_library
from surefoot.skills.patches import Rectangle
from surefoot.skills.values import Cell

_SHARE = 0.15
"""Half the side of the obstacle, of that of a cell: the feet stand before it, wherever the goal was re-targeted to."""


@dataclass(frozen=True, slots=True)
class Detour:
    """A mission in whose way an obstacle appears.

    Attributes:
        scene, seed: of the map.
        way: whether the oracle says that there is another way.
        segments_before: of the same mission without the obstacle.
        first_ms: processor time of the first strategy that was made after it appeared, physics not counted; None
            where no strategy was needed.
        asked: primitives that physics was asked about for that strategy.
        ended: how it ended.
    """

    scene: str
    seed: int
    way: bool
    segments_before: int
    first_ms: float | None
    asked: int
    ended: Ended


def measure_detour(campaign: Campaign, mission: Mission) -> Detour | None:
    """Walk a mission again, with an obstacle; None where it did not reach its goal, or has no cell half way."""
    if mission.ended is None or not mission.ended.reached:
        return None
    scene, seed = mission.scene, mission.seed
    place, terrain = campaign.place(scene, seed), generated(scene, seed)
    steps = [one for one in records(place / "run", "segment") if one["primitive"] is not None]
    if len(steps) < 3:
        return None
    before, step = steps[len(steps) // 2 - 1 : len(steps) // 2 + 1]
    here, there = (_cell(one) for one in step["cells"])
    side = _SHARE * terrain.cell_m
    box = Rectangle(-side, -side, side, side).moved(*terrain.centre_m(there))
    events, out = place / "obstacle.yaml", place / "detour"
    _write_event(events, before["number"] + 1, box)  # before the robot steps in place, if it does
    _, ended = walked(QuadrupedOrder(place / "terrain.yaml", campaign.library(scene), events=events), out)
    assert terrain.goal_m is not None
    knowledge = read_library(campaign.library(scene)).knowledge
    way = way_exists(World(terrain).with_obstacle(box), here, terrain.cell_at(terrain.goal_m), knowledge)
    first = _first_request(out)
    campaign.say(f"{scene}, seed {seed}, obstacle in {there}: {ended.told}{'' if way else ' (no way is left)'}")
    return Detour(
        scene=scene,
        seed=seed,
        way=way,
        segments_before=mission.ended.transitions,
        first_ms=None if first is None else first["symbolic_ms"],
        asked=0 if first is None else len(first["asked"]),
        ended=ended,
    )


def records(run: Path, name: str | None = None) -> list[dict[str, Any]]:
    """Return the records of a run that this campaign walked, all or those of one kind."""
    lines = (json.loads(line) for line in (run / "run.jsonl").read_text("utf-8").splitlines())
    return [one for one in lines if name is None or one["record"] == name]


def _cell(value: Sequence[int]) -> Cell:
    row, column = value
    return row, column


def _write_event(path: Path, segment: int, box: Rectangle) -> None:
    corners = [[round(box.west, 6), round(box.south, 6)], [round(box.east, 6), round(box.north, 6)]]
    line = json.dumps({"at_segment": segment, "obstacle_m": corners})
    path.write_text(f"format: 1\nkind: quadruped-events\nevents:\n- {line}\n", "utf-8")


def _first_request(run: Path) -> dict[str, Any] | None:
    """Return the first request after the obstacle appeared whose strategy was not the library's."""
    appeared = False
    for one in records(run):
        appeared = appeared or one["record"] == "event"
        if appeared and one["record"] == "request" and one["source"] != "library":
            return one
    return None
