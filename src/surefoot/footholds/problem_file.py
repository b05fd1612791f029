"""Problem files: YAML or JSON text becomes a ``Problem``, or every complaint about it with file, line and key."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from surefoot.documents import Document, FileProblems, Loc, dotted, problems_of, read_yaml
from surefoot.errors import InputError
from surefoot.footholds.cells import check_cells
from surefoot.footholds.gaits import NAMED, FreeGait, Gait, contact_table, mode_contacts, read_gait
from surefoot.footholds.problem import Options, Problem, Weights, nominal_feet
from surefoot.footholds.problem_blocks import Block, ProblemBlock, RobotBlock
from surefoot.footholds.terrain import Polygon, PolygonError, polygon
from surefoot.robots.quadruped import FOOT_NAMES, Quadruped, quadruped, quadruped_names

_REACH_TOLERANCE_M = 1e-9
_ON_M = 1e-6
_SINGULAR = 1e-6

FREE = "free"
"""The word for a gait that is to be found."""


def read_problem(path: Path) -> Problem:
    """Read and check a problem file.

    Args:
        path: YAML or JSON, as `surefoot footholds schema` says.

    Raises:
        InputError: with every problem of the file, one sentence and one line of text each.
    """
    path = Path(path)
    document = read_yaml(path)
    if not isinstance(document.value, dict):
        raise InputError("must be a mapping of keys to values, such as `robot: go2`", source=path, line=1)
    block = _validated(ProblemBlock, document, path)
    return _Reading(path, document.lines).problem(block)


def problem_schema() -> dict[str, Any]:
    """Return the JSON Schema of a problem file."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **ProblemBlock.model_json_schema(),
        "title": "Surefoot foothold problem, format 1",
    }


def _validated(kind: type[Any], document: Document, path: Path) -> Any:
    problems = list(document.problems)
    try:
        block: Block = kind.model_validate(document.value)
    except ValidationError as refused:
        problems += problems_of(refused, kind.model_json_schema(), path, document.lines)
        raise FileProblems(problems) from None
    if problems:
        raise FileProblems(problems)
    return block


def read_robot(path: Path) -> Quadruped:
    """Read a robot file.

    Raises:
        InputError: with every problem of the file.
    """
    document = read_yaml(path)
    block: RobotBlock = _validated(RobotBlock, document, path)
    values = block.model_dump(exclude={"format"})
    robot = Quadruped(**values, source=str(path))
    if min(abs(float(np.linalg.det(np.array(j)))) for j in robot.jacobians) < _SINGULAR:
        raise InputError(
            "stretches a leg so far that its Jacobian is singular; bend the knee",
            source=path,
            key="joint_reference_rad",
        )
    return robot


