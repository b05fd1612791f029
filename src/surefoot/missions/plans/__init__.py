"""From a scenario to a verified plan folder, and back from the folder to what walks it (docs/formats.md 2)."""
