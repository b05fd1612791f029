"""Checks terrain against its scan, and measures and classifies cells of a quadruped's map again."""
