"""What quadruped missions are measured on: four scenes with many seeds, and what the paper compares on them.

Source: Zhou et al. 2025, Fig. 8, Table III; the oracle is ours.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, fields, replace
from pathlib import Path

from surefoot.errors import InputError
from surefoot.footholds import Problem, solve
from surefoot.missions.bench.campaign import Campaign
from surefoot.missions.quadruped.crossing import Crossed
from surefoot.missions.quadruped.mission import QuadrupedAnswer, QuadrupedOrder, walk_quadruped
from surefoot.missions.quadruped.outcome import Outcome
from surefoot.missions.quadruped.route import on_map
from surefoot.missions.quadruped.walk import QuadrupedWalk
from surefoot.missions.quadruped.world import World
from surefoot.skills import Knowledge, QuadrupedTerrain, generated, read_library, write_terrain
from surefoot.skills.shortest import fewest_new
from surefoot.skills.values import Cell


@dataclass(frozen=True, slots=True, kw_only=True)
class Ended(Outcome):
    """How a run ended, as a campaign keeps it.

    Attributes:
        refuted: moves that no gait could do, and what each lacks.
    """

    refuted: tuple[str, ...] = ()

    @property
    def told(self) -> str:
        """The same in a sentence."""
        end = "reached" if self.reached else f"NOT reached: {self.why_not}"
        checked = "" if self.verified else f", NOT VERIFIED: {self.findings[0]}"
        return f"{end}, {self.transitions} segments, {self.contradictions} contradictions{checked}"


@dataclass(frozen=True, slots=True)
class Program:
    """One online program.

    Attributes:
        solve_ms, retarget_ms: processor times.
        polygons, continuous, binaries: its size, as the paper counts.
        clear_ms, plain_ms: of the same program solved anew with and without its free regions; None where it has none.
        plain_binaries: binary variables without them.
    """

    solve_ms: float
    retarget_ms: float
    polygons: int
    continuous: int
    binaries: int
    clear_ms: float | None
    plain_ms: float | None
    plain_binaries: int


@dataclass(frozen=True, slots=True)
class Mission:
    """One seed of a scene.

    Attributes:
        scene, seed: of the map.
        left_out: why nobody walked it; empty if somebody did.
        way: whether the oracle says that a way exists.
        ended: how it ended.
        programs: that were solved on the way.
    """

    scene: str
    seed: int
    left_out: str
    way: bool
    ended: Ended | None
    programs: tuple[Program, ...]


def measure_mission(campaign: Campaign, scene: str, seed: int) -> Mission:
    """Walk a map whose start the robot can stand in."""
    terrain, place = generated(scene, seed), campaign.place(scene, seed)
    file, library = place / "terrain.yaml", campaign.library(scene)
    place.mkdir(parents=True, exist_ok=True)
    write_terrain(file, terrain)
    try:
        walk, ended = walked(QuadrupedOrder(file, library), place / "run")
    except InputError as refused:  # a drawn map may have a start in which the robot cannot stand
        campaign.say(f"{scene}, seed {seed}: left out: {refused}")
        return Mission(scene, seed, str(refused), False, None, ())
    way = oracle(terrain, read_library(library).knowledge)
    campaign.say(f"{scene}, seed {seed}: {ended.told}{'' if way else ' (no way exists)'}")
    return Mission(scene, seed, "", way, ended, tuple(_program(one) for one in walk.tally.crossed))


def walked(order: QuadrupedOrder, out: Path) -> tuple[QuadrupedWalk, Ended]:
    """Walk a mission and keep how it ended, with an explanation of every move that no gait could do."""
    walk, answer = walk_quadruped(order, out)
    return walk, _ended(answer, refuted(walk.world.terrain, walk.tally.crossed))


def _ended(answer: QuadrupedAnswer, moves: tuple[str, ...]) -> Ended:
    kept = {one.name: getattr(answer, one.name) for one in fields(Outcome)}
    return Ended(**kept, refuted=moves)


def refuted(terrain: QuadrupedTerrain, programs: Collection[Crossed]) -> tuple[str, ...]:
    """Return, for every move that no gait could do, why the first of its programs has no motion."""
    failed: dict[tuple[Cell, Cell], Crossed] = {}
    for one in programs:
        if one.infeasible:
            failed.setdefault(_move(terrain, one.problem), one)
    done = {_move(terrain, one.problem) for one in programs if not one.reason}
    return tuple(
        f"{here} to {there}: {_lacks(one)}" for (here, there), one in failed.items() if (here, there) not in done
    )


def _move(terrain: QuadrupedTerrain, problem: Problem) -> tuple[Cell, Cell]:
    (a, b, _), (c, d, _) = problem.start_m.tolist(), problem.goal_m.tolist()
    return terrain.cell_at((a, b)), terrain.cell_at((c, d))


def _lacks(crossed: Crossed) -> str:
    if crossed.solution is None:
        return crossed.reason
    explained = solve(crossed.problem, certify=False).explanation
    return crossed.reason + ("" if explained is None else f"; {explained.text}")


def _program(crossed: Crossed) -> Program:
    problem = crossed.problem
    clear_ms = plain_ms = None
    if problem.free_regions and not crossed.reason:
        options = replace(problem.options, collision=False)
        plain = replace(problem, free_regions=(), options=options)
        clear_ms, plain_ms = (solve(one, certify=False, why=False).solve_cpu_ms for one in (problem, plain))
    return Program(
        solve_ms=crossed.solve_ms,
        retarget_ms=crossed.retarget_ms,
        polygons=len(problem.polygons),
        continuous=crossed.continuous,
        binaries=crossed.binaries,
        clear_ms=clear_ms,
        plain_ms=plain_ms,
        plain_binaries=len(problem.footsteps) * len(problem.polygons),
    )


def oracle(terrain: QuadrupedTerrain, knowledge: Knowledge) -> bool:
    """Return whether requests of the local grids lead from start to goal without what physics refused."""
    assert terrain.start_m is not None
    assert terrain.goal_m is not None
    return way_exists(World(terrain), terrain.cell_at(terrain.start_m), terrain.cell_at(terrain.goal_m), knowledge)


def way_exists(world: World, start: Cell, goal: Cell, knowledge: Knowledge) -> bool:
    """Return the same for any two cells of a world, in which obstacles may have appeared."""
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
