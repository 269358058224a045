"""The smallest factor on all widths at which a stream of the tube breaks a claim: proved below it, with a run above it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from safeloc.language.expr import NumVar, Var
from safeloc.language.nodes import Value
from safeloc.proof.around.containment import first_outside
from safeloc.proof.around.deviations import PARTS
from safeloc.proof.around.tube import Tube
from safeloc.proof.around.windows import Breaks, Holds, Outcome

Decide = Callable[[int], Outcome]
"""So many PARTS of all widths -> what is found of the claim in that tube."""
Again = Callable[[int, int], Breaks | None]
"""So many PARTS of all widths and a cycle -> a stream of that tube that breaks the claim, at its corners or in that cycle, if one is found."""


@dataclass(frozen=True, eq=False)
class Nearest:
    """The nearest stream that was found to break a claim.

    broken_at  PARTS of all widths that the run needs
    holds_at   the most PARTS at which the claim is proved; None if it is broken without any width
    moved      whether messages may be lost or late
    """

    breaks: Breaks
    broken_at: int
    holds_at: int | None
    moved: bool = False

    @property
    def told(self) -> str:
        """Return both factors in words."""
        broken = f"broken at {_factor(self.broken_at)} of the widths (this run)"
        if self.holds_at is None:
            allowed = ", with the losses and delays allowed," if self.moved else ""
            return broken if self.broken_at else f"{broken}: the stream given{allowed} breaks it without any width"
        between = "" if self.broken_at - self.holds_at == 1 else "; between them it is undecided"
        return f"holds at {_factor(self.holds_at)} of the widths (proved), {broken}{between}"


def _factor(parts: int) -> str:
    return f"{parts / PARTS:.3f}"


def nearest(tube: Tube, found: Breaks, decide: Decide, again: Again) -> Nearest:
    """Return the nearest stream that breaks a claim; `found` is one of the whole tube.

    In the cycle in which one breaks it, the smallest factor is found by bisection; then the whole stream is asked just below
    that factor. If it breaks there too, in another cycle, that is bisected; if it is undecided there, the factor that is proved is.
    """
    best = _least_there(tube, found, again)
    holds, broken, unsure = -1, needed(tube, best.stream), PARTS + 1
    while broken - holds > 1 and unsure - holds > 1:
        parts = broken - 1 if unsure > PARTS else (holds + unsure) // 2
        outcome = decide(parts)
        match outcome:
            case Holds():
                holds = _same_widths(tube, parts, min(broken, unsure))
            case Breaks():
                best = _least_there(tube, outcome, again)
                broken, unsure = min(parts, needed(tube, best.stream)), PARTS + 1
            case _:
                unsure = parts
    return Nearest(best, broken, None if holds < 0 else holds, bool(tube.deviations.channels))


def _least_there(tube: Tube, found: Breaks, again: Again) -> Breaks:
    """Return the stream of the smallest factor that breaks the claim in about the same cycle, as far as one is found."""
    low, best = 0, found
    high = needed(tube, best.stream)
    while low < high:
        middle = (low + high) // 2
        nearer = again(middle, best.cycle)
        if nearer is None:
            low = middle + 1
        else:
            best, high = nearer, min(middle, needed(tube, nearer.stream))
    return best


def _same_widths(tube: Tube, parts: int, below: int) -> int:
    """Return the most parts below a bound at which all widths are as at `parts`: what is proved there is proved here."""
    widths = tube.scaled(parts).deviations
    while parts + 1 < below and tube.scaled(parts + 1).deviations == widths:
        parts += 1
    return parts


def needed(tube: Tube, stream: Sequence[Mapping[Var, Value]]) -> int:
    """Return the fewest PARTS of all widths with which the tube holds a stream of it."""
    low, high = 0, PARTS
    while low < high:
        middle = (low + high) // 2
        if first_outside(tube.scaled(middle), stream) is None and _ghosts_near(tube.scaled(middle)):
            high = middle
        else:
            low = middle + 1
    return high


def _ghosts_near(tube: Tube) -> bool:
    """Return whether no state of the world is held near what is recorded: `first_outside` looks at inputs alone."""
    return not any(tube.named(var) for var in tube.system.state if isinstance(var, NumVar))
