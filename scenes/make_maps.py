"""Draw the maps of the example scenes from pictures in characters: ``python scenes/make_maps.py [folder]``.

'#' is occupied, '.' is free, 'o' has a box in the middle, a fifth of a cell wide; one character per coarse cell, north
at the top. A cell is 10 x 10 pixels, so that walls are whole pixels and cell borders lie on pixel borders. The
lower-left corner of every map is the world's origin.
"""

from __future__ import annotations

import sys
from pathlib import Path

PIXELS = 10
OCCUPIED, FREE = 0, 254
_MIDDLE = range(4, 6)
PICTURES = {
    "#": [[OCCUPIED] * PIXELS] * PIXELS,
    ".": [[FREE] * PIXELS] * PIXELS,
    "o": [
        [OCCUPIED if row in _MIDDLE and column in _MIDDLE else FREE for column in range(PIXELS)]
        for row in range(PIXELS)
    ],
}

SCENES = {
    # The two rooms of Shamsah et al., T-RO 2023, Fig. 14, with a border of walls.
    "two_rooms": (
        2.70351,
        """
        ############
        ####..##...#
        ####.......#
        #......#...#
        #..##..#...#
        #......#####
        ############
        """,
    ),
    # One room with a short wall that something can hide behind.
    "tutorial": (
        2.7,
        """
        ########
        #......#
        #..#...#
        #..#...#
        #......#
        ########
        """,
    ),
    # The smallest scene that is known in which it matters what the robot remembers of a hidden obstacle.
    "blind_corner": (
        2.7,
        """
        #######
        ###...#
        ##..#.#
        ##....#
        #######
        """,
    ),
    # A laboratory of 6 x 6 cells of 1 m with four boxes, in a hall: Shamsah et al., IX-D. The cells along the walls are
    # too near to them for a robot.
    "laboratory": (
        1.0,
        """
        ##########
        #........#
        #........#
        #..o..o..#
        #........#
        #........#
        #..o..o..#
        #........#
        #........#
        ##########
        """,
    ),
}


def pgm(rows: list[str]) -> bytes:
    """Return a binary PGM picture of rows of characters."""
    lines = [bytes(value for sign in row for value in PICTURES[sign][line]) for row in rows for line in range(PIXELS)]
    header = f"P5\n{len(rows[0]) * PIXELS} {len(rows) * PIXELS}\n255\n"
    return header.encode() + b"".join(lines)


def yaml(name: str, cell_size_m: float) -> str:
    """Return the map_server YAML of a picture."""
    return (
        f"image: {name}.pgm\n"
        "mode: trinary\n"
        f"resolution: {cell_size_m / PIXELS:.6f}\n"
        "origin: [0.0, 0.0, 0.0]\n"
        "negate: 0\n"
        "occupied_thresh: 0.65\n"
        "free_thresh: 0.25\n"
    )


def main(folder: Path) -> None:
    """Write every map into a folder."""
    for name, (cell_size_m, drawing) in SCENES.items():
        (folder / f"{name}.pgm").write_bytes(pgm(drawing.split()))
        (folder / f"{name}.yaml").write_text(yaml(name, cell_size_m))


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
