"""The checker of libraries accepts a real one and refuses every broken one; and the commands around it."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from skills_oracle import CLASSES, Recorded, grid
from typer.testing import CliRunner

from surefoot.cli.commands import app
from surefoot.errors import InputError
from surefoot.skills.classes import class_set
from surefoot.skills.journal import Stage, open_journal
from surefoot.skills.library import LIBRARY, write_library
from surefoot.skills.manager import synthesize_library
from surefoot.skills.physics import PhysicsOfClasses
from surefoot.skills.values import CheckResult, Direction, Primitive, TerrainState
from surefoot.verify import verify_path

MADE_WITH = {"rules_sha256": "a" * 64, "robot": "go2", "cell_m": 0.8}
STATES = (grid("fdf", "fff", "fff"), grid("#g#", "#f#", "#ff"), grid("fsf", "#f#", "###"), grid("f##", "#f#", "###"))
REFUSED = {("flat", "gap"), ("flat", "sparse")}
Document = dict[str, Any]


class OnFlatGround(Recorded):
    """Certificates are real motions over flat ground, whatever the classes are called; some moves are refused."""

    def __init__(self) -> None:
        super().__init__(())
        flat = [Primitive(direction, "flat", "flat") for direction in Direction]
        self.motions = {
            one.primitive.direction: one for one in PhysicsOfClasses(class_set("unstructured-4"), workers=2)(flat)
        }

    def __call__(self, primitives: Sequence[Primitive]) -> Iterator[CheckResult]:  # type: ignore[override]
        """Yield a motion of the same direction, or a refusal."""
        for primitive in primitives:
            if (primitive.here, primitive.next) in REFUSED:
                yield from super().__call__([primitive])
            else:
                yield replace(self.motions[primitive.direction], primitive=primitive)


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a library of twelve pairs, three of them without a strategy."""
    folder = tmp_path_factory.mktemp("library")
    pairs = [(state, cell) for state in STATES for cell in requests(state)]
    with open_journal(folder, MADE_WITH) as journal:
        found = synthesize_library(pairs, (), journal.recording(OnFlatGround(), Stage.REPAIR))
        write_library(
            folder,
            found,
            journal.plans,
            made_with=MADE_WITH,
            terrain={"name": "test", "grid": [3, 3], "requests": None},
            classes=CLASSES,
            states=STATES,
            order="cost-aware",
        )
    return folder


def requests(state: TerrainState) -> list[tuple[int, int]]:
    cells = [(0, 0), (0, 1), (0, 2), (2, 0), (2, 2)]
    return [cell for cell in cells if state.label(cell) != "obstacle"]


@pytest.fixture
def changed(library: Path, tmp_path: Path) -> Callable[[Callable[[Document], object]], Path]:
    """Return a function that copies the library with a change in its file."""

    def change(edit: Callable[[Document], object]) -> Path:
        folder = tmp_path / "copy"
        shutil.copytree(library, folder)
        value = json.loads((folder / LIBRARY).read_text())
        edit(value)
        (folder / LIBRARY).write_text(json.dumps(value))
        return folder

    return change


def test_a_real_library_is_accepted(library: Path) -> None:
    report = verify_path(library)
    assert report.accepted, report.findings
    assert report.kind == "skill-library"
    assert report.counts["pairs"] == 11
    assert report.counts["skills"]
    assert verify_path(library / LIBRARY).accepted


def pair_at(value: Document, state: int, request: list[int]) -> Document:
    return next(pair for pair in value["pairs"] if (pair["state"], pair["request"]) == (state, request))


def check_of(value: Document, verdict: str) -> Document:
    return next(check for check in value["checks"] if check["verdict"] == verdict)


