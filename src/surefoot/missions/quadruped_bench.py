"""What quadruped missions are measured on: four scenes with many seeds, and what the paper compares on them.

Source: Zhou et al. 2025, Fig. 8, Table III; the oracle is ours.
"""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from surefoot.compute import process_pool
from surefoot.errors import InputError
from surefoot.footholds import solve
from surefoot.missions.quadruped import QuadrupedAnswer, QuadrupedOrder, walk_quadruped
from surefoot.missions.quadruped_crossing import Crossed
from surefoot.missions.quadruped_route import on_map
from surefoot.missions.quadruped_world import World
from surefoot.skills import QuadrupedTerrain, TerrainSet, generated, terrain_set, write_terrain
from surefoot.skills.library import read_library
from surefoot.skills.making import make_library
from surefoot.skills.manager import Knowledge
from surefoot.skills.physics import PRELOAD
from surefoot.skills.shortest import fewest_new
from surefoot.skills.terrain_checks import terrain_checks
from surefoot.skills.values import Cell

SCENES = ("unstructured-4", "unstructured-8", "rebar-7", "rebar-14")
Say = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class Mission:
    """One seed of a scene.

    Attributes:
        seed: of the map.
        way: whether the oracle says that a way exists.
        answer: what the run did.
        with_collision_ms, without_ms: solve times of the same programs with and without free regions.
    """

    seed: int
    way: bool
    answer: QuadrupedAnswer
    with_collision_ms: tuple[float, ...]
    without_ms: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class SceneResult:
    """All seeds of a scene.

    Attributes:
        scene: its name.
        library_s: what making the skills took.
        missions: one for every seed.
        solve_ms: processor times of all online programs.
    """

    scene: str
    library_s: float
    missions: tuple[Mission, ...]
    solve_ms: tuple[float, ...]
    retarget_ms: tuple[float, ...]

    @property
    def missed(self) -> tuple[Mission, ...]:
        """Seeds with a way whose goal was not reached."""
        return tuple(one for one in self.missions if one.way and not one.answer.reached)


def measure_scene(scene: str, seeds: Sequence[int], say: Say = lambda _: None) -> SceneResult:
    """Make the skills that all maps of a scene need, and walk each map whose start the robot can stand in."""
    terrains = [generated(scene, seed) for seed in seeds]
    with tempfile.TemporaryDirectory(prefix="surefoot-") as name:
        folder = Path(name)
        begin_s = time.perf_counter()
        make_scene_library(terrains, folder / "library", say)
        library_s = time.perf_counter() - begin_s
        missions, solve_ms, retarget_ms = [], [], []
        for seed, terrain in zip(seeds, terrains, strict=True):
            file = folder / f"{seed}.yaml"
            write_terrain(file, terrain)
            try:
                walk, answer = walk_quadruped(QuadrupedOrder(file, folder / "library"), folder / f"run-{seed}")
            except InputError as refused:  # a drawn map may have a start in which the robot cannot stand
                say(f"{scene}, seed {seed}: left out: {refused}")
                continue
            way = oracle(terrain, read_library(folder / "library").knowledge)
            pairs = [pair for one in walk.tally.crossed if (pair := _both(one)) is not None]
            missions.append(Mission(seed, way, answer, tuple(a for a, _ in pairs), tuple(b for _, b in pairs)))
            solve_ms += [one.solve_ms for one in walk.tally.crossed]
            retarget_ms += [one.retarget_ms for one in walk.tally.crossed]
            say(f"{scene}, seed {seed}: {_told(answer, way=way)}")
    return SceneResult(scene, library_s, tuple(missions), tuple(solve_ms), tuple(retarget_ms))


def _told(answer: QuadrupedAnswer, *, way: bool) -> str:
    end = "reached" if answer.reached else answer.why_not
    checked = "" if answer.verified else f", NOT VERIFIED: {answer.findings[0]}"
    numbers = f"{answer.transitions} segments, {answer.solve_ms_mean:.0f} ms, {answer.contradictions} contradictions"
    return f"{end}{'' if way else ' (no way exists)'}, {numbers}{checked}"


def make_scene_library(terrains: Iterable[QuadrupedTerrain], folder: Path, say: Say) -> None:
    """Make one library for the terrain states of several maps of a scene."""
    sets = [terrain_set(terrain) for terrain in terrains]
    states = dict.fromkeys(state for one in sets for state in one.states)
    first = sets[0]
    joined = TerrainSet(first.name, first.cell_m, first.classes, first.robot, tuple(states), first.asked)
    workers = len(os.sched_getaffinity(0))
    with process_pool(workers, preload=PRELOAD) as executor:
        checks = terrain_checks(generated(first.classes.name, 0), executor)
        make_library(joined, folder, checks, at_once=3 * workers, say=say)


def oracle(terrain: QuadrupedTerrain, knowledge: Knowledge) -> bool:
    """Return whether requests of the local grids lead from start to goal without what physics refused."""
    world = World(terrain)
    assert terrain.start_m is not None
    assert terrain.goal_m is not None
    start, goal = terrain.cell_at(terrain.start_m), terrain.cell_at(terrain.goal_m)
    seen, stack = {start}, [start]
    while stack:
        cell = stack.pop()
        for target in _successors(world, cell, knowledge):
            if target not in seen:
                seen.add(target)
                stack.append(target)
    return goal in seen


def _successors(world: World, cell: Cell, knowledge: Knowledge) -> list[Cell]:
    state = world.state(cell)
    if state is None:
        return []
    found = []
    for local in state.cells():
        target = on_map(cell, local, 0, (state.rows, state.columns))
        inside = world.inside(target) and world.state(target) is not None
        if inside and fewest_new(state, local, knowledge.skills, knowledge.refused) is not None:
            found.append(target)
    return found


def _both(crossed: Crossed) -> tuple[float, float] | None:
    """Return the solve times of a program with and without its free regions; None where it has none."""
    if not crossed.problem.free_regions or crossed.reason:
        return None
    options = replace(crossed.problem.options, collision=False)
    plain = replace(crossed.problem, free_regions=(), options=options)
    return crossed.solve_ms, solve(plain, certify=False, why=False).solve_cpu_ms
