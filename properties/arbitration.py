"""What must hold of arbitration between sources (RFL-13, RFL-14, MRK-D3): only agreement counts, and only of the valid."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import Bool, Lit, Num, all_of, any_of, before, between, exact_to, ite
from safeloc.language.machine import Machine
from safeloc.language.spec import Property, always, earlier_bool
from safeloc.language.units import NM
from safeloc.models.arbitration import Arbitration
from safeloc.models.arbitration.variables import Source
from safeloc.models.vocabulary.absent import NO_POSITION_MM
from safeloc.models.vocabulary.reasons import CONTRADICTION, LOCATED, NO_REFERENCE, SENSOR_FAILURE, TOLERANCE
from safeloc.properties.no_interval import no_interval

SOURCES_ARE_TRUE = "a source that states an interval states one that holds the truth (its own proof discharges this)"
REQUIREMENTS = ("RFL-13", "RFL-14")


def properties(model: Arbitration) -> list[Property]:
    """Every property of the arbitration machine, for whatever sources it has."""
    makers = (_safety, _fail_safe, _withdrawn, _leading, _estimated, _front)
    return [prop for maker in makers for prop in maker(model)]


def _free(name: str, term: Bool, statement: str) -> Property:
    """A property that needs no assumption."""
    return always(name, term, statement=statement, requirements=REQUIREMENTS, unconditional=True)


def _safety(model: Arbitration) -> Iterator[Property]:
    machine, own = model.machine, model.own
    given, low, high = _given(model)
    yield always(
        "containment",
        given.implies(between(exact_to(low, NM), own.truth, exact_to(high, NM))),
        statement="what is given out holds the true position of the front end",
        requirements=REQUIREMENTS,
        assumption=SOURCES_ARE_TRUE,
    )
    most = own.config.tolerance_mm
    tolerable = (machine.output("margin_below_mm") <= most) & (machine.output("margin_above_mm") <= most)
    yield _free(
        "tolerance", given.implies(tolerable), "what is given out is never wider than tolerable, on either side"
    )
    silent = all_of(own_var.eq(0) for own_var in (own.position, own.below, own.above, own.lag))
    yield _free(
        "nothing withheld is told",
        given | (silent & _nothing_told(model.machine)),
        "while a position is withheld no part of it is told",
    )


def _nothing_told(machine: Machine) -> Bool:
    ends = [machine.output(name).eq(NO_POSITION_MM) for name in ("min_safe_front_mm", "max_safe_front_mm")]
    return no_interval(machine) & all_of(ends)


def _fail_safe(model: Arbitration) -> Iterator[Property]:
    machine, own = model.machine, model.own
    given, low, high = _given(model)
    inside = [source.valid.implies((low >= source.low) & (high <= source.high)) for source in own.sources]
    yield _free(
        "all that are valid agree", given.implies(all_of(inside)), "it lies within what every valid source states"
    )
    lowest = any_of(source.valid & source.low.eq(low) for source in own.sources)
    highest = any_of(source.valid & source.high.eq(high) for source in own.sources)
    yield _free(
        "only valid sources narrow",
        given.implies(lowest & highest),
        "each end of it is an end that a valid source states: what states nothing, or may not, narrows nothing",
    )
    for index, source in enumerate(own.sources):
        for other in own.sources[index + 1 :]:
            yield _free(
                f"{source.name} against {other.name}",
                _apart(source, other).implies(~given),
                f"where {source.name} and {other.name} exclude each other nothing is given out in the same step",
            )
    named = own.reason.eq(CONTRADICTION) & earlier_bool(given)
    excluded = [
        (own.first.eq(Lit(one, own.named)) & own.second.eq(Lit(two, own.named))).implies(_apart(a, b))
        for one, a in enumerate(own.sources, 1)
        for two, b in enumerate(own.sources, 1)
        if a is not b
    ]
    if excluded:
        both = own.first.ne(Lit(0, own.named)) & own.second.ne(Lit(0, own.named)) & own.first.ne(own.second)
        clash = machine.fired("sources contradict each other")
        yield _free(
            "both sources are named",
            (clash & named).implies(both & all_of(excluded)),
            "a contradiction names two sources, and these two exclude each other",
        )
    referred = ~all_of(source.valid.implies(~source.reference) for source in own.sources)
    yield _free(
        "no resurrection",
        (given & ~earlier_bool(given)).implies(referred),
        "after it was withheld a position is given out only in a step in which a valid source has accepted an absolute "
        "reference, and all that are valid agree",
    )
    silent = all_of(~source.valid for source in own.sources)
    yield _free(
        "silence withholds", silent.implies(~given), "without any valid source nothing is given out in that step"
    )
    yield _free(
        "reason stated", own.reason.eq(LOCATED).iff(given), "a reason is stated exactly while nothing is given out"
    )
    accepted = any_of(source.valid & source.reference for source in own.sources)
    yield _free(
        "a reference is told when it is accepted",
        machine.flag("reference_accepted").iff(given & accepted),
        "a reference is told exactly in a step in which a position is given out and a valid source accepted a reference",
    )
    named = own.first.eq(Lit(0, own.named)) & own.second.eq(Lit(0, own.named))
    yield _free(
        "nobody is named in vain", given.implies(named), "while a position is given out no contradiction is named"
    )


def _withdrawn(model: Arbitration) -> Iterator[Property]:
    machine, own = model.machine, model.own
    given, _, _ = _given(model)
    lost = earlier_bool(given) & ~given
    valid = any_of(source.valid for source in own.sources)
    apart = any_of(_apart(one, other) for one in own.sources for other in own.sources if one is not other)
    contradicted = own.reason.eq(CONTRADICTION)
    if len(own.sources) > 1:
        yield _free(
            "a contradiction is the reason",
            (lost & valid).implies(contradicted.iff(apart)),
            "a position is withdrawn for a contradiction exactly where two valid sources exclude each other",
        )
    for source, mode in zip(own.sources, machine.modes[1:], strict=True):
        why = ite(source.reason.eq(LOCATED), NO_REFERENCE, source.reason)
        yield _free(
            f"the reason of {source.name} is passed on",
            (lost & ~valid & before(machine.mode).eq(mode)).implies(own.reason.eq(why)),
            f"where {source.name} led and no source states an interval any more, its reason is told",
        )
    too_wide = own.reason.eq(TOLERANCE)
    most = own.config.tolerance_mm
    narrow = any_of(
        one.valid & other.valid & (one.high - other.low <= most) for one in own.sources for other in own.sources
    )
    yield _free(
        "a narrow interval is tolerable",
        (lost & narrow).implies(~too_wide),
        "a position is not withdrawn for its tolerance where what the sources have in common is no wider than it",
    )
    lags = own.reason.eq(SENSOR_FAILURE) & valid
    yield _free(
        "withdrawn for a reason",
        (lost & valid).implies(contradicted | too_wide | lags),
        "while a source states an interval a position is withdrawn for a contradiction, its tolerance, or a lag beyond its limit",
    )


def _leading(model: Arbitration) -> Iterator[Property]:
    machine, own = model.machine, model.own
    given, _, _ = _given(model)
    for source, mode in zip(own.sources, machine.modes[1:], strict=True):
        leads = machine.mode.eq(mode)
        yield _free(
            f"{source.name} leads validly", leads.implies(source.valid), f"{source.name} leads only while valid"
        )
        others = all_of(one.valid.implies(_no_wider(source, one)) for one in own.sources)
        yield _free(
            f"{source.name} leads by its margin",
            leads.implies(others),
            f"{source.name} leads only while no valid source has a smaller margin",
        )
        if len(own.sources) == 1:
            continue
        changed = leads & earlier_bool(given) & before(machine.mode).ne(mode)
        better = [
            before(machine.mode).eq(other).implies(~one.valid | ~_no_wider(one, source))
            for one, other in zip(own.sources, machine.modes[1:], strict=True)
        ]
        yield _free(
            f"{source.name} takes over for a reason",
            changed.implies(all_of(better)),
            f"{source.name} takes over only from a source that is no longer valid or has the greater margin",
        )
        earlier = own.sources[: own.sources.index(source)]
        yield _free(
            f"{source.name} comes after those declared before it",
            (leads & before(machine.mode).ne(mode)).implies(
                all_of(one.valid.implies(~_no_wider(one, source)) for one in earlier)
            ),
            f"{source.name} begins to lead only with a smaller margin than every valid source that is declared before it",
        )


def _no_wider(source: Source, other: Source) -> Bool:
    """Its greater margin is no greater than the greater one of the other."""
    sides = (source.below, source.above)
    return all_of((side <= other.below) | (side <= other.above) for side in sides)


def _estimated(model: Arbitration) -> Iterator[Property]:
    machine, own = model.machine, model.own
    _, low, high = _given(model)
    position = own.position
    for source, mode in zip(own.sources, machine.modes[1:], strict=True):
        theirs = source.position
        nearest = position.eq(theirs) | (position.eq(low) & (theirs < low)) | (position.eq(high) & (theirs > high))
        yield _free(
            f"{source.name} gives the estimate",
            machine.mode.eq(mode).implies(between(low, position, high) & nearest),
            f"while {source.name} leads, the position is that of {source.name}, or the nearest place that all have in common",
        )


def _front(model: Arbitration) -> Iterator[Property]:
    own = model.own
    given, low, _ = _given(model)
    front = model.machine.output("min_safe_front_mm")
    safe_before = before(own.position) - before(own.below) - before(own.lag)
    yield always(
        "min safe front end",
        given.implies(exact_to(front, NM) <= own.truth) & (front <= low),
        statement="the front end is never behind the min safe front end that is given out",
        requirements=REQUIREMENTS,
        assumption=SOURCES_ARE_TRUE,
    )
    kept = given & earlier_bool(given)
    yield _free(
        "min safe front end advances with the distance",
        (kept & own.distance.present).implies(front - safe_before <= own.distance.value),
        "the min safe front end never advances by more than the distance estimated (OCORA 7244): that of the odometer",
    )
    yield _free(
        "min safe front end begins at the interval's",
        (given & ~earlier_bool(given)).implies(front.eq(low)),
        "where a position is given out for the first time its min safe front end is the lower end of the interval",
    )
    yield _free(
        "min safe front end lags no farther than it must",
        (kept & own.distance.present).implies(front.eq(low) | (front - safe_before).eq(own.distance.value)),
        "the min safe front end is the interval's lower end, or advances by the whole distance estimated",
    )
    most = own.config.max_step_mm
    change = own.position - before(own.position)
    estimated = ite(change > most, most, ite(change < -most, -most, change))
    yield _free(
        "min safe front end advances with the estimate",
        (kept & ~own.distance.present).implies(front - safe_before <= estimated),
        "without a measured distance the min safe front end never advances by more than the estimated position does",
    )
    yield _free(
        "min safe front end lags no farther than the estimate",
        (kept & ~own.distance.present).implies(front.eq(low) | (front - safe_before).eq(estimated)),
        "without a measured distance it is the interval's lower end, or advances by as much as the estimated position does",
    )


def _given(model: Arbitration) -> tuple[Bool, Num, Num]:
    own = model.own
    return model.machine.flag("valid"), own.position - own.below, own.position + own.above


def _apart(source: Source, other: Source) -> Bool:
    return source.valid & other.valid & ((source.high < other.low) | (other.high < source.low))
