"""A navigation problem as arrays for the compiled exploration: sets of cells become rows of 64-bit words."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from surefoot.navigation.navigation_rules import Rules

Words = NDArray[np.uint64]


class World(NamedTuple):
    """K kinds of obstacles on C cells, of which D can hold an obstacle, in rows of W words; P parts of beliefs.

    ``threats``, ``can_clear`` and ``can_show`` are the sets of assumption (c) for every kind, cell and direction: cells
    that threaten the move; whose component has a cell free for it; one that is seen, too.
    """

    obstacles: NDArray[np.int64]
    speed: NDArray[np.int64]
    within: Words
    beside: Words
    seen: Words
    bit_of: NDArray[np.int64]
    parts: Words
    part_of: NDArray[np.int64]
    narrowed: bool
    post: bool
    escape_clause: bool
    target: NDArray[np.int32]
    stairs: NDArray[np.bool_]
    threats: Words
    can_clear: Words
    can_show: Words


def world_of(rules: Rules) -> World:
    """Return the arrays of a problem."""
    problem, kinds, coarse = rules.problem, rules.kinds, rules.problem.coarse
    cells, domain = len(coarse.target), len(kinds.cells)
    width = max(1, (domain + 63) // 64)
    bit_of = np.full(cells, -1, np.int64)
    bit_of[list(kinds.cells)] = np.arange(domain)
    parts = rules.abstract.parts
    part_of = np.zeros(domain, np.int64)
    for number, part in enumerate(parts):
        part_of[[bit_of[cell] for cell in kinds.members(part)]] = number
    within = words_of((kind.within for kind in kinds), width)
    beside = words_of((mask for kind in kinds for mask in kind.beside), width).reshape(len(kinds.kinds), domain, width)
    speed = np.array([kind.speed_cells for kind in kinds], np.int64)
    seen = words_of(kinds.seen_from, width)
    return World(
        np.array([len(kind.obstacles) for kind in kinds], np.int64),
        speed,
        within,
        beside,
        seen,
        bit_of,
        words_of(parts, width),
        part_of,
        rules.abstract.narrowed,
        problem.view == "post",
        problem.escape_clause,
        coarse.target,
        np.array([coarse.is_stairs(cell) for cell in range(cells)]),
        *_clearance(speed, within, beside, seen, bit_of, coarse.target),
    )


def words_of(masks: Iterable[int], width: int) -> Words:
    """Return masks as rows of words."""
    data = b"".join(mask.to_bytes(8 * width, "little") for mask in masks)
    return np.frombuffer(data, np.uint64).reshape(-1, width)


@njit(cache=True)
def has(words: Words, bit: int) -> bool:
    """Return whether a set has a cell."""
    return bool(words[bit >> 6] >> np.uint64(bit & 63) & np.uint64(1) != 0)


@njit(cache=True)
def spread(beside: Words, speed: int, barred: int, mask: Words) -> None:
    """Replace a set by where obstacles in it can be after one turn; no move ends in the barred cell (-1: none)."""
    for _ in range(speed):
        before = mask.copy()
        for word in range(mask.size):
            rest = before[word]
            while rest:
                low = rest & (~rest + np.uint64(1))
                rest ^= low
                bit = word * 64 + _position(low)
                for place in range(mask.size):
                    mask[place] |= beside[bit, place]
        if barred >= 0 and not has(before, barred):
            mask[barred >> 6] &= ~(np.uint64(1) << np.uint64(barred & 63))
    if barred >= 0:
        mask[barred >> 6] &= ~(np.uint64(1) << np.uint64(barred & 63))


@njit(cache=True)
def _position(low: np.uint64) -> int:
    """Return the number of the only set bit."""
    position = 0
    for step in (32, 16, 8, 4, 2, 1):
        if low >> np.uint64(step):
            low >>= np.uint64(step)
            position += step
    return position


@njit(cache=True)
def _clearance(
    speed: NDArray[np.int64],
    within: Words,
    beside: Words,
    seen: Words,
    bit_of: NDArray[np.int64],
    target: NDArray[np.int32],
) -> tuple[Words, Words, Words]:
    """Return threats, can_clear and can_show: (kinds, cells, 4, words) each."""
    kinds, domain, width = beside.shape
    cells = target.shape[0]
    threats = np.zeros((kinds, cells, 4, width), np.uint64)
    can_clear = np.zeros((kinds, cells, 4, width), np.uint64)
    can_show = np.zeros((kinds, cells, 4, width), np.uint64)
    for kind in range(kinds):
        for cell in range(cells):
            component = _components(beside[kind], within[kind], bit_of[cell], domain)
            for move in range(4):
                goal = target[cell, move]
                if goal < 0:
                    continue
                danger = threats[kind, cell, move]
                for place in (bit_of[cell], bit_of[goal]):
                    if place >= 0 and has(within[kind], place):
                        danger[place >> 6] |= np.uint64(1) << np.uint64(place & 63)
                spread(beside[kind], speed[kind], -1, danger)
                clears = np.zeros(domain + 1, np.bool_)
                shows = np.zeros(domain + 1, np.bool_)
                for bit in range(domain):
                    if component[bit] >= 0 and not has(danger, bit):
                        clears[component[bit]] = True
                        shows[component[bit]] |= has(seen[cell], bit)
                for bit in range(domain):
                    if component[bit] >= 0:
                        one = np.uint64(1) << np.uint64(bit & 63)
                        if clears[component[bit]]:
                            can_clear[kind, cell, move, bit >> 6] |= one
                        if shows[component[bit]]:
                            can_show[kind, cell, move, bit >> 6] |= one
    return threats, can_clear, can_show


@njit(cache=True)
def _components(beside: Words, within: Words, barred: int, domain: int) -> NDArray[np.int64]:
    """Return for every cell the number of its connected component in the domain without the barred cell, else -1."""
    component = np.full(domain, -1, np.int64)
    queue = np.empty(domain, np.int64)
    for seed in range(domain):
        if component[seed] >= 0 or seed == barred or not has(within, seed):
            continue
        component[seed] = seed
        queue[0], done, filled = seed, 0, 1
        while done < filled:
            bit = queue[done]
            done += 1
            for word in range(beside.shape[1]):
                rest = beside[bit, word]
                while rest:
                    low = rest & (~rest + np.uint64(1))
                    rest ^= low
                    near = word * 64 + _position(low)
                    if near != barred and component[near] < 0:
                        component[near] = seed
                        queue[filled] = near
                        filled += 1
    return component