class _Reading:
    """What only several keys together can tell about a problem file."""

    def __init__(self, path: Path, lines: dict[Loc, int]) -> None:
        self.path, self.lines = path, lines
        self.problems: list[InputError] = []

    def complain(self, message: str, *loc: str | int) -> None:
        known = next((loc[:size] for size in range(len(loc), -1, -1) if loc[:size] in self.lines), ())
        line = self.lines.get(known)
        self.problems.append(InputError(message, source=self.path, line=line, key=dotted(loc) or None))

    def problem(self, block: ProblemBlock) -> Problem:
        robot, gait = self.robot(block.robot), self.gait(block)
        polygons = [self.polygon(number, given) for number, given in enumerate(block.polygons)]
        regions = self.regions(block)
        if self.problems or robot is None or gait is None:
            raise FileProblems(self.problems)
        start, goal = block.start, block.goal
        feet = start.feet_m
        problem = Problem(
            robot=robot,
            gait=gait,
            step_s=block.step_s,
            start_m=np.array(start.position_m),
            start_rpy_rad=np.array(start.rpy_rad),
            feet_m=nominal_feet(robot, np.array(start.position_m), np.array(start.rpy_rad))
            if feet is None
            else np.array(feet),
            goal_m=np.array(goal.position_m),
            goal_rpy_rad=np.array(goal.rpy_rad),
            polygons=tuple(one for one in polygons if one is not None),
            free_regions=regions,
            options=Options(**block.options.model_dump()),
            weights=Weights(**block.weights.model_dump()),
            gravity_mps2=block.gravity_mps2,
            source=self.path,
        )
        self.check_feet(problem, given=feet is not None)
        if self.problems:
            raise FileProblems(self.problems)
        return problem

    def robot(self, name: str) -> Quadruped | None:
        if name in quadruped_names():
            return quadruped(name)
        path = self.path.parent / name
        if ("/" in name or "." in name) and _is_file(path):
            return read_robot(path)
        self.complain(
            f"there is no robot {name!r}; there are {', '.join(quadruped_names())}, or give the path of a robot file",
            "robot",
        )
        return None

    def gait(self, block: ProblemBlock) -> Gait | FreeGait | None:
        if block.gait == FREE:
            return self.free_gait(block)
        if block.horizon_s is not None:
            self.complain(f"is for `gait: {FREE}`; the gait that is given has its own horizon", "horizon_s")
        return self.fixed_gait(block)

    def free_gait(self, block: ProblemBlock) -> FreeGait | None:
        if block.horizon_s is None:
            self.complain(f"is {FREE}, which needs `horizon_s: ...`, how long the gait lasts in seconds", "gait")
            return None
        options = block.options
        if options.joint_reach:
            self.complain("is for gaits that are given, not for a free one", "options", "joint_reach")
        try:
            check_cells(block.horizon_s, options.cell_s, block.step_s, options.min_dwell_cells)
        except InputError as problem:
            self.complain(problem.message, *(problem.key or "").split("."))
            return None
        return FreeGait(block.horizon_s)

    def fixed_gait(self, block: ProblemBlock) -> Gait | None:
        given = block.gait
        try:
            if not isinstance(given, str):
                gait = Gait(given.modes, given.switching_times_s)
            elif given in NAMED:
                gait = NAMED[given]
            elif _is_file(self.path.parent / given):
                gait = read_gait(self.path.parent / given)
            else:
                self.complain(
                    f"there is no gait {given!r}; there are {FREE}, {', '.join(NAMED)}, or give the path of a gait "
                    "file",
                    "gait",
                )
                return None
            for mode in gait.modes:
                mode_contacts(mode)
            contact_table(gait, block.step_s)
        except InputError as problem:
            if problem.source is not None:
                raise
            self.complain(problem.message, *(problem.key or "gait").split("."))
            return None
        return gait

    def polygon(self, number: int, given: Any) -> Polygon | None:
        try:
            return polygon(given.vertices_m, given.friction)
        except PolygonError as problem:
            self.complain(str(problem), "polygons", number, "vertices_m")
            return None

    def regions(self, block: ProblemBlock) -> tuple[tuple[np.ndarray, np.ndarray], ...]:
        for number, region in enumerate(block.free_regions):
            if len(region.A) != len(region.b):
                self.complain(
                    f"needs as many bounds as A has rows, {len(region.A)}, not {len(region.b)}",
                    "free_regions",
                    number,
                    "b",
                )
        if block.options.collision and not block.free_regions:
            self.complain("is true, which needs at least one of free_regions", "options", "collision")
        return tuple((np.array(region.A), np.array(region.b)) for region in block.free_regions)

    def check_feet(self, problem: Problem, *, given: bool) -> None:
        """Refuse start feet that stand on nothing, or out of reach."""
        reach = np.array(problem.robot.foot_reach_m)
        for foot, name in enumerate(FOOT_NAMES):
            loc: tuple[str | int, ...] = ("start", "feet_m", foot) if given else ("start",)
            whose = f"the {name} foot at {_point(problem.feet_m[foot])}" + (
                "" if given else " (nominal, as feet_m is left out)"
            )
            off = problem.rotations[0].T @ (problem.feet_m[foot] - problem.start_m) - np.array(
                problem.robot.feet_m[foot]
            )
            if problem.start_polygons[foot] < 0:
                self.complain(
                    f"{whose} stands outside every polygon; it has to stand on one (within {_ON_M:g} m)", *loc
                )
            elif (np.abs(off) > reach + _REACH_TOLERANCE_M).any():
                self.complain(
                    f"{whose} is out of reach of the base; allowed is {_point(reach)} m about its nominal place", *loc
                )


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def _point(values: Any) -> str:
    return "(" + ", ".join(f"{value:.4g}" for value in values) + ")"
