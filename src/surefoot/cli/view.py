"""``surefoot view``: pictures of a run or a plan."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from surefoot.cli.output import AsJson, answer
from surefoot.errors import InputError

if TYPE_CHECKING:
    from surefoot.viewer.answers import Asked


class Heading(StrEnum):
    """The directions of the grid."""

    NORTH = "north"
    EAST = "east"
    SOUTH = "south"
    WEST = "west"


def view(
    path: Annotated[Path, typer.Argument(help="The folder of a run or of a plan, or a scenario.", show_default=False)],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="The folder for the pictures; default: that folder.")
    ] = None,
    cell: Annotated[
        str | None,
        typer.Option(metavar="R,C", help="Of a plan: what the strategy does in this cell, for every belief."),
    ] = None,
    heading: Annotated[Heading | None, typer.Option(help="With this heading; default: the commonest there.")] = None,
    goal: Annotated[int | None, typer.Option(min=0, help="On the way to this goal; default: the commonest.")] = None,
    step: Annotated[
        int | None, typer.Option(min=0, help="Of a run: this step, with its push and the strategy around it.")
    ] = None,
    html: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write a page that shows it in motion; opens without a network.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Draw a run (map, feet, belief, phase space, keyframes) or a plan (its grid, or its answers in a cell).

    Examples:
      surefoot view run/
      surefoot view run/ --html replay.html
      surefoot view run/ --step 12
      surefoot view plan/ -o pictures/
      surefoot view plan/ --cell 3,4 --heading west --goal 1
      surefoot view my.yaml
    """
    from surefoot.viewer import view_answers, view_folder, view_page, view_step

    if html is not None:
        if output is not None or cell is not None or step is not None:
            raise InputError("--html FILE names all that is written; leave out -o, --cell and --step")
        page = view_page(path, html)
        answer({"page": page}, [f"Wrote {page}: open it with any browser"], yes=True, as_json=as_json)
    if cell is None and (heading is not None or goal is not None):
        raise InputError("--heading and --goal belong to --cell R,C; give all or none of them")
    if step is not None:
        if cell is not None:
            raise InputError("--step belongs to a run and --cell to a plan; give one of them")
        pictures = view_step(path, step, output)
    elif cell is not None:
        pictures = view_answers(path, _asked(cell, heading, goal), output)
    else:
        pictures = view_folder(path, output)
    answer({"pictures": pictures}, [str(picture) for picture in pictures], yes=True, as_json=as_json)


def _asked(cell: str, heading: Heading | None, goal: int | None) -> Asked:
    """Return the robot state that was asked about."""
    from surefoot.frames import Cell, Direction
    from surefoot.viewer.answers import Asked

    parts = cell.split(",")
    if len(parts) != 2 or not all(part.strip().isdecimal() and len(part) < 9 for part in parts):
        raise InputError(f"--cell {cell!r} is no cell; allowed are a row and a column, such as 3,4")
    row, column = map(int, parts)
    return Asked(Cell(row, column), None if heading is None else Direction[heading.name], goal)
