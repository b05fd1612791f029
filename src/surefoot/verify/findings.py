"""What a checker answers: a report with its findings, each with the rule that is broken."""

from __future__ import annotations

from dataclasses import dataclass, field

KEPT = 20
"""How many findings a report keeps; all are counted."""


@dataclass(frozen=True, slots=True)
class Finding:
    """One broken rule.

    Attributes:
        rule: the rule, such as ``rules.md 4, collision``.
        message: what is wrong, in one sentence.
        where: the state, record or key in which it shows.
    """

    rule: str
    message: str
    where: str = ""

    def __str__(self) -> str:
        """Return the finding as one line."""
        return f"{self.rule}: {self.message}" + (f" ({self.where})" if self.where else "")


@dataclass(frozen=True, slots=True)
class Report:
    """The answer of a checker.

    Attributes:
        kind: what was checked, ``biped-plan`` or ``biped-run``.
        accepted: True when no rule is broken.
        findings: the first findings, at most ``KEPT``.
        counts: sizes and counts of what was checked; ``findings`` counts all of them.
        failures: what went wrong in a mission, by its own log: the robot fell, or no step was safe. They make no log
            wrong, and a log that shows them is accepted.
    """

    kind: str
    accepted: bool
    findings: tuple[Finding, ...]
    counts: dict[str, object]
    failures: tuple[Finding, ...] = ()


@dataclass(slots=True)
class Ledger:
    """Collects findings, failures and counts while a check runs."""

    kept: list[Finding] = field(default_factory=list)
    failed: list[Finding] = field(default_factory=list)
    total: int = 0
    counts: dict[str, object] = field(default_factory=dict)

    def refuse(self, rule: str, message: str, where: str = "", times: int = 1) -> None:
        """Note a broken rule, and how often it is broken."""
        self.total += times
        if len(self.kept) < KEPT:
            self.kept.append(Finding(rule, message, where))

    def fail(self, rule: str, message: str, where: str = "") -> None:
        """Note what went wrong in a mission whose log says so itself."""
        self.failed.append(Finding(rule, message, where))

    def report(self, kind: str) -> Report:
        """Return what was found."""
        counts = {**self.counts, "findings": self.total}
        return Report(kind, self.total == 0, tuple(self.kept), counts, tuple(self.failed))
