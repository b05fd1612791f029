"""The library on disk: it says what was found, survives interruption, and refuses what does not fit."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from skills_oracle import ALL, CLASSES, Recorded, grid

from surefoot.errors import InputError
from surefoot.skills.journal import CHECKS, Stage, open_journal
from surefoot.skills.library import LIBRARY, read_library, write_library
from surefoot.skills.manager import Outcome, Synthesis, synthesize_library
from surefoot.skills.values import CheckResult, Direction, Physics, Primitive

MADE_WITH = {"rules_sha256": "a" * 64, "robot": "go2", "cell_m": 0.8}
STATES = (grid("gsd", "fff", "dfd"), grid("ggg", "fff", "sss"), grid("#g#", "#s#", "###"))
PAIRS = [(state, (0, column)) for state in STATES for column in range(3) if state.label((0, column)) != "obstacle"]
FEASIBLE = frozenset(one for one in ALL if (one.here, one.next) != ("sparse", "gap"))
START = tuple(Primitive(direction, name, name) for name in CLASSES for direction in Direction)


class Planned(Recorded):
    """Physics whose certificates are texts, and which may be interrupted after some checks."""

    def __init__(self, feasible: frozenset[Primitive], most: int = 10**6) -> None:
        super().__init__(feasible)
        self.most = most

    def __call__(self, primitives: Sequence[Primitive]) -> Iterator[CheckResult]:  # type: ignore[override]
        """Yield one answer after another."""
        for primitive in primitives:
            if len(self.asked) == self.most:
                raise KeyboardInterrupt
            (result,) = super().__call__([primitive])
            plan = json.dumps({"of": primitive.name}) if result.verdict is Physics.FEASIBLE else None
            yield replace(result, plan=plan)


def synthesize(folder: Path, physics: Planned, **options: Any) -> tuple[Synthesis, dict[str, Any]]:
    with open_journal(folder, MADE_WITH, **options) as journal:
        found = synthesize_library(PAIRS, START, journal.recording(physics, Stage.REPAIR))
        terrain = {"name": "test", "grid": [3, 3], "requests": None}
        answer = write_library(
            folder,
            found,
            journal.plans,
            made_with=MADE_WITH,
            terrain=terrain,
            classes=CLASSES,
            states=STATES,
            order="cost-aware",
        )
    return found, answer


def opened(folder: Path) -> object:
    with open_journal(folder, MADE_WITH) as journal:
        return journal


def test_what_was_found_can_be_read_again(tmp_path: Path) -> None:
    found, answer = synthesize(tmp_path, Planned(FEASIBLE))
    library = read_library(tmp_path, made_with=MADE_WITH)
    assert library.skills.keys() == found.knowledge.skills
    assert library.knowledge.refused.keys() == found.knowledge.refused.keys()
    for pair in found.pairs:
        read = library.pairs[pair.state, pair.request]
        assert (read.outcome, read.strategy, read.new, read.why) == (pair.outcome, pair.strategy, pair.new, pair.why)
    for primitive, skill in library.skills.items():
        path = library.plan_path(primitive)
        assert path is not None
        assert json.loads(path.read_text()) == {"of": primitive.name}
        assert skill.plan is not None
    assert answer["pairs"] == answer["realizable"] + answer["repaired"] + answer["unrepairable"] + answer["undecided"]
    assert answer["unrepairable"] == answer["unrepairable_by_physics"] == 1
    assert answer["checks_feasible"] + answer["checks_infeasible"] == len(found.knowledge.results)
    assert answer["start_skills"] + answer["suggested_feasible"] == answer["checks_feasible"]
    assert answer["handled_as_the_paper_counts"] == pytest.approx(6 / 7)


@pytest.mark.parametrize("most", [0, 1, 3, 17, 18])
def test_an_interrupted_synthesis_goes_on_where_it_was(tmp_path: Path, most: int) -> None:
    whole, _ = synthesize(tmp_path / "whole", Planned(FEASIBLE))
    first = Planned(FEASIBLE, most)
    with pytest.raises(KeyboardInterrupt):
        synthesize(tmp_path / "parts", first)
    with pytest.raises(InputError, match="was interrupted"):
        read_library(tmp_path / "parts")
    second = Planned(FEASIBLE)
    again, _ = synthesize(tmp_path / "parts", second)
    assert not set(first.asked) & set(second.asked)
    assert {one: result.verdict for one, result in again.knowledge.results.items()} == {
        one: result.verdict for one, result in whole.knowledge.results.items()
    }
    assert [pair.outcome for pair in again.pairs] == [pair.outcome for pair in whole.pairs]


def test_a_line_that_was_cut_off_is_made_again(tmp_path: Path) -> None:
    synthesize(tmp_path, Planned(FEASIBLE))
    (tmp_path / LIBRARY).unlink()
    journal = tmp_path / CHECKS
    journal.write_bytes(journal.read_bytes()[:-20])
    physics = Planned(FEASIBLE)
    synthesize(tmp_path, physics)
    assert len(physics.asked) == 1


def test_a_certificate_that_was_changed_is_made_again(tmp_path: Path) -> None:
    synthesize(tmp_path, Planned(FEASIBLE))
    changed = next(iter(sorted((tmp_path / "plans").iterdir())))
    changed.write_text("{}")
    physics = Planned(FEASIBLE)
    synthesize(tmp_path, physics)
    assert len(physics.asked) == 1


def test_undecided_checks_are_kept_unless_they_are_to_be_tried_again(tmp_path: Path) -> None:
    class Slow(Planned):
        def __call__(self, primitives: Sequence[Primitive]) -> Iterator[CheckResult]:  # type: ignore[override]
            for result in super().__call__(primitives):
                hard = result.primitive == Primitive(Direction.FORWARD, "flat", "gap")
                yield replace(result, verdict=Physics.UNKNOWN, plan=None) if hard else result

    first, _ = synthesize(tmp_path, Slow(FEASIBLE))
    assert first.knowledge.count(Physics.UNKNOWN) == 1
    kept = Planned(FEASIBLE)
    synthesize(tmp_path, kept)
    assert kept.asked == []
    again = Planned(FEASIBLE)
    after, answer = synthesize(tmp_path, again, retry_unknown=True)
    assert Primitive(Direction.FORWARD, "flat", "gap") in again.asked
    assert answer["checks_unknown"] == after.count(Outcome.UNDECIDED) == 0


def test_another_process_that_is_killed_loses_the_check_in_hand_only(tmp_path: Path) -> None:
    program = f"""
