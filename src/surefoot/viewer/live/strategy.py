"""The strategy of a plan in three dimensions, served to this machine's browsers: which order for what is known."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from surefoot.frames import Direction
from surefoot.navigation import Order
from surefoot.viewer import style
from surefoot.viewer.browser.page import HOST, colour, server
from surefoot.viewer.browser.scenery import light
from surefoot.viewer.live.look import LookPanel
from surefoot.viewer.live.strategy_choices import Question, Seen, StrategyBook, hidden_cells
from surefoot.viewer.scenes.belief_tiles import KIND_HUES, BeliefTiles
from surefoot.viewer.scenes.run import add_ground, map_cameras
from surefoot.viewer.sources.cells import centre_m, floor_m, heights_of
from surefoot.viewer.sources.plans import PlanSource, read_plan_source, strategy_of

MOST_OFFERED = 2000
"""Values of a dropdown; of more, those about the chosen one are offered."""

_ANYWHERE = "anywhere"
_ABOVE_M = 0.06
_REACH = 0.3
"""Half the length of an order's arrow, in cells."""
_OBSTACLE_M = (0.3, 1.1)
_LOOKS: dict[str, float] = {"shaft_radius": 0.035, "head_radius": 0.12, "head_length": 0.24}


class StrategyScene:
    """Draws a plan into a scene, and what its strategy orders for any knowledge.

    Args:
        scene: of a viser server.
        plan: the plan.
        book: its strategy.
    """

    def __init__(self, scene: Any, plan: PlanSource, book: StrategyBook) -> None:
        self.scene, self.plan, self.book = scene, plan, book
        self.heights = heights_of(plan)
        self.nodes: list[Any] = []
        light(scene)
        add_ground(scene, plan)
        self.tiles = BeliefTiles(scene, plan)

    def show(self, asked: Question) -> None:
        """Show the orders of a question, its obstacles and its belief."""
        for node in self.nodes:
            node.remove()
        self.nodes.clear()
        for cell, order in self.book.orders(asked).items():
            self._add_order(cell, order, chosen=asked.cell in (None, cell))
        for kind, cells in enumerate(asked.seen):
            for cell in cells:
                self._add_obstacle(kind, cell)
        if asked.cell is not None:
            self._add_robot(asked.cell, Direction(asked.heading))
        grid = self.plan.grid
        self.tiles.show(frozenset((kind, grid.cell(cell)) for kind, cell in self.book.believed(asked)))

    def _place(self, cell: int, above_m: float) -> Any:
        at = self.plan.grid.cell(cell)
        return np.array([*centre_m(self.plan, at), floor_m(self.heights, at) + above_m])

    def _along(self, way: Direction) -> Any:
        yaw_rad = way.yaw_rad + self.plan.grid.rotation_rad
        return _REACH * self.plan.grid.cell_size_m * np.array([np.cos(yaw_rad), np.sin(yaw_rad), 0.0])

    def _add_order(self, cell: int, order: Order, *, chosen: bool) -> None:
        """Add an arrow; those of cells that are not asked about are thin."""
        at, middle, along = self.plan.grid.cell(cell), self._place(cell, _ABOVE_M), self._along(order.direction)
        hue = style.RIGHT if order.waits else style.BLUE
        size = self.plan.grid.cell_size_m * (1.0 if chosen else 0.4)
        looks = {name: value * size for name, value in _LOOKS.items()}
        name = f"/orders/{at.row}_{at.column}/{str(order).replace(' ', '_')}"
        self.nodes.append(
            self.scene.add_arrows(name, np.array([[middle - along, middle + along]]), colour(hue), **looks)
        )

    def _add_obstacle(self, kind: int, cell: int) -> None:
        radius_m, height_m = _OBSTACLE_M
        at, place = self.plan.grid.cell(cell), self._place(cell, height_m / 2)
        name, hue = f"/obstacles/{kind}/{at.row}_{at.column}", colour(KIND_HUES[kind % len(KIND_HUES)][0])
        self.nodes.append(self.scene.add_cylinder(name, radius_m, height_m, hue, position=place))

    def _add_robot(self, cell: int, heading: Direction) -> None:
        """Add a post with an arrow along the heading."""
        along, up = 1.2 * self._along(heading), np.array([0.0, 0.0, 0.65])
        post = self.scene.add_cylinder("/robot", 0.08, 1.3, colour(style.BLACK), position=self._place(cell, 0.65))
        arrow = self.scene.add_arrows("/robot/heading", np.array([[up, up + along]]), colour(style.BLACK))
        label = self.scene.add_label("/robot/name", f"heads {heading.name.lower()}", position=1.3 * up)
        self.nodes += [label, arrow, post]


