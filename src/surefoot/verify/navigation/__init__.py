"""Checks navigation strategies against docs/rules.md 4: what a plan claims, belief, orders, goals, liveness."""