BREAKS: dict[str, tuple[Callable[[Document], object], str]] = {
    "a strategy that walks away": (
        lambda v: pair_at(v, 0, [0, 0])["strategy"].__setitem__(0, [0, 0, "right"]),
        "skills, strategy",
    ),
    "a strategy that stops early": (
        lambda v: pair_at(v, 0, [0, 0]).update(strategy=[[1, 1, None]]),
        "does not come to",
    ),
    "no strategy": (lambda v: pair_at(v, 0, [0, 0]).update(strategy=[[0, 0, None]]), "where the robot begins"),
    "a strategy into an obstacle": (
        lambda v: pair_at(v, 1, [2, 2])["strategy"].append([2, 1, "left"]),
        "skills, strategy",
    ),
    "a strategy by an infeasible skill": (
        lambda v: pair_at(v, 2, [0, 1]).update(outcome="realizable", strategy=[[1, 1, "forward"], [0, 1, None]]),
        "is no certified skill",
    ),
    "a skill that physics refused": (
        lambda v: check_of(v, "infeasible").update(verdict="feasible"),
        "has no plan that could be checked",
    ),
    "a skill with the plan of another direction": (
        lambda v: check_of(v, "feasible").update(primitive="left gap->gap"),
        "not one cell left",
    ),
    "a refusal that never happened": (
        lambda v: v["checks"].remove(check_of(v, "infeasible")),
        "can be reached without any refused move",
    ),
    "a handled pair called unrepairable": (
        lambda v: pair_at(v, 0, [0, 0]).update(
            outcome="unrepairable", strategy=[], why={"cause": "obstacle", "text": "", "primitives": []}
        ),
        "can be reached without any refused move",
    ),
    "obstacles blamed for physics": (
        lambda v: pair_at(v, 1, [0, 1])["why"].update(cause="obstacle", primitives=[]),
        "is not explained by obstacle",
    ),
    "physics blamed for obstacles": (
        lambda v: pair_at(v, 3, [0, 0])["why"].update(cause="physics"),
        "is not explained by physics",
    ),
    "unrepairable without a reason": (lambda v: pair_at(v, 3, [0, 0]).update(why=None), "comes without a reason"),
    "undecided although it is decided": (
        lambda v: pair_at(v, 3, [0, 0]).update(outcome="undecided"),
        "although the cause is obstacle",
    ),
    "a pair left out": (lambda v: v["pairs"].pop(), "are not complete"),
    "a pair twice": (lambda v: v["pairs"].append(v["pairs"][0]), "some stand twice"),
    "wrong counts": (lambda v: v["answer"].update(repaired=0), "skills, counts"),
    "another number of first skills": (lambda v: v["answer"].update(start_skills=7), "skills, counts"),
    "fewer primitives than there are": (lambda v: v["answer"].update(exhaustive=5), "skills, counts"),
    "a better share": (lambda v: v["answer"].update(repaired_of_those_in_need=1.0), "skills, counts"),
    "less time than the checks took": (lambda v: v["answer"].update(checks_s=-5.0), "skills, counts"),
    "a new skill that nobody asked for": (
        lambda v: pair_at(v, 0, [0, 0])["new"].append("forward gap->gap"),
        "new skills are not those",
    ),
    "an answer that physics never gave": (
        lambda v: pair_at(v, 3, [0, 0]).update(asked=["forward gap->sparse"]),
        "which has no answer of its own",
    ),
    "more new skills needed than there are": (
        lambda v: pair_at(v, 0, [0, 0]).update(fewest=9),
        "needs at least 9 new skills",
    ),
    "repaired by nothing": (
        lambda v: next(p for p in v["pairs"] if not p["new"] and p["strategy"]).update(outcome="repaired"),
        "with 0 new skills",
    ),
    "another gait than that of the plan": (
        lambda v: check_of(v, "feasible").update(gait="leap-1.5s"),
        "its plan is not",
    ),
    "no gait at all": (lambda v: check_of(v, "feasible").update(gait="gallop"), "which is no gait"),
    "any gait of another time": (lambda v: check_of(v, "feasible").update(gait="free-1.5s"), "its plan is not"),
    "another horizon": (lambda v: check_of(v, "feasible").update(horizon_s=1.0), "its plan takes"),
    "a lower cost": (lambda v: check_of(v, "feasible").update(cost=1.0), "its plan costs"),
    "a primitive twice": (lambda v: v["checks"].append(v["checks"][0]), "stands twice"),
    "no such direction": (lambda v: v["checks"][0].update(primitive="up flat->flat"), "is no primitive"),
}


@pytest.mark.parametrize("name", BREAKS)
def test_broken_libraries_are_refused(name: str, changed: Callable[..., Path]) -> None:
    edit, message = BREAKS[name]
    report = verify_path(changed(edit))
    assert not report.accepted
    assert message in "\n".join(map(str, report.findings))


