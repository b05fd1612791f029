"""The obstacles of a scene as they truly are: where they can go, and how simulated ones move."""
