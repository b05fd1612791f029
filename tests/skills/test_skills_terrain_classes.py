from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surefoot.errors import InputError
from surefoot.footholds.terrain import Polygon, polygon
from surefoot.skills.classes import MEASURES, SHIPPED, ClassSet, class_set, read_classes
from surefoot.skills.measures import NONE, SINGLE, Ground
from surefoot.skills.patches import Rectangle, class_polygons
from surefoot.skills.values import OBSTACLE

COUNTS = {"unstructured-4": 4, "unstructured-8": 8, "rebar-7": 7, "rebar-14": 14, "stairs": 3}
FLAT = {
    "coverage": 1.0, "band_m": 0.0, "largest": 1.0, "spacing_m": math.inf, "rise_m": 0.0, "spread_m": 0.0,
    "slope_deg": 0.0,
}  # fmt: skip
STONES = {**FLAT, "coverage": 0.5, "largest": 0.06, "band_m": 0.05}


def cell_of(rules: ClassSet) -> Rectangle:
    half = rules.cell_m / 2
    return Rectangle(-half, -half, half, half)


def nearly_worst(rules: ClassSet, name: str) -> tuple[Polygon, ...]:
    """Return the worst case of a class, a hair's breadth within its half-open levels."""
    ground = rules.classes[name].ground
    ways = {key: 0.999 * value for key in ("across", "along") if isinstance(value := getattr(ground, key), float)}
    ground = ground.model_copy(update=ways)
    return class_polygons(ground, rules.cell_m, rules.margin_m, np.array([0.0, 0.0, ground.height_m]))


def label(rules: ClassSet, polygons: tuple[Polygon, ...], support_m: float = 0.0) -> str:
    measured = Ground(polygons, rules.margin_m, rules.measures).measure(cell_of(rules))
    return rules.classify(measured.seen_from(support_m))


@pytest.mark.parametrize(("name", "count"), COUNTS.items())
def test_shipped_sets_claim_every_combination_once(name: str, count: int) -> None:
    rules = class_set(name)
    assert len(rules.classes) == count
    assert len(rules.claims) == math.prod(len(levels) for levels in rules.levels.values())
    assert set(rules.claims.values()) == {*rules.names, OBSTACLE}


@pytest.mark.parametrize("name", COUNTS)
def test_the_worst_case_of_a_class_is_of_the_class(name: str) -> None:
    rules = class_set(name)
    assert {one: label(rules, nearly_worst(rules, one)) for one in rules.names} == {one: one for one in rules.names}


@pytest.mark.parametrize(
    ("measured", "expected"),
    [
        (FLAT, "flat"),
        ({**FLAT, "rise_m": 0.12}, "high"),
        ({**FLAT, "rise_m": -0.12}, "low"),
        ({**FLAT, "rise_m": 0.05}, "high"),
        ({**FLAT, "rise_m": 0.31}, OBSTACLE),
        ({**FLAT, "slope_deg": 31.0}, OBSTACLE),
        ({**FLAT, "coverage": 0.0, "largest": 0.0}, OBSTACLE),
        ({**STONES, "spacing_m": 0.05}, "dense"),
        ({**STONES, "spacing_m": 0.15}, "sparse"),
        ({**STONES, "spacing_m": 0.15, "rise_m": 0.12}, OBSTACLE),
        ({**STONES, "band_m": 0.30}, "gap"),
        ({**STONES, "band_m": 0.30, "rise_m": 0.12}, "high gap"),
        ({**STONES, "band_m": 0.30, "rise_m": -0.12}, "low gap"),
        ({**STONES, "band_m": 0.40}, OBSTACLE),
        ({**FLAT, "spread_m": 0.13}, OBSTACLE),
    ],
)
def test_ground_rules(measured: dict[str, float], expected: str) -> None:
    assert class_set("unstructured-8").classify(measured) == expected


def test_four_classes_know_no_heights() -> None:
    rules = class_set("unstructured-4")
    assert rules.classify({**FLAT, "rise_m": 0.12}) == OBSTACLE
    assert rules.classify({**STONES, "band_m": 0.30}) == "gap"


@pytest.mark.parametrize(
    ("across", "along", "fourteen", "seven"),
    [
        (0.20, 0.30, "sparse-sparse", "sparse-sparse"),
        (0.10, 0.10, "sparse-sparse", "sparse-sparse"),
        (0.04, 0.30, "dense-sparse", "dense-sparse"),
        (0.35, 0.30, "extreme-sparse", OBSTACLE),
        (SINGLE, 0.30, "single-sparse", "single-sparse"),
        (0.30, NONE, "sparse-none", "sparse-none"),
        (SINGLE, SINGLE, OBSTACLE, OBSTACLE),
        (SINGLE, NONE, OBSTACLE, OBSTACLE),
        (NONE, 0.50, "none-extreme", OBSTACLE),
    ],
)
def test_rebar_rules(across: float, along: float, fourteen: str, seven: str) -> None:
    measured = {"across_m": across, "along_m": along, "rise_m": 0.0, "spread_m": 0.0}
    assert class_set("rebar-14").classify(measured) == fourteen
    assert class_set("rebar-7").classify(measured) == seven


