"""Pushes on a walking biped: where they come from, and how a pushed step is recovered."""
