"""Whether ends and Newton's law contradict each other by themselves: who is hardly carried cannot come to rest."""

from __future__ import annotations

import numpy as np

from surefoot.verify.footholds.file import FootholdFile

_CONTRADICTION_M = 1e-6


def falls(plan: FootholdFile) -> bool:
    """Return whether no forces at all bring the base to the goal and to rest there.

    The base is at rest at sample 0 and accelerates by F[i] / m + g at every other one; at the last two it is at the
    goal. What F[i] adds to these two places is known, so that two samples in contact reach any goal. With fewer, least
    squares tell.
    """
    size, dt = len(plan.contacts), plan.number("step_s")
    carried = np.flatnonzero(plan.contacts.any(axis=1))
    carried = carried[carried > 0]
    if len(carried) > 1:
        return False
    ends = np.array([size - 2, size - 1])
    gains = dt**2 * np.maximum(ends[:, None] - carried + 1, 0.0)
    start, goal = (np.array(plan.values[key]["position_m"], dtype=float) for key in ("start", "goal"))
    wanted = np.tile(goal - start, (2, 1))
    wanted[:, 2] += plan.number("gravity_mps2") * dt**2 * ends * (ends + 1) / 2
    found = np.linalg.lstsq(gains, wanted, rcond=None)[0]
    return bool(np.abs(gains @ found - wanted).max() > _CONTRADICTION_M)
