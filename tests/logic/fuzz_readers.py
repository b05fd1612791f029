"""Coverage-guided fuzzing of both readers of specifications: python tests/logic/fuzz_readers.py [-runs=N].

Whatever the bytes are, a reader returns a specification or says in one sentence what is wrong with it.
"""

from __future__ import annotations

import sys

import atheris  # type: ignore[import-untyped, import-not-found, unused-ignore]

with atheris.instrument_imports(include=["surefoot.logic"]):
    from surefoot.errors import InputError
    from surefoot.logic import parse_slugsin, parse_structuredslugs

HEAD = "[INPUT]\na\nx:0...5\n[OUTPUT]\nb\ny:-1...2\n[SYS_TRANS]\n"


def test_one_input(data: bytes) -> None:
    """Read the same bytes as a whole file and as lines of a section, in both notations."""
    text = data.decode("utf-8", errors="replace")
    for parse in (parse_slugsin, parse_structuredslugs):
        for whole in (text, HEAD + text, HEAD.replace("x:0...5\n", "").replace("y:-1...2\n", "") + text):
            try:
                parse(whole)
            except InputError as problem:
                if not str(problem):
                    raise AssertionError("an error without a sentence") from problem


if __name__ == "__main__":
    atheris.Setup(sys.argv, test_one_input)
    atheris.Fuzz()
