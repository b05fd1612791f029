"""Controllers: look-up, margins, simulation, saving and loading."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surefoot.errors import InputError
from surefoot.reach import (
    Controller,
    Disturbance,
    Push,
    Reading,
    Settings,
    Transition,
    load_region,
    masks_sha256,
    save_region,
    synthesize,
)
from surefoot.reach.simulation import Ending

REGION = synthesize(Transition(0.416, (0.4, 0.6)), Settings(Disturbance(Reading.RATE)))
CONTROLLER = Controller(REGION)


@settings(max_examples=300, deadline=None)
@given(
    x=st.floats(-0.2, 0.6),
    v=st.floats(-0.1, 1.3),
    previous=st.floats(2.8, 3.5),
    half=st.sampled_from(["first", "second"]),
)
def test_the_law_takes_the_allowed_omega_that_costs_least(x: float, v: float, previous: float, half: str) -> None:
    found = CONTROLLER.omega(x, v, half, previous)  # type: ignore[arg-type]
    allowed = CONTROLLER.omegas(x, v, half)  # type: ignore[arg-type]
    if not allowed:
        assert found is None
        return
    assert found in allowed
    costs = [0.5 * (w - 3.1) ** 2 + 0.5 * (w - previous) ** 2 for w in allowed]
    assert 0.5 * (found - 3.1) ** 2 + 0.5 * (found - previous) ** 2 == pytest.approx(min(costs), abs=1e-12)
    assert CONTROLLER.contains(x, v, half)  # type: ignore[arg-type]


@settings(max_examples=200, deadline=None)
@given(x=st.floats(-0.045, 0.43), v=st.floats(0.05, 1.2), half=st.sampled_from(["first", "second"]))
def test_margins_lead_exactly_to_the_edge(x: float, v: float, half: str) -> None:
    margin = CONTROLLER.margin(x, v, half)  # type: ignore[arg-type]
    inside = CONTROLLER.contains(x, v, half)  # type: ignore[arg-type]
    assert (margin >= -1e-12) == inside or abs(margin) < 1e-9
    lost, gained = CONTROLLER.half(half).margins(x, v)  # type: ignore[arg-type]
    if inside:
        assert margin == min(lost, gained)
        assert not CONTROLLER.contains(x, v - lost - 1e-6, half)  # type: ignore[arg-type]
        assert not CONTROLLER.contains(x, v + gained + 1e-6, half)  # type: ignore[arg-type]


def test_outside_the_grid_there_is_nothing() -> None:
    assert CONTROLLER.omega(9.0, 0.5) is None
    assert CONTROLLER.margin(9.0, 0.5) == -np.inf
    assert not CONTROLLER.contains(0.0, 99.0)


@settings(max_examples=60, deadline=None)
@given(start=st.integers(0, 14847), seed=st.integers(0, 2**20), x=st.floats(-0.49, 0.49), v=st.floats(-0.49, 0.49))
def test_every_state_of_the_first_region_reaches_the_target(start: int, seed: int, x: float, v: float) -> None:
    i, j = (int(n[start]) for n in np.nonzero(REGION.first.won))
    cells = REGION.cells
    at = cells.x0_m + (i + x) * cells.x_step_m
    trace = CONTROLLER.simulate(at, cells.v0_mps + (j + v) * cells.v_step_mps, seed=seed)
    assert trace.ending is Ending.REACHED
    assert trace.switch is not None


def test_a_push_within_the_margin_is_absorbed_and_a_larger_one_is_a_loss_with_its_margin() -> None:
    calm = CONTROLLER.simulate(0.0, 0.5)
    k = 5
    low, high = CONTROLLER.first.margins(calm.positions_m[k], calm.velocities_mps[k])
    at = k * 0.02 - 1e-9
    assert CONTROLLER.simulate(0.0, 0.5, (Push(at, 0.95 * high),)).succeeded
    assert CONTROLLER.simulate(0.0, 0.5, (Push(at, -0.95 * low),)).succeeded
    lost = CONTROLLER.simulate(0.0, 0.5, (Push(at, high + 0.1),))
    assert lost.ending is Ending.LEFT_REGION
    assert lost.margin_mps == pytest.approx(-0.1, abs=0.005)


def test_the_barrier_law_recovers_from_what_the_table_cannot() -> None:
    pushes = [(Push(0.12, size),) for size in np.linspace(-0.5, 0.5, 41)]
    table = [CONTROLLER.simulate(0.0, 0.5, push).succeeded for push in pushes]
    barrier = [CONTROLLER.simulate(0.0, 0.5, push, law="barrier").succeeded for push in pushes]
    assert all(b for t, b in zip(table, barrier, strict=True) if t)
    assert sum(barrier) > sum(table) > 5


def test_saved_regions_come_back_the_same(tmp_path: Path) -> None:
    document, arrays = save_region(REGION, tmp_path / "step")
    for path in (document, arrays):
        again = load_region(path)
        assert masks_sha256(again) == masks_sha256(REGION)
        assert again.counts == REGION.counts
        assert again.transition == REGION.transition
        assert again.settings == REGION.settings
        assert Controller(again).omega(0.1, 0.6) == CONTROLLER.omega(0.1, 0.6)


@pytest.mark.parametrize(
    ("key", "value", "complaint"),
    [
        ("format", 2, "this version reads format 1"),
        ("kind", "map", "has to be step-region"),
        ("masks_sha256", "0" * 64, "does not fit the masks"),
        ("transition", {}, "lacks a key"),
        ("settings", None, "lacks a key"),
    ],
)
def test_other_versions_and_broken_documents_are_refused(
    tmp_path: Path, key: str, value: object, complaint: str
) -> None:
    document, _ = save_region(REGION, tmp_path / "step")
    content = json.loads(document.read_text())
    content[key] = value
    document.write_text(json.dumps(content))
    with pytest.raises(InputError, match=complaint):
        load_region(document)


def test_truncated_files_are_refused(tmp_path: Path) -> None:
    document, arrays = save_region(REGION, tmp_path / "step")
    whole = arrays.read_bytes()
    arrays.write_bytes(whole[:-100])
    with pytest.raises(InputError):
        load_region(document)
    arrays.write_bytes(whole + b"x")
    with pytest.raises(InputError, match="hash"):
        load_region(document)
    document.write_text("{")
    with pytest.raises(InputError, match="JSON"):
        load_region(document)
    with pytest.raises(InputError, match="cannot be read"):
        load_region(tmp_path / "none.json")
