"""Three-valued answers: yes, no with a witness, unknown because of a limit."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Generic, TypeVar

W = TypeVar("W")


class Answer(Enum):
    """What a question was answered with."""

    TRUE = "true"
    FALSE = "false"
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True)
class Verdict(Generic[W]):
    """An answer with its reason.

    Attributes:
        answer: yes, no or unknown. An unknown is to be treated as unavailable.
        witness: why the answer is no (for instance the goal that fails and the states it fails from).
        limit: which limit made the answer unknown.
    """

    answer: Answer
    witness: W | None = None
    limit: str | None = None

    @classmethod
    def true(cls) -> Verdict[W]:
        """Return the answer yes."""
        return cls(Answer.TRUE)

    @classmethod
    def false(cls, witness: W) -> Verdict[W]:
        """Return the answer no, with its reason."""
        return cls(Answer.FALSE, witness=witness)

    @classmethod
    def unknown(cls, limit: str) -> Verdict[W]:
        """Return that the question stayed open, with the limit that was reached."""
        return cls(Answer.UNKNOWN, limit=limit)

    def __bool__(self) -> bool:
        """Return True for yes only."""
        return self.answer is Answer.TRUE
