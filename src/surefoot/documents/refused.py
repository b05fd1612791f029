"""From what pydantic refuses to sentences: file, line, key, what is wrong and what is allowed."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from surefoot.documents.yaml_lines import Loc, dotted
from surefoot.errors import InputError

_SHOWN_CHARACTERS = 60
_CHOICE = re.compile(r"needs (?P<wanted>.*), not (?P<given>.*)", re.DOTALL)
_MOST_PROBLEMS = 50


class FileProblems(InputError):  # noqa: N818
    """Every problem of one file; the text has one line for each.

    Attributes:
        problems: each with its own source, line and key.
    """

    def __init__(self, problems: Iterable[InputError]) -> None:
        self.problems = tuple(sorted(problems, key=lambda problem: problem.line or 0))
        shown = [str(problem) for problem in self.problems[:_MOST_PROBLEMS]]
        if len(self.problems) > len(shown):
            shown.append(f"... and {len(self.problems) - len(shown)} more problems")
        super().__init__("\n".join(shown))
        first = self.problems[0]
        self.source, self.line, self.key = first.source, first.line, first.key


def problems_of(
    refused: ValidationError, schema: Mapping[str, Any], path: Path, lines: Mapping[Loc, int]
) -> list[InputError]:
    """Return one InputError for each complaint of pydantic.

    Args:
        refused: what pydantic raised.
        schema: the JSON Schema of the model, to say which keys and values are allowed.
        path: the file.
        lines: where each place stands in it.
    """
    found: dict[Loc, list[str]] = {}
    for detail in _about_what_was_meant(_without_miscounts(refused.errors(include_url=False)), schema):
        for loc, message in _places(detail, schema):
            found.setdefault(loc, []).append(message)
    return [
        InputError(message, source=path, line=_line(loc, lines), key=dotted(loc) or None)
        for loc, messages in found.items()
        for message in _as_choices(list(dict.fromkeys(messages)))
    ]


def _as_choices(messages: list[str]) -> list[str]:
    """Return what is said about one place, with one sentence for all choices that were not met there."""
    parts = [_CHOICE.fullmatch(message) for message in messages]
    given = {part["given"] for part in parts if part is not None}
    if len(messages) < 2 or None in parts or len(given) != 1:
        return messages
    wanted = ", or ".join(part["wanted"] for part in parts if part is not None)
    return [f"needs {wanted}; not {given.pop()}"]


def _without_miscounts(details: Sequence[ErrorDetails]) -> list[ErrorDetails]:
    """Return complaints without those of lists that are too short only because items in them were refused."""
    outer = {detail["loc"][:size] for detail in details for size in range(len(detail["loc"]))}
    return [detail for detail in details if detail["type"] != "too_short" or detail["loc"] not in outer]


def _about_what_was_meant(details: Sequence[ErrorDetails], schema: Mapping[str, Any]) -> list[ErrorDetails]:
    """Return complaints without the names that pydantic gives to the choices of a place.

    Of a place with several choices, such as a list or text, only what comes farthest into one of them is kept.
    """
    farthest: dict[Loc, int] = {}
    found = []
    for detail in details:
        loc = detail["loc"]
        at = next((k for k in range(len(loc)) if _names_a_choice(loc, k, schema)), None)
        if at is not None:
            loc = loc[:at] + loc[at + 1 :]
            farthest[loc[:at]] = max(farthest.get(loc[:at], 0), len(loc))
        found.append((detail | {"loc": loc}, None if at is None else loc[:at]))
    return [detail for detail, choice in found if choice is None or len(detail["loc"]) == farthest[choice]]


def _names_a_choice(loc: Loc, at: int, schema: Mapping[str, Any]) -> bool:
    """Return whether a part of a place is no key, but the name of one of several choices."""
    here = _at(schema, loc[:at])
    choices = [one for one in here.get("anyOf", ()) if one.get("type") != "null"]
    return len(choices) > 1 and isinstance(loc[at], str) and loc[at] not in here.get("properties", {})


def _line(loc: Loc, lines: Mapping[Loc, int]) -> int | None:
    return next((lines[loc[:size]] for size in range(len(loc), -1, -1) if loc[:size] in lines), None)


def _places(detail: ErrorDetails, schema: Mapping[str, Any]) -> list[tuple[Loc, str]]:
    context = detail.get("ctx", {})
    if detail["type"] == "several":
        return list(context["problems"])
    loc = detail["loc"]
    parent = _at(schema, loc[:-1])
    size = len(parent.get("prefixItems", ()))
    if size and detail["type"] == "missing":
        return [(loc[:-1], f"needs exactly {size} numbers")]
    here = _at(schema, loc)
    size = len(here.get("prefixItems", ()))
    if size and detail["type"] in {"too_long", "tuple_type"}:
        return [(loc, f"needs a list of exactly {size} numbers")]
    return [(loc, _sentence(detail, context, parent, here))]


def _sentence(
    detail: ErrorDetails, context: Mapping[str, Any], parent: Mapping[str, Any], here: Mapping[str, Any]
) -> str:
    if detail["type"] == "missing":
        about = here.get("description")
        return f"is required{f' ({about})' if about else ''}"
    if detail["type"] == "extra_forbidden":
        return unknown_key(str(detail["loc"][-1]), list(parent.get("properties", ())))
    if detail["type"] in {"model_type", "dict_type", "model_attributes_type"}:
        return f"needs a mapping with keys among {', '.join(here.get('properties', ()))}, not {_shown(detail['input'])}"
    sentence = _SENTENCES.get(detail["type"])
    if sentence is None:
        return f"{detail['msg'][:1].lower()}{detail['msg'][1:]}, not {_shown(detail['input'])}"
    return sentence(context, detail["input"])


def unknown_key(key: str, allowed: Sequence[str]) -> str:
    """Return the sentence that refuses a key, with the allowed one that it resembles."""
    near = get_close_matches(key, allowed, n=1)
    hint = f" (did you mean {near[0]}?)" if near else ""
    return f"is not a known key{hint}; allowed are {', '.join(allowed)}"


def _wants(what: str) -> Callable[[Mapping[str, Any], object], str]:
    return lambda context, given: f"needs {what.format(**context)}, not {_shown(given)}"


_SENTENCES: dict[str, Callable[[Mapping[str, Any], object], str]] = {
    "float_type": _wants("a number"),
    "finite_number": _wants("a finite number"),
    "int_type": _wants("a whole number"),
    "int_from_float": _wants("a whole number"),
    "string_type": _wants("text"),
    "string_too_short": _wants("text of at least {min_length} character"),
    "string_too_long": _wants("text of at most {max_length} characters"),
    "tuple_type": _wants("a list"),
    "literal_error": _wants("{expected}"),
    "greater_than": _wants("a number greater than {gt:g}"),
    "greater_than_equal": _wants("a number not below {ge:g}"),
    "less_than": _wants("a number less than {lt:g}"),
    "less_than_equal": _wants("a number not above {le:g}"),
    "too_short": lambda context, _: (
        f"needs at least {context['min_length']} item{'s' if context['min_length'] > 1 else ''}, "
        f"not {context['actual_length']}"
    ),
    "too_long": lambda context, _: f"needs at most {context['max_length']} items, not {context['actual_length']}",
    "value_error": lambda context, _: str(context["error"]),
}


def _shown(given: object) -> str:
    if given is None:
        return "nothing"
    if isinstance(given, dict):
        return "a mapping"
    if isinstance(given, tuple):
        return "a list"
    text = {True: "true", False: "false"}[given] if isinstance(given, bool) else repr(given)
    return text if len(text) <= _SHOWN_CHARACTERS else f"{text[:_SHOWN_CHARACTERS]}..."


def _at(schema: Mapping[str, Any], loc: Loc) -> Mapping[str, Any]:
    """Return the part of the JSON Schema that describes a place; an empty one when the schema does not know it."""
    here: Mapping[str, Any] = _followed(schema, schema)
    for part in loc:
        if isinstance(part, int):
            fixed = here.get("prefixItems", ())
            inner = fixed[part] if part < len(fixed) else here.get("items", {})
        else:
            inner = here.get("properties", {}).get(part, {})
        here = _followed(inner if isinstance(inner, dict) else {}, schema)
    return here


def _followed(here: Mapping[str, Any], schema: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return a part of the schema with its reference followed and the choice of null removed."""
    merged = dict(here)
    if "$ref" in merged:
        merged = {**schema["$defs"][merged["$ref"].removeprefix("#/$defs/")], **merged}
    for option in merged.get("anyOf", ()):
        if option.get("type") != "null":
            merged = {**_followed(option, schema), **merged}
    return merged
