"""Reads what is shown (plans, runs, foothold plans, terrain) and turns it into curves in time; draws nothing."""