import sys, time
sys.path.insert(0, {str(Path(__file__).parent)!r})
from pathlib import Path
from test_skills_library import *
class Slow(Planned):
    def __call__(self, primitives):
        for number, result in enumerate(super().__call__(primitives)):
            if number == 5:
                print("five", flush=True)
                time.sleep(60)
            yield result
synthesize(Path({str(tmp_path)!r}), Slow(FEASIBLE))
"""
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "five\n"
        os.kill(process.pid, signal.SIGKILL)
    physics = Planned(FEASIBLE)
    synthesize(tmp_path, physics)
    assert not set(START[:5]) & set(physics.asked)
    assert START[5] in physics.asked


def test_a_library_made_with_other_rules_is_refused_and_left_alone(tmp_path: Path) -> None:
    synthesize(tmp_path, Planned(FEASIBLE))
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    other = {**MADE_WITH, "cell_m": 0.6}
    with (
        pytest.raises(InputError, match=r"made with other rules: cell_m was 0\.8 and is now 0\.6"),
        open_journal(tmp_path, other),
    ):
        pass
    with pytest.raises(InputError, match="made with other rules"):
        read_library(tmp_path, made_with=other)
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before


def test_two_syntheses_into_one_folder_are_refused(tmp_path: Path) -> None:
    with open_journal(tmp_path, MADE_WITH), pytest.raises(InputError, match="another synthesis"):
        opened(tmp_path)


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        (CHECKS, "{}\n", "no journal of kind"),
        (CHECKS, "[1, 2\n", "is damaged"),
        (LIBRARY, "{", "not whole JSON"),
        (LIBRARY, "[]", "holds no JSON object"),
        (LIBRARY, '{"kind": "skill-library", "format": 2}', "no library of kind"),
        (LIBRARY, '{"kind": "skill-library", "format": 1}', "no whole library"),
    ],
)
def test_damaged_files_are_refused(tmp_path: Path, name: str, text: str, message: str) -> None:
    (tmp_path / name).write_text(text)
    reader = opened if name == CHECKS else read_library
    with pytest.raises(InputError, match=message):
        reader(tmp_path)


@pytest.mark.parametrize(
    "change",
    [
        {"primitive": "up flat->flat"},
        {"verdict": "perhaps"},
        {"plan": {"path": "../../etc/passwd", "sha256": ""}},
        {"stage": "end"},
        {"time_s": None},
    ],
)
def test_damaged_checks_are_refused_with_their_line(tmp_path: Path, change: dict[str, Any]) -> None:
    synthesize(tmp_path, Planned(FEASIBLE))
    journal = tmp_path / CHECKS
    lines = journal.read_text().splitlines()
    lines[3] = json.dumps(json.loads(lines[3]) | change)
    journal.write_text("\n".join(lines) + "\n")
    with pytest.raises(InputError, match=rf"{CHECKS}:4"), open_journal(tmp_path, MADE_WITH):
        pass


def test_no_library_is_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is no library of skills"):
        read_library(tmp_path)
