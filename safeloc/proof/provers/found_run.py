"""A run that reaches a mode or a transition: the verdict that it shows, and the method in words."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.spec import Goal
from safeloc.language.trace import Trace
from safeloc.language.verdict import Proved, Verdict
from safeloc.proof.provers.sparing_run import how_it_breaks


@dataclass(frozen=True, eq=False)
class FoundRun:
    """A run to a target, the engine that found it, and a description."""

    trace: Trace
    engine: str
    words: str


def shown_lawfully(run: FoundRun) -> tuple[Verdict, str]:
    """Return the verdict for a target that a run reaches under the assumption, and the method."""
    verdict = Proved(None, run.engine, len(run.trace.steps), ("interpreter",), witness=run.trace)
    return verdict, f"{run.words} under the assumption"


def shown_freely(free: Goal, run: FoundRun, while_kept: str) -> tuple[Verdict, str]:
    """Return the same for a run that was looked for without the assumption, which may keep it all the same.

    while_kept  what is known while the assumption is kept, in words
    """
    breaks, (verdict, lawful) = how_it_breaks(free.original, run.trace), shown_lawfully(run)
    return verdict, f"a defence: {run.words} that {breaks}; {while_kept}" if breaks else lawful
