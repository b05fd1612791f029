"""Gaits: which feet are in contact when; named ones, and files as OCS2 users write them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import InputError

LEG_NAMES = ("LF", "RF", "LH", "RH")
"""The legs as mode names list them, in the order of ``surefoot.robots.quadruped.FEET``."""

_WHOLE = 1e-3
MOST_SAMPLES = 2000
_LARGEST_FILE = 100_000


@dataclass(frozen=True, slots=True)
class Gait:
    """A sequence of contact modes.

    Attributes:
        modes: the legs in contact joined by ``_`` (``LF_RH``), or ``STANCE`` or ``FLY``.
        switching_times_s: one more than there are modes, from 0 to the horizon.
    """

    modes: tuple[str, ...]
    switching_times_s: tuple[float, ...]

    @property
    def horizon_s(self) -> float:
        """How long the gait lasts."""
        return self.switching_times_s[-1]


@dataclass(frozen=True, slots=True)
class FreeGait:
    """A gait that is to be found.

    Attributes:
        horizon_s: how long it lasts.
    """

    horizon_s: float


@dataclass(frozen=True, slots=True)
class Footstep:
    """One full swing of a foot, and the stance that follows.

    Attributes:
        foot: index of the foot.
        step: the how-manieth step of that foot, from 0.
        lift: first swing sample.
        touch: first stance sample after it.
        leave: first sample of the next swing, or the number of samples.
    """

    foot: int
    step: int
    lift: int
    touch: int
    leave: int

    @property
    def cleared(self) -> range:
        """Return the samples at which the foot keeps the swing clearance."""
        quarter = (self.touch - self.lift) // 4
        return range(self.lift + quarter, self.touch - quarter)


def _trot(cycles: int, stands_first: str = "LF_RH", then: str = "RF_LH") -> Gait:
    modes = (stands_first, "STANCE", then, "STANCE") * cycles
    times = [round(cycle + part, 3) for cycle in range(cycles) for part in (0.0, 0.45, 0.5, 0.95)]
    return Gait(modes, (*times, float(cycles)))


_WALK = ("STANCE", "LF_RF_RH", "STANCE", "RF_LH_RH", "STANCE", "LF_RF_LH", "STANCE", "LF_LH_RH", "STANCE")

NAMED = {
    "trot-1s": _trot(1),
    "trot-2s": _trot(2),
    "trot-3s": _trot(3),
    "walk-2.25s": Gait(_WALK, (0.0, 0.05, 0.55, 0.6, 1.1, 1.15, 1.65, 1.7, 2.2, 2.25)),
    "leap-1.5s": Gait(("STANCE", "LH_RH", "FLY", "LF_RF", "STANCE"), (0.0, 0.5, 0.65, 0.85, 1.0, 1.5)),
    "trot-2s-mirrored": _trot(2, "RF_LH", "LF_RH"),
    "trot-3s-mirrored": _trot(3, "RF_LH", "LF_RH"),
}
"""Zhou et al. 2025, VI-A and IX; the timing of leap and walk is an assumption, and mirrored trots are ours."""


def mode_contacts(mode: str) -> tuple[bool, bool, bool, bool]:
    """Return which feet a mode holds in contact.

    Raises:
        InputError: the mode has another form than ``LF_RH``, ``STANCE`` or ``FLY``.
    """
    if mode == "FLY":
        return (False,) * 4
    legs = LEG_NAMES if mode == "STANCE" else tuple(mode.split("_"))
    if len(set(legs)) != len(legs) or not set(legs) <= set(LEG_NAMES):
        raise InputError(
            f"there is no contact mode {mode!r}; a mode is STANCE, FLY, or the legs in contact among LF, RF, LH, RH "
            "joined by underscores, such as LF_RH",
            key="gait.modes",
        )
    return tuple(leg in legs for leg in LEG_NAMES)  # type: ignore[return-value]


def samples_of(gait: Gait, step_s: float) -> tuple[int, ...]:
    """Return the switching times in samples.

    Raises:
        InputError: the times do not ascend from 0, or are no multiples of the step.
    """
    times = gait.switching_times_s
    if len(times) != len(gait.modes) + 1:
        raise InputError(
            f"needs one time more than there are modes, {len(gait.modes) + 1}, not {len(times)}",
            key="gait.switching_times_s",
        )
    if times[0] != 0 or any(b <= a for a, b in pairwise(times)):
        raise InputError("needs times that ascend from 0", key="gait.switching_times_s")
    if times[-1] / step_s > MOST_SAMPLES:
        raise InputError(
            f"lasts {times[-1]:g} s, more than the {MOST_SAMPLES} steps of {step_s:g} s that are allowed",
            key="gait.switching_times_s",
        )
    counts = tuple(round(time / step_s) for time in times)
    for time, count in zip(times, counts, strict=True):
        if abs(time / step_s - count) > _WHOLE:
            raise InputError(
                f"{time:g} s is no multiple of step_s = {step_s:g} s; switching times have to fit the step", key="gait"
            )
    if counts[-1] < 4:
        raise InputError(f"lasts {counts[-1]} steps; at least 4 are needed", key="gait")
    return counts


def contact_table(gait: Gait, step_s: float) -> NDArray[np.bool_]:
    """Return which feet are in contact at which sample, shape (N, 4).

    Sample i stands for the time i * step_s and has the mode whose half-open interval holds it; sample 0 counts as
    stance in every gait.
    """
    counts = samples_of(gait, step_s)
    table = np.zeros((counts[-1], 4), dtype=np.bool_)
    for mode, begin, end in zip(gait.modes, counts, counts[1:], strict=False):
        table[begin:end] = mode_contacts(mode)
    table[0] = True
    return table


def footsteps(contacts: NDArray[np.bool_]) -> tuple[Footstep, ...]:
    """Return every maximal run of swing samples with stance before and after, by foot and then by time."""
    found = []
    size = len(contacts)
    for foot in range(contacts.shape[1]):
        changes = np.flatnonzero(np.diff(contacts[:, foot].astype(np.int8))) + 1
        lifts = [int(i) for i in changes if not contacts[i, foot]]
        touches = [int(i) for i in changes if contacts[i, foot]]
        for step, (lift, touch) in enumerate(zip(lifts, touches, strict=False)):
            leave = lifts[step + 1] if step + 1 < len(lifts) else size
            found.append(Footstep(foot, step, lift, touch, leave))
    return tuple(found)


def read_gait(path: Path) -> Gait:
    """Read a gait as OCS2 users write it: ``modeSequence { [0] LF_RH ... }`` and ``switchingTimes { [0] 0.0 ... }``.

    Raises:
        InputError: the file holds no such lists.
    """
    try:
        with path.open("rb") as stream:
            data = stream.read(_LARGEST_FILE + 1)
    except OSError as problem:
        raise InputError(f"cannot be read: {problem.strerror}", source=path, key="gait") from problem
    if len(data) > _LARGEST_FILE:
        raise InputError(f"is larger than the {_LARGEST_FILE} bytes that are allowed", source=path, key="gait")
    text = re.sub(r"[;#][^\n]*", "", data.decode("utf-8", "replace"))
    modes = _listed(text, "modeSequence", path)
    try:
        times = tuple(float(word) for word in _listed(text, "switchingTimes", path))
    except ValueError as problem:
        raise InputError("switchingTimes needs numbers", source=path, key="gait") from problem
    if not all(np.isfinite(times)):
        raise InputError("switchingTimes needs finite numbers", source=path, key="gait")
    return Gait(modes, times)


def gait_text(gait: Gait) -> str:
    """Return a gait as OCS2 users write it, and as ``read_gait`` reads it."""
    modes = "\n".join(f"  [{k}]  {mode}" for k, mode in enumerate(gait.modes))
    times = "\n".join(f"  [{k}]  {time:.9g}" for k, time in enumerate(gait.switching_times_s))
    return f"modeSequence\n{{\n{modes}\n}}\n\nswitchingTimes\n{{\n{times}\n}}\n"


def _listed(text: str, name: str, path: Path) -> tuple[str, ...]:
    """Return the entries of the first list of a name, in the order of their indices."""
    block = re.search(name + r"\s*\{([^{}]*)\}", text)
    entries = re.findall(r"\[(\d{1,6})\]\s*(\S+)", block.group(1)) if block else []
    if not entries or [int(index) for index, _ in entries] != list(range(len(entries))):
        raise InputError(
            f"needs a list `{name} {{ [0] ... [1] ... }}` with indices from 0; allowed are gait files as OCS2 "
            "users write them",
            source=path,
            key="gait",
        )
    return tuple(word for _, word in entries)
