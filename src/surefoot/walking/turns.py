"""Lengths of the steps of a quarter turn that end exactly on the centre of a fine cell.

A quarter turn has k steps; step i first turns by 90/k degrees and then goes its length along the new heading. With f
the way along the original heading and t the way toward the turn's side, lengths that are symmetric (l_i = l_(k-i))
obey t = f + l_k, so that one free length and a whole last step remove all drift. The nominal lengths of the papers
are 0.43 m for a step away from the stance foot and 0.28 m for a step toward it (Shamsah et al., T-RO 2023, Eqs. 8-9).
The authors end a type-B turn with 0.47 m; with 0.52 m, the next whole number of cells, that step overshoots the bound
on the switch speed in some runs, so it is 0.42 m here.
"""

from __future__ import annotations

import math

from surefoot.errors import InputError

END_TOLERANCE_CELLS = 1e-3
_REFERENCE_CELL_M = 0.1039812
_LONG_CELLS = 0.43 / _REFERENCE_CELL_M
_SHORT_CELLS = 0.28 / _REFERENCE_CELL_M


def quarter_turn_end(lengths_cells: tuple[float, ...]) -> tuple[float, float]:
    """Return how far a quarter turn goes along its original heading and toward its side, in fine cells."""
    turn_rad = math.pi / 2 / len(lengths_cells)
    forward = sum(length * math.cos(i * turn_rad) for i, length in enumerate(lengths_cells, 1))
    sideways = sum(length * math.sin(i * turn_rad) for i, length in enumerate(lengths_cells, 1))
    return forward, sideways


def booked_displacements(lengths_cells: tuple[float, ...], turn_rad: float) -> tuple[tuple[int, int], ...]:
    """Return what each step of a turn is booked as: (forward, sideways) in fine cells of the original heading.

    The sum of the first i displacements is the cell that contains the true point after i steps.
    """
    booked: list[tuple[int, int]] = []
    forward = sideways = 0.0
    cell = (0, 0)
    for i, length in enumerate(lengths_cells, 1):
        forward += length * math.cos(i * turn_rad)
        sideways += length * math.sin(i * turn_rad)
        reached = (round(forward), round(sideways))
        booked.append((reached[0] - cell[0], reached[1] - cell[1]))
        cell = reached
    return tuple(booked)


def default_lengths(turn_steps: int, turn_type: str) -> tuple[float, ...]:
    """Derive drift-free lengths near the nominal pattern, which alternates between long and short steps.

    When k is even the pattern is symmetric but for its last length, and the long lengths are stretched to make f
    whole. When k is odd it is not, and equal lengths would carry the CoM out of the turn; all lengths are then
    changed as little as makes f and t whole.

    Args:
        turn_steps: k, how many steps make a quarter turn.
        turn_type: ``A`` (the first step is away from the stance foot) or ``B`` (it is toward it).

    Returns:
        k lengths in fine cells.
    """
    first_is_long = turn_type == "A"
    nominal = [_LONG_CELLS if (i % 2 == 0) == first_is_long else _SHORT_CELLS for i in range(turn_steps)]
    if turn_steps % 2:
        return _whole(tuple(nominal))
    turn_rad = math.pi / 2 / turn_steps
    body = nominal[:-1]
    stretched = [length == max(body) for length in body]
    ahead = [length * math.cos(i * turn_rad) for i, length in enumerate(body, 1)]
    free = sum(length for length, is_free in zip(ahead, stretched, strict=True) if is_free)
    stretch = 1 + (max(1, round(sum(ahead))) - sum(ahead)) / free
    lengths = [length * stretch if is_free else length for length, is_free in zip(body, stretched, strict=True)]
    return (*lengths, float(round(nominal[-1])))


def drift_free(lengths_cells: tuple[float, ...], key: str) -> tuple[float, ...]:
    """Return given lengths with their last rounding error removed, so that a turn ends exactly on a cell centre.

    Raises:
        InputError: if they end further than 1e-3 fine cells from a cell centre.
    """
    forward, sideways = quarter_turn_end(lengths_cells)
    missing = (round(forward) - forward, round(sideways) - sideways)
    if max(abs(missing[0]), abs(missing[1])) > END_TOLERANCE_CELLS:
        raise InputError(
            f"a turn of these lengths ends {forward:.4f} fine cells forward and {sideways:.4f} sideways; "
            f"both must be whole numbers up to {END_TOLERANCE_CELLS}",
            key=key,
        )
    return _whole(lengths_cells)


def _whole(lengths: tuple[float, ...]) -> tuple[float, ...]:
    """Return lengths that end on the nearest cell centre, changed with the least sum of squares."""
    forward, sideways = quarter_turn_end(lengths)
    missing = (round(forward) - forward, round(sideways) - sideways)
    turn_rad = math.pi / 2 / len(lengths)
    columns = [(math.cos(i * turn_rad), math.sin(i * turn_rad)) for i in range(1, len(lengths) + 1)]
    a = sum(c * c for c, _ in columns)
    b = sum(c * s for c, s in columns)
    d = sum(s * s for _, s in columns)
    determinant = a * d - b * b
    p = (d * missing[0] - b * missing[1]) / determinant
    q = (a * missing[1] - b * missing[0]) / determinant
    return tuple(length + c * p + s * q for length, (c, s) in zip(lengths, columns, strict=True))
