"""Checks the run of a quadruped: its records, moves, events and end (docs/formats.md 12)."""
