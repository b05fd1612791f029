"""Checks the run log of a biped: decisions, steps, feet, the pendulum, pushes (docs/formats.md 3)."""
