"""One turn of the obstacles of a kind, transcribed from rules.md 4: images, assignments, observations, hidden images.

A set of cells is a row of words; bit b of word w stands for the cell with place 32 w + b among all domains' cells. A
list of visible cells is one number, its *code*: places plus one, ascending from the lowest digit, in digits of
``digit_bits`` bits.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from surefoot.errors import LimitExceeded
from surefoot.verify.row_index import place_of

Ints = NDArray[Any]
WORD = 32
MOST_OBSERVATIONS = 3_000_000
EXACT, REGIONS, SINGLE = 0, 1, 2


class Field(NamedTuple):
    """Where the obstacles of a kind may be, and what is believed of them.

    Attributes:
        near: (places, 4) neighbours in the domain, -1 for none.
        speed: moves in a turn.
        domain: its words.
        method: EXACT, REGIONS or SINGLE.
        regions: (regions, words), cut with the domain; with the rest.
        members: how many obstacles the kind has.
        digit_bits: bits of a digit of a code.
    """

    near: Ints
    speed: int
    domain: Ints
    method: int
    regions: Ints
    members: int
    digit_bits: int


@njit(cache=True)
def has(words: Ints, place: int) -> bool:
    """Return whether a set holds a place; -1 is in none."""
    return place >= 0 and words[place // WORD] >> (place % WORD) & 1 == 1


@njit(cache=True)
def places_of(words: Ints) -> Ints:
    """Return the places of a set, ascending."""
    found, count = np.empty(len(words) * WORD, np.int64), 0
    for number in range(len(words)):
        if words[number]:
            for bit in range(WORD):
                if words[number] >> bit & 1:
                    found[count] = number * WORD + bit
                    count += 1
    return found[:count]


@njit(cache=True)
def image(field: Field, start: Ints, barred: int) -> Ints:
    """Return next of a set; no move ends in the barred place (-1: none), and it does not stay there."""
    found, edge = start.copy(), places_of(start)
    for _ in range(field.speed):
        fresh, count = np.empty(4 * len(edge), np.int64), 0
        for place in edge:
            for side in range(4):
                other = field.near[place, side]
                if other >= 0 and other != barred and not has(found, other):
                    found[other // WORD] |= 1 << (other % WORD)
                    fresh[count] = other
                    count += 1
        edge = fresh[:count]
    if barred >= 0:
        found[barred // WORD] &= ~(1 << (barred % WORD))
    return found


@njit(cache=True)
def abstraction(field: Field, hidden: Ints, seen: Ints) -> Ints:
    """Return the belief that stands for a hidden image."""
    if field.method == EXACT:
        return hidden
    if field.method == SINGLE:
        return field.domain & ~seen
    found = np.zeros_like(hidden)
    for number in range(len(field.regions)):
        if (field.regions[number] & hidden).any():
            found |= field.regions[number]
    return found & ~seen


@njit(cache=True)
def inserted(code: int, place: int, digit_bits: int) -> int:
    """Return the code of a list with one more cell."""
    shift, mask = 0, (1 << digit_bits) - 1
    while code >> shift & mask and code >> shift & mask <= place:
        shift += digit_bits
    low = code & ((1 << shift) - 1)
    return low | (place + 1) << shift | (code >> shift) << (shift + digit_bits)


@njit(cache=True)
def listed(code: int, digit_bits: int) -> Ints:
    """Return the places of a code."""
    found, count = np.empty(64, np.int64), 0
    while code:
        found[count] = (code & ((1 << digit_bits) - 1)) - 1
        code >>= digit_bits
        count += 1
    return found[:count]


@njit(cache=True)
def _one_more(codes: Ints, hiders: Ints, shown: Ints, hides: int, digit_bits: int) -> tuple[Ints, Ints]:
    """Let one more obstacle be seen somewhere, or hide.

    Args:
        codes: every observation of the obstacles before it, once.
        hiders: of each, who is hidden in some assignment that fits: a set of bits.
        shown: places where it may be seen.
        hides: its bit when it may be hidden, else 0.
        digit_bits: of a digit of a code.
    """
    most, size = len(codes) * (len(shown) + 1), 16
    if most > MOST_OBSERVATIONS:
        raise LimitExceeded("the hidden obstacles of a kind may be seen in too many ways after one turn")
    while size < 2 * most:
        size *= 2
    slots, after, who = np.full(size, -1, np.int64), np.empty((most, 1), np.int64), np.zeros(most, np.int64)
    count = 0
    for number in range(len(codes)):
        for choice in range(len(shown) + (hides != 0)):
            seen = choice < len(shown)
            after[count, 0] = inserted(codes[number], shown[choice], digit_bits) if seen else codes[number]
            slot = place_of(slots, after, after[count])
            if slots[slot] < 0:
                slots[slot] = count
                count += 1
            who[slots[slot]] |= hiders[number] | (0 if seen else hides)
    return after[:count, 0].copy(), who[:count].copy()


@njit(cache=True)
def turn_of_kind(field: Field, code: int, hidden: Ints, barred: int, seen: Ints) -> tuple[Ints, Ints, Ints, Ints]:
    """Return what a kind may be known to be after a turn.

    Args:
        field: of the kind.
        code: its visible cells.
        hidden: where its hidden obstacles may be.
        barred: the place of a robot that stands, -1 when it moves or stands outside all domains.
        seen: what is seen from the view cell.

    Returns:
        Codes of the observations, for each the row of its hidden set, these rows, and all cells that an obstacle of
        the kind may be in.
    """
    visible = listed(code, field.digit_bits)
    images = np.zeros((len(visible) + 1, len(seen)), np.int64)
    for number in range(len(visible)):
        alone = np.zeros_like(seen)
        alone[visible[number] // WORD] |= 1 << (visible[number] % WORD)
        images[number] = image(field, alone, barred)
    images[-1] = image(field, hidden, barred)
    codes, hiders = np.zeros(1, np.int64), np.zeros(1, np.int64)
    for number in range(field.members):
        source = min(number, len(visible))
        hides = 1 << source if (images[source] & ~seen).any() else 0
        codes, hiders = _one_more(codes, hiders, places_of(images[source] & seen), hides, field.digit_bits)
    row_of, rows = np.full(1 << len(images), -1, np.int64), np.zeros((1 << len(images), len(seen)), np.int64)
    count, hidden_rows = 0, np.empty(len(codes), np.int64)
    for number in range(len(codes)):
        who = hiders[number]
        if row_of[who] < 0:
            row_of[who] = count
            if who:
                rows[count] = abstraction(field, _united(images, who) & ~seen, seen)
            count += 1
        hidden_rows[number] = row_of[who]
    return codes, hidden_rows, rows[:count], _united(images, (1 << len(images)) - 1)


@njit(cache=True)
def _united(images: Ints, who: int) -> Ints:
    """Return the union of those rows whose bits are set."""
    found = np.zeros(images.shape[1], np.int64)
    for number in range(len(images)):
        if who >> number & 1:
            found |= images[number]
    return found
