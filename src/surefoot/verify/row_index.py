"""Finds rows of whole numbers in a table: open addressing over the hash of a row."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

Ints = NDArray[Any]


@njit(cache=True)
def place_of(slots: Ints, rows: Ints, row: Ints) -> int:
    """Return the slot that holds a row, or the free slot where it belongs."""
    mixed = np.uint64(0x9E3779B97F4A7C15)
    for value in row:
        mixed = (mixed ^ np.uint64(value)) * np.uint64(0xBF58476D1CE4E5B9)
        mixed ^= mixed >> np.uint64(29)
    place = np.int64(mixed & np.uint64(len(slots) - 1))
    while slots[place] >= 0:
        same = True
        for column in range(len(row)):
            if rows[slots[place], column] != row[column]:
                same = False
                break
        if same:
            return int(place)
        place = (place + 1) & (len(slots) - 1)
    return int(place)


@njit(cache=True)
def slots_of(rows: Ints, least: int = 16) -> tuple[Ints, int]:
    """Return the index of a table of int64 rows, and a row that stands in it twice, or -1."""
    size = 16
    while size < max(2 * len(rows), least):
        size *= 2
    slots, twice = np.full(size, -1, np.int64), -1
    for number in range(len(rows)):
        place = place_of(slots, rows, rows[number])
        if slots[place] >= 0:
            twice = number
        else:
            slots[place] = number
    return slots, twice


@njit(cache=True)
def row_of(slots: Ints, rows: Ints, row: Ints) -> int:
    """Return the number of a row, -1 where the table has none."""
    return int(slots[place_of(slots, rows, row)])


@njit(cache=True)
def numbered(rows: Ints) -> tuple[Ints, Ints]:
    """Return the number of every row among the distinct ones, and where each of these stands first."""
    size = 16
    while size < 2 * len(rows):
        size *= 2
    slots = np.full(size, -1, np.int64)
    numbers, firsts = np.empty(len(rows), np.int64), np.empty(len(rows), np.int64)
    count = 0
    for place in range(len(rows)):
        slot = place_of(slots, rows, rows[place])
        if slots[slot] < 0:
            slots[slot] = place
            firsts[count], numbers[place] = place, count
            count += 1
        else:
            numbers[place] = numbers[slots[slot]]
    return numbers, firsts[:count]
