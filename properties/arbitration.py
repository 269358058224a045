"""Properties of arbitration between sources (RFL-13, RFL-14, MRK-D3): only valid sources count, and only if they agree."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

from safeloc.language.expr import Bool, Lit, Num, all_of, any_of, before, between, exact_to, ite
from safeloc.language.machine import Machine
from safeloc.language.spec import Property, always, earlier_bool
from safeloc.language.units import NM
from safeloc.models.arbitration import Arbitration
from safeloc.models.arbitration.variables import Source
from safeloc.models.vocabulary.absent import NO_POSITION_MM
from safeloc.models.vocabulary.reasons import CONTRADICTION, LOCATED, NO_REFERENCE, SENSOR_FAILURE, TOLERANCE
from safeloc.properties.claims import Claims
from safeloc.properties.no_interval import no_interval

_SOURCES_ARE_TRUE = "a source that states an interval states one that holds the truth (its own proof discharges this)"
REQUIREMENTS = ("RFL-13", "RFL-14")


def properties(model: Arbitration) -> list[Property]:
    """Return the properties of the arbitration machine, whatever its sources are."""
    makers = (_safety, _common_part, _contradiction, _reference, _stated, _withdrawn, _leading, _estimated, _front)
    return [prop for maker in makers for prop in maker(model)]


_free = Claims(REQUIREMENTS).for_all_inputs


def _safety(model: Arbitration) -> Iterator[Property]:
    machine, own = model.machine, model.own
    given, low, high = _given(model)
    yield always(
        "containment",
        given.implies(between(exact_to(low, NM), own.truth, exact_to(high, NM))),
        statement="the reported interval contains the true position of the front end",
        requirements=REQUIREMENTS,
        assumption=_SOURCES_ARE_TRUE,
    )
    most = own.config.tolerance_mm
    tolerable = (machine.output("margin_below_mm") <= most) & (machine.output("margin_above_mm") <= most)
    yield _free(
        "tolerance", given.implies(tolerable), "the reported interval is never wider than tolerable, on either side"
    )
    silent = all_of(own_var.eq(0) for own_var in (own.position, own.below, own.above, own.lag))
    yield _free(
        "no part of a withheld position is reported",
        given | (silent & _nothing_reported(model.machine)),
        "while a position is withheld the machine reports no part of it",
    )


def _nothing_reported(machine: Machine) -> Bool:
    ends = [machine.output(name).eq(NO_POSITION_MM) for name in ("min_safe_front_mm", "max_safe_front_mm")]
    return no_interval(machine) & all_of(ends)


def _common_part(model: Arbitration) -> Iterator[Property]:
    own = model.own
    given, low, high = _given(model)
    inside = [source.valid.implies((low >= source.low) & (high <= source.high)) for source in own.sources]
    yield _free(
        "all that are valid agree",
        given.implies(all_of(inside)),
        "the reported interval lies within the interval of every valid source",
    )
    lowest = any_of(source.valid & source.low.eq(low) for source in own.sources)
    highest = any_of(source.valid & source.high.eq(high) for source in own.sources)
    yield _free(
        "only valid sources narrow",
        given.implies(lowest & highest),
        "each end of the reported interval is an end of a valid source's interval: a source without an interval, or "
        "one that is not valid, narrows nothing",
    )
    yield from _exclusions(model)


def _exclusions(model: Arbitration) -> Iterator[Property]:
    given, _, _ = _given(model)
    for one, other in combinations(model.own.sources, 2):
        yield _free(
            f"{one.name} against {other.name}",
            _apart(one, other).implies(~given),
            f"if {one.name} and {other.name} exclude each other, no position is reported in that step",
        )


def _contradiction(model: Arbitration) -> Iterator[Property]:
    own, nobody = model.own, Lit(0, model.own.named)
    given, _, _ = _given(model)
    noticed = own.reason.eq(CONTRADICTION) & earlier_bool(given)
    excluded = [
        (own.first.eq(Lit(one, own.named)) & own.second.eq(Lit(two, own.named))).implies(_apart(a, b))
        for one, a in enumerate(own.sources, 1)
        for two, b in enumerate(own.sources, 1)
        if a is not b
    ]
    if excluded:
        both = own.first.ne(nobody) & own.second.ne(nobody) & own.first.ne(own.second)
        clash = model.machine.fired("sources contradict each other")
        yield _free(
            "both sources are named",
            (clash & noticed).implies(both & all_of(excluded)),
            "a contradiction names two sources, and these two exclude each other",
        )


def _reference(model: Arbitration) -> Iterator[Property]:
    given, _, _ = _given(model)
    referred = ~all_of(source.valid.implies(~source.reference) for source in model.own.sources)
    yield _free(
        "no resurrection",
        (given & ~earlier_bool(given)).implies(referred),
        "after a position was withheld, the machine reports one only in a step in which a valid source has accepted "
        "an absolute reference, and all valid sources agree",
    )


def _stated(model: Arbitration) -> Iterator[Property]:
    own, nobody = model.own, Lit(0, model.own.named)
    given, _, _ = _given(model)
    silent = all_of(~source.valid for source in own.sources)
    yield _free(
        "silence withholds",
        silent.implies(~given),
        "without any valid source the machine reports no position in that step",
    )
    yield _free(
        "reason stated",
        own.reason.eq(LOCATED).iff(given),
        "the machine gives a reason exactly while it reports no position",
    )
    none_accepted = all_of(~source.valid | ~source.reference for source in own.sources)
    yield _free(
        "a reference is reported when it is accepted",
        model.machine.flag("reference_accepted").iff(given & ~none_accepted),
        "a reference is reported exactly in a step in which a position is reported and a valid source accepted a reference",
    )
    unnamed = own.first.eq(nobody) & own.second.eq(nobody)
    yield _free(
        "no contradiction is named while a position is reported",
        given.implies(unnamed),
        "while a position is reported no contradiction is named",
    )


def _withdrawn(model: Arbitration) -> Iterator[Property]:
    machine, own = model.machine, model.own
    given, _, _ = _given(model)
    lost = earlier_bool(given) & ~given
    silent = all_of(~source.valid for source in own.sources)
    apart = any_of(_apart(one, other) for one in own.sources for other in own.sources if one is not other)
    contradicted = own.reason.eq(CONTRADICTION)
    if len(own.sources) > 1:
        yield _free(
            "a contradiction is the reason",
            (lost & ~silent).implies(contradicted.iff(apart)),
            "the machine withdraws a position for a contradiction exactly if two valid sources exclude each other",
        )
    for source, mode in zip(own.sources, machine.modes[1:], strict=True):
        why = ite(source.reason.eq(LOCATED), NO_REFERENCE, source.reason)
        yield _free(
            f"the reason of {source.name} is passed on",
            (lost & silent & before(machine.mode).eq(mode)).implies(own.reason.eq(why)),
            f"where {source.name} led and no source states an interval any more, the reported reason is the one of {source.name}",
        )
    too_wide = own.reason.eq(TOLERANCE)
    most = own.config.tolerance_mm
    narrow = any_of(
        one.valid & other.valid & (one.high - other.low <= most) for one in own.sources for other in own.sources
    )
    yield _free(
        "a narrow interval is tolerable",
        (lost & narrow).implies(~too_wide),
        "the machine does not withdraw a position for its tolerance if the part that all sources have in common is no wider than that",
    )
    lags = own.reason.eq(SENSOR_FAILURE) & ~silent
    yield _free(
        "withdrawn for a reason",
        (lost & ~silent).implies(contradicted | too_wide | lags),
        "while a source gives an interval, the machine withdraws a position only for a contradiction, its tolerance, or a lag beyond its limit",
    )


def _leading(model: Arbitration) -> Iterator[Property]:
    for source in model.own.sources:
        yield _leads_validly(model, source)
        yield _leads_by_margin(model, source)
        if len(model.own.sources) > 1:
            yield from _takes_over(model, source)


def _mode_of(model: Arbitration, source: Source) -> Lit:
    return model.machine.modes[1 + model.own.sources.index(source)]


def _leads_validly(model: Arbitration, source: Source) -> Property:
    leads = model.machine.mode.eq(_mode_of(model, source))
    return _free(f"{source.name} leads validly", leads.implies(source.valid), f"{source.name} leads only while valid")


def _leads_by_margin(model: Arbitration, source: Source) -> Property:
    leads = model.machine.mode.eq(_mode_of(model, source))
    return _free(
        f"{source.name} leads by its margin",
        leads.implies(all_of(one.valid.implies(_no_wider(source, one)) for one in model.own.sources)),
        f"{source.name} leads only while no valid source has a smaller margin",
    )


def _takes_over(model: Arbitration, source: Source) -> Iterator[Property]:
    machine, own, mode = model.machine, model.own, _mode_of(model, source)
    given, _, _ = _given(model)
    leads = machine.mode.eq(mode)
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
    narrower = all_of(one.valid.implies(~_no_wider(one, source)) for one in earlier)
    yield _free(
        f"{source.name} comes after those declared before it",
        (leads & before(machine.mode).ne(mode)).implies(narrower),
        f"{source.name} begins to lead only with a smaller margin than every valid source that is declared before it",
    )


def _no_wider(source: Source, other: Source) -> Bool:
    """Return whether the source's greater margin is no greater than that of the other."""
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
    yield always(
        "min safe front end",
        given.implies(exact_to(front, NM) <= own.truth) & (front <= low),
        statement="the front end is never behind the reported min safe front end",
        requirements=REQUIREMENTS,
        assumption=_SOURCES_ARE_TRUE,
    )
    yield _advances_with_distance(model)
    yield _free(
        "min safe front end begins at the interval's",
        (given & ~earlier_bool(given)).implies(front.eq(low)),
        "when a position is reported for the first time, its min safe front end is the lower end of the interval",
    )
    measured, estimated = own.distance.value, _estimated_change(model)
    yield _free(
        "min safe front end lags no farther than it must",
        _goes_on(model, measured=True).implies(front.eq(low) | _advance(model).eq(measured)),
        "the min safe front end is the interval's lower end, or advances by the whole distance estimated",
    )
    yield _advances_with_estimate(model)
    yield _free(
        "min safe front end lags no farther than the estimate",
        _goes_on(model, measured=False).implies(front.eq(low) | _advance(model).eq(estimated)),
        "without a measured distance it is the interval's lower end, or advances by as much as the estimated position does",
    )


