"""The executive: from way point to way point, from cell to cell, until the goal is reached or nothing leads there.

The automaton advances only when the online program of its transition has a motion. What goes wrong (classes that the
library has not seen, a program that fails, a world that changes) leads to another strategy, and when there is none, the
robot stands and asks the global planner for another way. Everything is logged as it happens.

Source: Zhou et al. 2025, VII and VIII-B; docs/quadruped.md.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial

import numpy as np

from surefoot.footholds.gaits import FreeGait, Gait
from surefoot.missions.quadruped.ahead import looked_ahead
from surefoot.missions.quadruped.changes import LEAVE, pushed, still_fits, ways_out
from surefoot.missions.quadruped.crossing import (
    OTHER_GAITS,
    SETTLING,
    Certificate,
    Crossed,
    OnlineLimits,
    cross,
    crossing,
)
from surefoot.missions.quadruped.events import Event, Happening
from surefoot.missions.quadruped.records import Log
from surefoot.missions.quadruped.route import Edge, Pose, Routes, moves_from, pose_in_grid, pose_on_map
from surefoot.missions.quadruped.skills import Handled, SkillBook
from surefoot.missions.quadruped.stance import Segment, Stance
from surefoot.missions.quadruped.tally import Tally
from surefoot.missions.quadruped.timeline import Clock, delay_of
from surefoot.missions.quadruped.world import World
from surefoot.robots.quadruped import Quadruped
from surefoot.skills.values import OBSTACLE, Cell, CheckResult, Direction, Physics, Primitive, TerrainState, Way

Strategy = Mapping[Pose, Way | None]
_SETTLED_M = 0.01


class QuadrupedWalk:
    """One mission while it is under way.

    Args:
        robot: its numbers.
        world: the map.
        book: skills.
        stance: how the robot stands.
        goal: cell of the map.
        log: what is told.
        events: what will happen.
        limits: of online programs.
        delays_s: added to what planning takes, one after another.
        most_segments: the mission is given up after so many.
    """

    def __init__(
        self,
        robot: Quadruped,
        world: World,
        book: SkillBook,
        stance: Stance,
        goal: Cell,
        log: Log,
        *,
        events: Sequence[Event] = (),
        limits: OnlineLimits | None = None,
        delays_s: Sequence[float] = (0.0,),
        most_segments: int = 10_000,
    ) -> None:
        self.robot, self.world, self.book, self.stance, self.goal, self.log = robot, world, book, stance, goal, log
        self.waiting = list(events)
        self.limits = limits or OnlineLimits()
        self.delays_s, self.most_segments = delays_s, most_segments
        self.tally, self.clock = Tally(), Clock()
        self.failed: dict[Edge, Crossed] = {}
        self.lost: set[Edge] = set()
        self.segments: list[Segment] = []
        self.requests = 0
        self.checking_s = 0.0
        self.delayed = -1
        self.planned: dict[tuple[World, int, int, frozenset[Edge]], Routes] = {}

    def run(self) -> str:
        """Walk; return why the mission ended, empty if the goal was reached."""
        if self.stance.cell != self.goal:
            self._happen()
            self._prepare()
        while self.stance.cell != self.goal:
            if len(self.segments) >= self.most_segments:
                return f"the limit of {self.most_segments} segments was reached"
            problem = self._next_request()
            if problem:
                return problem
        return ""

    def _prepare(self) -> None:
        """Have skills made that the way to the goal lacks, while the robot stands anyway."""
        begin_s = time.process_time()
        made = [one for one in looked_ahead(self.world, self.book, self._pose, self.goal) if one.checked]
        self.clock = self.clock.planned(time.process_time() - begin_s)
        for one in made:
            self.tally.prepared_ms += one.symbolic_ms
            self._spend(one.checked)
        if made:
            self.log.prepared([result for one in made for result in one.checked], self.book.new_plans)

    def _next_request(self) -> str:
        """Choose a way point, find a strategy, and roll it out; return why there is nothing to do, if so."""
        self._happen()
        cell, turns = self.stance.cell, self.stance.quarter_turns
        state = self.world.state(cell, turns)
        if cell == self.goal:  # a push took it there
            return ""
        if not all(map(self.world.holds, self.stance.feet_m)):
            return "the ground below a foot of the robot has gone"
        if state is None:
            return self._leave()
        begin_s = time.process_time()
        routes, refused = self._routed(turns), self.book.knowledge.refused
        route = routes.route(cell)
        self.clock = self.clock.planned(time.process_time() - begin_s)
        if route is None:
            return "no way leads to the goal: the global planner knows none that is not blocked or refused"
        known = len(refused)
        for local in routes.wishes(cell, state, self.world.terrain.requests):
            found = self._strategy(state, local, route)
            if found is not None:
                self._roll_out(state, found)
                return ""
        if len(self.book.knowledge.refused) > known:
            self._detour([])  # physics has refused what the way was made of
        else:
            self._give_up(state)
        return ""

    def _routed(self, turns: int) -> Routes:
        """Return the ways to the goal as a robot with a heading sees them; the same ones while nothing changes."""
        closed, refused = frozenset(self.failed) | self.lost, self.book.knowledge.refused
        key = self.world, turns, len(refused), closed
        if key not in self.planned:
            self.planned = {key: Routes(self.world, self.goal, turns, refused, closed, self.book.turning)}
        return self.planned[key]

    def _give_up(self, state: TerrainState) -> None:
        """Stand, and ask the global planner for another way: no request from here that leads on has a strategy."""
        grid, turning = (state.rows, state.columns), self.book.turning
        headings = range(1 if turning is None else 4)
        ways = [(h, after) for h in headings for _, after in moves_from(state, (state.centre, h), turning)]
        here = self._pose
        closed = [
            (pose_on_map(here, (state.centre, h), grid), pose_on_map(here, after, grid))
            for h, after in ways
            if after[0] != state.centre
        ]
        self.lost |= set(closed)
        self._detour(closed)

    def _detour(self, given_up: Sequence[Edge]) -> None:
        self.tally.detours += 1
        self.log.write("detour", cell=self.stance.cell, given_up=[[one[0], other[0]] for one, other in given_up])

    @property
    def _pose(self) -> Pose:
        return self.stance.cell, self.stance.quarter_turns

    def _strategy(self, state: TerrainState, local: Cell, route: Sequence[Cell]) -> Strategy | None:
        """Look a strategy up, or have one made; None where there is none."""
        grid = (state.rows, state.columns)
        edges = [
            (a, b)
            for one, other in sorted(self.failed)
            if (a := pose_in_grid(self._pose, one, grid)) is not None
            and (b := pose_in_grid(self._pose, other, grid)) is not None
        ]
        handled = self.book.strategy(state, local, edges)
        self._count(handled)
        self.log.request(self.requests, self.stance, state, local, route, edges, handled, self.book.new_plans)
        self.requests += 1
        return handled.ways if handled.winning else None

    def _count(self, handled: Handled) -> None:
        if handled.source == "library":
            return
        self.tally.repairs += 1
        self.clock = self.clock.planned(1e-3 * handled.symbolic_ms)
        times = self.tally.repair_ms if handled.checked else self.tally.resynthesis_ms
        times.append(handled.symbolic_ms)
        self._spend(handled.checked)

    def _spend(self, checked: Sequence[CheckResult]) -> None:
        """Count the skills that physics found, and let the time pass that it took."""
        self.tally.new_skills += sum(one.verdict is Physics.FEASIBLE for one in checked)
        physics_s = sum(one.time_s for one in checked)
        self.checking_s += physics_s
        self.clock = self.clock.planned(physics_s)

    def _roll_out(self, state: TerrainState, strategy: Strategy) -> None:
        """Follow a strategy until its request is reached, or something stands in its way."""
        looked, grid = self._pose, (state.rows, state.columns)
        local: Pose = (state.centre, 0)
        while (way := strategy[local]) is not None and self.stance.cell != self.goal:
            holds = partial(self._holds, state, looked, local)
            if self._happen() and not holds():
                return
            steps = {primitive.direction: (primitive, after) for primitive, after in self._ways(state, local)}
            primitive, after = steps[way]
            if not self._advance(pose_on_map(looked, after, grid), primitive, (local, after), holds):
                return
            local = after

    def _ways(self, state: TerrainState, local: Pose) -> Iterator[tuple[Primitive, Pose]]:
        return moves_from(state, local, self.book.turning)

    def _holds(self, state: TerrainState, looked: Pose, local: Pose) -> bool:
        """Return whether what the strategy assumes still holds: the classes, and where the robot is."""
        expected = pose_on_map(looked, local, (state.rows, state.columns))
        if self._pose != expected:
            return self._violated("post", f"the robot is in {self.stance.cell}, not in {expected[0]}")
        if not all(map(self.world.holds, self.stance.feet_m)):
            return self._violated("terrain", "the ground below a foot of the robot has gone")
        now = self.world.state(*looked)
        if now == state:
            return True
        if now is None:
            return self._violated("obstacle", f"the cell {looked[0]} has become an obstacle")
        changed = [cell for cell in state.cells() if now.label(cell) != state.label(cell)]
        appeared = [cell for cell in changed if now.label(cell) == OBSTACLE]
        what = "an obstacle appeared" if appeared else "the terrain changed"
        return self._violated("obstacle" if appeared else "terrain", f"{what} in {changed} of the local grid")

    def _violated(self, assumption: str, text: str) -> bool:
        self.tally.violations += 1
        self.log.write("violation", assumption=assumption, text=text, cell=self.stance.cell)
        return False

    def _happen(self) -> bool:
        """Let happen what is due when the planner looks; return whether anything did."""
        due = [one for one in self.waiting if one.due(len(self.segments), self.clock.planner_s)]
        for event in due:
            self._apply(event, self.clock.planner_s)
        return bool(due)

    def _apply(self, event: Event, seen_s: float) -> None:
        self.waiting.remove(event)
        if event.what is Happening.OBSTACLE and event.area is not None:
            self.world = self.world.with_obstacle(event.area)
        elif event.what is Happening.HOLE and event.area is not None:
            self.world = self.world.without_ground(event.area)
        legs = self.limits.joint_reach
        landed = pushed(self.robot, self.world, self.stance, event.push_m, joint_reach=legs) if event.push_m else None
        self.log.event(event, len(self.segments), seen_s, landed)
        self.stance = landed or self.stance
        self.lost.clear()

    def _advance(self, target: Pose, primitive: Primitive, move: tuple[Pose, Pose], holds: Callable[[], bool]) -> bool:
        """Plan the motion of one transition and have it walked; return whether that was done.

        Certificates begin in a re-targeted pose. A motion may end with its feet far from theirs; where the next program
        fails for that reason, the robot settles first, and looks around again.
        """
        certificate = self.book.certificate(primitive)
        begin_s = self.clock.planner_s
        crossed = self._planned(target, certificate.gait, certificate)
        settling = self._settling() if crossed.refuted else None
        if settling is not None:
            if not self._send(settling, begin_s, self._pose, None, None, holds):
                return False
            self.tally.settled += 1
            if self._happen() and not holds():
                return False
            begin_s = self.clock.planner_s
            crossed = self._planned(target, certificate.gait, certificate)
        if crossed.refuted:
            self.tally.contradictions += 1
            crossed = self._with_another_gait(target, certificate.gait) or crossed
        if crossed.reason:
            self._fail(target, primitive.name, move, crossed)
            return False
        return self._send(crossed, begin_s, target, primitive.name, move, holds)

    def _leave(self) -> str:
        """Leave a cell that has become an obstacle, in any gait that leads out; return why not, if none does."""
        begin_s = self.clock.planner_s
        ways = ways_out(self.world, self._pose, self._routed(self.stance.quarter_turns).left)
        refused: dict[Direction, Crossed] = {}
        for gait in OTHER_GAITS:
            for way, cell in ways:
                target = cell, self.stance.quarter_turns
                if way in refused and not refused[way].standing:
                    continue
                crossed = self._planned(target, gait)
                if not crossed.reason:
                    free = partial(self._free, target)
                    self.tally.left += self._send(crossed, begin_s, target, f"{LEAVE} {way}", None, free)
                    return ""
                refused[way] = crossed
        for way, cell in ways:
            self._fail((cell, self.stance.quarter_turns), f"{LEAVE} {way}", None, refused[way])
        return "the robot's own cell has become an obstacle, and no motion leads out of it"

    def _free(self, target: Pose) -> bool:
        """Return whether the robot may still go to a cell."""
        return self.world.state(*target) is not None

    def _planned(self, target: Pose, gait: Gait | FreeGait, certificate: Certificate | None = None) -> Crossed:
        """Solve the program of a transition, and let the time pass that it took."""
        turned = (target[1] - self.stance.quarter_turns + 1) % 4 - 1
        heading = self.stance.quarter_turns + turned
        begin_s = time.process_time()
        problem = crossing(self.robot, self.world, self.stance, target[0], heading, gait, self.limits)
        crossed = cross(problem, certificate, self.limits)
        self.clock = self.clock.planned(time.process_time() - begin_s + self._delay_s())
        if isinstance(gait, Gait):
            self.tally.crossed.append(crossed)
        return crossed

    def _delay_s(self) -> float:
        """Return the injected delay of the segment that is being planned, once."""
        if self.delayed == len(self.segments):
            return 0.0
        self.delayed = len(self.segments)
        return delay_of(self.delays_s, self.delayed)

    def _with_another_gait(self, target: Pose, certified: Gait) -> Crossed | None:
        """Return a motion in a gait that the certificate does not have; None where none is found."""
        for gait in OTHER_GAITS:
            if gait != certified:
                crossed = self._planned(target, gait)
                if not crossed.reason:
                    self.tally.other_gaits += 1
                    return crossed
        return None

    def _settling(self) -> Crossed | None:
        """Return a motion in place that puts the feet where they should be; None where that is of no use."""
        settling = self._planned(self._pose, SETTLING)
        if settling.reason or settling.solution is None or settling.solution.plan is None:
            return None
        moved_m = float(np.abs(settling.solution.plan.feet_m[-1] - self.stance.feet_m).max())
        return settling if moved_m >= _SETTLED_M else None

    def _send(
        self,
        crossed: Crossed,
        begin_s: float,
        target: Pose,
        name: str | None,
        move: tuple[Pose, Pose] | None,
        holds: Callable[[], bool],
    ) -> bool:
        """Send a motion to whoever tracks it, or withdraw it; return whether it was sent."""
        if self._withdrawn(crossed, target, name, holds):
            return False
        assert crossed.solution is not None
        assert crossed.solution.plan is not None
        plan = crossed.solution.plan
        slot, self.clock = self.clock.walked(begin_s, crossed.problem.gait.horizon_s)
        self.tally.slots.append(slot)
        self.tally.idle_for_checks_s += min(slot.idle_s, self.checking_s)
        self.checking_s = 0.0
        segment = Segment(len(self.segments), crossed.problem, plan, slot.start_s)
        self.segments.append(segment)
        self.log.segment(segment, crossed, slot, self.stance, target, name, move)
        self.stance = Stance(*target, plan.base_m[-1], plan.feet_m[-1])
        return True

    def _withdrawn(self, crossed: Crossed, target: Pose, name: str | None, holds: Callable[[], bool]) -> bool:
        """Watch the world until a planned motion begins; return whether what happens leads to another plan.

        A motion that has begun is walked to its end: feet in the air cannot wait.
        """
        begins_s, stance = max(self.clock.planner_s, self.clock.walked_s), self.stance
        for event in sorted(self.waiting, key=lambda one: one.at_s or 0.0):
            if event.at_s is None or event.at_s > begins_s:
                continue
            seen_s = max(self.clock.planner_s, event.at_s)
            self._apply(event, seen_s)
            if self.stance is not stance or not holds() or not still_fits(crossed, self.world):
                self.clock = self.clock.planned(seen_s - self.clock.planner_s)
                self.tally.withdrawn += 1
                self.log.withdrawn(stance, target, name, seen_s)
                return True
        return False

    def _fail(self, target: Pose, name: str, move: tuple[Pose, Pose] | None, crossed: Crossed) -> None:
        """Disallow a transition on this ground; its class may be feasible elsewhere."""
        self.tally.limits += not crossed.infeasible
        self.tally.no_stance += crossed.infeasible and not crossed.standing
        self.failed[self._pose, target] = crossed
        self.log.failed(self.stance, target, name, move, crossed)
