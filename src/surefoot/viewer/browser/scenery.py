"""What all scenes in three dimensions share: which way is up, and light in which colours are what they are."""

from __future__ import annotations

from typing import Any

_SKY, _BELOW, _SUN = (255, 255, 255), (150, 145, 138), (255, 250, 240)
_SUN_FROM_M = (-3.0, -5.0, 9.0)


def light(scene: Any) -> None:
    """Set up a scene: z upwards, a bright sky, a sun from the rear right, no shadows.

    Args:
        scene: of a viser server.
    """
    scene.set_up_direction("+z")
    scene.configure_default_lights(enabled=False)
    scene.configure_environment_map(None)
    scene.add_light_hemisphere("/light/sky", sky_color=_SKY, ground_color=_BELOW, intensity=1.8)
    scene.add_light_directional("/light/sun", color=_SUN, intensity=1.6, position=_SUN_FROM_M)
