"""Checks libraries of skills: certificates, strategies, terrain states, claims (docs/formats.md 11)."""
