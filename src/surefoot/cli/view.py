"""``surefoot view``: pictures of a run or a plan."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from surefoot.cli.output import AsJson, answer


def view(
    path: Annotated[Path, typer.Argument(help="The folder of a run or of a plan, or a scenario.", show_default=False)],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="The folder for the pictures; default: that folder.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Draw a run (map, feet, belief, phase space, keyframes) or a plan (its grid).

    Examples:
      surefoot view run/
      surefoot view plan/ -o pictures/
      surefoot view my.yaml
    """
    from surefoot.viewer import view_folder

    pictures = view_folder(path, output)
    answer({"pictures": pictures}, [str(picture) for picture in pictures], yes=True, as_json=as_json)
