"""Branch and bound over the polygons (and free regions) that are left to every footstep (and window).

A node is a ``Choice``; its program holds the convex hull of what is left, so that its value is a lower bound. A node is
closed when its bound reaches the best plan, when its program is infeasible, or when nothing is left open in it. Bounds
are certified by weak duality (``qp``), never taken from the solver. No decision depends on time, except to stop.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from surefoot.footholds.model import Choice, decided
from surefoot.footholds.nodes import Node
from surefoot.footholds.problem import Problem, impossible_cost
from surefoot.footholds.rows import Array

_INSIDE_M = 1e-7


class Convex(Protocol):
    """What the search needs of a program."""

    def solve(self, choice: Choice) -> Node:
        """Solve the program for what a choice leaves open."""
        ...


@dataclass(slots=True, eq=False)
class Branch:
    """One node of the tree.

    Attributes:
        choice: what is left.
        bound: certified lower bound of its part.
        node: its solved program, if it was solved.
        proof: the branch whose multipliers prove ``bound`` (itself, or an ancestor).
        children: empty for a leaf.
        split: the place of the choice in which the children differ, -1 for a leaf.
    """

    choice: Choice
    bound: float
    node: Node | None = None
    proof: Branch | None = None
    children: list[Branch] = field(default_factory=list)
    split: int = -1


@dataclass(slots=True, eq=False)
class Outcome:
    """What a search found.

    Attributes:
        best: the decided choice of the best plan, or None.
        node: its solved program.
        value: its objective; infinite without a plan.
        bound: certified lower bound of the objective; infinite when infeasibility is proved.
        root: the tree that proves it.
        nodes: how many programs were solved.
        complete: False when a limit stopped the search.
        slack: False when the plan would need forces that the program does not know (see ``accept``).
        pressing: the choice of that plan.
        unproved: how many leaves the solver called infeasible without a ray that proves it.
    """

    root: Branch
    best: Choice | None = None
    node: Node | None = None
    value: float = np.inf
    bound: float = -np.inf
    nodes: int = 0
    complete: bool = True
    slack: bool = True
    pressing: Choice | None = None
    unproved: int = 0


Accept = Callable[[Choice, Node], bool]


def search(
    problem: Problem,
    program: Convex,
    root: Choice,
    *,
    gap: float,
    stop: Callable[[], bool],
    accept: Accept = lambda _c, _n: True,
    guesses: tuple[Choice, ...] = (),
    before: Branch | None = None,
    worth: float = np.inf,
) -> Outcome:
    """Find the best choice, to a relative gap.

    Args:
        problem: what to solve.
        program: of its nodes.
        root: what is left at the start.
        gap: (value - bound) / value at which the search ends.
        stop: asked before every node; True ends the search with what there is.
        accept: asked about every plan; when it says no the search ends with ``slack`` False.
        guesses: decided choices to try first (warm start).
        before: the root of a search with a relaxation of the program, whose bound holds here too.
        worth: plans that cost as much are not looked for.
    """
    started = _Search(problem, program, root, gap, stop, accept)
    started.worth = worth
    if before is not None and before.proof is before:
        started.outcome.root.bound, started.outcome.root.proof = before.bound, before
    return started.run(guesses)


class _Search:
    def __init__(
        self, problem: Problem, program: Convex, root: Choice, gap: float, stop: Callable[[], bool], accept: Accept
    ) -> None:
        self.problem, self.program, self.gap, self.stop, self.accept = problem, program, gap, stop, accept
        self.outcome = Outcome(Branch(root, -np.inf))
        self.worth = np.inf
        self.tried: set[Choice] = set()
        self.closed = np.inf
        self.impossible = impossible_cost(problem)
        self.windows = problem.windows() if problem.options.collision else ()

    def run(self, guesses: tuple[Choice, ...]) -> Outcome:
        outcome = self.outcome
        for guess in guesses:
            self.round(guess)
        heap: list[tuple[float, int, Branch]] = [(outcome.root.bound, 0, outcome.root)]
        count = 1
        while heap:
            if heap[0][0] >= self.enough():
                break
            if self.stop() or not outcome.slack:
                outcome.complete = False
                break
            _, _, branch = heapq.heappop(heap)
            for child in self.expand(branch):
                heapq.heappush(heap, (child.bound, count, child))
                count += 1
        opened = min((bound for bound, _, _ in heap), default=np.inf)
        outcome.bound = min(opened, self.closed)
        return outcome

    def expand(self, branch: Branch) -> list[Branch]:
        """Solve a branch's program; close it, or split it into children."""
        node = self.solved(branch.choice)
        answer = node.answer
        branch.node = node
        if answer.bound >= branch.bound or branch.proof is None:
            branch.bound, branch.proof = max(answer.bound, branch.bound), branch
        if answer.feasible is False:
            return self.close(branch, proved=answer.bound > min(self.outcome.value, self.impossible))
        if branch.bound >= self.enough():
            return self.close(branch)
        if answer.feasible is None:
            return self.close(branch, proved=False) if decided(branch.choice) else self.split_anywhere(branch)
        split, rounded = self.violated(branch.choice, node)
        if decided(branch.choice):
            self.offer(branch.choice, node)
            return self.close(branch)
        self.round(rounded)
        if branch.bound >= self.enough():
            return self.close(branch)
        return self.split(branch, node, split) if split >= 0 else self.split_off(branch, rounded)

    def enough(self) -> float:
        """Return the bound from which on a branch is of no interest."""
        return min(self.outcome.value, self.worth) * (1 - self.gap)

    def solved(self, choice: Choice) -> Node:
        self.outcome.nodes += 1
        return self.program.solve(choice)

    def close(self, branch: Branch, *, proved: bool = True) -> list[Branch]:
        if not proved:
            self.outcome.unproved += 1
        self.closed = min(self.closed, branch.bound)
        return []

    def offer(self, choice: Choice, node: Node) -> None:
        """Take the solution of a decided choice as a plan, if it is better."""
        if node.answer.feasible and node.answer.value < self.outcome.value:
            self.take(choice, node)

    def take(self, choice: Choice, node: Node) -> None:
        if not self.accept(choice, node):
            self.outcome.slack, self.outcome.pressing = False, choice
            return
        self.outcome.best, self.outcome.node, self.outcome.value = choice, node, node.answer.value

    def round(self, choice: Choice) -> None:
        """Try the plan that decides everything as the relaxed solution suggests."""
        if choice in self.tried:
            return
        self.tried.add(choice)
        self.offer(choice, self.solved(choice))

    def violated(self, choice: Choice, node: Node) -> tuple[int, Choice]:
        """Return the place whose choices the solution obeys least (-1: all are obeyed), and the nearest decision."""
        worst, place, nearest = _INSIDE_M, -1, []
        for number, step in enumerate(self.problem.footsteps):
            point = node.feet[step.touch, step.foot]
            distances = [self.problem.polygons[r].excess(point) for r in choice[number]]
            best = int(np.argmin(distances))
            if len(distances) > 1 and distances[best] > worst:
                spans = [np.linalg.norm(self.problem.polygons[r].nearest(point) - point) for r in choice[number]]
                best = int(np.argmin(spans))
                worst, place = max(worst, float(distances[best])), number
            nearest.append((choice[number][best],))
        steps = len(self.problem.footsteps)
        for number, regions in enumerate(choice[steps:], start=steps):
            excess = self.window_excess(number - steps, regions, node.feet)
            best = int(np.argmin(excess))
            if len(regions) > 1 and excess[best] > worst:
                worst, place = float(excess[best]), number
            nearest.append((regions[best],))
        return place, tuple(nearest)

    def window_excess(self, number: int, regions: tuple[int, ...], feet: Array) -> list[float]:
        foot, window = divmod(number, len(self.windows))
        points = feet[list(self.windows[window]), foot]
        return [
            float((points @ matrix.T - bound).max())
            for matrix, bound in map(self.problem.free_regions.__getitem__, regions)
        ]

    def split(self, branch: Branch, node: Node, place: int) -> list[Branch]:
        """Cut what is left at a place in two so that neither hull holds the solution, where that is possible."""
        left = branch.choice[place]
        if place >= len(self.problem.footsteps):
            return self.children(branch, place, [(region,) for region in left])
        step = self.problem.footsteps[place]
        point = node.feet[step.touch, step.foot]
        spans = [self.problem.polygons[r].nearest(point) - point for r in left]
        nearest = int(np.argmin([np.linalg.norm(span) for span in spans]))
        ahead = spans[nearest]
        beyond = [float(((self.problem.polygons[r].vertices_m - point) @ ahead).min()) > 1e-12 for r in left]
        if all(beyond) or not any(beyond):
            beyond = [index == nearest for index in range(len(left))]
        groups = [
            tuple(r for r, is_beyond in zip(left, beyond, strict=True) if is_beyond is side) for side in (True, False)
        ]
        return self.children(branch, place, groups)

    def split_off(self, branch: Branch, rounded: Choice) -> list[Branch]:
        """Cut one decision off where the points fit, but cones or windows of several choices were mixed."""
        place = next(i for i, left in enumerate(branch.choice) if len(left) > 1)
        rest = tuple(r for r in branch.choice[place] if r != rounded[place][0])
        return self.children(branch, place, [rounded[place], rest])

    def split_anywhere(self, branch: Branch) -> list[Branch]:
        place = next(i for i, left in enumerate(branch.choice) if len(left) > 1)
        left = branch.choice[place]
        return self.children(branch, place, [left[: len(left) // 2], left[len(left) // 2 :]])

    def children(self, branch: Branch, place: int, groups: list[tuple[int, ...]]) -> list[Branch]:
        branch.split = place
        for group in groups:
            choice = (*branch.choice[:place], group, *branch.choice[place + 1 :])
            branch.children.append(Branch(choice, branch.bound, proof=branch.proof))
        return branch.children
