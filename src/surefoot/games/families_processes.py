"""The families bunny and synt15, as structuredslugs text: processes that step beside each other.

The rules are those of the slugs benchmarks of these names; what those spell out bit by bit is said with integers here.
"""

from __future__ import annotations

from collections.abc import Iterator


def bunny(size: int) -> str:
    """Return a bunny on a square field of size + 1 rows that visits its edges and evades a fox.

    The fox moves up and down by one field at most; its column is free.
    """
    if size < 2:
        raise ValueError(f"the field has at least the size 2, not {size}")
    sections = {
        "INPUT": ["envkey:0...5", "pc1", f"xt:0...{size - 1}", f"yt:0...{size}", "ps0", "ps1"],
        "OUTPUT": ["pc0", f"x:0...{size}", f"y:0...{size}", "syskey:0...5"],
        "ENV_INIT": ["xt >= 1", "!pc1", "yt = 0"],
        "SYS_INIT": ["!pc0", "x = 0", "y = 0"],
        "ENV_TRANS": [
            "!ps0'",
            "!ps1'",
            "!pc1'",
            "xt' >= 1",
            "envkey' <= 1 | yt' = yt",
            "(envkey' = 0 & yt' + 1 = yt) | (envkey' = 1 & yt' = yt + 1) | envkey' = 2",
        ],
        "SYS_TRANS": [
            "!pc0'",
            "syskey' = 2 | syskey' = 3 | y' = y",
            "syskey' <= 1 | x' = x",
            "syskey' = 0 -> x' + 1 = x",
            "syskey' = 1 -> x' = x + 1",
            "syskey' = 2 -> y' + 1 = y",
            "syskey' = 3 -> y' = y + 1",
            "syskey' <= 4",
            "!(x = xt & y = yt)",
            "!(xt' = x & yt' = y)",
        ],
        "ENV_LIVENESS": ["yt = 0"],
        "SYS_LIVENESS": [f"x = {x} & y = {y}" for x in (0, size) for y in range(size)],
    }
    return _text(sections)


def synt15(masters: int) -> str:
    """Return a bus arbiter between so many masters, with bursts counted by two processes."""
    if masters < 2:
        raise ValueError(f"the bus has at least 2 masters, not {masters}")
    requests = [f"request{i}" for i in range(masters)]
    bus = f"0...{masters - 1}"
    waits = ["burst:0...2", "grantee_lockreq", "master_lockreq", "ready"]
    outputs = ["pc0", "pc1", "count:0...3", "decide", "decide_prev", f"grant:{bus}", "lock", "lockmemo"]
    sections = {
        "INPUT": ["envkey:0...2", "pc2", *waits, *requests, "ps0", "ps1"],
        "OUTPUT": [*outputs, f"master:{bus}", "start", "syskey0:0...2", "syskey1:0...2"],
        "ENV_INIT": [*(f"!{name}" for name in (*waits[1:], *requests)), "!pc2"],
        "SYS_INIT": ["!decide_prev", "decide", "count = 0", "!lock", "start", "!pc0", "!pc1", "master = 0"],
        "ENV_TRANS": [
            "!ps0'",
            "ps1' <-> start & (pc0 | pc1)",
            "envkey' = 0",
            "!pc2 -> (pc2' <-> lock)",
            "pc2 -> pc2' | !master_lockreq'",
        ],
        "SYS_TRANS": ["!ps1'", *_counted_burst(), *_open_burst(), *_bus(requests)],
        "ENV_LIVENESS": ["!ps0 & !pc2", "ready"],
        "SYS_LIVENESS": [f"request{i} -> master = {i}" for i in range(masters)],
    }
    return _text(sections)


def _counted_burst() -> Iterator[str]:
    begins = "(start & lock & burst = 1)"
    yield "pc0' & ((!pc0 & syskey1' = 0) | (pc0 & syskey1' = 1)) | count' = count"
    yield f"!pc0 -> syskey1' = 0 & (pc0' <-> {begins})"
    yield f"!pc0 & {begins} -> (ready -> count' = 1) & (!ready -> count' = 0)"
    yield "pc0 -> !start & (pc0' <-> !(ready & count = 3))"
    yield "pc0 -> (syskey1' = 1 <-> ready & count != 3) & syskey1' != 2"
    yield "pc0 & ready & count != 3 -> count' = count + 1"


def _open_burst() -> Iterator[str]:
    yield "syskey0' = 0"
    yield "!pc1 -> (pc1' <-> lock & start & burst = 2)"
    yield "pc1 -> !start & (pc1' | !master_lockreq')"


def _bus(requests: list[str]) -> Iterator[str]:
    yield "start' -> ready"
    yield "ready -> master' = grant & (lock' <-> lockmemo')"
    yield "!start' -> master' = master & (lock' <-> lock)"
    yield "decide_prev -> (lockmemo' <-> grantee_lockreq')"
    yield "!decide_prev -> (lockmemo' <-> lockmemo)"
    yield "!decide -> grant' = grant"
    asked = " | ".join(f"(grant' = {i} & {name})" for i, name in enumerate(requests))
    yield f"grant' = grant | grant' = 0 | {asked}"
    yield "decide_prev' <-> decide"


def _text(sections: dict[str, list[str]]) -> str:
    return "\n".join(f"[{name}]\n" + "\n".join(lines) + "\n" for name, lines in sections.items())
