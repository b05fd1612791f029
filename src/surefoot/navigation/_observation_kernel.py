"""Compiled: what the robot may know of one kind of obstacles after a turn (``belief.observe``, made fast)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from surefoot.navigation._interning import FULL, Masks, Pairs, mixed, put, put_mask
from surefoot.navigation._world_arrays import World, has, spread

DONE, MASKS_FULL, KNOWN_FULL, OUTCOMES_FULL, SCRATCH_FULL = 0, 1, 2, 3, 4


class Scratch(NamedTuple):
    """Work space for the observations of one turn: visible cells (packed) and which obstacles may be hidden with them.

    ``slots`` holds the turn's stamp in the upper 32 bits and an entry in the lower ones.
    """

    visible: NDArray[np.int64]
    sources: NDArray[np.int64]
    slots: NDArray[np.int64]
    stamp: NDArray[np.int64]


def empty_scratch(room: int) -> Scratch:
    """Return work space for so many observations."""
    slots = np.zeros(1 << (2 * room - 1).bit_length(), np.int64)
    return Scratch(np.zeros(room, np.int64), np.zeros(room, np.int64), slots, np.zeros(1, np.int64))


@njit(cache=True)
def unpack(packed: int, base: int, visible: NDArray[np.int64]) -> int:
    """Write the bits of visible obstacles, ascending, and return how many there are."""
    seen = 0
    while packed > 0:
        visible[seen] = packed % base - 1
        packed //= base
        seen += 1
    return seen


@njit(cache=True)
def observe_kind(
    world: World,
    masks: Masks,
    known: Pairs,
    scratch: Scratch,
    outcomes: NDArray[np.int32],
    filled: int,
    kind: int,
    now: int,
    view: int,
    barred: int,
) -> tuple[int, int]:
    """Append what may be known of a kind after a turn to ``outcomes``.

    Args:
        world: the problem.
        masks: all hidden sets.
        known: what can be known of a kind: visible cells (packed), hidden set and kind.
        scratch: work space.
        outcomes: takes numbers of ``known``.
        filled: how many it has.
        kind: the kind.
        now: what is known before.
        view: the cell from which the robot looks.
        barred: the bit of the cell in which the robot stands, -1 when it moves or no obstacle can be there.

    Returns:
        a status, and how many ``outcomes`` has then.
    """
    width, base = world.within.shape[1], world.part_of.size + 1
    count = world.obstacles[kind]
    kinds = world.obstacles.size
    visible = np.empty(count, np.int64)
    seen_before = unpack(known.left[now], base, visible)
    hidden_before = count - seen_before
    sources = seen_before + (1 if hidden_before else 0)
    in_view = world.seen[view]
    unseen = np.zeros((sources, width), np.uint64)
    options = np.empty((sources, width * 64 + 1), np.int64)
    ends = np.zeros(sources, np.int64)
    for source in range(sources):
        image = unseen[source]
        if source < seen_before:
            bit = visible[source]
            image[bit >> 6] = np.uint64(1) << np.uint64(bit & 63)
        else:
            image[:] = masks.words[known.right[now] // kinds]
        spread(world.beside[kind], world.speed[kind], barred, image)
        any_unseen = False
        for word in range(width):
            shown = image[word] & in_view[word]
            for offset in range(64):
                if shown >> np.uint64(offset) & np.uint64(1):
                    options[source, ends[source]] = word * 64 + offset
                    ends[source] += 1
            image[word] &= ~in_view[word]
            any_unseen |= image[word] != 0
        if any_unseen:
            options[source, ends[source]] = -1
            ends[source] += 1
        if ends[source] == 0:
            return DONE, filled
    entries = _combine(scratch, options, ends, count, seen_before, base)
    if entries == FULL:
        return SCRATCH_FULL, filled
    return _believe(world, masks, known, scratch, outcomes, filled, kind, view, entries, unseen)


@njit(cache=True)
def _combine(
    scratch: Scratch,
    options: NDArray[np.int64],
    ends: NDArray[np.int64],
    count: int,
    seen_before: int,
    base: int,
) -> int:
    """Collect the visible cells of all assignments, each with the obstacles that are hidden in some of them.

    The hidden obstacles have the same options, so their choices are taken in ascending order only.
    """
    scratch.stamp[0] += 1
    stamp = scratch.stamp[0] << 32
    size = scratch.slots.size
    entries = 0
    chosen = np.zeros(count, np.int64)
    cells = np.empty(count, np.int64)
    while True:
        shown, sources = 0, 0
        for obstacle in range(count):
            source = min(obstacle, seen_before)
            bit = options[source, chosen[obstacle]]
            if bit < 0:
                sources |= 1 << source
                continue
            place = shown
            while place > 0 and cells[place - 1] > bit:
                cells[place] = cells[place - 1]
                place -= 1
            cells[place] = bit
            shown += 1
        packed = 0
        for place in range(shown - 1, -1, -1):
            packed = packed * base + cells[place] + 1
        slot = mixed(packed, 1, size)
        while True:
            if scratch.slots[slot] >> 32 != stamp >> 32:
                if entries == scratch.visible.size:
                    return FULL
                scratch.visible[entries], scratch.sources[entries] = packed, sources
                scratch.slots[slot] = stamp | entries
                entries += 1
                break
            entry = scratch.slots[slot] & 0xFFFFFFFF
            if scratch.visible[entry] == packed:
                scratch.sources[entry] |= sources
                break
            slot = (slot + 1) & (size - 1)
        turning = count - 1
        while turning >= 0 and chosen[turning] == ends[min(turning, seen_before)] - 1:
            turning -= 1
        if turning < 0:
            return entries
        chosen[turning] += 1
        for later in range(turning + 1, count):
            chosen[later] = chosen[turning] if turning >= seen_before else 0


@njit(cache=True)
def _believe(
    world: World,
    masks: Masks,
    known: Pairs,
    scratch: Scratch,
    outcomes: NDArray[np.int32],
    filled: int,
    kind: int,
    view: int,
    entries: int,
    unseen: NDArray[np.uint64],
) -> tuple[int, int]:
    """Give every observation its belief; equal sets of hidden obstacles have equal ones."""
    if filled + entries > outcomes.size:
        return OUTCOMES_FULL, filled
    kinds, width = world.obstacles.size, unseen.shape[1]
    met_sources = np.empty(64, np.int64)
    met_masks = np.empty(64, np.int64)
    met = 0
    for entry in range(entries):
        sources = scratch.sources[entry]
        belief = np.int64(0)
        if sources:
            place = 0
            while place < met and met_sources[place] != sources:
                place += 1
            if place == met:
                image = np.zeros(width, np.uint64)
                for source in range(unseen.shape[0]):
                    if sources >> source & 1:
                        image |= unseen[source]
                found = put_mask(masks, _abstract(world, kind, view, image))
                if found == FULL:
                    return MASKS_FULL, filled
                place = min(met, 63)
                met_sources[place], met_masks[place] = sources, found
                met = place + 1
            belief = met_masks[place]
        number = put(known, scratch.visible[entry], belief * kinds + kind)
        if number == FULL:
            return KNOWN_FULL, filled
        outcomes[filled + entry] = number
    return DONE, filled + entries


@njit(cache=True)
def _abstract(world: World, kind: int, view: int, image: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Return the belief for a hidden image."""
    belief = np.zeros(image.size, np.uint64)
    for word in range(image.size):
        if image[word]:
            for offset in range(64):
                bit = word * 64 + offset
                if image[word] >> np.uint64(offset) & np.uint64(1) and not has(belief, bit):
                    belief |= world.parts[world.part_of[bit]]
    belief &= world.within[kind]
    if world.narrowed:
        belief &= ~world.seen[view]
    return belief
