"""YAML into plain values, remembering the line of every key, and refusing what only attacks or accidents contain."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import yaml

from surefoot.errors import InputError

MAX_BYTES = 1_000_000
MAX_VALUES = 100_000
MAX_DEPTH = 40

Loc = tuple[str | int, ...]
_TAG = "tag:yaml.org,2002:"


@dataclass(frozen=True, slots=True)
class Document:
    """What a YAML file holds.

    Attributes:
        value: mappings as dicts with text keys, sequences as tuples, scalars as None, bool, int, float or str.
        lines: the line (from 1) where each value's key or item stands.
        problems: complaints that did not stop the reading, such as keys given twice.
    """

    value: object
    lines: dict[Loc, int]
    problems: tuple[InputError, ...]


class _CoreLoader(yaml.SafeLoader):
    """The scalars of YAML 1.2's core schema: no dates, no sexagesimals, no `yes` and `no`; 1e-3 is a number."""


_CoreLoader.yaml_implicit_resolvers = {}


def _resolve_as(tag: str, pattern: str, first: str) -> None:
    _CoreLoader.add_implicit_resolver(_TAG + tag, re.compile(f"^(?:{pattern})$"), list(first))


_resolve_as("int", r"[-+]?[0-9]{1,300}", "-+0123456789")
_resolve_as("float", r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?", "-+.0123456789")
_resolve_as("float", r"[-+]?\.(?:inf|Inf|INF)|\.nan|\.NaN|\.NAN", "-+.")
_resolve_as("bool", r"true|True|TRUE|false|False|FALSE", "tTfF")
_CoreLoader.add_implicit_resolver(_TAG + "null", re.compile(r"^(?:~|null|Null|NULL|)$"), ["~", "n", "N", ""])


def dotted(loc: Loc) -> str:
    """Return a place as a person writes it: ``goals[0].position_m``."""
    text = ""
    for part in loc:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else part
    return text


def read_yaml(path: Path) -> Document:
    """Read a YAML file with the lines of its keys.

    Raises:
        InputError: if it cannot be read, is too large, is no YAML, or is nested or repeated beyond reason.
    """
    text = _text_of(path)
    try:
        root = yaml.compose(text, Loader=_CoreLoader)
    except yaml.MarkedYAMLError as problem:
        mark = problem.problem_mark or problem.context_mark
        raise InputError(
            f"is not YAML: {problem.problem or problem.context or 'it cannot be parsed'}"
            f"{f' (column {mark.column + 1})' if mark else ''}; allowed is one YAML document",
            source=path,
            line=mark.line + 1 if mark else None,
        ) from problem
    except yaml.YAMLError as problem:
        raise InputError("is not YAML: it holds characters that YAML does not allow", source=path) from problem
    except RecursionError as problem:
        raise _too_deep(path) from problem
    if root is None:
        raise InputError("is empty; a mapping of keys to values is expected", source=path)
    return _Walk(path).document(root)


def _text_of(path: Path) -> str:
    if not path.exists():
        raise InputError("does not exist; give the path of a YAML file", source=path)
    if not path.is_file():
        raise InputError("is not a file; give the path of a YAML file", source=path)
    try:
        with path.open("rb") as stream:
            data = stream.read(MAX_BYTES + 1)
    except OSError as problem:
        raise InputError(f"cannot be read: {problem.strerror}", source=path) from problem
    if len(data) > MAX_BYTES:
        raise InputError(f"is larger than the {MAX_BYTES} bytes that are allowed", source=path)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as problem:
        line = data.count(b"\n", 0, problem.start) + 1
        raise InputError("is not UTF-8 text, the only encoding allowed", source=path, line=line) from problem


def _too_deep(path: Path, line: int | None = None) -> InputError:
    return InputError(f"is nested deeper than the {MAX_DEPTH} levels that are allowed", source=path, line=line)


class _Walk:
    """One walk over the nodes of one file; aliases are followed, and every visit counts against the limit."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.lines: dict[Loc, int] = {}
        self.problems: list[InputError] = []
        self.values = 0

    def document(self, root: yaml.Node) -> Document:
        value = self.value(root, ())
        return Document(value, self.lines, tuple(self.problems))

    def value(self, node: yaml.Node, loc: Loc) -> object:
        line = _line(node)
        self.lines.setdefault(loc, line)
        self.values += 1
        if self.values > MAX_VALUES:
            raise InputError(f"holds more than the {MAX_VALUES} values that are allowed", source=self.path, line=line)
        if len(loc) > MAX_DEPTH:
            raise _too_deep(self.path, line)
        if isinstance(node, yaml.MappingNode) and node.tag == _TAG + "map":
            return self.mapping(node, loc)
        if isinstance(node, yaml.SequenceNode) and node.tag == _TAG + "seq":
            return tuple(self.value(item, (*loc, index)) for index, item in enumerate(node.value))
        if isinstance(node, yaml.ScalarNode):
            return self.scalar(node, loc)
        self.complain(f"has the tag {node.tag}; tags are not allowed", node, loc)
        return None

    def mapping(self, node: yaml.MappingNode, loc: Loc) -> dict[str, object]:
        result: dict[str, object] = {}
        for key_node, value_node in node.value:
            if not isinstance(key_node, yaml.ScalarNode):
                self.complain("has a key that is a list or a mapping; keys are plain words", key_node, loc)
                continue
            key, place = key_node.value, (*loc, key_node.value)
            if key in result:
                first = self.lines[place]
                self.complain(f"is given a second time (first in line {first}); once is allowed", key_node, place)
                continue
            self.lines[place] = _line(key_node)
            result[key] = self.value(value_node, place)
        return result

    def scalar(self, node: yaml.ScalarNode, loc: Loc) -> object:
        kind = node.tag.removeprefix(_TAG)
        text: str = node.value
        try:
            if kind == "null":
                return None
            if kind == "bool":
                return text.lower() == "true"
            if kind == "int":
                return int(text)
            if kind == "float":
                special = text.lower().endswith(("inf", "nan"))
                return float(text.replace(".", "") if special else text)
            if kind == "str":
                return text
        except ValueError:
            pass
        self.complain(f"has the tag {node.tag}, which does not fit it; tags are not allowed", node, loc)
        return None

    def complain(self, message: str, node: yaml.Node, loc: Loc) -> None:
        self.problems.append(InputError(message, source=self.path, line=_line(node), key=dotted(loc) or None))


def _line(node: yaml.Node) -> int:
    return int(node.start_mark.line) + 1
