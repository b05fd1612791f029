"""Families of specifications that grow: for benchmarks of how far an engine comes.

``genbuf(n)`` is IBM's generalised buffer between n senders and two receivers, in the encoding of the slugs benchmarks
(there the members 2, 3, 5 and 10 are stored; the generator gives the same rules). The others are in
``families_bus`` and ``families_processes``.

Source: Bloem et al., "Specify, compile, run: hardware from PSL", COCV 2007.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from surefoot.games.families_bus import jcss12
from surefoot.games.families_processes import bunny, synt15
from surefoot.logic import Specification, parse_slugsin, parse_structuredslugs

RECEIVERS = 2


def genbuf(senders: int) -> str:
    """Return the generalised buffer with so many senders as a slugsin text."""
    if senders < 2:
        raise ValueError(f"the buffer has at least 2 senders, not {senders}")
    slots = range((senders - 1).bit_length())
    states = ["stateG7_0", "stateG7_1", "ENQ", "DEQ", "stateG12"]
    inputs = [*_each("StoB_REQ", senders), *_each("RtoB_ACK", RECEIVERS), "FULL", "EMPTY"]
    outputs = [*_each("BtoS_ACK", senders), *_each("BtoR_REQ", RECEIVERS), *states, *(f"SLC{k}" for k in slots)]
    sections = {
        "INPUT": inputs,
        "OUTPUT": outputs,
        "ENV_TRANS": [*_environment(senders)],
        "ENV_INIT": [name if name == "EMPTY" else f"! {name}" for name in inputs],
        "SYS_TRANS": [*_senders(senders), *_RECEIVER_RULES, *_slots(senders), *_BUFFER_RULES],
        "SYS_INIT": [name if name == "stateG7_1" else f"! {name}" for name in outputs],
        "ENV_LIVENESS": [_both_or_none(f"BtoR_REQ{r}", f"RtoB_ACK{r}") for r in range(RECEIVERS)],
        "SYS_LIVENESS": [*(_both_or_none(f"StoB_REQ{s}", f"BtoS_ACK{s}") for s in range(senders)), "! stateG12"],
    }
    return "\n".join(f"[{name}]\n" + "\n".join(lines) + "\n" for name, lines in sections.items())


def _each(name: str, count: int) -> list[str]:
    return [f"{name}{k}" for k in range(count)]


def _both_or_none(one: str, two: str) -> str:
    return f"| & ! {one} ! {two} & {one} {two}"


def _joined(operator: str, parts: list[str]) -> str:
    return f"{operator} " * (len(parts) - 1) + " ".join(parts)


def _environment(senders: int) -> Iterator[str]:
    for s in range(senders):
        yield f"| ! & StoB_REQ{s} ! BtoS_ACK{s} StoB_REQ{s}'"
        yield f"| ! BtoS_ACK{s} ! StoB_REQ{s}'"
    for r in range(RECEIVERS):
        yield f"| ! ! BtoR_REQ{r} ! RtoB_ACK{r}'"
        yield f"| ! & BtoR_REQ{r} RtoB_ACK{r} RtoB_ACK{r}'"
    yield "| ! & ENQ ! DEQ ! EMPTY'"
    yield "| ! & DEQ ! ENQ ! FULL'"
    yield "| ! | & ! ENQ ! DEQ & ENQ DEQ & | & ! FULL ! FULL' & FULL FULL' | & ! EMPTY ! EMPTY' & EMPTY EMPTY'"


def _senders(senders: int) -> Iterator[str]:
    for s in range(senders):
        yield f"| ! & ! StoB_REQ{s} StoB_REQ{s}' ! BtoS_ACK{s}'"
        yield f"| ! & ! BtoS_ACK{s} ! StoB_REQ{s} ! BtoS_ACK{s}'"
        yield f"| ! & BtoS_ACK{s} StoB_REQ{s} BtoS_ACK{s}'"
        yield from (f"| ! BtoS_ACK{s} ! BtoS_ACK{t}" for t in range(s + 1, senders))


def _slots(senders: int) -> Iterator[str]:
    """Return the rules of the slot that a rising acknowledgement selects, a binary number."""
    width = (senders - 1).bit_length()
    for s in range(senders):
        rises = f"& ! BtoS_ACK{s} BtoS_ACK{s}'"
        code = _joined("&", [f"SLC{k}'" if s >> k & 1 else f"! SLC{k}'" for k in range(width)])
        yield f"| ! {rises} ENQ'"
        yield f"| ! {rises} {code}" if s == 0 else f"| & ! {rises} ! {code} & {rises} {code}"
    still = _joined("&", [f"| BtoS_ACK{s} ! BtoS_ACK{s}'" for s in range(senders)])
    yield f"| ! {still} ! ENQ'"


_RECEIVER_RULES = (
    "| ! & BtoR_REQ0 ! RtoB_ACK0 BtoR_REQ0'",
    "| ! BtoR_REQ0 ! BtoR_REQ1",
    "| ! RtoB_ACK0 ! BtoR_REQ0'",
    "| ! & BtoR_REQ1 ! RtoB_ACK1 BtoR_REQ1'",
    "| ! RtoB_ACK1 ! BtoR_REQ1'",
    "| ! & BtoR_REQ0 BtoR_REQ1 0",
    "| ! & & ! stateG7_1 ! BtoR_REQ0 BtoR_REQ1 & stateG7_1' ! stateG7_0'",
    "| ! & & stateG7_1 BtoR_REQ0 ! BtoR_REQ1 & ! stateG7_1' ! stateG7_0'",
    "| ! & & ! stateG7_1 ! BtoR_REQ0 ! BtoR_REQ1 & ! stateG7_1' stateG7_0'",
    "| ! & & stateG7_1 ! BtoR_REQ0 ! BtoR_REQ1 & stateG7_1' stateG7_0'",
    "| ! & & & ! stateG7_1 ! stateG7_0 BtoR_REQ0 ! BtoR_REQ1 & ! stateG7_1' ! stateG7_0'",
    "| ! & & & stateG7_1 ! stateG7_0 ! BtoR_REQ0 BtoR_REQ1 & stateG7_1' ! stateG7_0'",
    "| ! & & ! stateG7_1 stateG7_0 BtoR_REQ0 0",
    "| ! & & stateG7_1 stateG7_0 BtoR_REQ1 0",
)

_BUFFER_RULES = (
    "| ! & RtoB_ACK0 ! RtoB_ACK0' DEQ'",
    "| ! & RtoB_ACK1 ! RtoB_ACK1' DEQ'",
    "| ! & | ! RtoB_ACK0 RtoB_ACK0' | ! RtoB_ACK1 RtoB_ACK1' ! DEQ'",
    "| ! & FULL ! DEQ ! ENQ",
    "| ! EMPTY ! DEQ",
    "| ! & ! stateG12 EMPTY ! stateG12'",
    "| ! & ! stateG12 DEQ ! stateG12'",
    "| ! & & ! stateG12 ! EMPTY ! DEQ stateG12'",
    "| ! & stateG12 ! DEQ stateG12'",
    "| ! & stateG12 DEQ ! stateG12'",
)

FAMILIES: dict[str, Callable[[int], str]] = {"genbuf": genbuf, "bunny": bunny, "jcss12": jcss12, "synt15": synt15}


def member(family: str, size: int) -> Specification:
    """Return a member of a family.

    Raises:
        ValueError: there is no such family, or no such member.
    """
    if family not in FAMILIES:
        raise ValueError(f"the families are {', '.join(FAMILIES)}, not {family!r}")
    text = FAMILIES[family](size)
    return parse_slugsin(text) if family == "genbuf" else parse_structuredslugs(text)
