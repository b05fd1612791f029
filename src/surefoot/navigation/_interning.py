"""Compiled tables that give every pair of numbers, and every set of cells, one small number.

The tables have a fixed room; ``put`` and ``put_mask`` answer -1 when it is used up, and the caller, outside of compiled
code, goes on with a table of twice the room. Numbers that were given stay valid.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

FULL = -1
Number = Any
"""A whole number, of Python or of compiled code."""


class Pairs(NamedTuple):
    """Pairs by number: ``left[i]`` and ``right[i]``; ``slots`` finds a pair's number; ``used[0]`` of them exist."""

    left: NDArray[np.int64]
    right: NDArray[np.int64]
    slots: NDArray[np.int32]
    used: NDArray[np.int64]


class Masks(NamedTuple):
    """Sets of cells by number, as rows of 64-bit words."""

    words: NDArray[np.uint64]
    slots: NDArray[np.int32]
    used: NDArray[np.int64]


def empty_pairs(room: int) -> Pairs:
    """Return a table for so many pairs."""
    slots = np.full(_slots(room), -1, np.int32)
    return Pairs(np.zeros(room, np.int64), np.zeros(room, np.int64), slots, np.zeros(1, np.int64))


def empty_masks(room: int, width: int) -> Masks:
    """Return a table for so many sets; the empty set has the number 0."""
    table = Masks(np.zeros((room, width), np.uint64), np.full(_slots(room), -1, np.int32), np.zeros(1, np.int64))
    put_mask(table, np.zeros(width, np.uint64))
    return table


def larger_pairs(table: Pairs) -> Pairs:
    """Return the same pairs, with the same numbers, in twice the room."""
    new = empty_pairs(2 * len(table.left))
    _copy_pairs(table, new)
    return new


def larger_masks(table: Masks) -> Masks:
    """Return the same sets, with the same numbers, in twice the room."""
    new = empty_masks(2 * len(table.words), table.words.shape[1])
    for number in range(1, int(table.used[0])):
        put_mask(new, table.words[number])
    return new


def _slots(room: int) -> int:
    return 1 << (2 * room - 1).bit_length()


@njit(cache=True)
def _copy_pairs(old: Pairs, new: Pairs) -> None:
    for number in range(old.used[0]):
        put(new, old.left[number], old.right[number])


@njit(cache=True)
def mixed(left: Number, right: Number, size: int) -> Number:
    """Return where to look for a pair first, among ``size`` slots, a power of two."""
    value = np.uint64(left) * np.uint64(0x9E3779B97F4A7C15) + np.uint64(right)
    value ^= value >> np.uint64(29)
    value *= np.uint64(0xBF58476D1CE4E5B9)
    value ^= value >> np.uint64(32)
    return np.int64(value & np.uint64(size - 1))


@njit(cache=True)
def find(table: Pairs, left: Number, right: Number) -> Number:
    """Return the number of a pair, or -1."""
    size = table.slots.size
    slot = mixed(left, right, size)
    while table.slots[slot] >= 0:
        number = table.slots[slot]
        if table.left[number] == left and table.right[number] == right:
            return np.int64(number)
        slot = (slot + 1) & (size - 1)
    return np.int64(-1)


@njit(cache=True)
def put(table: Pairs, left: Number, right: Number) -> Number:
    """Return the number of a pair, a new one if need be; -1 when the table is full."""
    size = table.slots.size
    slot = mixed(left, right, size)
    while table.slots[slot] >= 0:
        number = table.slots[slot]
        if table.left[number] == left and table.right[number] == right:
            return np.int64(number)
        slot = (slot + 1) & (size - 1)
    number = table.used[0]
    if number == table.left.size:
        return np.int64(FULL)
    table.left[number], table.right[number] = left, right
    table.slots[slot] = number
    table.used[0] = number + 1
    return np.int64(number)


@njit(cache=True)
def put_mask(table: Masks, words: NDArray[np.uint64]) -> Number:
    """Return the number of a set, a new one if need be; -1 when the table is full."""
    size = table.slots.size
    value = np.int64(0)
    for word in words:
        value = value * np.int64(31) + mixed(np.int64(word), value, 1 << 62)
    slot = mixed(value, 1, size)
    while table.slots[slot] >= 0:
        number = table.slots[slot]
        same = True
        for place in range(words.size):
            if table.words[number, place] != words[place]:
                same = False
                break
        if same:
            return np.int64(number)
        slot = (slot + 1) & (size - 1)
    number = table.used[0]
    if number == table.words.shape[0]:
        return np.int64(FULL)
    table.words[number] = words
    table.slots[slot] = number
    table.used[0] = number + 1
    return np.int64(number)
