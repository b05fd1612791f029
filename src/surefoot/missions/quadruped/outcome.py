"""How a quadruped's mission ended: what its answer tells, and what a campaign of missions keeps of it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """How a mission ended.

    Attributes:
        reached: whether the robot stands in the cell of the goal.
        why_not: why it does not; empty if it does.
        transitions: that were walked.
        repairs: strategies that were made at run time, because the library had none or a program failed.
        new_skills: skills that physics certified, before the robot set out or on the way.
        resynthesis_ms: the longest time that making such a strategy from skills at hand took [ms], in processor time.
        repair_ms: the same where physics had to be asked about new skills, physics not counted; 0 without any.
        contradictions: online programs that are infeasible although the skill has an offline certificate.
        other_gaits: how many of these transitions another gait could do.
        settled: how often the robot stepped in place, because a program failed from where its feet were.
        limits: online programs that a limit left open.
        detours: how often the robot stood and the global planner was asked for another way.
        idle_s: how long the robot stood because the next motion was not there [s].
        idle_for_checks_s: the part of it in which physics was asked about skills that the library lacks.
        walked_s: when the robot stands at last [s].
        verified: whether the independent checker accepted the log.
        findings: what it refused.
    """

    reached: bool
    why_not: str
    transitions: int
    repairs: int
    new_skills: int
    resynthesis_ms: float
    repair_ms: float
    contradictions: int
    other_gaits: int
    settled: int
    limits: int
    detours: int
    idle_s: float
    idle_for_checks_s: float
    walked_s: float
    verified: bool
    findings: tuple[str, ...]
