"""Checks saved step regions: their sets by definition, their promise against an adversary."""
