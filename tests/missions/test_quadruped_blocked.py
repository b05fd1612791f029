"""What a mission says is in the way: steps by the rules, skills that physics refuses, obstacles that appeared."""

from __future__ import annotations

from surefoot.footholds.terrain import polygon
from surefoot.missions.quadruped.blocked import Blockade
from surefoot.missions.quadruped.world import World
from surefoot.skills import Knowledge, QuadrupedTerrain, class_set
from surefoot.skills.patches import Rectangle
from surefoot.skills.values import CheckResult, Direction, Physics, Primitive

RULES = class_set("stairs")
UP = Primitive(Direction.FORWARD, "flat", "high")


def corridor(*heights_m: float) -> World:
    """Return plates of one cell each, one ahead of the other."""
    side, margin = 0.3, 0.02
    plates = [
        polygon(Rectangle(k * side, 0.0, (k + 1) * side, side).shrunk(margin).corners(height))
        for k, height in enumerate(heights_m)
    ]
    cells = (len(heights_m), 1)
    return World(QuadrupedTerrain("stairs", "go2", RULES, side, (3, 3), (0.0, 0.0), cells, tuple(plates), margin))


def refused(primitive: Primitive) -> Knowledge:
    why = "trot-2s: reach short by 3 cm"
    return Knowledge({primitive: CheckResult(primitive, Physics.INFEASIBLE, "trot-2s", why, 0.1)})


def test_nothing_is_in_the_way_of_what_the_rules_allow() -> None:
    assert Blockade(corridor(0.0, 0.15, 0.3), Knowledge(), {}, None).between((2, 0), (0, 0)) == ()


def test_a_refused_skill_is_named_with_its_explanation() -> None:
    found = Blockade(corridor(0.0, 0.15, 0.15), refused(UP), {}, None).between((2, 0), (0, 0))
    assert [(one.cell, one.coming_from, one.why) for one in found] == [((1, 0), (2, 0), ())]
    assert found[0].text == "physics refuses forward flat->high: trot-2s: reach short by 3 cm"


def test_a_step_beyond_the_rules_comes_with_its_measure() -> None:
    (found,) = Blockade(corridor(0.0, 0.0, 0.3), Knowledge(), {}, None).between((2, 0), (0, 0))
    assert (found.cell, found.coming_from) == ((0, 0), (1, 0))
    assert [(one.measure, round(one.value, 6), one.high) for one in found.why] == [("rise_m", 0.3, 0.201)]


def test_what_appeared_is_in_the_way() -> None:
    world = corridor(0.0, 0.0, 0.0).with_obstacle(Rectangle(0.3, 0.0, 0.32, 0.02))
    (found,) = Blockade(world, Knowledge(), {}, None).between((2, 0), (0, 0))
    assert (found.cell, found.text) == ((1, 0), "something stands there")
