"""Scenario files, the online executives and run logs."""
