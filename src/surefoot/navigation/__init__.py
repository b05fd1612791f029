"""Belief, the navigation game and the action game (Shamsah et al., T-RO 2023, VI; docs/rules.md)."""

from surefoot.navigation.action_game import (
    ActionGame,
    Deviations,
    FineState,
    Moved,
    apply_action,
    build_action_game,
    deviations,
    displace_action,
    standing_start,
)
from surefoot.navigation.action_rules import STOP_ORDER, Action, ActionRules, Context, Mode, action_rules, order_context
from surefoot.navigation.action_synthesis import FineStart, solve_action
from surefoot.navigation.automatic_regions import automatic_regions
from surefoot.navigation.belief import BeliefKind
from surefoot.navigation.belief_study import BeliefAnswer, belief_study
from surefoot.navigation.coarse import CoarseMap, adjacent_free, coarse_map
from surefoot.navigation.navigation_game import NavigationGame, build_navigation_game
from surefoot.navigation.navigation_rules import NavigationProblem, Order, Rules, allowed_orders
from surefoot.navigation.obstacles import (
    BeliefTracking,
    Obstacle,
    ObstacleKind,
    ObstacleKinds,
    ObstacleState,
    obstacle_kinds,
)
from surefoot.navigation.strategies import (
    ActionStrategy,
    NavigationStrategy,
    load_action_strategy,
    load_navigation_strategy,
    save_arrays,
)
from surefoot.navigation.synthesis import Unrealizable, solve_navigation
from surefoot.navigation.throughput import Throughput, throughput

__all__ = [
    "STOP_ORDER",
    "Action",
    "ActionGame",
    "ActionRules",
    "ActionStrategy",
    "BeliefAnswer",
    "BeliefKind",
    "BeliefTracking",
    "CoarseMap",
    "Context",
    "Deviations",
    "FineStart",
    "FineState",
    "Mode",
    "Moved",
    "NavigationGame",
    "NavigationProblem",
    "NavigationStrategy",
    "Obstacle",
    "ObstacleKind",
    "ObstacleKinds",
    "ObstacleState",
    "Order",
    "Rules",
    "Throughput",
    "Unrealizable",
    "action_rules",
    "adjacent_free",
    "allowed_orders",
    "apply_action",
    "automatic_regions",
    "belief_study",
    "build_action_game",
    "build_navigation_game",
    "coarse_map",
    "deviations",
    "displace_action",
    "load_action_strategy",
    "load_navigation_strategy",
    "obstacle_kinds",
    "order_context",
    "save_arrays",
    "solve_action",
    "solve_navigation",
    "standing_start",
    "throughput",
]
