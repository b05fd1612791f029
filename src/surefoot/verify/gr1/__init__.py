"""Checks strategies and rankings of GR(1) specifications, with sets and rules of its own (docs/formats.md 4)."""
