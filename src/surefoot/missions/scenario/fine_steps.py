"""Between the action game and the walking planner: commands for actions, places for fine cells."""

from __future__ import annotations

import math
from dataclasses import dataclass

from surefoot.frames import Foot, heading_yaw_rad
from surefoot.missions.scenario.scene import BipedScene
from surefoot.navigation import STOP_ORDER, Action, ActionRules, FineState, Mode, apply_action, deviations
from surefoot.walking import StepCommand, StepKind
from surefoot.world.flights import CLEARANCE_M


@dataclass(frozen=True, slots=True)
class FineSteps:
    """Translates states and actions of the action game for the walking planner.

    Attributes:
        scene: the scenario on its map.
        rules: the action game's rules.
    """

    scene: BipedScene
    rules: ActionRules

    def command(self, state: FineState, action: int) -> StepCommand:
        """Return what the walking planner is told for an action; the nominal outcome gives the change of height."""
        tables = self.rules.tables
        nominal = apply_action(tables, state, action, 0, 0)
        turned = _signed(nominal.state.heading - state.heading, 4 * tables.turn_steps)
        return StepCommand(
            kind={Action.STOP: StepKind.STOP, Action.START: StepKind.START}.get(Action(min(action, 6)), StepKind.WALK),
            length_m=self._length_cells(state, action) * self.scene.walking.fine_cell_m,
            heading_change_rad=-turned * self._turn_rad,
            height_change_m=nominal.height_change_m,
            last_turn_step=turned != 0 and nominal.state.mode == Mode.WALKING,
            next_heading_changes_rad=self.next_changes(nominal.state, achieved=nominal.achieved),
            sagittal_outcomes_cells=deviations(tables, state, action).sagittal,
        )

    @property
    def _turn_rad(self) -> float:
        return math.radians(self.scene.walking.turn_angle_deg)

    def _length_cells(self, state: FineState, action: int) -> float:
        """Return how long a step is, in fine cells."""
        tables, walking = self.rules.tables, self.scene.walking
        if tables.length[action]:
            return float(tables.length[action])
        if action == Action.TURN:
            return walking.turn_a_cells[0] if state.mode == Mode.WALKING else walking.turn_b_cells[0]
        left = state.mode in (Mode.LEFT_A, Mode.LEFT_B)
        done = (-state.heading if left else state.heading) % tables.turn_steps
        return (walking.turn_a_cells if state.mode in (Mode.LEFT_A, Mode.RIGHT_A) else walking.turn_b_cells)[done]

    def next_changes(self, state: FineState, *, achieved: bool) -> tuple[float, ...]:
        """Return the heading changes, left positive, that the action game may command in a state.

        When the order was achieved the next one is unknown, and any turn away from the stance foot may come.
        """
        angle = self._turn_rad
        if state.mode == Mode.STANDING:
            return (0.0,)
        if state.mode >= Mode.LEFT_A:
            return (angle if state.mode in (Mode.LEFT_A, Mode.LEFT_B) else -angle,)
        ahead = state.heading // self.rules.tables.turn_steps
        order = self.rules.contexts[state.context].order
        away = -angle if state.stance == Foot.LEFT else angle
        if achieved:
            return (0.0, away)
        turns_left = order == (ahead + 3) % 4
        if order in (STOP_ORDER, ahead):
            return (0.0,)
        toward_order = angle if turns_left else -angle
        if state.mode == Mode.READY:
            return (toward_order,)
        return (0.0, away) if away == toward_order else (0.0,)

    def waypoint_m(self, cell: int, state: FineState) -> tuple[float, float, float]:
        """Return the map position of the centre of a fine cell; z is the floor."""
        grid, fine_m = self.scene.grid, self.scene.walking.fine_cell_m
        place = grid.cell(cell)
        east = grid.north_west_m[0] + place.column * grid.cell_size_m + (state.column + 0.5) * fine_m
        north = grid.north_west_m[1] - place.row * grid.cell_size_m - (state.row + 0.5) * fine_m
        x, y = (float(value) for value in grid.to_world((east, north)))
        return x, y, float(self.scene.heights.height_at(grid, (x, y)))

    def yaw_rad(self, state: FineState) -> float:
        """Return the map yaw of a state's heading."""
        return heading_yaw_rad(state.heading, 4 * self.rules.tables.turn_steps) + self.scene.grid.rotation_rad

    def contains(self, cell: int, state: FineState, point_m: tuple[float, float, float]) -> bool:
        """Return whether a fine cell (in a coarse cell) contains a point of the map, up to 1e-6 m."""
        x, y, _ = self.waypoint_m(cell, state)
        center = self.scene.grid.to_grid((x, y))
        point = self.scene.grid.to_grid(point_m[:2])
        reach = self.scene.walking.fine_cell_m / 2 + 1e-6
        return bool(abs(point[0] - center[0]) <= reach and abs(point[1] - center[1]) <= reach)

    def stands(
        self, foot_m: tuple[float, float, float], waypoint_m: tuple[float, float, float], yaw_rad: float
    ) -> bool:
        """Return whether the floor is level around a foot that stands ahead of its waypoint or behind it."""
        cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
        ahead = cos * (foot_m[0] - waypoint_m[0]) + sin * (foot_m[1] - waypoint_m[1])
        if abs(ahead) < 1e-6:
            return True
        grid, heights = self.scene.grid, self.scene.heights
        reach = CLEARANCE_M + 0.5 * self.scene.walking.fine_cell_m
        places = [(foot_m[0] + side * reach * cos, foot_m[1] + side * reach * sin) for side in (-1, 0, 1)]
        return all(abs(heights.height_at(grid, place) - foot_m[2]) < 1e-6 for place in places)


def _signed(difference: int, headings: int) -> int:
    """Return a difference of headings in -headings/2 .. headings/2."""
    return (difference + headings // 2) % headings - headings // 2
