"""Pages that are served while they are looked at: runs as they are walked, and strategies that answer questions."""
