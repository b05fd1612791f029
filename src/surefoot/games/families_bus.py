"""The family jcss12: the arbiter of the AMBA AHB bus between n masters, as structuredslugs text.

Source: Bloem, Jobstmann, Piterman, Pnueli and Sa'ar, JCSS 78, 2012, Sec. 6: assumptions 1 to 4, guarantees 1 to 11,
with the same automata for assumption 1 and guarantees 2, 3 and 10.
"""

from __future__ import annotations

from collections.abc import Iterator

INCR, BURST4 = 0, 2
"""Codes of hburst."""


def jcss12(masters: int) -> str:
    """Return the arbiter for so many masters."""
    if masters < 2:
        raise ValueError(f"the bus has at least 2 masters, not {masters}")
    each = range(masters)
    inputs = ["hburst:0...3", *(f"hbusreq{i}" for i in each), *(f"hlock{i}" for i in each), "hready"]
    outputs = ["busreq", "decide", *(f"hgrant{i}" for i in each), f"hmaster:0...{masters - 1}", "hmastlock", "locked"]
    outputs += ["start", "stateA1:0...2", "stateG2", "stateG3:0...4", *(f"stateG10_{i}" for i in each[1:])]
    silent = [*(f"!{name}" for name in inputs[1:]), "hburst = 0"]
    begins = ["hmaster = 0", "!hmastlock", "start", "decide", "!locked", "hgrant0", "!busreq"]
    begins += ["stateA1 = 0", "!stateG2", "stateG3 = 0"]
    begins += [f"!{name}{i}" for i in each[1:] for name in ("hgrant", "stateG10_")]
    sections = {
        "INPUT": inputs,
        "OUTPUT": outputs,
        "ENV_INIT": silent,
        "SYS_INIT": begins,
        "ENV_TRANS": [f"hlock{i} -> hbusreq{i}" for i in each],
        "SYS_TRANS": [*_lock_automaton(), *_bursts(), *_transfers(masters), *_grants(masters)],
        "ENV_LIVENESS": ["stateA1 != 1", "hready"],
        "SYS_LIVENESS": ["!stateG2", "stateG3 = 0", *(f"hbusreq{i} -> hmaster = {i}" for i in each)],
    }
    return "\n".join(f"[{name}]\n" + "\n".join(lines) + "\n" for name, lines in sections.items())


def _lock_automaton() -> Iterator[str]:
    """Assumption 1: a locked burst of unspecified length ends; its master stops asking."""
    begins = f"(hmastlock & hburst = {INCR})"
    yield f"stateA1 = 0 -> stateA1' != 2 & (stateA1' = 1 <-> {begins})"
    yield "stateA1 = 1 & busreq -> stateA1' = 1"
    yield f"stateA1 = 1 & !busreq -> (stateA1' = 2 <-> {begins}) & (stateA1' = 0 <-> !{begins})"
    yield "stateA1 = 2 & busreq -> stateA1' = 1"
    yield f"stateA1 = 2 & {begins} -> stateA1' = 1"
    yield f"stateA1 = 2 & !busreq & !{begins} -> stateA1' = 0"


def _bursts() -> Iterator[str]:
    """Guarantees 1 to 3: no start unless the bus is ready, nor within a locked burst."""
    locked = "hmastlock & start"
    yield "start' -> hready"
    yield f"!stateG2 -> (stateG2' <-> {locked} & hburst = {INCR})"
    yield "stateG2 -> !start & (stateG2' <-> busreq)"
    yield f"stateG3 = 0 & !({locked} & hburst = {BURST4}) -> stateG3' = 0"
    yield f"stateG3 = 0 & {locked} & hburst = {BURST4} -> (hready -> stateG3' = 2) & (!hready -> stateG3' = 1)"
    for count in range(1, 5):
        yield f"stateG3 = {count} -> !start & (!hready -> stateG3' = {count})"
        yield f"stateG3 = {count} & hready -> stateG3' = {(count + 1) % 5}"


def _transfers(masters: int) -> Iterator[str]:
    """Guarantees 4 to 6: the bus changes its master when it is ready, and at starts only."""
    for i in range(masters):
        yield f"hmaster = {i} -> (busreq <-> hbusreq{i})"
        yield f"hready -> (hgrant{i} <-> hmaster' = {i})"
    yield "hready -> (locked <-> hmastlock')"
    yield "!start' -> hmaster' = hmaster & (hmastlock' <-> hmastlock)"


def _grants(masters: int) -> Iterator[str]:
    """Guarantees 7 to 10: grants change on decisions only, and go to masters that ask."""
    for i in range(masters):
        yield f"decide & hgrant{i}' -> (locked' <-> hlock{i})"
        yield f"!decide -> (hgrant{i}' <-> hgrant{i})"
    yield "!decide -> (locked' <-> locked)"
    for i in range(1, masters):
        yield f"!stateG10_{i} -> (stateG10_{i}' <-> !hgrant{i} & !hbusreq{i})"
        yield f"stateG10_{i} & !hbusreq{i} -> !hgrant{i} & stateG10_{i}'"
        yield f"stateG10_{i} & hbusreq{i} -> !stateG10_{i}'"
    yield "decide & " + " & ".join(f"!hbusreq{i}" for i in range(masters)) + " -> hgrant0'"
