"""The checker of saved step regions: it accepts sound ones and refuses every kind of forgery."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from surefoot.compute import sha256_of
from surefoot.errors import InputError
from surefoot.reach import Disturbance, GridSpec, OmegaSet, Reading, Settings, Transition, save_region, synthesize
from surefoot.verify.report import verify_path

Arrays = dict[str, Any]
Document = dict[str, Any]


@pytest.fixture
def saved(tmp_path: Path) -> Path:
    region = synthesize(Transition(0.416, (0.4, 0.6)), Settings(Disturbance(Reading.RATE)))
    return save_region(region, tmp_path / "step")[0]


def forge(path: Path, change: Callable[[Arrays, Document], None]) -> None:
    """Change arrays and document, and mend counts and hashes, so that only the content is wrong."""
    document = json.loads(path.read_text())
    with np.load(path.with_suffix(".npz")) as archive:
        arrays = {name: archive[name] for name in archive.files}
    change(arrays, document)
    names = {"target": "second_target", "shws": "second_won", "guard": "first_target", "fhws": "first_won"}
    document["cells"] = {key: int(arrays[name].sum()) for key, name in names.items()}
    np.savez_compressed(path.with_suffix(".npz"), **arrays)
    document["arrays"]["sha256"] = sha256_of(path.with_suffix(".npz"))
    words = b"".join(arrays[f"{half}_masks"].astype("<u8").tobytes() for half in ("first", "second"))
    document["masks_sha256"] = hashlib.sha256(words).hexdigest()
    path.write_text(json.dumps(document))


@pytest.mark.parametrize("reading", [Reading.RATE, Reading.INSIDE_PHI, Reading.JUMP])
def test_sound_regions_are_accepted(reading: Reading, tmp_path: Path) -> None:
    asked = Settings(Disturbance(reading), grid=GridSpec(0.002, 0.004))
    if reading is Reading.JUMP:
        asked = Settings(Disturbance(reading, 0.0005, 0.002))
    region = synthesize(Transition(0.5, (0.4, 0.7), 0.03, -0.1, True), asked)
    document, arrays = save_region(region, tmp_path / "step")
    for path in (document, arrays):
        report = verify_path(path)
        assert report.accepted, report.findings
        assert report.kind == "step-region"
        assert report.counts["fhws"] == region.counts["fhws"] > 0
        assert int(str(report.counts["adversary_steps"])) >= 100_000


def test_masks_of_two_words(tmp_path: Path) -> None:
    asked = Settings(Disturbance(Reading.RATE), omegas=OmegaSet(2.0, 4.0, 0.02))
    path = save_region(synthesize(Transition(0.416, (0.4, 0.6)), asked), tmp_path / "step")[0]
    assert verify_path(path).accepted

    def unknown(arrays: Arrays, _: Document) -> None:
        arrays["first_masks"][..., 1] |= np.where(arrays["first_masks"][..., 1] != 0, np.uint64(2**50), np.uint64(0))

    forge(path, unknown)
    assert not verify_path(path).accepted


def grown(arrays: Arrays, _: Document) -> None:
    """Let the cells above and below the first half's region win too, with an omega of a neighbour."""
    for shift in (1, -1):
        more = np.roll(arrays["first_won"], shift, axis=1) & ~arrays["first_won"]
        arrays["first_masks"] = np.where(more[..., None], np.uint64(1) << np.uint64(20), arrays["first_masks"])
        arrays["first_won"] = arrays["first_won"] | more


def all_omegas(arrays: Arrays, _: Document) -> None:
    arrays["second_masks"] = np.where(arrays["second_masks"] != 0, np.uint64(2**36 - 1), np.uint64(0))


def wider_target(arrays: Arrays, _: Document) -> None:
    arrays["second_target"] |= np.roll(arrays["second_target"], 1, axis=1)
    arrays["second_won"] |= arrays["second_target"]


def wider_guard(arrays: Arrays, _: Document) -> None:
    arrays["first_target"] |= arrays["second_won"]
    arrays["first_won"] |= arrays["first_target"]


def unknown_omega(arrays: Arrays, _: Document) -> None:
    arrays["first_masks"] = np.where(arrays["first_masks"] != 0, arrays["first_masks"] | np.uint64(2**60), np.uint64(0))


def mute_cell(arrays: Arrays, _: Document) -> None:
    i, j = (int(n[0]) for n in np.nonzero(arrays["first_masks"].any(axis=2)))
    arrays["first_masks"][i, j] = 0


def rougher(_: Arrays, document: Document) -> None:
    document["settings"]["disturbance"]["second"] = 0.2


def longer_samples(_: Arrays, document: Document) -> None:
    document["settings"]["tau_s"] = 0.03


def other_reading(_: Arrays, document: Document) -> None:
    document["settings"]["disturbance"]["reading"] = "inside_phi"


def other_foot(_: Arrays, document: Document) -> None:
    document["transition"]["first_foot_m"] = 0.02


def narrower_window(_: Arrays, document: Document) -> None:
    document["transition"]["apex_velocity_mps"] = [0.402, 0.6]


@pytest.mark.parametrize(
    "change",
    [
        grown,
        all_omegas,
        wider_target,
        wider_guard,
        unknown_omega,
        mute_cell,
        rougher,
        longer_samples,
        other_reading,
        other_foot,
        narrower_window,
    ],
)
def test_forgeries_are_refused(saved: Path, change: Callable[[Arrays, Document], None]) -> None:
    forge(saved, lambda arrays, document: None)
    assert verify_path(saved).accepted
    forge(saved, change)
    report = verify_path(saved)
    assert not report.accepted
    assert report.findings


def test_wrong_counts_are_refused(saved: Path) -> None:
    document = json.loads(saved.read_text())
    document["cells"]["fhws"] += 1
    saved.write_text(json.dumps(document))
    assert not verify_path(saved).accepted


@pytest.mark.parametrize(
    ("key", "value", "complaint"),
    [
        ("format", 2, "reads format 1"),
        ("masks_sha256", "x", "does not fit the masks"),
        ("arrays", {"path": "../step.npz", "sha256": ""}, "beside this one"),
        ("arrays", {"path": "step.npz", "sha256": ""}, "does not fit"),
        ("transition", {"step_length_m": -1}, "has to be above 0"),
        ("transition", {"step_length_m": 1e5}, "at most"),
        ("settings", [], "has to be a mapping"),
    ],
)
def test_documents_that_cannot_be_used(saved: Path, key: str, value: object, complaint: str) -> None:
    document = json.loads(saved.read_text())
    document[key] = value
    saved.write_text(json.dumps(document))
    with pytest.raises(InputError, match=complaint):
        verify_path(saved)


def test_a_missing_half_of_the_pair(saved: Path) -> None:
    saved.with_suffix(".npz").unlink()
    with pytest.raises(InputError, match="npz"):
        verify_path(saved)
    saved.unlink()
    with pytest.raises(InputError):
        verify_path(saved.with_suffix(".npz"))
