"""Reads a saved plan back for walking it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from surefoot.compute import sha256_of
from surefoot.errors import InputError
from surefoot.missions.biped_scene import BipedScene
from surefoot.missions.plan_document import read_plan_document
from surefoot.navigation import (
    ActionRules,
    ActionStrategy,
    NavigationStrategy,
    action_rules,
    load_action_strategy,
    load_navigation_strategy,
)


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
        expected = [
            (scene.path, document["scenario"]["sha256"]),
            (scene.occupancy.path, document["map"]["sha256"]),
            (scene.occupancy.image_path, document["map"]["image_sha256"]),
            *((folder / name, document["files"][name]) for name in ("navigation.npz", "action.npz")),
        ]
        fine_start = document["start"]["fine"]
        start = int(fine_start["row"]), int(fine_start["column"])
    except (KeyError, TypeError, ValueError) as problem:
        raise InputError(f"lacks {problem} or holds another type there; plan again", source=path) from problem
    for input_path, digest in expected:
        if not input_path.is_file() or sha256_of(input_path) != digest:
            raise InputError(
                f"was made for another {input_path.name} than {input_path}; plan again with: "
                f"surefoot plan {scene.path} -o {folder}",
                source=path,
            )
    kinds = tuple(kind.obstacles for kind in scene.problem.obstacle_kinds)
    return BipedPlan(
        load_navigation_strategy(folder / "navigation.npz", scene.problem.goals, kinds),
        load_action_strategy(folder / "action.npz"),
        action_rules(scene.coarse, scene.library),
        start,
    )
