"""The first compilation of the sweep: seconds, once on a machine."""

from __future__ import annotations

import numpy as np

from surefoot.reach._sweep import sweep
from surefoot.reach.flows import flow, images
from surefoot.reach.lattice import Lattice
from surefoot.reach.parameters import Disturbance, Reading


def warm_up() -> None:
    """Compile the sweep, or load what was compiled before, on a grid of four cells."""
    cells = Lattice(0.0, 0.1, 0.1, 0.1, 2, 2)
    target = np.array([[False, False], [True, True]])
    step = flow((3.0,), 0.02, Disturbance(Reading.RATE))
    sweep(target, ~target, images(cells, 0.0, step), False)
