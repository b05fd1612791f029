"""What a mission of a quadruped counts while it is under way."""

from __future__ import annotations

from dataclasses import dataclass, field

from surefoot.missions.quadruped.crossing import Crossed
from surefoot.missions.quadruped.timeline import Slot


@dataclass(slots=True)
class Tally:
    """What a mission counts.

    Attributes:
        repairs: strategies that were made at run time.
        new_skills: skills that physics certified at run time.
        resynthesis_ms: processor time of every such strategy from skills at hand.
        repair_ms: of every one that physics was asked for, physics not counted.
        prepared_ms: of all strategies that skills were made for before setting out, physics not counted.
        contradictions: online programs proved infeasible although the skill has a certificate.
        other_gaits: how many of them another gait could do.
        no_stance: targets without a pose to stand in; no program was solved.
        limits: online programs that a limit left open.
        violations: assumptions that did not hold.
        detours: how often the global planner was asked for another way.
        settled: how often the robot stepped in place, because a program failed from where its feet were.
        left: how often it left a cell that had become an obstacle.
        withdrawn: motions that were planned, and not walked because of what happened before they began.
        idle_for_checks_s: how long the robot stood while physics was asked about new skills.
        slots: of the motions that were walked.
        crossed: every online program.
    """

    repairs: int = 0
    new_skills: int = 0
    resynthesis_ms: list[float] = field(default_factory=list)
    repair_ms: list[float] = field(default_factory=list)
    prepared_ms: float = 0.0
    contradictions: int = 0
    other_gaits: int = 0
    no_stance: int = 0
    limits: int = 0
    violations: int = 0
    detours: int = 0
    settled: int = 0
    left: int = 0
    withdrawn: int = 0
    idle_for_checks_s: float = 0.0
    slots: list[Slot] = field(default_factory=list)
    crossed: list[Crossed] = field(default_factory=list)
