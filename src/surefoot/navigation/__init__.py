"""Belief, the navigation game and the action game (Shamsah et al., T-RO 2023, VI; docs/rules.md)."""

from surefoot.navigation.action_game import (
    ActionGame,
    Deviations,
    FineState,
    Moved,
    apply_action,
    build_action_game,
    deviations,
    standing_start,
)
from surefoot.navigation.action_rules import STOP_ORDER, Action, ActionRules, Context, Mode, action_rules, order_context
from surefoot.navigation.belief import BeliefKind, first_knowledge
from surefoot.navigation.coarse import CoarseMap, adjacent_free, coarse_map
from surefoot.navigation.navigation_game import (
    NavigationGame,
    NavigationProblem,
    Order,
    Rules,
    allowed_orders,
    build_navigation_game,
)
from surefoot.navigation.obstacles import ObstacleDomain, ObstacleState, obstacle_domain
from surefoot.navigation.strategies import (
    ActionStrategy,
    NavigationStrategy,
    load_action_strategy,
    load_navigation_strategy,
    save_arrays,
)
from surefoot.navigation.synthesis import FineStart, Unrealizable, solve_action, solve_navigation

__all__ = [
    "STOP_ORDER",
    "Action",
    "ActionGame",
    "ActionRules",
    "ActionStrategy",
    "BeliefKind",
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
    "ObstacleDomain",
    "ObstacleState",
    "Order",
    "Rules",
    "Unrealizable",
    "action_rules",
    "adjacent_free",
    "allowed_orders",
    "apply_action",
    "build_action_game",
    "build_navigation_game",
    "coarse_map",
    "deviations",
    "first_knowledge",
    "load_action_strategy",
    "load_navigation_strategy",
    "obstacle_domain",
    "order_context",
    "save_arrays",
    "solve_action",
    "solve_navigation",
    "standing_start",
]
