"""``surefoot bench quadruped``: everything that is measured of quadruped missions, one map after the other."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

from pydantic import TypeAdapter

from surefoot.missions.bench.campaign import Campaign, make_scene_library
from surefoot.missions.bench.detours import Detour, measure_detour
from surefoot.missions.bench.quadruped_missions import Mission, measure_mission
from surefoot.missions.bench.straight import Straight, measure_straight
from surefoot.missions.bench.turned import MAT, MOST_SEEDS, Turned, measure_mat, measure_turned

_MISSION = TypeAdapter(Mission)
_DETOUR: TypeAdapter[Detour | None] = TypeAdapter(Detour | None)
_STRAIGHT: TypeAdapter[tuple[Straight, ...]] = TypeAdapter(tuple[Straight, ...])
_TURNED: TypeAdapter[tuple[Turned, ...]] = TypeAdapter(tuple[Turned, ...])


@dataclass(frozen=True, slots=True)
class Measured:
    """What a campaign found.

    Attributes:
        missions: the four scenes (Zhou et al. 2025, Fig. 8, Table III).
        detours: an obstacle that appears (Fig. 14).
        straight: against the nearest foothold (Fig. 15).
        turned: transitions on turned ground (Table IV).
    """

    missions: tuple[Mission, ...]
    detours: tuple[Detour, ...]
    straight: tuple[Straight, ...]
    turned: tuple[Turned, ...]


@dataclass(frozen=True, slots=True)
class _Map:
    """What was measured on one map."""

    mission: Mission
    detour: Detour | None
    straight: tuple[Straight, ...]
    turned: tuple[Turned, ...]


def measure(campaign: Campaign) -> Measured:
    """Measure every scene and seed of a campaign; what its folder holds already is not measured again."""
    maps: list[_Map] = []
    for scene in campaign.scenes:
        make_scene_library(campaign, scene)
        maps += [_measure_map(campaign, scene, seed) for seed in campaign.seeds]
    mats = [one for seed in campaign.seeds[:MOST_SEEDS] for one in _mat(campaign, seed)]
    return Measured(
        missions=tuple(one.mission for one in maps),
        detours=tuple(one.detour for one in maps if one.detour is not None),
        straight=tuple(row for one in maps for row in one.straight),
        turned=(*(row for one in maps for row in one.turned), *mats),
    )


def _measure_map(campaign: Campaign, scene: str, seed: int) -> _Map:
    """Walk a map, again with an obstacle, and straight ahead; then solve its transitions on turned ground."""
    place = campaign.place(scene, seed)
    mission = campaign.once(_MISSION, place / "mission.json", partial(measure_mission, campaign, scene, seed))
    return _Map(
        mission,
        campaign.once(_DETOUR, place / "detour.json", partial(measure_detour, campaign, mission)),
        campaign.once(_STRAIGHT, place / "straight.json", partial(measure_straight, campaign, scene, seed)),
        campaign.once(_TURNED, place / "turned.json", partial(measure_turned, campaign, mission)),
    )


def _mat(campaign: Campaign, seed: int) -> tuple[Turned, ...]:
    return campaign.once(_TURNED, campaign.place(MAT, seed) / "turned.json", partial(measure_mat, campaign, seed))
