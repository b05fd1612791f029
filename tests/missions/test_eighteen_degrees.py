"""Quarter turns of five steps of 18 degrees at cells of 1 m: which numbers walk for ever (docs/missions.md 5)."""

from __future__ import annotations

from pathlib import Path

import pytest

from surefoot.missions.plans.trial import Trial, trial_walks
from surefoot.missions.scenario.scene import read_biped_scene
from surefoot.navigation import Order, action_rules, build_action_game, order_context, solve_action


def trial(scenario: Path, walks: int) -> Trial:
    """Walk under random orders."""
    scene = read_biped_scene(scenario)
    rules = action_rules(scene.coarse, scene.library)
    context = order_context(scene.coarse, scene.problem.start, Order(scene.problem.heading, waits=False))
    middle = scene.walking.fine_cells / 2
    _, strategy, start = solve_action(build_action_game(rules, scene.problem.heading, context), middle, middle)
    assert strategy is not None
    assert start is not None
    return trial_walks(scene, rules, strategy, start, rules.contexts.index(context), walks)


@pytest.mark.campaign
def test_the_laboratory_walks_whatever_is_ordered(scenes: Path) -> None:
    found = trial(scenes / "laboratory_mission.yaml", 100)
    assert found.unsafe == 0, found.reason
    assert found.steps == 100 * 500


@pytest.mark.campaign
def test_faster_apexes_leave_short_steps_no_time(scenes: Path, tmp_path: Path) -> None:
    text = (scenes / "laboratory_mission.yaml").read_text().replace("map: ", f"map: {scenes}/")
    assert "apex_speed_mps: [0.11, 0.7]" in text
    scenario = tmp_path / "mission.yaml"
    scenario.write_text(text.replace("apex_speed_mps: [0.11, 0.7]", "apex_speed_mps: [0.2, 0.7]"))
    assert trial(scenario, 20).unsafe > 0
