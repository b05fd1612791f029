"""Checks a plan as a whole: the action strategy against docs/rules.md 5, and that both strategies fit together."""
