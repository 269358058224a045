"""Arbitration between several positions: the intersection of all that are valid, or nothing (RFL-13, MRK-D3).

Each source states an interval that holds the front end, or nothing. The position is the common part of all stated intervals;
the source with the smallest margin leads and gives the estimate. If intervals exclude each other, at least one is wrong, and it
is unknown which: the machine withdraws the position and names two sources that exclude each other. It reports a position again
only when all stated intervals agree, and one of their sources has just accepted an absolute reference. A source that states
nothing narrows nothing.

    WITHHELD  nothing is reported
    ODOMETRY, BALISE, ...  the position is reported; the source that the mode names leads

The min safe front end is a separate output. It never advances by more than the distance estimated for the cycle (OCORA
7244), even where a better source joins and narrows the interval at once: it then lags behind the interval's lower end until it
has caught up. The estimated distance is the odometer's, or, without one, the change of the estimated position, limited to the
run of a vehicle in a cycle.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from safeloc.language.expr import (
    FALSE,
    Bool,
    Expr,
    Lit,
    Num,
    NumVar,
    as_num,
    ite,
)
from safeloc.language.machine import Model, Transition, current_mode, modes
from safeloc.language.rows import Updates, together
from safeloc.language.units import MM
from safeloc.language.world import Law
from safeloc.models.arbitration.cycle import Cycle
from safeloc.models.arbitration.variables import SOURCES, ArbitrationConfig, Parts, Source, parts
from safeloc.models.vocabulary.absent import margin_if, position_if
from safeloc.models.vocabulary.reasons import CONTRADICTION, LOCATED, SENSOR_FAILURE, TOLERANCE
from safeloc.models.vocabulary.vehicle_world import stated_interval_holds

__all__ = ["SOURCES", "Arbitration", "ArbitrationConfig", "Source", "build", "parts"]
REQUIREMENTS = ("RFL-13", "RFL-14")


@dataclass(frozen=True, eq=False)
class Arbitration(Model[Parts]):
    """The machine together with the terms it was built from, for properties to speak about."""

    cycle: Cycle


# ------------------------------------------------------------------ the machine


def build(own: Parts) -> Arbitration:
    """Build the machine over the given variables."""
    table = modes("WITHHELD", *(source.name.upper() for source in own.sources))
    current = current_mode(table)
    given = current.ne(table[0])
    cycle = Cycle(own, current, table)
    made = own.declared.machine(
        name="arbitration",
        modes=table,
        outputs={
            "valid": given,
            "position_mm": position_if(given, own.position),
            "margin_below_mm": margin_if(given, own.below),
            "margin_above_mm": margin_if(given, own.above),
            "min_safe_front_mm": position_if(given, own.position - own.below - own.lag),
            "max_safe_front_mm": position_if(given, own.position + own.above),
            "lead": _named(own, current),
            "reference_accepted": own.reference_taken,
            "contradicting_first": own.first,
            "contradicting_second": own.second,
            "reason": own.reason,
        },
        transitions=[*_given(own, cycle), *_withheld(own, cycle)],
        world=own.declared.world(
            moves={own.truth: own.next_truth},
            clauses=_sources_hold_the_truth(own),
        ),
        lemmas=_lemmas(own, given),
        definitions=_definitions(own, cycle),
        doc=(
            "Gives out what all sources that state a position have in common, led by the one with the smallest margin, and "
            "nothing when they exclude each other. Assumed: a source that states an interval states one that holds the "
            "truth (each source's own proof discharges this). Where that does not hold, two that exclude each other are "
            "noticed; one that is wrong and alone is not."
        ),
    )  # fmt: skip
    return Arbitration(made, own, cycle)


def _named(own: Parts, current: NumVar) -> Num:
    """The leading source as a member of the sources' enumeration."""
    found: Num = Lit(0, own.named)
    for index, _ in enumerate(own.sources, 1):
        found = ite(current.eq(Lit(index, current.unit)), Lit(index, own.named), found)
    return found


