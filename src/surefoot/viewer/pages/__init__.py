"""Pages that open from a file: replays and strategies."""
