"""The page of the strategy of a specification, asked and played in a browser."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from browsing import Opened, browser

from surefoot.cli import main
from surefoot.logic.strategy_file import load_strategy

TANK = Path(__file__).parents[2] / "scenes" / "specifications" / "tank.structuredslugs"


@pytest.fixture(scope="module")
def strategy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    saved = tmp_path_factory.mktemp("tank") / "tank.json"
    assert main(["synth", str(TANK), "-o", str(saved)]) == 0
    return saved


@pytest.fixture(scope="module")
def opened(strategy: Path) -> Iterator[Opened]:
    page = strategy.with_suffix(".html")
    assert main(["view", str(strategy), "--html", str(page)]) == 0
    with browser() as one:
        one.page.goto(page.as_uri())
        yield one


def rows(opened: Opened, table: str) -> list[list[str]]:
    script = "rows => rows.map(row => [...row.cells].map(cell => cell.textContent))"
    found: list[list[str]] = opened.page.eval_on_selector_all(f"#{table} tbody tr", script)
    return found


def written(values: list[int], goal: int) -> list[str]:
    rain, level, drain = values
    return [str(bool(rain)).lower(), str(level), str(bool(drain)).lower(), str(goal)]


@pytest.mark.xdist_group("browser")
def test_a_play_is_one_of_the_strategy(opened: Opened, strategy: Path) -> None:
    machine = load_strategy(strategy).transducer
    opened.page.click("#restart")
    node = int(machine.initial[0])
    for step in range(6):
        after = machine.after(node).tolist()
        shown = [written(machine.values[one].tolist(), int(machine.memory[one])) for one in after]
        assert rows(opened, "answers") == shown
        assert len(rows(opened, "trace")) == step + 1
        opened.page.locator("#answers tbody tr").nth(step % len(after)).click()
        node = after[step % len(after)]
    opened.page.click("#back")
    assert len(rows(opened, "trace")) == 6


@pytest.mark.xdist_group("browser")
def test_a_dropdown_goes_to_a_state_with_that_value(opened: Opened, strategy: Path) -> None:
    machine = load_strategy(strategy).transducer
    for level in sorted(set(machine.values[:, 1].tolist())):
        opened.page.select_option("select[data-variable=level]", str(level))
        ((*values, goal),) = rows(opened, "trace")
        assert values[1] == str(level)
        assert [*values, goal] in [
            written(row, memory) for row, memory in zip(machine.values.tolist(), machine.memory.tolist(), strict=True)
        ]
    assert opened.errors == []
    assert len(opened.requests) == 1


@pytest.mark.xdist_group("browser")
def test_a_strategy_of_the_environment_says_its_move(opened: Opened, tmp_path: Path) -> None:
    (tmp_path / "no.structuredslugs").write_text(TANK.read_text().replace("level = 5", "level = 7"))
    assert main(["synth", str(tmp_path / "no.structuredslugs"), "-o", str(tmp_path / "no.json")]) == 1
    assert main(["view", str(tmp_path / "no.json"), "--html", str(tmp_path / "no.html")]) == 0
    opened.page.goto((tmp_path / "no.html").as_uri())
    assert "a strategy of the environment" in opened.page.inner_text("#title")
    assert "The environment moves: rain = " in opened.page.inner_text("#next")


def test_a_strategy_that_is_too_large_is_refused(
    strategy: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("surefoot.viewer.pages.gr1.MOST_NUMBERS", 3)
    assert main(["view", str(strategy), "--html", str(tmp_path / "p.html")]) == 2
    assert "numbers, and a page at most 3; surefoot simulate plays it" in capsys.readouterr().err