@pytest.mark.parametrize("name", COUNTS)
def test_turning_a_label_is_turning_the_ground(name: str) -> None:
    rules = class_set(name)
    for one in rules.names:
        polygons = nearly_worst(rules, one)
        turned = tuple(polygon([[-y, x, z] for x, y, z in each.vertices_m.tolist()]) for each in polygons)
        assert label(rules, turned) == rules.turned(one, 1)
        assert rules.turned(rules.turned(one, 1), 1) == rules.turned(one, 2) == one
    assert rules.turned(OBSTACLE, 1) == OBSTACLE


@settings(max_examples=60, deadline=None)
@given(
    name=st.sampled_from(["unstructured-8", "rebar-14"]),
    numbers=st.lists(st.floats(-2, 200, allow_nan=False), min_size=7, max_size=7),
)
def test_any_measures_have_a_class(name: str, numbers: list[float]) -> None:
    rules = class_set(name)
    measured = dict(zip(MEASURES[rules.measures], numbers, strict=False))
    assert rules.classify(measured) in {*rules.names, OBSTACLE}


def test_a_bar_beside_the_cell_counts_for_the_spacing() -> None:
    bars = [
        polygon([[x - 0.005, -1, 0], [x + 0.005, -1, 0], [x + 0.005, 1, 0], [x - 0.005, 1, 0]]) for x in (-0.2, -0.1)
    ]
    cell = Rectangle(-0.3, -0.3, 0.3, 0.3)
    alone = Ground(bars, 0.01, "bars").measure(cell).values
    assert alone["across_m"] == pytest.approx(0.4)  # nothing follows up to the far side
    more = [*bars, polygon([[0.345, -1, 0], [0.355, -1, 0], [0.355, 1, 0], [0.345, 1, 0]])]
    assert Ground(more, 0.01, "bars").measure(cell).values["across_m"] == pytest.approx(0.45)


def test_a_gap_cut_by_the_side_of_a_cell_keeps_its_width() -> None:
    plates = [polygon([[x, -1, 0], [x + 1, -1, 0], [x + 1, 1, 0], [x, 1, 0]]) for x in (-0.75, 0.52)]
    measured = Ground(plates, 0.0, "ground").measure(Rectangle(-0.4, -0.4, 0.4, 0.4))
    assert measured.values["band_m"] == pytest.approx(0.27, abs=1e-4)


RULES = SHIPPED.read_text()


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("      - {coverage: nothing}\n", "", "claimed by no rule"),
        (
            "    classes:\n",
            "    classes:\n      moat: {when: [{coverage: []}], ground: {pattern: whole}}\n",
            "moat: is covered by no rule",
        ),
        ("rise_m: level, spread_m", "rise_m: [level, above], spread_m", "claimed by flat and high"),
        ("largest: whole, rise_m: level", "largest: huge, rise_m: level", "has no level huge"),
        ("{spread_m: uneven}", "{roughness: uneven}", "is no measure"),
        ("{name: whole}", "{name: whole, below: 2}", "needs `below` for every level but the last"),
        ("robot: go2", "robot: spot", "there is no robot 'spot'"),
        ("- [flat, flat]", "- [flat, fat]", "there is no class fat"),
        ("pattern: stones, per_side: 3", "pattern: rocks, per_side: 3", "pattern"),
        ("across: 0.56, along: none", "across: 0.55, along: none", "has no counterpart after a quarter turn"),
        ("    measures: ground", "    measures: bars", "needs levels of exactly across_m"),
    ],
)
def test_rules_that_leave_doubt_are_refused(tmp_path: Path, old: str, new: str, said: str) -> None:
    path = tmp_path / "rules.yaml"
    assert old in RULES
    path.write_text(RULES.replace(old, new, 1))
    with pytest.raises(InputError, match=said) as refused:
        read_classes(path)
    assert str(path) in str(refused.value)


def test_other_rules_have_another_digest(tmp_path: Path) -> None:
    path = tmp_path / "rules.yaml"
    path.write_text(RULES.replace("below: 0.20}", "below: 0.21}"))
    assert read_classes(path)["unstructured-8"].digest != class_set("unstructured-8").digest
    assert read_classes(path)["unstructured-8"].source == path


def test_sets_that_do_not_exist_are_named() -> None:
    with pytest.raises(InputError, match="there are: unstructured-8, unstructured-4, rebar-14, rebar-7, stairs"):
        class_set("moon")