def _given(own: Parts, cycle: Cycle) -> Iterator[Transition]:
    """Transitions out of the modes in which a position is reported."""
    lost, *given = cycle.table
    nobody = Lit(0, own.named)

    def drop(reason: Num, first: Num = nobody, second: Num = nobody) -> Updates:
        return together(_nothing(own), {own.reason: reason, own.first: first, own.second: second})

    clash, carried = cycle.any_valid & ~cycle.agree, tuple(given)
    named = drop(CONTRADICTION, cycle.highest_low(), cycle.lowest_high())
    lags = cycle.lag > own.config.lag_limit_mm
    yield Transition("no source is left", carried, lost, ~cycle.any_valid, drop(cycle.why_withdrawn()), REQUIREMENTS, 0)
    if len(own.sources) > 1:  # one cannot contradict itself
        yield Transition("sources contradict each other", carried, lost, clash, named, REQUIREMENTS, 1)
    yield Transition("tolerance exceeded", carried, lost, ~cycle.tolerable, drop(TOLERANCE), REQUIREMENTS, 2)
    yield Transition("distance and position disagree", carried, lost, lags, drop(SENSOR_FAILURE), REQUIREMENTS, 3)
    kept = _stored_interval(own, cycle, cycle.lag)
    for source, target in zip(own.sources, given, strict=True):
        others, leads = tuple(mode for mode in given if mode is not target), cycle.leads(source)
        yield Transition(f"{source.name} goes on leading", target, target, leads, kept, REQUIREMENTS, 4)
        if others:
            takes, stands_in = leads & cycle.leader_valid, leads & ~cycle.leader_valid
            yield Transition(f"{source.name} takes over", others, target, takes, kept, REQUIREMENTS, 4)
            yield Transition(f"{source.name} stands in", others, target, stands_in, kept, REQUIREMENTS, 4)


def _withheld(own: Parts, cycle: Cycle) -> Iterator[Transition]:
    """Transitions out of the mode in which nothing is reported."""
    lost, *given = cycle.table
    begun = _stored_interval(own, cycle, as_num(0, MM))
    for source, target in zip(own.sources, given, strict=True):
        begins = cycle.usable & cycle.referred & cycle.leads(source)
        yield Transition(f"{source.name} leads first", lost, target, begins, begun, REQUIREMENTS, 0)
    if len(own.sources) > 1:
        clash = cycle.any_valid & ~cycle.agree & own.first.eq(Lit(0, own.named))
        named: Updates = {own.first: cycle.highest_low(), own.second: cycle.lowest_high()}
        noticed = together(_nothing(own), named, {own.reason: CONTRADICTION})
        yield Transition("contradiction while withheld", lost, lost, clash, noticed, REQUIREMENTS, 1)
    yield Transition("nothing to report", lost, lost, set=_nothing(own), requirements=REQUIREMENTS, rank=2)


def _stored_interval(own: Parts, cycle: Cycle, lag: Num) -> Updates:
    """The interval that all valid sources have in common is reported."""
    nobody = Lit(0, own.named)
    return {
        own.position: cycle.estimate,
        own.below: cycle.estimate - cycle.low,
        own.above: cycle.high - cycle.estimate,
        own.lag: lag,
        own.first: nobody,
        own.second: nobody,
        own.reason: LOCATED,
        own.reference_taken: cycle.referred,
    }


def _nothing(own: Parts) -> Updates:
    """No position is reported."""
    zero = as_num(0, MM)
    return {own.position: zero, own.below: zero, own.above: zero, own.lag: zero, own.reference_taken: FALSE}


def _definitions(own: Parts, cycle: Cycle) -> dict[str, Expr]:
    """Names for what the table speaks of."""
    named: dict[str, Expr] = {
        "some source is valid": cycle.any_valid, "all sources agree": cycle.agree, "interval tolerable": cycle.tolerable,
        "lower end in common": cycle.low, "upper end in common": cycle.high, "estimate": cycle.estimate,
        "distance estimated": cycle.estimated, "reference accepted now": cycle.referred,
        "the leader is valid": cycle.leader_valid,
    }  # fmt: skip
    return named | {f"{source.name} leads now": cycle.leads(source) for source in own.sources}


def _sources_hold_the_truth(own: Parts) -> dict[str, Law]:
    """Return the laws that an interval which a source states holds the truth."""
    return {
        f"{source.name} holds the truth": Law(
            source.valid.implies(source.holds(own.next_truth)),
            f"The interval that {source.name} states as valid holds the true position.",
            source="[D] containment of that way of locating, whose own proof it is",
            owner="supplier",
            check="every two sources that exclude each other are noticed and counted",
        )
        for source in own.sources
    }


def _lemmas(own: Parts, given: Bool) -> dict[str, Bool]:
    inside = stated_interval_holds(own.position, own.below, own.above, own.truth)
    nothing = own.position.eq(0) & own.below.eq(0) & own.above.eq(0) & own.lag.eq(0)
    return {
        "the interval holds the truth": given.implies(inside),
        "nothing while withheld": given | nothing,
    }