def _advances_with_distance(model: Arbitration) -> Property:
    return _free(
        "min safe front end advances with the distance",
        _goes_on(model, measured=True).implies(_advance(model) <= model.own.distance.value),
        "the min safe front end never advances by more than the distance estimated (OCORA 7244): that of the odometer",
    )


def _advances_with_estimate(model: Arbitration) -> Property:
    return _free(
        "min safe front end advances with the estimate",
        _goes_on(model, measured=False).implies(_advance(model) <= _estimated_change(model)),
        "without a measured distance the min safe front end never advances by more than the estimated position does",
    )


def _goes_on(model: Arbitration, *, measured: bool) -> Bool:
    """A position is reported before and after the step, with a measured distance or without one."""
    given, _, _ = _given(model)
    present = model.own.distance.present
    return given & earlier_bool(given) & (present if measured else ~present)


def _advance(model: Arbitration) -> Num:
    """Return the advance of the min safe front end in the step, mm."""
    own = model.own
    safe_before = before(own.position) - before(own.below) - before(own.lag)
    return model.machine.output("min_safe_front_mm") - safe_before


def _estimated_change(model: Arbitration) -> Num:
    """The change of the estimated position, as far as a vehicle can run in a cycle, mm."""
    own, most = model.own, model.own.config.max_cycle_distance_mm
    change = own.position - before(own.position)
    return ite(change > most, most, ite(change < -most, -most, change))


def kept_in_compositions(model: Arbitration) -> list[Property]:
    """Return the properties that a localizer claims of the whole as well."""
    leading = [made for one in model.own.sources for made in (_leads_validly(model, one), _leads_by_margin(model, one))]
    front = [_advances_with_distance(model), _advances_with_estimate(model)]
    return [*_common_part(model), *leading, *front]


def _given(model: Arbitration) -> tuple[Bool, Num, Num]:
    own = model.own
    return model.machine.flag("valid"), own.position - own.below, own.position + own.above


def _apart(source: Source, other: Source) -> Bool:
    return source.valid & other.valid & ((source.high < other.low) | (other.high < source.low))
