"""The coarse side of a walk: orders, belief, goals, and the watch over the obstacles' assumptions.

Once a turn the navigator gives an order, and when the robot has carried it out it looks where the obstacles are. As
long as they keep their assumptions the strategy has an answer. When they do not, the robot stops and plans again from
what it sees.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass

from surefoot.errors import CertificateRejected
from surefoot.frames import Direction
from surefoot.missions.biped.legs import Legs
from surefoot.missions.biped.monitor import (
    VIOLATIONS,
    Seen,
    Violation,
    explained,
    reset,
    safe_order,
    seen_of,
    violations,
)
from surefoot.missions.biped.replanning import Guide, replanned
from surefoot.missions.obstacles.policies import Crowd
from surefoot.missions.run_writer import RunWriter
from surefoot.missions.scenario.scene import BipedScene
from surefoot.navigation import NavigationStrategy, ObstacleKinds, ObstacleState, Order

NO_STRATEGY = -1


@dataclass(frozen=True, slots=True)
class Counts:
    """What a navigator counts.

    Attributes:
        belief_violations: turns at which an obstacle that the robot did not see was outside its belief.
        assumption_violations: assumptions that the robot saw broken.
        replans: new strategies.
        replan_ms_max: the longest time that one took [ms], successful or not.
        reactions: legs between goals by reaction.
    """

    belief_violations: int
    assumption_violations: int
    replans: int
    replan_ms_max: float
    reactions: dict[str, int]


class Navigator:
    """The coarse side of a walk in progress.

    Args:
        scene: the scenario on its map.
        strategy: the plan's.
        crowd: the true obstacles.
        writer: of the log.
        progress: is told what happens.
    """

    def __init__(
        self,
        scene: BipedScene,
        strategy: NavigationStrategy,
        crowd: Crowd,
        writer: RunWriter,
        progress: Callable[[str], None],
    ) -> None:
        self.scene, self.crowd, self.writer, self.progress = scene, crowd, writer, progress
        problem = scene.problem
        self.guide: Guide | None = Guide.of(0, problem, strategy)
        self.kinds: ObstacleKinds = problem.obstacle_kinds
        self.cell, self.heading, self.turn, self.goal = problem.start, problem.heading, -1, 0
        self.knowledge: ObstacleState = self.guide.rules.start()
        self.goals_reached = [0] * len(problem.goals)
        self._legs = Legs(scene.coarse, self.cell, self.heading)
        self._left = self._view = self.cell
        self._broken: tuple[Violation, ...] = ()
        self._strategies, self._stops = 0, 0
        self._belief_violations = self._assumption_violations = 0
        self._replan_ms_max = 0.0
        self._book_goal(steps=0)

    @property
    def counts(self) -> Counts:
        """Return what has been counted so far."""
        return Counts(
            self._belief_violations,
            self._assumption_violations,
            self._strategies,
            self._replan_ms_max,
            dict(self._legs.counts),
        )

    def decide(self, time_s: float, *, standing: bool) -> Order:
        """Return the next order, and log the turn."""
        self.turn += 1
        self._report_violations(time_s)
        if self.guide is None and standing and self._stops:
            self._replan(time_s)
        if self.guide is None:
            self._stops += 1
            order = safe_order(self.scene.coarse, self.cell, self.heading)
            number = NO_STRATEGY
        else:
            order, number = self._asked(self.guide), self.guide.number
        self.writer.write(
            "turn",
            turn=self.turn,
            time_s=time_s,
            cell=self._place(self.cell),
            heading=self.heading.name.lower(),
            goal=self.goal,
            obstacles=self._places(self.crowd.cells),
            **self._known(),
            order=str(order),
            strategy=number,
        )
        return order

    def arrive(self, cell: int, heading: Direction, steps: int) -> None:
        """Book the cell that a move has led to, and its goal."""
        self._left, self.cell, self.heading = self.cell, cell, heading
        self._legs.order(Order(heading, waits=False))
        self._book_goal(steps)

    def finish_turn(self, order: Order) -> None:
        """Let the obstacles move, and look where they are."""
        if order.waits:
            self._left = self.cell
            self._legs.order(order)
        self.crowd.move(self.turn, self._left, order)
        self._view = self.cell if self.scene.problem.view == "post" else self._left
        seen = seen_of(self.scene.coarse, self.kinds, self.crowd.cells, self._view)
        if self.guide is None:
            self._reset(seen)
            return
        rules = self.guide.rules
        outcomes = rules.outcomes(self._left, self.cell, order, self.knowledge)
        known = explained(outcomes, seen)
        if known is None:
            self._broken = violations(rules, self._left, order, self.knowledge, outcomes, seen)
            self.guide, self._stops = None, 0
            self._reset(seen)
            return
        self.knowledge = known
        self._check_belief()

    def _book_goal(self, steps: int) -> None:
        """Book a goal that the robot has come to."""
        goals = self.scene.problem.goals
        if self.cell != goals[self.goal]:
            return
        self.goals_reached[self.goal] += 1
        self.progress(f"step {steps}: goal {self.goal} reached ({self.goals_reached[self.goal]})")
        self.goal = (self.goal + 1) % len(goals)
        if self.turn >= 0:
            self._legs.finish(self.cell, self.heading)

    def _asked(self, guide: Guide) -> Order:
        try:
            return guide.decide(self.cell, self.heading, self.knowledge, self.goal)
        except KeyError as problem:
            raise CertificateRejected("the navigation strategy has no order for where the robot is") from problem

    def _check_belief(self) -> None:
        """Count a turn in which the belief lacks an obstacle that the robot does not see."""
        sees, truth = self.scene.coarse.sees, self.crowd.cells
        lacking = (
            not sees[self._view, truth[number]] and not hidden & self.kinds.mask((truth[number],))
            for kind, hidden in zip(self.kinds, self.knowledge.hidden, strict=True)
            for number in kind.obstacles
        )
        self._belief_violations += any(lacking)

    def _reset(self, seen: Seen) -> None:
        """Forget everything but what is seen."""
        self.kinds = self.scene.problem.obstacle_kinds
        self.knowledge = ObstacleState(seen, reset(self.kinds, self._view, seen))

    def _report_violations(self, time_s: float) -> None:
        for broken in self._broken:
            cell = None if broken.cell is None else self._place(broken.cell)
            self.writer.write("violation", turn=self.turn, time_s=time_s, **{**asdict(broken), "cell": cell})
            told = f"an obstacle {VIOLATIONS[broken.violation]}; the robot stops and plans again"
            self.progress(f"decision {self.turn}: {told}")
        self._assumption_violations += len(self._broken)
        self._broken = ()

    def _replan(self, time_s: float) -> None:
        """Plan again from what is seen, if that can be won."""
        number = self._strategies + 1
        attempt = replanned(
            self.scene.problem, number, self.cell, self.heading, self.goal, self._view, self.knowledge.visible
        )
        self._replan_ms_max = max(self._replan_ms_max, attempt.took_ms)
        if attempt.guide is None:
            return
        self.guide, self._strategies = attempt.guide, number
        self.kinds, self.knowledge = attempt.guide.rules.kinds, attempt.guide.rules.start()
        path = self.writer.folder / f"replan_{number}.npz"
        self.writer.write(
            "replan",
            turn=self.turn,
            time_s=time_s,
            strategy=number,
            cell=self._place(self.cell),
            heading=self.heading.name.lower(),
            goal=self.goal,
            **self._known(),
            domains=[self._places(self.kinds.members(kind.within)) for kind in self.kinds],
            path=path.name,
            sha256=attempt.guide.save(path),
        )

    def _known(self) -> dict[str, list[list[list[int]]]]:
        return {
            "visible": [self._places(cells) for cells in self.knowledge.visible],
            "hidden": [self._places(self.kinds.members(mask)) for mask in self.knowledge.hidden],
        }

    def _place(self, cell: int) -> list[int]:
        return list(self.scene.grid.cell(cell))

    def _places(self, cells: tuple[int, ...] | list[int]) -> list[list[int]]:
        return [self._place(cell) for cell in cells]
