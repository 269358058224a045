"""Emptiness of a tube: a claim about lawful streams says nothing where no stream obeys the laws."""

from __future__ import annotations

from safeloc.language.system import TransitionSystem
from safeloc.language.verdict import Unknown, Vacuous
from safeloc.proof.around.course import Space
from safeloc.proof.around.deviations import Deviations
from safeloc.proof.around.members import Member, as_recorded, emptied, first_unlawful, member
from safeloc.proof.around.tube import Tube
from safeloc.proof.provers.limits import Limits


def a_lawful_stream(
    system: TransitionSystem, tube: Tube, limits: Limits
) -> tuple[Member | None, Vacuous | Unknown | None]:
    """Return a lawful stream of the tube, or the verdict of every claim about lawful streams if none is known."""
    recorded = as_recorded(system, tube.given)
    if recorded is not None and first_unlawful(system, recorded) is None:
        return recorded, None
    for deviations in (Deviations(dict.fromkeys(tube.deviations.widths, 0)), tube.deviations):
        found = member(Space(system, Tube(system, tube.given, deviations)), limits, tube.given.length)
        if found is not None:
            return found, None
    empty = emptied(Space(system, tube), limits)
    if empty is None:
        return None, Unknown(
            "no stream of the tube was found that obeys the laws up to the end, and none was excluded either"
        )
    laws = " and ".join(repr(law) for law in empty.laws) or "the ranges of the inputs"
    return None, Vacuous(
        f"the tube is empty from cycle {empty.cycle} on: no stream of it obeys {laws} so far; widen the tube, "
        "or leave a law out with --without"
    )
