"""The biped online: orders, steps, obstacles, assumptions that break; and its run log (docs/formats.md 3)."""
