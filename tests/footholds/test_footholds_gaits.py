from __future__ import annotations

from pathlib import Path

import pytest

from surefoot.errors import InputError
from surefoot.footholds.gaits import NAMED, Gait, contact_table, footsteps, read_gait


@pytest.mark.parametrize(
    ("name", "samples", "steps"),
    [("trot-1s", 40, 4), ("trot-2s", 80, 8), ("trot-3s", 120, 12), ("walk-2.25s", 90, 4), ("leap-1.5s", 60, 4)],
)
def test_named_gaits_fit_the_default_step(name: str, samples: int, steps: int) -> None:
    contacts = contact_table(NAMED[name], 0.025)
    assert contacts.shape == (samples, 4)
    assert contacts[0].all()
    assert contacts[-1].all()
    assert len(footsteps(contacts)) == steps


def test_the_first_swing_of_a_trot_starts_after_sample_0() -> None:
    first = footsteps(contact_table(NAMED["trot-2s"], 0.025))[0]
    assert (first.foot, first.lift, first.touch, first.leave) == (0, 20, 38, 60)
    second = next(step for step in footsteps(contact_table(NAMED["trot-2s"], 0.025)) if step.foot == 1)
    assert (second.lift, second.touch, second.leave) == (1, 18, 40)
    assert second.cleared == range(5, 14)


@pytest.mark.parametrize("name", ["trot-2s", "trot-3s"])
def test_mirrored_trots_swap_left_and_right(name: str) -> None:
    usual, mirrored = (contact_table(NAMED[one], 0.025) for one in (name, f"{name}-mirrored"))
    assert (usual[:, [1, 0, 3, 2]] == mirrored).all()
    assert (usual != mirrored).any()


def test_a_run_that_ends_in_the_air_is_no_footstep() -> None:
    gait = Gait(("STANCE", "LF_RH"), (0.0, 0.5, 1.0))
    assert footsteps(contact_table(gait, 0.1)) == ()


@pytest.mark.parametrize(
    ("gait", "says"),
    [
        (Gait(("STANCE", "LF_RH"), (0.0, 1.0)), "one time more"),
        (Gait(("STANCE",), (0.1, 1.0)), "ascend from 0"),
        (Gait(("STANCE",), (0.0, 1.01)), "no multiple"),
        (Gait(("LF_XX",), (0.0, 1.0)), "no contact mode"),
        (Gait(("LF_LF",), (0.0, 1.0)), "no contact mode"),
    ],
)
def test_gaits_that_do_not_fit_are_refused(gait: Gait, says: str) -> None:
    with pytest.raises(InputError, match=says):
        contact_table(gait, 0.025)


def test_reads_gaits_as_ocs2_users_write_them(tmp_path: Path) -> None:
    path = tmp_path / "gait.info"
    path.write_text(
        "trot\n{\n  modeSequence\n  {\n    [0] LF_RH ; diagonal\n    [1] STANCE\n  }\n"
        "  switchingTimes\n  {\n    [0] 0.0\n    [1] 0.45\n    [2] 0.5\n  }\n}\n"
    )
    assert read_gait(path) == Gait(("LF_RH", "STANCE"), (0.0, 0.45, 0.5))
    path.write_text("modeSequence { [1] LF_RH }")
    with pytest.raises(InputError, match="indices from 0"):
        read_gait(path)
