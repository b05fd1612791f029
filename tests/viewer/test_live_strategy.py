"""The strategy of a plan with dropdowns, in a browser and without one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from browsing import Opened, browser
from hypothesis import given
from hypothesis import strategies as st

from surefoot.navigation import NavigationStrategy, Order
from surefoot.viewer.browser.page import HOST, server
from surefoot.viewer.live import strategy as live_strategy
from surefoot.viewer.live.strategy import StrategyView
from surefoot.viewer.live.strategy_choices import Question, StrategyBook
from surefoot.viewer.sources.plans import PlanSource

BOXES = "[...document.querySelectorAll('input[aria-haspopup=listbox]')].slice(-5).map(box => box.value)"


@pytest.fixture(scope="module")
def looked(tutorial_plan: Path) -> Iterator[tuple[StrategyView, Opened]]:
    with server() as running, browser() as one:
        view = StrategyView(running, tutorial_plan)
        one.open(f"http://{HOST}:{running.get_port()}", "/orders")
        yield view, one


def question(strategy: NavigationStrategy, row: int) -> Question:
    """Return the question that a decision of the strategy answers."""
    state = int(strategy.state[row])
    cell, heading, goal = int(strategy.cell[row]), int(strategy.heading[row]), int(strategy.goal[row])
    return Question(goal, heading, cell, strategy.states[state].visible, state)


@given(share=st.floats(0, 1, exclude_max=True))
def test_every_decision_can_be_asked_for(strategy: NavigationStrategy, share: float) -> None:
    row, book = int(share * strategy.size), StrategyBook(strategy)
    asked = question(strategy, row)
    settled, choices = book.settled(asked)
    assert settled == asked
    assert asked.cell in choices.cells
    assert asked.state in choices.states
    assert asked.cell is not None
    assert book.orders(asked)[asked.cell] == Order.of(int(strategy.order[row]))


@given(numbers=st.tuples(*[st.integers(-2, 40)] * 4))
def test_what_is_chosen_last_gives_way(strategy: NavigationStrategy, numbers: tuple[int, int, int, int]) -> None:
    book = StrategyBook(strategy)
    goal, heading, cell, state = numbers
    settled, choices = book.settled(Question(goal, heading, cell, (), state))
    assert book.orders(settled)
    assert settled == book.settled(settled)[0]
    if goal in choices.goals:
        assert settled.goal == goal
        if heading in choices.headings:
            assert settled.heading == heading


def nodes_of(book: StrategyBook, source: PlanSource, asked: Question) -> set[str]:
    """Return the names of the arrows for a question."""
    found = {source.grid.cell(cell): order for cell, order in book.orders(asked).items()}
    return {f"/orders/{at.row}_{at.column}/{str(order).replace(' ', '_')}" for at, order in found.items()}


def leaves(opened: Opened, prefix: str) -> set[str]:
    return {name for name in opened.nodes(prefix) if name.count("/") == 3}


@pytest.mark.xdist_group("browser")
def test_the_scene_shows_the_orders_and_what_is_known(
    looked: tuple[StrategyView, Opened], source: PlanSource, strategy: NavigationStrategy
) -> None:
    view, opened = looked
    sizes = [sum(mask.bit_count() for mask in strategy.states[state].hidden) for state in strategy.state]
    asked = question(strategy, int(np.argmax(sizes)))
    view.ask(asked)
    opened.wait(f"document.body.innerText.includes('order: {view.book.orders(asked)[asked.cell or 0]}')")
    opened.page.wait_for_timeout(500)
    assert leaves(opened, "/orders/") == nodes_of(view.book, source, asked)
    assert len(leaves(opened, "/belief/")) == max(sizes)
    assert not leaves(opened, "/obstacles/")


def test_a_dropdown_offers_what_is_near(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(live_strategy, "MOST_OFFERED", 4)
    values = tuple("abcdefgh")
    for chosen, offered in (("a", "abcd"), ("d", "bcde"), ("h", "efgh")):
        assert "".join(live_strategy._near(values, chosen)) == offered
    assert live_strategy._near(("a", "b"), "b") == ("a", "b")


@pytest.mark.xdist_group("browser")
def test_a_dropdown_changes_the_answer(looked: tuple[StrategyView, Opened], source: PlanSource) -> None:
    view, opened = looked
    view.ask(view.book.first())
    before = view.asked
    opened.wait(f"{BOXES}[2] !== 'anywhere'")
    opened.page.locator("input[aria-haspopup=listbox]").nth(-3).click()
    opened.page.get_by_role("option", name="anywhere").click()
    opened.wait("document.body.innerText.includes('cells in which this can be known')")
    assert view.asked == replace(before, cell=None)
    opened.page.wait_for_timeout(500)
    assert leaves(opened, "/orders/") == nodes_of(view.book, source, view.asked)
    assert opened.page.evaluate(BOXES)[1:3] == ["east", "anywhere"]
    assert opened.errors == []
    assert {url.split("/")[2].split(":")[0] for url in opened.requests if url.startswith(("http", "ws"))} == {HOST}