class StrategyView:
    """Dropdowns for a question, and its answer in the scene and in words.

    Args:
        running: a viser server.
        plan_dir: the folder of the plan.
    """

    def __init__(self, running: Any, plan_dir: Path) -> None:
        self.plan = read_plan_source(plan_dir)
        self.book = StrategyBook(strategy_of(self.plan))
        self.lock, self.setting = threading.RLock(), False
        self.look = LookPanel(running)
        self.words = running.gui.add_markdown("")
        self.boxes: dict[str, Any] = {}
        self.asked, self.choices = self.book.settled(self.book.first())
        for name, (labels, number) in self._offers().items():
            box = running.gui.add_dropdown(name, labels, initial_value=labels[number])
            box.on_update(self._changed(name))
            self.boxes[name] = box
        self.scene = StrategyScene(running.scene, self.plan, self.book)
        self._show()
        self.look.look_from(lambda: map_cameras(self.plan))

    def ask(self, asked: Question) -> None:
        """Show the answer to a question, or to the nearest one that the strategy answers."""
        with self.lock:
            self.asked, self.choices = self.book.settled(asked)
            self._show()

    def _show(self) -> None:
        self.setting = True
        for name, (labels, number) in self._offers().items():
            if tuple(self.boxes[name].options) != labels:
                self.boxes[name].options = labels
            if self.boxes[name].value != labels[number]:
                self.boxes[name].value = labels[number]
        self.setting = False
        self.words.content = self._says()
        with self.look.running.atomic():
            self.scene.show(self.asked)

    def _says(self) -> str:
        """Say the order in the chosen cell, or how many cells there are."""
        orders = self.book.orders(self.asked)
        if self.asked.cell is not None:
            return f"**order: {orders[self.asked.cell]}**"
        return f"{len(orders)} cells in which this can be known; blue: moves, red: waits"

    def _changed(self, name: str) -> Callable[[Any], None]:
        def changed(event: Any) -> None:
            if self.setting or event.client is None:
                return
            with self.lock:
                number = self.boxes[name].options.index(self.boxes[name].value)
                field, values = self._fields()[name]
                self.ask(replace(self.asked, **{field: values[number]}))

        return changed

    def _offers(self) -> dict[str, tuple[tuple[str, ...], int]]:
        """Return what every dropdown offers, and the number of what is chosen."""
        found = {}
        for name, (field, values) in self._fields().items():
            labels = tuple(self._label(field, value) for value in values)
            found[name] = labels, values.index(getattr(self.asked, field))
        return found

    def _fields(self) -> dict[str, tuple[str, tuple[Any, ...]]]:
        """Return the dropdowns: their names, the part of a question that they set, and the values that they offer."""
        asked, choices = self.asked, self.choices
        return {
            "goal": ("goal", choices.goals),
            "heading": ("heading", choices.headings),
            "cell": ("cell", choices.cells),
            "obstacles": ("seen", _near(choices.seen, asked.seen)),
            "belief": ("state", _near(choices.states, asked.state)),
        }

    def _label(self, field: str, value: Any) -> str:
        if field == "goal":
            return f"{value}, in {self._named(self.book.strategy.goals[value])}"
        if field == "heading":
            return Direction(value).name.lower()
        if field == "cell":
            return _ANYWHERE if value is None else self._named(value)
        if field == "seen":
            return self._sight(value)
        cells = hidden_cells(self.book.strategy.states[value])
        return f"{cells} cells (knowledge {value})" if cells else f"none hidden (knowledge {value})"

    def _sight(self, seen: Seen) -> str:
        kinds = self.book.strategy.kinds
        said = []
        for kind, (cells, members) in enumerate(zip(seen, kinds, strict=True)):
            places = [self._named(cell) for cell in cells] + ["hidden"] * (len(members) - len(cells))
            said.append((f"kind {kind + 1}: " if len(kinds) > 1 else "") + ", ".join(places))
        return "; ".join(said) or "none"

    def _named(self, cell: int) -> str:
        at = self.plan.grid.cell(cell)
        return f"({at.row}, {at.column})"


def _near(values: tuple[Any, ...], chosen: Any) -> tuple[Any, ...]:
    """Return so many values about the chosen one as a dropdown can offer."""
    begin = max(0, min(values.index(chosen) - MOST_OFFERED // 2, len(values) - MOST_OFFERED))
    return values[begin : begin + MOST_OFFERED]


def serve_strategy(plan_dir: Path, port: int | None, say: Callable[[str], None]) -> None:
    """Serve the strategy of a plan until the process is interrupted.

    Args:
        plan_dir: the folder of the plan.
        port: to listen on; None takes any free one.
        say: is told where the view is.

    Raises:
        BackendMissing: viser is not installed.
        InputError: the plan cannot be read, or the port is in use.
    """
    with server(port) as running:
        StrategyView(running, plan_dir)
        say(f"http://{HOST}:{running.get_port()}")
        threading.Event().wait()