def test_a_changed_certificate_is_refused(changed: Callable[..., Path]) -> None:
    folder = changed(lambda _: None)
    plan = next(iter(sorted((folder / "plans").iterdir())))
    plan.write_text(plan.read_text().replace("0.29", "0.28", 1))
    report = verify_path(folder)
    assert "missing or was changed" in str(report.findings[0])


def test_a_certificate_of_a_motion_that_breaks_the_model_is_refused(changed: Callable[..., Path]) -> None:
    import hashlib

    def edit(value: Document) -> None:
        check = check_of(value, "feasible")
        path = tmp / check["plan"]["path"]
        plan = json.loads(path.read_text())
        plan["motion"]["feet_m"][5][0][0] += 0.05
        path.write_text(json.dumps(plan))
        check["plan"]["sha256"] = hashlib.sha256(path.read_bytes()).hexdigest()

    tmp = changed(lambda _: None)
    value = json.loads((tmp / LIBRARY).read_text())
    edit(value)
    (tmp / LIBRARY).write_text(json.dumps(value))
    assert "has a plan that is refused" in "\n".join(map(str, verify_path(tmp).findings))


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (lambda v: v.pop("states"), "is missing"),
        (lambda v: v["states"].__setitem__(0, [["flat", "flat"]]), "a centre"),
        (lambda v: v["states"].__setitem__(0, [["mud"]]), "no class"),
        (lambda v: v["pairs"][0].update(state=99), "whole number"),
        (lambda v: v["pairs"][0].update(request=[0, 9]), "outside of the grid"),
        (lambda v: v["pairs"][0].update(strategy=[[0, 0, "up"]]), "one of forward"),
        (lambda v: v.update(format=2), "format"),
        (lambda v: v["pairs"][0].update(fewest=-1), "whole number"),
        (lambda v: v["checks"][0].update(time_s=-1), "at least 0"),
        (lambda v: v["terrain"].update(path="../library.json", sha256="0"), None),
    ],
)
def test_unusable_libraries_are_bad_input(
    edit: Callable[[Document], object], message: str | None, changed: Callable[..., Path]
) -> None:
    folder = changed(edit)
    if message is None:
        (folder.parent / LIBRARY).write_text("{}")
        message = "made from another version"
    with pytest.raises(InputError, match=message):
        verify_path(folder)


def run(*arguments: object) -> tuple[int, str]:
    found = CliRunner().invoke(app, [str(one) for one in arguments])
    return found.exit_code, found.output


def test_show_says_what_the_robot_can_do_and_why_not(library: Path) -> None:
    code, text = run("skills", "show", library)
    assert code == 0
    assert "11 pairs of 4 terrain states" in text
    assert "forward flat->gap: infeasible, the feet cannot reach" in text
    assert "obstacles cut the requested cell (0, 0) off" in text
    value = json.loads(run("skills", "show", library, "--json")[1])
    assert value["pairs"] == 11
    assert {one["primitive"] for one in value["refused"]} == {"forward flat->gap", "forward flat->sparse"}


def test_show_draws_a_terrain_state_and_exports_its_specification(library: Path, tmp_path: Path) -> None:
    code, text = run("skills", "show", library, "--state", 0)
    assert code == 0
    assert "to (0, 0): " in text
    for request, realizable in (("2,2", True), ("0,1", False)):
        file = tmp_path / f"{request[0]}.structuredslugs"
        assert run("skills", "show", library, "--state", 1, "--request", request, "--spec", file)[0] == 0
        code, _ = run("synth", file, "--realizability-only")
        assert code == (0 if realizable else 1)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--state", 9], "they go from 0 to 3"),
        (["--state", 0, "--request", "9,9"], "outside of the grid"),
        (["--state", 0, "--request", "1,1"], "is not requested"),
        (["--state", 0, "--request", "front"], "row,column"),
        (["--state", 0, "--spec", "x.slugsin"], "one pair"),
        (["--state", 0, "--request", "0,0", "--spec", "x.txt"], "has to end in"),
    ],
)
def test_bad_questions_to_show_are_one_sentence(library: Path, arguments: list[object], message: str) -> None:
    found = CliRunner().invoke(app, ["skills", "show", str(library), *map(str, arguments)])
    assert isinstance(found.exception, InputError)
    assert message in str(found.exception)
