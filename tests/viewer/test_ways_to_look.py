"""What `surefoot view` says about options that do not go with what stands at a path."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from quadruped_field import write_field
from surefoot.cli import main
from surefoot.viewer import kinds
from synthetic_run import write_run

OPTIONS = {
    "": [],
    "--html": ["--html", "page.html"],
    "--mcap": ["--mcap", "bag.mcap"],
    "--step": ["--step", "1"],
    "--cell": ["--cell", "1,1"],
    "--follow": ["--follow"],
}


@pytest.fixture(scope="module")
def paths(tmp_path_factory: pytest.TempPathFactory) -> dict[kinds.Kind, Path]:
    """Return something of every kind, as far as telling it apart needs."""
    folder = tmp_path_factory.mktemp("kinds")
    run = write_run(folder, laps=1)
    found = {kinds.BIPED_RUN: run, kinds.PLAN: folder / "plan", kinds.SCENARIO: folder / "room_mission.yaml"}
    for kind, file, text in (
        (kinds.QUADRUPED_RUN, "walk/run.jsonl", '{"record": "header", "kind": "quadruped-run", "format": 2}\n'),
        (kinds.LIBRARY, "library/library.json", "{}"),
        (kinds.FOOTHOLDS, "plan.json", '{"kind": "foothold-plan"}'),
        (kinds.REGIONS, "step.json", '{"kind": "step-region"}'),
        (kinds.STRATEGY, "strategy.json", '{"kind": "gr1-strategy"}'),
        (kinds.RANKING, "ranking.json", '{"kind": "gr1-ranking"}'),
        (kinds.TERRAIN, "scan.json", '{"kind": "terrain"}'),
    ):
        path = folder / file
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
        found[kind] = path.parent if path.parent != folder else path
    found[kinds.QUADRUPED_TERRAIN] = write_field(folder / "field.yaml")
    return found


def refused(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """Return what is said about arguments that are refused with one sentence."""
    assert main(arguments) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    return said


def test_every_kind_is_told_apart(paths: dict[kinds.Kind, Path]) -> None:
    assert {kind: kinds.kind_of(path) for kind, path in paths.items()} == {kind: kind for kind in paths}


def test_what_a_kind_does_not_have_is_refused_and_what_it_has_is_named(
    paths: dict[kinds.Kind, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    for kind, path in paths.items():
        for option, given in OPTIONS.items():
            if option in kind.options or (not option and kind.pictures):
                continue
            said = refused(["view", str(path), *given], capsys)
            assert f"{path}: is {kind.name}, and has no {option or 'picture'}" in said
            assert all(other in said for other in kind.options)


@pytest.mark.parametrize(
    ("given", "complaint"),
    [
        (["--html", "p.html", "--follow"], "--follow, --html and --mcap are different ways to look"),
        (["--step", "1", "--cell", "1,1"], "--step, --cell are different ways to look"),
        (["--html", "p.html", "-o", "pictures"], "-o names a folder for pictures"),
        (["--follow", "-o", "pictures"], "-o names a folder for pictures"),
        (["--port", "8123"], "--port belongs to --follow"),
        (["--html", "."], "is a folder; name a file"),
        (["--mcap", "."], "is a folder; name a file"),
        (["--heading", "north"], "--heading and --goal belong to --cell"),
        (["--cell", "1"], "is no cell"),
        (["--step", "99999"], "has no step 99999; the steps that were walked are 0 to"),
    ],
)
def test_options_that_do_not_go_together(
    given: list[str], complaint: str, paths: dict[kinds.Kind, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    assert complaint in refused(["view", str(paths[kinds.BIPED_RUN]), *given], capsys)


@pytest.mark.parametrize("option", OPTIONS)
def test_what_is_nothing_to_look_at(option: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "empty").mkdir()
    (tmp_path / "noise.json").write_bytes(bytes(range(256)))
    (tmp_path / "zebra.json").write_text(json.dumps({"kind": "zebra"}))
    (tmp_path / "noise.bin").write_bytes(bytes(range(256)))
    (tmp_path / "events.yaml").write_text("format: 1\nkind: quadruped-events\nevents: []\n")
    for name, complaint in (
        ("missing", "does not exist"),
        ("empty", "is none of these"),
        ("noise.bin", "is none of these"),
        ("events.yaml", "is none of these"),
        ("noise.json", "is not whole JSON"),
        ("zebra.json", "is no kind that can be drawn; allowed are foothold-plan,"),
    ):
        assert complaint in refused(["view", str(tmp_path / name), *OPTIONS[option]], capsys)


def test_the_terrain_of_a_quadruped_is_drawn(paths: dict[kinds.Kind, Path], tmp_path: Path) -> None:
    assert main(["view", str(paths[kinds.QUADRUPED_TERRAIN]), "-o", str(tmp_path)]) == 0
    assert (tmp_path / "field.png").stat().st_size > 10_000


@pytest.mark.parametrize("option", ["", "--html", "--mcap", "--follow"])
def test_the_log_of_a_quadruped_of_another_version(
    option: str, paths: dict[kinds.Kind, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    said = refused(["view", str(paths[kinds.QUADRUPED_RUN]), *OPTIONS[option]], capsys)
    assert "run.jsonl:1: kind: is no log of a quadruped's run of format 1" in said
