"""What stands at a path, and in which ways it can be looked at."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from surefoot.documents import read_json_object
from surefoot.errors import InputError

_LARGEST_BYTES = 200_000_000
_HEAD_BYTES = 64_000
_YAML_KIND = re.compile(rb"""^["']?kind["']?\s*:\s*["']?([\w-]+)""", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of what can be looked at.

    Attributes:
        name: in a sentence, such as "the run of a biped".
        options: of ``surefoot view`` that it has; pictures need none.
        pictures: whether there are any.
        otherwise: what else is to be done with it, a clause.
    """

    name: str
    options: tuple[str, ...] = ()
    pictures: bool = True
    otherwise: str = ""


BIPED_RUN = Kind("the run of a biped", ("--html", "--mcap", "--follow", "--step"))
QUADRUPED_RUN = Kind("the run of a quadruped", ("--html", "--mcap", "--follow"))
PLAN = Kind("the plan of a biped", ("--html", "--follow", "--cell"))
LIBRARY = Kind("a library of skills")
FOOTHOLDS = Kind("a foothold plan", ("--html", "--mcap"))
REGIONS = Kind("the regions of a step")
STRATEGY = Kind(
    "the strategy of a specification",
    ("--html",),
    pictures=False,
    otherwise="surefoot export --format dot writes it as a graph",
)
RANKING = Kind("a ranking", ("--html",), pictures=False, otherwise="surefoot simulate plays it, as any strategy")
SCENARIO = Kind("the scenario of a biped")
QUADRUPED_TERRAIN = Kind("the terrain of a quadruped")
TERRAIN = Kind("a segmented terrain")

_FOLDERS = (("plan.json", PLAN), ("library.json", LIBRARY))
_FILES = {
    "foothold-plan": FOOTHOLDS,
    "step-region": REGIONS,
    "gr1-strategy": STRATEGY,
    "gr1-ranking": RANKING,
    "quadruped-terrain": QUADRUPED_TERRAIN,
    "terrain": TERRAIN,
}
_ALLOWED = (
    "the folder of a run (run.jsonl), of a plan (plan.json) or of skills (library.json); a scenario or the terrain of "
    f"a quadruped (.yaml); or a JSON file of one of the kinds {', '.join(_FILES)}"
)


def kind_of(path: Path) -> Kind:
    """Return what stands at a path.

    Raises:
        InputError: nothing that can be looked at.
    """
    if not path.exists():
        raise InputError(f"does not exist; allowed are: {_ALLOWED}", source=path)
    if path.is_dir():
        found = _of_folder(path)
    elif path.suffix.lower() in {".yaml", ".yml"}:
        found = _of_yaml(path)
    else:
        found = _of_json(path) if path.suffix.lower() == ".json" else None
    if found is None:
        raise InputError(f"is none of these: {_ALLOWED}", source=path)
    return found


def demand(path: Path, option: str) -> Kind:
    """Return what stands at a path, if it can be looked at in a way.

    Args:
        path: the folder or the file.
        option: of the command line; empty for pictures.

    Raises:
        InputError: it cannot; the message says how it can.
    """
    kind = kind_of(path)
    if option in kind.options or (not option and kind.pictures):
        return kind
    ways = [*(["no option (pictures)"] if kind.pictures else []), *kind.options]
    shown = f"; it is shown with {' or '.join(ways)}" if ways else ""
    otherwise = f"; {kind.otherwise}" if kind.otherwise else ""
    raise InputError(f"is {kind.name}, and has no {option or 'picture'}{shown}{otherwise}", source=path)


def _of_folder(path: Path) -> Kind | None:
    if (path / "run.jsonl").is_file():
        return QUADRUPED_RUN if is_quadruped_run(path) else BIPED_RUN
    return next((kind for file, kind in _FOLDERS if (path / file).is_file()), None)


def _of_yaml(path: Path) -> Kind | None:
    """Return the terrain of a quadruped, or, without a kind, a scenario, whose reader says what is wrong with it."""
    with path.open("rb") as stream:
        found = _YAML_KIND.search(stream.read(_HEAD_BYTES))
    kinds = {b"quadruped-terrain": QUADRUPED_TERRAIN, b"biped": SCENARIO}
    return SCENARIO if found is None else kinds.get(found[1])


def _of_json(path: Path) -> Kind:
    named = read_json_object(path, _LARGEST_BYTES).get("kind")
    if not isinstance(named, str) or named not in _FILES:
        raise InputError(f"is no kind that can be drawn; allowed are {', '.join(_FILES)}", source=path, key="kind")
    return _FILES[named]


def is_quadruped_run(run_dir: Path) -> bool:
    """Return whether a folder holds the run of a quadruped."""
    try:
        with (run_dir / "run.jsonl").open("rb") as stream:
            return b'"quadruped-run"' in stream.read(400)
    except OSError:
        return False
