"""What all scenes in three dimensions share: which way is up, and light."""

from __future__ import annotations

from typing import Any


def light(scene: Any) -> None:
    """Set up a scene: z upwards, light from everywhere with one sun, no shadows.

    Args:
        scene: of a viser server.
    """
    scene.set_up_direction("+z")
    scene.configure_default_lights(cast_shadow=False)
