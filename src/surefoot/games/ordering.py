"""The order of the decision diagram variables, derived from the rules.

Bits that occur together in small formulas come close together: a comparison or a sum interleaves the bits of its
integers, a table of cells keeps each integer's bits side by side. The primed copy of a bit follows the bit itself.

Source: Aloul, Markov and Sakallah, "FORCE: a fast and easy-to-implement variable-ordering heuristic", GLSVLSI 2003.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from surefoot.games.bits import BitGame, bits_of
from surefoot.logic.syntax import Atom, Node, children, postorder

_ROUNDS = 60
_IDLE_ROUNDS = 12
_WIDEST_EDGE = 12


def variable_orders(game: BitGame) -> list[list[int]]:
    """Return orders of the bits to try, top first.

    Two arrangements by FORCE, from two starts, and one that keeps pairs together; each stands here both ways round, at
    first the way with the environment's bits further down: most games are solved faster so, since the environment's
    next values are quantified last.
    """
    edges = _edges(game)
    starts = (list(range(len(game.bits))), _outputs_first(game))
    found = sorted((_force(start, edges) for start in starts), key=lambda order: _span(order, edges))
    found.append(_closest_first(len(game.bits), edges))
    found = [order[::-1] if _environment_above(game, order) else order for order in found]
    orders: list[list[int]] = []
    for order in (*found, *(order[::-1] for order in found)):
        if order not in orders:
            orders.append(order)
    return orders


def _environment_above(game: BitGame, order: Sequence[int]) -> bool:
    depth = [place for place, bit in enumerate(order) if bit < game.inputs]
    return bool(depth) and 2 * sum(depth) < len(depth) * (len(order) - 1)


def _outputs_first(game: BitGame) -> list[int]:
    return [*range(game.inputs, len(game.bits)), *range(game.inputs)]


def _edges(game: BitGame) -> list[tuple[int, float]]:
    """Return sets of bits (masks) that occur together, with weights that fall with their width."""
    numbers = {name: number for number, name in enumerate(game.bits)}
    parts = (*game.env_trans, *game.sys_trans, *game.justices, *game.goals)
    reads: dict[int, int] = {}
    counts: Counter[int] = Counter(part.current | part.following for part in parts)
    for node in postorder([part.formula for part in parts]):
        reads[id(node)] = mask = _reads(node, reads, numbers)
        if 2 <= mask.bit_count() <= _WIDEST_EDGE:
            counts[mask] += 1
    return [(mask, (1.0 + np.log2(count)) / mask.bit_count()) for mask, count in counts.items() if mask.bit_count() > 1]


def _reads(node: Node, reads: dict[int, int], numbers: dict[str, int]) -> int:
    if isinstance(node, Atom):
        return 1 << numbers[node.name]
    mask = 0
    for child in children(node):
        mask |= reads[id(child)]
    return mask


def _force(start: Sequence[int], edges: list[tuple[int, float]]) -> list[int]:
    """Move every bit to the mean of the centres of its edges, again and again; return the best order seen."""
    order = list(start)
    if not edges:
        return order
    members = [bits_of(mask) for mask, _ in edges]
    row = np.repeat(np.arange(len(edges)), [len(bits) for bits in members])
    column = np.concatenate([np.asarray(bits) for bits in members])
    weight = np.array([value for _, value in edges])[row]
    width = np.bincount(row)
    best, best_span = order, _span(order, edges)
    idle = 0
    for _ in range(_ROUNDS):
        position = np.empty(len(order))
        position[order] = np.arange(len(order))
        centre = np.bincount(row, position[column]) / width
        pull = np.bincount(column, weight, len(order))
        target = np.bincount(column, weight * centre[row], len(order)) / np.where(pull > 0, pull, 1)
        target = np.where(pull > 0, target, position)
        order, before = [int(bit) for bit in np.lexsort((position, target))], order
        span = _span(order, edges)
        idle += 1
        if span < best_span:
            best, best_span, idle = order, span, 0
        if order == before or idle == _IDLE_ROUNDS:
            break
    return best


def _closest_first(bits: int, edges: list[tuple[int, float]]) -> list[int]:
    """Place bit after bit, each time the one with the largest share of its ties to those placed already.

    Bits of a pair that many rules join come side by side even where one wide rule joins all pairs, as in an arbiter.
    """
    tie = np.zeros((bits, bits))
    for mask, weight in edges:
        members = bits_of(mask)
        tie[np.ix_(members, members)] += weight / (len(members) - 1)
    np.fill_diagonal(tie, 0.0)
    total, placed = np.maximum(tie.sum(axis=1), 1e-9), np.zeros(bits)
    order: list[int] = []
    free = np.ones(bits, dtype=np.bool_)
    for _ in range(bits):
        gain = np.where(free, placed / total, -1.0)
        chosen = int(np.argmax(gain))
        order.append(chosen)
        free[chosen] = False
        placed += tie[chosen]
    return order


def _span(order: Sequence[int], edges: list[tuple[int, float]]) -> float:
    """Return the weighted sum over the edges of the distance between their outermost bits."""
    position: NDArray[np.int64] = np.empty(len(order), dtype=np.int64)
    position[list(order)] = np.arange(len(order))
    total = 0.0
    for mask, weight in edges:
        places = position[bits_of(mask)]
        total += weight * float(places.max() - places.min())
    return total
