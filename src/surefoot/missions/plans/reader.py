"""Reads a saved plan back for walking it."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from surefoot.compute import sha256_of
from surefoot.errors import InputError
from surefoot.missions.plans.document import read_plan_document
from surefoot.missions.scenario.scene import BipedScene
from surefoot.navigation import (
    ActionRules,
    ActionStrategy,
    NavigationStrategy,
    action_rules,
    load_action_strategy,
    load_navigation_strategy,
)


def _again(folder: Path, scene: BipedScene) -> str:
    return f"plan again with: surefoot plan {scene.path} -o {folder}"


def _stale(folder: Path, name: str, given: Path, scene: BipedScene) -> str:
    """Return why an input does not fit a plan: it is another file than the one it was made for, or was edited."""
    made_for = folder / name
    if made_for.resolve() == given.resolve():
        return f"{given} was edited since the plan was made; {_again(folder, scene)}"
    own = f"name the plan of that one, or make it with: surefoot plan {scene.path} -o FOLDER"
    return f"was made for {os.path.normpath(made_for)}, not for {given}; {own}"


@dataclass(frozen=True, slots=True)
class BipedPlan:
    """A plan, ready to be walked.

    Attributes:
        navigation: which order to give.
        action: which walking action to take.
        rules: the action game that it was made for.
        fine_start: fine row and column where the robot stands at the start.
    """

    navigation: NavigationStrategy
    action: ActionStrategy
    rules: ActionRules
    fine_start: tuple[int, int]


def read_plan(folder: Path, scene: BipedScene) -> BipedPlan:
    """Read a plan folder and make sure that it was made for a scenario.

    Raises:
        InputError: if it is not a whole plan, or one made for another scenario or map.
    """
    document = read_plan_document(folder)
    path = folder / "plan.json"
    try:
        places, inputs = document["map"], scene.occupancy
        expected = [
            (scene.path, document["scenario"]["path"], document["scenario"]["sha256"]),
            (inputs.path, places["path"], places["sha256"]),
            (inputs.image_path, places["image_path"], places["image_sha256"]),
        ]
        own = [(folder / name, document["files"][name]) for name in ("navigation.npz", "action.npz")]
        fine_start = document["start"]["fine"]
        start = int(fine_start["row"]), int(fine_start["column"])
    except (KeyError, TypeError, ValueError) as problem:
        raise InputError(f"lacks {problem} or holds another type there; plan again", source=path) from problem
    for input_path, name, digest in expected:
        if sha256_of(input_path) != digest:
            raise InputError(_stale(folder, str(name), input_path, scene), source=path)
    for part, digest in own:
        if not part.is_file() or sha256_of(part) != digest:
            what = "is not the one that the plan was saved with" if part.is_file() else "is missing"
            raise InputError(f"{part.name} {what}; {_again(folder, scene)}", source=path)
    kinds = tuple(kind.obstacles for kind in scene.problem.obstacle_kinds)
    return BipedPlan(
        load_navigation_strategy(folder / "navigation.npz", scene.problem.goals, kinds),
        load_action_strategy(folder / "action.npz"),
        action_rules(scene.coarse, scene.library),
        start,
    )
