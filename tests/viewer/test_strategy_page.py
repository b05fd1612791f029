"""The page that answers what a plan's strategy does, opened in a browser."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from browsing import Opened, browser

from surefoot.cli import main
from surefoot.navigation import NavigationStrategy, Order
from surefoot.viewer.sources.plans import PlanSource


@pytest.fixture(scope="module")
def opened(tutorial_plan: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Opened]:
    page = tmp_path_factory.mktemp("strategy") / "strategy.html"
    assert main(["view", str(tutorial_plan), "--html", str(page)]) == 0
    with browser() as one:
        one.page.goto(page.as_uri())
        yield one


def shown(opened: Opened) -> dict[tuple[int, int], str]:
    """Return the arrows on the page by cell."""
    script = "gs => gs.map(g => [Number(g.dataset.row), Number(g.dataset.column), g.dataset.order])"
    return {(row, column): order for row, column, order in opened.page.eval_on_selector_all("g[data-order]", script)}


@pytest.mark.xdist_group("browser")
@pytest.mark.parametrize("share", [0.0, 0.4, 0.9])
def test_the_orders_are_those_of_the_strategy(
    opened: Opened, source: PlanSource, strategy: NavigationStrategy, share: float
) -> None:
    row = int(share * (strategy.size - 1))
    cell, heading, goal = int(strategy.cell[row]), int(strategy.heading[row]), int(strategy.goal[row])
    opened.page.click("#everywhere")
    opened.page.select_option("#goal", str(goal))
    opened.page.select_option("#heading", str(heading))
    opened.page.locator("rect.free, rect.blocked").nth(cell).click()
    with_it = np.flatnonzero((strategy.cell == cell) & (strategy.heading == heading) & (strategy.goal == goal))
    assert f"of {len(set(strategy.state[with_it].tolist()))} with the robot" in opened.page.inner_text("#words")
    place = source.grid.cell(cell)
    found = set()
    for number in range(int(opened.page.get_attribute("#state", "max")) + 1):
        opened.page.locator("#state").fill(str(number))
        found.add((shown(opened)[place.row, place.column], opened.page.locator("[data-hidden]").count()))
    expected = set()
    for one in with_it.tolist():
        hidden = sum(mask.bit_count() for mask in strategy.states[strategy.state[one]].hidden)
        expected.add((str(Order.of(int(strategy.order[one]))), hidden))
    assert found == expected


@pytest.mark.xdist_group("browser")
def test_dropdowns_choose_the_cell_and_the_obstacles_in_view(
    opened: Opened, source: PlanSource, strategy: NavigationStrategy
) -> None:
    opened.page.click("#everywhere")
    row = int(np.argmax([bool(any(strategy.states[state].visible)) for state in strategy.state]))
    cell, heading, goal = int(strategy.cell[row]), int(strategy.heading[row]), int(strategy.goal[row])
    ((seen,),) = strategy.states[strategy.state[row]].visible
    place, at = source.grid.cell(cell), source.grid.cell(seen)
    for name, value in (("goal", goal), ("heading", heading), ("cell", cell)):
        opened.page.select_option(f"#{name}", str(value))
    opened.page.select_option("#seen", f"({at.row}, {at.column})")
    with_it = (strategy.cell == cell) & (strategy.heading == heading) & (strategy.goal == goal)
    states = [state for state in strategy.state[with_it] if strategy.states[state].visible == ((seen,),)]
    assert int(opened.page.get_attribute("#state", "max")) + 1 == len(states)
    assert f"of {len(states)} with the robot in cell ({place.row}, {place.column})" in opened.page.inner_text("#words")
    assert opened.page.locator("[data-seen]").count() == 1
    opened.page.click("#everywhere")
    assert opened.page.input_value("#cell") == ""


@pytest.mark.xdist_group("browser")
def test_nothing_is_asked_of_the_network(opened: Opened) -> None:
    assert len(opened.requests) == 1
    assert opened.errors == []
