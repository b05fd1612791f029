"""Checks foothold plans: every row of the model, the cost, and the proof of the bound (docs/formats.md 6)."""
