"""Derives the scene of a biped again from its scenario and map: grid, heights, sight (docs/rules.md 1 to 3)."""
