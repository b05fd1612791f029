"""Grid synthesis: the golden case, an oracle that is written without tricks, exact bounds, and what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from surefoot.errors import InputError
from surefoot.reach import Controller, Disturbance, GridSpec, GuardTube, OmegaSet, Reading, Region, Settings, Transition
from surefoot.reach.artefact import masks_sha256
from surefoot.reach.synthesis import HalfStep, synthesize

RATE = Settings(Disturbance(Reading.RATE))
GOLDEN = Transition(0.416, (0.4, 0.6))


def naive_half(region: Region, half: HalfStep, source: NDArray[np.bool_]) -> tuple[NDArray[np.bool_], set[object]]:
    """Iterate the definition cell by cell until nothing changes; return winning cells and (i, j, k) of the masks."""
    cells, bound, tau = region.cells, region.settings.disturbance, region.settings.tau_s
    dx, dv = cells.x_step_m, cells.v_step_mps
    boxes = {}
    for k, w in enumerate(half.omegas_radps):
        c, s = math.cosh(w * tau), math.sinh(w * tau)
        d1, d2 = bound.first, bound.second
        if bound.reading is Reading.INSIDE_PHI:
            d1, d2 = bound.second, w * w * bound.first
        r1, r2 = s / w * d1 + (c - 1) / w**2 * d2, (c - 1) * d1 + s / w * d2
        if bound.reading is Reading.JUMP:
            r1, r2 = bound.first, bound.second
        for i in range(cells.columns):
            for j in range(cells.rows):
                x, v = cells.x0_m + i * dx - half.foot_m, cells.v0_mps + j * dv
                corners = [
                    (half.foot_m + c * (x + a) + s / w * (v + b), w * s * (x + a) + c * (v + b))
                    for a in (-dx / 2, dx / 2)
                    for b in (-dv / 2, dv / 2)
                ]
                low = min(p for p, _ in corners) - r1, min(q for _, q in corners) - r2
                high = max(p for p, _ in corners) + r1, max(q for _, q in corners) + r2
                boxes[i, j, k] = (
                    math.floor((low[0] - cells.x0_m) / dx + 0.5 - 1e-9),
                    math.floor((high[0] - cells.x0_m) / dx + 0.5 + 1e-9),
                    math.floor((low[1] - cells.v0_mps) / dv + 0.5 - 1e-9),
                    math.floor((high[1] - cells.v0_mps) / dv + 0.5 + 1e-9),
                )
    won, masks, changed = half.target.copy(), set[object](), True
    while changed:
        changed = False
        for key, (il, ih, jl, jh) in boxes.items():
            i, j, _ = key
            if key in masks or half.target[i, j] or not source[i, j]:
                continue
            if il < 0 or jl < 0 or ih >= cells.columns or jh >= cells.rows:
                continue
            if won[il : ih + 1, jl : jh + 1].all():
                masks.add(key)
                won[i, j] = changed = True
    return won, masks


def mask_set(half: HalfStep) -> set[object]:
    return {
        (int(i), int(j), k)
        for i, j in zip(*np.nonzero(half.masks.any(axis=2)), strict=True)
        for k in range(len(half.omegas_radps))
        if int(half.masks[i, j, k // 64]) >> (k % 64) & 1
    }


def test_the_golden_case_cell_for_cell() -> None:
    region = synthesize(GOLDEN, RATE)
    assert region.counts == {"target": 343, "shws": 5529, "guard": 829, "fhws": 14848}
    assert region.area["shws"] == pytest.approx(0.0442, abs=5e-5)
    assert region.area["fhws"] == pytest.approx(0.1188, abs=5e-5)
    assert region.emptied_by is None
    assert region.notes == ()


@pytest.mark.parametrize(
    ("length", "window", "counts"),
    [
        (0.312, (0.2, 0.45), [427, 5680, 932, 10989]),
        (0.416, (0.45, 0.7), [427, 6975, 1123, 15952]),
        (0.52, (0.4, 0.6), [343, 5529, 704, 17808]),
    ],
)
def test_other_transitions_as_a_plain_numpy_fixpoint_found_them(
    length: float, window: tuple[float, float], counts: list[int]
) -> None:
    assert list(synthesize(Transition(length, window), RATE).counts.values()) == counts


def test_one_omega_per_cell_wins_the_same_cells_and_is_one_of_all() -> None:
    every, one = synthesize(GOLDEN, RATE), synthesize(GOLDEN, RATE, all_masks=False)
    assert every.counts == one.counts
    assert np.array_equal(every.first.won, one.first.won)
    assert not (one.first.masks & ~every.first.masks).any()
    assert (np.bitwise_count(one.first.masks) <= 1).all()
    assert masks_sha256(every) != masks_sha256(one)


@settings(max_examples=25, deadline=None)
@given(
    reading=st.sampled_from(Reading),
    first=st.floats(0, 0.02),
    second=st.floats(0, 0.04),
    tau=st.sampled_from([0.03, 0.05, 0.08]),
    foot=st.sampled_from([-0.03, 0.0, 0.04]),
    low=st.floats(0.2, 0.5),
    width=st.floats(0.2, 0.5),
    level=st.booleans(),
)
def test_the_sweep_is_the_definition(
    reading: Reading, first: float, second: float, tau: float, foot: float, low: float, width: float, level: bool
) -> None:
    region = synthesize(
        Transition(0.3, (low, low + width), foot, -0.1, level),
        Settings(
            Disturbance(reading, first, second),
            tau,
            GridSpec(0.02, 0.05, beyond_m=0.06),
            OmegaSet(2.5, 3.7, 0.4),
            GuardTube(3.1, 0.1, 0.9),
            target_half_width_m=0.05,
        ),
    )
    everywhere = np.ones(region.cells.shape, np.bool_)
    won, masks = naive_half(region, region.second, everywhere)
    assert np.array_equal(region.second.won, won)
    assert mask_set(region.second) == masks
    left, right = region.cells.x_edges()
    reach = region.first.omegas_radps[0] * np.maximum(abs(left - foot), abs(right - foot))
    above = region.cells.v_edges()[0][None, :] > reach[:, None] + 1e-12
    won, masks = naive_half(region, region.first, above)
    assert np.array_equal(region.first.won, won)
    assert mask_set(region.first) == masks


@settings(max_examples=10, deadline=None)
@given(
    length=st.floats(0.2, 0.6),
    low=st.floats(0.2, 0.5),
    width=st.floats(0.1, 0.3),
    reading=st.sampled_from([Reading.RATE, Reading.INSIDE_PHI]),
    size=st.floats(0, 1),
)
def test_an_adversary_never_leaves_a_region(
    length: float, low: float, width: float, reading: Reading, size: float
) -> None:
    asked = Settings(Disturbance(reading, 0.01 * size, 0.02 * size))
    region = synthesize(Transition(length, (low, low + width)), asked)
    found = Controller(region).certify(20_000)
    assert found.holds, found.example


def test_more_disturbance_never_wins_more() -> None:
    calm = synthesize(GOLDEN, Settings(Disturbance(Reading.RATE, 0.0, 0.0)))
    rough = synthesize(GOLDEN, Settings(Disturbance(Reading.RATE, 0.02, 0.05)))
    golden = synthesize(GOLDEN, RATE)
    assert not (golden.first.won & ~calm.first.won).any()
    assert not (rough.first.won & ~golden.first.won).any()
    assert rough.counts["fhws"] < golden.counts["fhws"] < calm.counts["fhws"]


def test_corners_exactly_on_an_asymptote_are_outside() -> None:
    region = synthesize(Transition(0.52, (0.4, 0.6)), RATE)
    left, right = region.cells.x_edges()
    lower, _ = region.cells.v_edges()
    i, j = int(np.argmin(abs(right - 0.155))), int(np.argmin(abs(lower - 0.434)))
    assert right[i] == pytest.approx(0.155)
    assert lower[j] == pytest.approx(0.434)
    assert not region.first.won[i, j]
    assert left[i] < 0.155


def test_edges_exactly_on_a_bound_of_the_window_are_outside() -> None:
    region = synthesize(Transition(0.416, (0.402, 0.602)), RATE)
    rows = np.nonzero(region.second.target.any(axis=0))[0]
    lower, upper = region.cells.v_edges()
    assert lower[rows[0]] == pytest.approx(0.406)
    assert upper[rows[-1]] == pytest.approx(0.598)


def test_jumps_at_every_sample_leave_nothing_and_the_reason_is_said() -> None:
    region = synthesize(GOLDEN, Settings(Disturbance(Reading.JUMP)))
    assert region.counts["guard"] == 0
    assert region.counts["fhws"] == 0
    assert region.emptied_by is not None
    assert "no omega" in region.emptied_by


def test_a_window_below_the_grid_has_no_target() -> None:
    region = synthesize(Transition(0.416, (0.05, 0.09)), RATE)
    assert region.emptied_by is not None
    assert "target" in region.emptied_by


def test_a_tube_that_misses_the_region_empties_the_guard() -> None:
    region = synthesize(GOLDEN, Settings(Disturbance(Reading.RATE), guard=GuardTube(3.1, 0.01, 0.02)))
    assert region.counts["guard"] == 0
    assert region.emptied_by is not None
    assert "guard" in region.emptied_by


def test_samples_longer_than_the_target_are_noted() -> None:
    region = synthesize(GOLDEN, Settings(Disturbance(Reading.RATE), tau_s=0.03))
    assert len(region.notes) == 1
    assert "jump over" in region.notes[0]


def test_a_level_com_changes_the_omegas_of_the_second_half_only() -> None:
    flat = synthesize(GOLDEN, RATE)
    down = synthesize(Transition(0.416, (0.4, 0.6), height_change_m=-0.2, level_com=True), RATE)
    assert down.first.omegas_radps == flat.first.omegas_radps
    ratio = math.sqrt(0.985 / 1.185)
    assert down.second.omegas_radps == pytest.approx([ratio * w for w in flat.second.omegas_radps])
    assert synthesize(Transition(0.416, (0.4, 0.6), height_change_m=-0.2), RATE).counts == flat.counts


@pytest.mark.parametrize(
    ("make", "complaint"),
    [
        (lambda: Transition(0.0, (0.4, 0.6)), "step-length"),
        (lambda: Transition(math.nan, (0.4, 0.6)), "step-length"),
        (lambda: Transition(0.4, (0.6, 0.4)), "apex-velocity"),
        (lambda: Transition(0.4, (0.4, 0.6), 0.5), "first-foot"),
        (lambda: Transition(0.4, (0.4, 0.6), height_change_m=1.0), "height-change"),
        (lambda: OmegaSet(3.5, 2.8, 0.02), "reversed or empty"),
        (lambda: OmegaSet(2.0, 4.0, 0.0001), "more than the 1024"),
        (lambda: OmegaSet(2.0, 4.0, 0.0), "above 0"),
        (lambda: Settings(Disturbance(Reading.RATE), tau_s=0.0), "tau"),
        (lambda: Settings(Disturbance(Reading.RATE), tau_s=5.0), "tau"),
        (lambda: Disturbance(Reading.RATE, -0.1), "disturbance-bound"),
        (lambda: Disturbance("rate"), "no reading"),  # type: ignore[arg-type]
        (lambda: GridSpec(0.0, 0.1), "grid"),
        (lambda: GuardTube(3.1, 0.7, 0.1), "guard-velocity"),
    ],
)
def test_bad_input_is_refused(make: object, complaint: str) -> None:
    with pytest.raises(InputError, match=complaint):
        make()  # type: ignore[operator]


def test_a_grid_that_does_not_fit_says_how_large_it_would_be() -> None:
    with pytest.raises(InputError, match=r"need about .* GB"):
        synthesize(GOLDEN, Settings(Disturbance(Reading.RATE), grid=GridSpec(1e-6, 1e-6)))


def test_more_than_64_omegas_need_more_words() -> None:
    few = synthesize(GOLDEN, RATE)
    many = synthesize(GOLDEN, Settings(Disturbance(Reading.RATE), omegas=OmegaSet(2.8, 3.5, 0.005)))
    assert many.first.masks.shape[2] == 3
    assert many.counts["fhws"] >= few.counts["fhws"]
    own, other = Controller(many), Controller(few)
    for x, v in ((0.0, 0.5), (0.1, 0.6), (0.18, 0.6)):
        assert set(other.omegas(x, v)) <= set(own.omegas(x, v))
        found = own.omega(x, v)
        assert found is not None
        assert abs(found - 3.1) == pytest.approx(min(abs(w - 3.1) for w in own.omegas(x, v)))
    assert own.certify(20_000).holds
    assert own.simulate(0.0, 0.5, seed=1).succeeded
    naive = Settings(
        Disturbance(Reading.RATE), 0.05, GridSpec(0.03, 0.06), OmegaSet(2.5, 3.7, 0.015), target_half_width_m=0.06
    )
    region = synthesize(Transition(0.3, (0.2, 0.6)), naive)
    won, masks = naive_half(region, region.second, np.ones(region.cells.shape, np.bool_))
    assert len(region.second.omegas_radps) == 81
    assert np.array_equal(region.second.won, won)
    assert mask_set(region.second) == masks
