"""Logs that grow, and scenes that grow with them: runs of bipeds and of quadrupeds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Protocol

from surefoot.missions.biped.run_log import Run, read_run
from surefoot.viewer.browser.recording import Moving
from surefoot.viewer.kinds import is_quadruped_run
from surefoot.viewer.robots.bodies import chosen_body
from surefoot.viewer.scenes.footholds import FootholdScene
from surefoot.viewer.scenes.run import RunScene
from surefoot.viewer.sources.foothold_motion import FootholdMotion, Segment, joined, read_segments, segment_motion
from surefoot.viewer.sources.ground import read_run_ground
from surefoot.viewer.sources.plans import RunSource, read_run_source
from surefoot.viewer.sources.timeline import RATE_HZ, curves_of, timeline
from surefoot.walking import Trajectory


class Growing(Protocol):
    """Reads a log again and again, and draws what is new."""

    def read(self, scene: Any) -> Moving | None:
        """Return what moves, which is the same object as long as the log goes on; None when nothing has moved yet.

        Args:
            scene: of a viser server; it is cleared before another run is drawn.

        Raises:
            InputError: the log holds something else than a run.
        """


class BipedLog:
    """The log of a biped's run.

    Args:
        log: the file.
    """

    def __init__(self, log: Path) -> None:
        self.log = log
        self.source: RunSource | None = None
        self.shown: RunScene | None = None
        self.curves: tuple[Trajectory, ...] = ()

    def read(self, scene: Any) -> RunScene | None:
        """Return the scene of the run, grown."""
        run = read_run(self.log, growing=True)
        if self.source is None or self.shown is None or not _continues(run, self.source.run):
            scene.reset()
            self.source, self.shown, self.curves = None, None, ()
            if not run.steps:
                return None
            self.source = replace(read_run_source(self.log.parent, growing=True), run=run)
            self.curves = curves_of(run.steps, RATE_HZ)
            chosen = chosen_body(self.source.plan.scenario.robot, biped=True, asked=None)
            self.shown = RunScene(scene, self.source, timeline(self.source, self.curves), chosen)
            return self.shown
        self.source = replace(self.source, run=run)
        self.curves += curves_of(run.steps[len(self.curves) :], RATE_HZ)
        self.shown.grow(self.source, timeline(self.source, self.curves))
        return self.shown


def _continues(run: Run, before: Run) -> bool:
    """Return whether a log is a longer state of another one, not one that replaced it."""
    return run.header == before.header and run.steps[: len(before.steps)] == before.steps


class QuadrupedLog:
    """The log of a quadruped's run.

    Args:
        log: the file.
    """

    def __init__(self, log: Path) -> None:
        self.log = log
        self.segments: tuple[Segment, ...] = ()
        self.motion: FootholdMotion | None = None
        self.shown: FootholdScene | None = None

    def read(self, scene: Any) -> FootholdScene | None:
        """Return the scene of the segments, grown."""
        segments = read_segments(self.log, growing=True)
        if segments[: len(self.segments)] != self.segments:
            self.segments, self.motion, self.shown = (), None, None
        new = [segment_motion(self.log, one) for one in segments[len(self.segments) :]]
        self.segments = segments
        if self.shown is None:
            scene.reset()
        if new:
            self.motion = joined(new if self.motion is None else [self.motion, *new])
            ground = read_run_ground(self.log.parent, growing=True)
            if self.shown is None:
                chosen = chosen_body(self.motion.robot, biped=False, asked=None)
                self.shown = FootholdScene(scene, self.motion, chosen, ground)
            else:
                self.shown.grow(self.motion, ground)
        return self.shown


_KINDS: Mapping[bool, type[BipedLog] | type[QuadrupedLog]] = {False: BipedLog, True: QuadrupedLog}


def growing(log: Path, before: Growing | None) -> Growing:
    """Return what reads a log: the same as before as long as the kind of robot is the same."""
    kind = _KINDS[is_quadruped_run(log.parent)]
    return before if isinstance(before, kind) else kind(log)
