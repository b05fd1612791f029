"""Scenes in three dimensions: a biped's run, a quadruped's motion, the ground and the belief in them."""
