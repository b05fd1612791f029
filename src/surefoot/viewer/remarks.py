"""What is said of things that are drawn or recorded otherwise than they were planned."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

Say = Callable[[str], None]
"""Is told a remark."""

TOLERANCE_M = 1e-3
"""A leg reaches its foot when it comes as near as this."""


def silent(remark: str) -> None:
    """Say nothing."""


def said_of_frame(away_m: NDArray[np.float64], names: Sequence[str]) -> str:
    """Name the feet that are out of reach at a moment; empty if none is.

    Args:
        away_m: how far each foot is from where its leg can put it.
        names: of the feet.
    """
    far = [f"{name} {100 * away:.1f} cm" for name, away in zip(names, away_m, strict=True) if away > TOLERANCE_M]
    return f"out of its leg's reach: {', '.join(far)}" if far else ""


def out_of_reach(away_m: NDArray[np.float64]) -> tuple[str, ...]:
    """Say how many positions of feet are out of reach, and by how much at most; nothing if none is.

    Args:
        away_m: of every moment and foot.
    """
    far = away_m > TOLERANCE_M
    if not far.any():
        return ()
    share, most = 100 * float(far.mean()), 100 * float(away_m.max())
    return (
        f"{share:.1f} % of the feet's positions are out of the legs' reach, by up to {most:.1f} cm: "
        "these legs are drawn as near as they come",
    )
