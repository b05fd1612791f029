"""Pictures of a biped's mission on its map: plans, what a strategy answers, where a run went, what it believed."""
