"""Scenario files of a biped, and the scene that they describe on their map."""
