"""Writers of slugsin and structuredslugs; what they write, the readers read back with the same meaning."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from surefoot.errors import InputError
from surefoot.logic.lower import Lowering
from surefoot.logic.ranges import range_conjuncts
from surefoot.logic.sections import LARGEST_CHARACTERS
from surefoot.logic.syntax import (
    SECTIONS,
    And,
    Atom,
    Comparison,
    Constant,
    Expression,
    Iff,
    Implies,
    Integer,
    Node,
    Not,
    Number,
    Or,
    Specification,
    Sum,
    Variable,
    Xor,
    children,
    postorder,
)

_SYMBOL: dict[type, str] = {Iff: "<->", Implies: "->", Xor: "^", Or: "|", And: "&", Sum: "+"}
_POWER: dict[type, int] = {Iff: 1, Implies: 2, Xor: 3, Or: 4, And: 5, Comparison: 6, Not: 7, Sum: 8}
_LEAF = 9


def write_structuredslugs(specification: Specification) -> str:
    """Return a specification in infix notation.

    Raises:
        InputError: an expression shares so many parts that it is too large without buffers.
    """
    blocks = [_block("INPUT", map(_declaration, specification.inputs))]
    blocks.append(_block("OUTPUT", map(_declaration, specification.outputs)))
    for section in SECTIONS:
        conjuncts = getattr(specification, section.lower())
        if conjuncts or not section.endswith(("HARD", "CONS", "REPAIR")):
            blocks.append(_block(section, (infix(conjunct.expression) for conjunct in conjuncts)))
    return "\n".join(blocks)


def write_slugsin(specification: Specification) -> str:
    """Return a specification in prefix notation: integers become bits, and their limits become lines."""
    lowering = Lowering(specification)
    limits = range_conjuncts(specification)
    blocks = [_block("INPUT", (bit for variable in specification.inputs for bit in variable.bits))]
    blocks.append(_block("OUTPUT", (bit for variable in specification.outputs for bit in variable.bits)))
    for section in SECTIONS:
        conjuncts = (*getattr(specification, section.lower()), *(limit for limit in limits if limit.section == section))
        if conjuncts or not section.endswith(("HARD", "CONS", "REPAIR")):
            lowered = (lowering.boolean(conjunct.expression) for conjunct in conjuncts)
            blocks.append(_block(section, (prefix(expression) for expression in lowered)))
    return "\n".join(blocks)


def infix(expression: Node) -> str:
    """Return an expression or an integer term in infix notation, with as few brackets as can be read with ease.

    Raises:
        InputError: it shares so many parts that it is too large without buffers.
    """
    sizes: dict[int, int] = {}
    for node in postorder([expression]):
        sizes[id(node)] = 4 + sum(sizes[id(child)] for child in children(node))
    if sizes[id(expression)] > LARGEST_CHARACTERS:
        raise InputError("an expression is too large without buffers; write it as slugsin")
    pieces: list[str] = []
    stack: list[Node | str] = [expression]
    while stack:
        item = stack.pop()
        if isinstance(item, str):
            pieces.append(item)
        else:
            stack.extend(reversed(list(_pieces(item))))
    return "".join(pieces)


def _pieces(node: Node) -> Iterator[Node | str]:
    """Yield symbols and operands of one node in their infix order."""
    if isinstance(node, Not):
        yield "!"
        yield from _bracketed(node.operand, _POWER[Not])
        return
    operands = children(node)
    if not operands:
        yield _leaf(node)
        return
    symbol = node.operator if isinstance(node, Comparison) else _SYMBOL[type(node)]
    power = _POWER[type(node)]
    for place, operand in enumerate(operands):
        if place:
            yield f" {symbol} "
        strict = isinstance(node, Implies | Iff | Comparison) and place > 0
        yield from _bracketed(operand, power + strict)


def _bracketed(operand: Node, power: int) -> Iterator[Node | str]:
    """Yield an operand, in brackets where it binds less tightly than its surroundings."""
    if _POWER.get(type(operand), _LEAF) >= power:
        yield operand
    else:
        yield "("
        yield operand
        yield ")"


def _leaf(node: Node) -> str:
    if isinstance(node, Constant):
        return "TRUE" if node.value else "FALSE"
    if isinstance(node, Number):
        return str(node.value)
    if isinstance(node, Atom | Integer):
        return f"{node.name}'" if node.primed else node.name
    raise ValueError(f"{type(node).__name__} needs operands")


def prefix(expression: Expression) -> str:
    """Return a lowered expression in prefix notation; what occurs repeatedly becomes an entry of a buffer."""
    order = postorder([expression])
    uses: dict[int, int] = {}
    for node in order:
        for child in children(node):
            uses[id(child)] = uses.get(id(child), 0) + 1
    shared = [node for node in order if uses.get(id(node), 0) > 1 and children(node)]
    entries = {id(node): place for place, node in enumerate(shared)}
    written = [_entry(root, entries) for root in [*shared, expression]]
    return written[-1] if not shared else f"$ {len(written)} {' '.join(written)}"


def _entry(root: Node, entries: dict[int, int]) -> str:
    """Return one expression in prefix notation that refers to entries of its buffer."""
    pieces: list[str] = []
    stack: list[tuple[Node | str, bool]] = [(root, True)]
    while stack:
        item, is_root = stack.pop()
        if isinstance(item, str):
            pieces.append(item)
        elif id(item) in entries and not is_root:
            pieces.append(f"? {entries[id(item)]}")
        elif isinstance(item, Constant):
            pieces.append("1" if item.value else "0")
        elif isinstance(item, Not):
            pieces.append("!")
            stack.append((item.operand, False))
        elif isinstance(item, And | Or | Xor):
            pieces.extend([_SYMBOL[type(item)]] * (len(item.operands) - 1))
            stack.extend((operand, False) for operand in reversed(item.operands))
        else:
            pieces.append(_leaf(item))
    return " ".join(pieces)


def _declaration(variable: Variable) -> str:
    return variable.name if variable.is_boolean else f"{variable.name}:{variable.lower}...{variable.upper}"


def _block(section: str, lines: Iterable[str]) -> str:
    return "\n".join([f"[{section}]", *lines, ""])
