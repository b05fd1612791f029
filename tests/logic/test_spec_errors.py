"""Bad specifications get one sentence with file, line and column; arbitrary text never gets anything else."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from surefoot.errors import InputError
from surefoot.logic import parse_slugsin, parse_structuredslugs, read_specification

HEAD = "[INPUT]\na\nx:0...5\n[OUTPUT]\nc\ny:2...9\n"
PREFIX_HEAD = "[INPUT]\na\nb\n[OUTPUT]\nc\nd\n"


@pytest.mark.parametrize(
    ("lines", "column", "complaint"),
    [
        ("[SYS_TRANS]\na % c", 3, "'%' is no operator"),
        ("[SYS_TRANS]\na & dor", 5, "'dor' is not declared; declared are: a, x, c, y"),
        ("[SYS_TRANS]\nx = 6", 5, "6 is out of range; x takes the values 0...5"),
        ("[SYS_TRANS]\n  1 != y'", 3, "1 is out of range; y takes the values 2...9"),
        ("[ENV_TRANS]\na -> c'", 6, "ENV_TRANS may use primed inputs and unprimed variables only, and c' is none"),
        ("[ENV_TRANS]\na & next(c)", 5, "c' is none"),
        ("[ENV_INIT]\nc", 1, "ENV_INIT may use unprimed inputs only"),
        ("[SYS_INIT]\na'", 1, "SYS_INIT may use unprimed variables only"),
        ("[SYS_TRANS]\nnext(a')", 1, "already has primes"),
        ("[SYS_TRANS]\nnext(x) = 3", 9, "write x' for the next value of x"),
        ("[SYS_TRANS]\na U c", 3, "the operator 'U' is not supported"),
        ("[SYS_TRANS]\n[] a", 1, "the operator '[]' is not supported"),
        ("[SYS_TRANS]\nx - 1 = y", 3, "the operator '-' is not supported"),
        ("[SYS_TRANS]\nx * 2 = y", 3, "the operator '*' is not supported"),
        ("[SYS_TRANS]\nx", 1, "this is an integer; compare it"),
        ("[SYS_TRANS]\na = 1", 1, "'=' takes integers, and this is Boolean"),
        ("[SYS_TRANS]\nx < 3 < 4", 1, "'<' takes integers"),
        ("[SYS_TRANS]\n(a & c", 1, "'(' is never closed"),
        ("[SYS_TRANS]\na & c)", 6, "')' closes no bracket"),
        ("[SYS_TRANS]\n(a & c]", 7, "']' closes no bracket"),
        ("[SYS_TRANS]\na &", 4, "an operand is missing after '&'"),
        ("[SYS_TRANS]\na c", 3, "an operator is missing before 'c'"),
        ("[SYS_TRANS]\n& a", 1, "'&' takes 2 operands, but 1 follow"),
        ("[SYS_TRANS]\nx = 99999999999", 5, "too large"),
        ("[SYS_TRAN]\na", 1, "[SYS_TRAN] is no section; there are: INPUT, OUTPUT"),
        ("[]\na", 1, "[] is no section"),
        ("[OUTPUT]\na", 1, "a is declared already, in line 2"),
        ("[OUTPUT]\nz:3...1", 1, "z has no value"),
        ("[OUTPUT]\n1z", 1, "'1z' declares nothing; allowed is a name"),
        ("[OUTPUT]\nTRUE", 1, "TRUE is a constant"),
        ("[OUTPUT]\nx@1", 1, "x@1 is the name of a bit of x already"),
    ],
)
def test_structuredslugs(lines: str, column: int, complaint: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_structuredslugs(HEAD + lines, Path("spec.structuredslugs"))
    bad = 7 if lines.startswith(("[SYS_TRAN]", "[]")) else 8
    assert str(caught.value).startswith(f"spec.structuredslugs:{bad}: column {column}: ")
    assert complaint in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("lines", "column", "complaint"),
    [
        ("[SYS_TRANS]\n& a", 1, "'&' takes 2 operands, but 1 follow"),
        ("[SYS_TRANS]\n! a c", 5, "'c' follows a complete expression"),
        ("[SYS_TRANS]\n& a = c", 5, "'=' is neither an operator"),
        ("[SYS_TRANS]\n$ 2 a ? 1", 7, "? 1 is a cyclic reference"),
        ("[SYS_TRANS]\n$ 3 a ? 2 c", 7, "? 2 is a forward reference; allowed here are earlier entries: entries 0 .. 0"),
        ("[SYS_TRANS]\n$ 1 ? 0", 5, "? 0 is a cyclic reference; allowed here are earlier entries: none yet"),
        ("[SYS_TRANS]\n? 0", 1, "? stands outside a buffer"),
        ("[SYS_TRANS]\n$ 0 a", 1, "a buffer has at least one entry"),
        ("[SYS_TRANS]\n$ many a", 3, "$ takes the number of its entries, not 'many'"),
        ("[SYS_TRANS]\n& a ?", 6, "? takes the number of an earlier entry"),
        ("[SYS_TRANS]\n$ 999999999 a", 1, "takes 999999999 operands, but 1 follow"),
        ("[ENV_TRANS]\n& a c'", 5, "ENV_TRANS may use primed inputs"),
        ("[SYS_TRANS]\n& a zz", 5, "'zz' is not declared"),
        ("[OUTPUT]\nx:0...3", 1, "slugsin has Boolean variables only"),
    ],
)
def test_slugsin(lines: str, column: int, complaint: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_slugsin(PREFIX_HEAD + lines, Path("spec.slugsin"))
    assert str(caught.value).startswith(f"spec.slugsin:8: column {column}: ")
    assert complaint in str(caught.value)


@pytest.mark.parametrize("reader", [parse_slugsin, parse_structuredslugs])
@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("", "no variable is declared"),
        ("[INPUT]\n[OUTPUT]\n[SYS_TRANS]\n", "no variable is declared; [INPUT] and [OUTPUT] cannot both be empty"),
        ("a\n[INPUT]\na\n", "stands before the first section"),
    ],
)
def test_sections(reader: object, text: str, complaint: str) -> None:
    assert callable(reader)
    with pytest.raises(InputError, match=r"^specification:1: column 1: ") as caught:
        reader(text)
    assert complaint in str(caught.value)


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    huge, binary = tmp_path / "huge.slugsin", tmp_path / "binary.slugsin"
    with huge.open("wb") as stream:
        stream.truncate(100_000_000)
    binary.write_bytes(b"[INPUT]\na\n\xff\xfe")
    for path, complaint in [
        (huge, "is too large; at most 8000000 bytes are read"),
        (binary, "binary.slugsin:3: is no text in UTF-8"),
        (tmp_path, "is no file"),
        (tmp_path / "none", "does not exist"),
        (Path("/dev/zero"), "is no file"),
    ]:
        with pytest.raises(InputError) as caught:
            read_specification(path)
        assert complaint in str(caught.value)


_PIECES = [
    *(
        "[INPUT]\n",
        "[OUTPUT]\n",
        "[SYS_TRANS]\n",
        "[ENV_TRANS]\n",
        "[SYS_LIVENESS]\n",
        "a\n",
        "b\n",
        "c:0...3\n",
        "\n",
        "a'",
    ),
    *(
        "a",
        "b",
        "c",
        " ",
        "! ",
        "& ",
        "| ",
        "^ ",
        "-> ",
        "<-> ",
        "( ",
        ") ",
        "[ ",
        "] ",
        "$ 2 ",
        "? 0 ",
        "? ",
        "$ ",
        "= ",
        "+ ",
    ),
    *("1 ", "0 ", "3", "-", "' ", "next", "X ", "#", "U ", "@0", "...", ":", "/\\", "\\/", "TRUE ", "<= "),
]
texts = st.one_of(st.text(max_size=300), st.lists(st.sampled_from(_PIECES), max_size=60).map("".join))


@given(texts)
@example("[INPUT]\na\n[SYS_TRANS]\n" + "!" * 3000)
@example("[INPUT]\na:0..." + "9" * 5000)
@example("[OUTPUT]\na\n[SYS_TRANS]\n" + "9" * 5000 + " = 1")
def test_arbitrary_text_gives_a_specification_or_a_sentence(text: str) -> None:
    for reader in (parse_slugsin, parse_structuredslugs):
        try:
            reader(text)
        except InputError as problem:
            assert "\n" not in str(problem)  # noqa: PT017


@given(st.binary(max_size=200))
def test_arbitrary_bytes_in_a_file_give_a_specification_or_a_sentence(
    tmp_path_factory: pytest.TempPathFactory, data: bytes
) -> None:
    path = tmp_path_factory.getbasetemp() / "fuzz.slugsin"
    path.write_bytes(data)
    try:
        read_specification(path)
    except InputError as problem:
        assert "\n" not in str(problem)  # noqa: PT017
