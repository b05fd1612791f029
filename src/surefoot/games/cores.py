"""Minimal unrealizable cores: lines of the system that cannot be kept together, each of them needed.

Delta debugging by halves. Since fewer promises are easier to keep, a set inside one that can be kept can be kept, and
a set around one that cannot be kept cannot; both are remembered, so that most questions are answered without solving.

Source: Zeller and Hildebrandt, IEEE TSE 28, 2002; Firman, Maoz and Ringert, Acta Informatica 57, 2020.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TypeVar

from surefoot.compute import Deadline
from surefoot.errors import LimitExceeded
from surefoot.games.attempts import watched
from surefoot.games.solution import FOREVER, EnvDeadEnd
from surefoot.games.subsets import Subsets
from surefoot.logic.syntax import Conjunct, Specification, atoms, bit_owners

_T = TypeVar("_T")
_Question = Callable[[tuple[Conjunct, ...], Deadline], bool | None]


@dataclass(frozen=True, slots=True)
class Core:
    """Lines of the system that cannot be kept together.

    Attributes:
        lines: in the order of the file's sections.
        minimal: whether each of them is known to be needed.
        limit: what ended the search early, if it did.
    """

    lines: tuple[Conjunct, ...]
    minimal: bool = True
    limit: str | None = None


def unrealizable_core(
    specification: Specification,
    *,
    semantics: str = "slugs",
    env_dead_end: EnvDeadEnd = "wins",
    deadline: Deadline = FOREVER,
) -> Core:
    """Return a minimal set of lines of the system that make a specification unrealizable.

    With these lines alone it is unrealizable, and without any one of them it is realizable. Limits of integers and
    all lines of the environment stay in force. With robotics semantics SYS_INIT stays too, for there it is an
    assumption. The core is empty where the environment wins whatever the system promises. When the deadline ends the
    search, the smallest set found so far is returned, marked as not minimal.

    Args:
        specification: an unrealizable one.
        semantics: ``slugs`` or ``robotics``.
        env_dead_end: as for ``synthesize``.
        deadline: when to stop.

    Raises:
        LimitExceeded: the deadline passed before it was known to be unrealizable.
        ValueError: the specification is realizable.
    """
    candidates = specification.system_safety + specification.sys_liveness
    if semantics == "slugs":
        candidates = specification.sys_init + candidates
    subsets = Subsets(specification, candidates, robotics=semantics == "robotics", env_dead_end=env_dead_end)
    best: list[tuple[Conjunct, ...]] = []

    def unrealizable(kept: tuple[Conjunct, ...], ask: _Question = subsets.realizable) -> bool | None:
        deadline.check("searching for an unrealizable core")
        realizable = ask(kept, deadline)
        if realizable is False:
            best.append(kept)
        return None if realizable is None else not realizable

    def search() -> tuple[Conjunct, ...]:
        memory = Memory(unrealizable)
        if not memory.holds(candidates):
            raise ValueError("the specification is realizable: it has no unrealizable core")
        hurried = Memory(partial(unrealizable, ask=subsets.glanced), memory.yes, memory.no)
        return minimal(candidates, memory.holds, hurried.holds)

    try:
        return Core(watched(search, deadline))
    except LimitExceeded as limit:
        if not best:
            raise
        return Core(min(best, key=len), minimal=False, limit=str(limit))


def keeping(
    specification: Specification, kept: tuple[Conjunct, ...], candidates: tuple[Conjunct, ...]
) -> Specification:
    """Return a specification without those candidates that are not kept."""
    dropped = {id(conjunct) for conjunct in candidates} - {id(conjunct) for conjunct in kept}

    def left(conjuncts: tuple[Conjunct, ...]) -> tuple[Conjunct, ...]:
        return tuple(conjunct for conjunct in conjuncts if id(conjunct) not in dropped)

    return replace(
        specification,
        sys_init=left(specification.sys_init),
        sys_trans=left(specification.sys_trans),
        sys_trans_hard=left(specification.sys_trans_hard),
        sys_liveness=left(specification.sys_liveness),
    )


def without_idle_outputs(specification: Specification) -> Specification:
    """Return a specification without the outputs that no line mentions; who wins stays the same."""
    owners = bit_owners(specification)
    names = {name for name, _ in atoms(conjunct.expression for conjunct in specification.conjuncts)}
    names |= {owners[name][0].name for name in names if name in owners}
    return replace(specification, outputs=tuple(v for v in specification.outputs if v.name in names))


@dataclass(slots=True)
class Memory:
    """Answers a monotone question about sets, from earlier answers where they tell.

    Attributes:
        ask: whether it holds for a set; it then holds for every larger one. None where that is not found out.
        yes: sets for which it holds; two memories may share these and ``no``.
        no: sets for which it does not.
        asked: how often ``ask`` was called.
    """

    ask: Callable[[tuple[Conjunct, ...]], bool | None]
    yes: list[frozenset[int]] = field(default_factory=list)
    no: list[frozenset[int]] = field(default_factory=list)
    asked: int = 0

    def holds(self, kept: tuple[Conjunct, ...]) -> bool:
        """Return the answer for a set, False where it is not found out."""
        names = frozenset(map(id, kept))
        if any(names >= known for known in self.yes):
            return True
        if any(names <= known for known in self.no):
            return False
        self.asked += 1
        answer = self.ask(kept)
        if answer is not None:
            (self.yes if answer else self.no).append(names)
        return bool(answer)


def minimal(
    items: tuple[_T, ...],
    holds: Callable[[tuple[_T, ...]], bool],
    glance: Callable[[tuple[_T, ...]], bool] | None = None,
) -> tuple[_T, ...]:
    """Return a minimal subset for which a monotone question still holds; large pieces are left out first.

    Args:
        items: a set for which it holds.
        holds: whether it holds for a set; it then holds for every larger one.
        glance: asked instead where several items are left out at once; it may give up and say no. What is hard to
            tell of large sets is told soon enough of what is left of them.
    """
    if holds(()):
        return ()
    size = max(1, len(items) // 2)
    while True:
        place = 0
        while place < len(items):
            shorter = items[:place] + items[place + size :]
            if len(items) > 1 and (glance or holds if size > 1 else holds)(shorter):
                items = shorter
            else:
                place += size
        if size == 1:
            return items
        size = max(1, size // 2)
