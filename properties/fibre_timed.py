"""Properties of the fibre that is timed: F by the time of flight shows a broken law, and each place that can be compared is (FWG-4, -6, -7).

The claims of the time-of-flight machine and of the sections machine hold of the whole too; each stands here with the name of its machine in front.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from safeloc.language.expr import Bool, Num, abs_, all_of, between, exact_to, ite
from safeloc.language.spec import Property, always, earlier_bool, reachable
from safeloc.language.units import NM, NM_PER_MM
from safeloc.models.fibre import variables as v
from safeloc.models.fibre_timed import FibreTimed
from safeloc.models.fibre_timed.additional import (
    AMPLITUDE_MISSED,
    COMPARED,
    NO_PLACE,
    OFF_THE_LINE,
    REQUIREMENTS,
    TOO_WIDE,
)
from safeloc.models.vocabulary.absent import NO_POSITION_MM
from safeloc.properties import fibre, time_of_flight

LAW = f"{fibre.place.LAW}; {time_of_flight.LAW}; both are those of one end of a train"
_OF_THE_FLIGHT = (
    "the distance holds the vehicle",
    "containment",
    "a vehicle that is timed is reported",
    "time and distance are reported exactly when they are known",
    "a place is reported exactly with a surveyed point",
    "what is not known is absent",
)
"""Claimed of the time of flight alone; T and Ls are outputs of the whole as well."""
_OF_THE_SECTIONS = (
    "containment",
    "time of flight raises F at once",
    "time of flight off the section raises F",
    "F arises only for the reported reason",
    "F is latched",
    "F reports nothing",
    "count agrees with the truth",
    "a position signal is reported as one",
    "an end in a section is reported",
)
"""Claimed of the sections alone, for whatever place is compared; by the last two an observer knows which place was compared with an edge."""
for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)
under_assumption = partial(always, requirements=REQUIREMENTS, assumption=LAW)


def properties(whole: FibreTimed) -> list[Property]:
    """Return the properties of the whole device."""
    return [*of_one_end(whole), *_kept(whole), *_reached(whole)]


def of_one_end(whole: FibreTimed) -> list[Property]:
    """Return what is claimed of sections and time of flight together, of one end."""
    return [*_true_times(whole), *_compared(whole), *_handed(whole), *_differs(whole)]


# ------------------------------------------------------------------ terms


def _of_flight(whole: FibreTimed, name: str) -> Num:
    return whole.composition.of(whole.flight.machine).num(whole.flight.machine.output(name))


def _placed(whole: FibreTimed) -> Bool:
    return whole.composition.of(whole.flight.machine).bool(whole.flight.machine.flag("valid"))


def _is_compared(whole: FibreTimed) -> Bool:
    return whole.composition.of(whole.additional.machine).bool(whole.additional.machine.flag("compared"))


def _reason(whole: FibreTimed) -> Num:
    """Reason for which the end is not located; once F came, the reason of F."""
    return whole.composition.of(whole.sections.machine).num(whole.sections.machine.output("reason"))


def _came_before(whole: FibreTimed) -> Bool:
    """The amplitude came in the cycle before."""
    return earlier_bool(whole.composition.of(whole.additional.machine).bool(whole.additional.own.amplitude_came))


def _signal_edge(whole: FibreTimed) -> Num:
    """The near edge of the map's section in the direction of the run."""
    own, into = whole.sections.own, whole.composition.of(whole.sections.machine)
    return into.num(ite(own.forwards, own.ahead.near, own.behind.near))


# ------------------------------------------------------------------ true times


def _true_times(whole: FibreTimed) -> Iterator[Property]:
    """Claim that F by the time of flight never comes of true times, and how far a compared place is off."""
    own, config = whole.additional.own, whole.config
    into = whole.composition.of(whole.additional.machine)
    most = config.fibre.flight_threshold_mm - config.off_at_a_signal_mm
    yield under_assumption(
        "a true time raises no F",
        _reason(whole).ne(v.FLIGHT_DIFFERS),
        statement="while the laws of light, pattern, cable and sections hold, F never comes for the reason that the time of flight gives another place",
    )
    yield under_assumption(
        "a compared place is near the end",
        _is_compared(whole).implies(
            between(
                -most * NM_PER_MM,
                exact_to(_of_flight(whole, "position_mm"), NM) - into.num(own.truth),
                most * NM_PER_MM,
            )
        ),
        statement="a place by time of flight that is compared is no farther from the end of the train than the threshold, less the "
        "greatest distance of the end from an edge in the cycle of its signal",
    )


# ------------------------------------------------------------------ which place is compared


def _compared(whole: FibreTimed) -> Iterator[Property]:
    """Claim when a place is compared, in both directions, and that a surveyed point nearby is enough."""
    config, limit = whole.config, whole.config.fibre.position_limit_mm
    most = config.fibre.flight_threshold_mm - config.off_at_a_signal_mm
    place, margins = (
        _of_flight(whole, "position_mm"),
        [_of_flight(whole, f"margin_{side}_mm") for side in ("below", "above")],
    )
    narrow, on_line = all_of(margin <= most for margin in margins), between(-limit, place, limit)
    yield for_all_inputs(
        "a place is compared exactly when it can be",
        _is_compared(whole).iff(_placed(whole) & narrow & on_line & _came_before(whole)),
        statement="a place by time of flight is compared in the cycle in which it is reported, if the amplitude came in the cycle before and both margins "
        "fit into the threshold; in no other cycle",
    )
    into, own = whole.composition.of(whole.flight.machine), whole.flight.own
    near = abs_(_of_flight(whole, "distance_mm") - into.num(own.map_distance)) <= config.point_reach_mm
    yield for_all_inputs(
        "a surveyed point nearby is enough",
        all_of([_placed(whole), near, on_line, _came_before(whole)]).implies(_is_compared(whole)),
        statement="with a surveyed point within its reach of the distance Ls, the place by time of flight is compared, wherever on the fibre the end is",
    )
    reason = whole.composition.of(whole.additional.machine).num(whole.additional.machine.output("reason"))
    causes = {
        NO_PLACE: ~_placed(whole), AMPLITUDE_MISSED: ~_came_before(whole), TOO_WIDE: ~narrow, OFF_THE_LINE: ~on_line,
    }  # fmt: skip
    yield for_all_inputs(
        "it is reported why a place is not compared",
        all_of(
            [reason.eq(COMPARED).iff(_is_compared(whole)), *(reason.eq(why).implies(so) for why, so in causes.items())]
        ),
        statement="the reason is one that holds in this cycle",
    )


def _handed(whole: FibreTimed) -> Iterator[Property]:
    """Claim what the sections are compared with: the place of this cycle, and no other one."""
    own, into = whole.sections.own, whole.composition.of(whole.sections.machine)
    machine, of_additional = whole.additional.machine, whole.composition.of(whole.additional.machine)
    given, handed = own.flight_position, of_additional.num(machine.output("compared_mm"))
    place = _of_flight(whole, "position_mm")
    same = into.num(given.value).eq(place) & handed.eq(place)
    yield for_all_inputs(
        "the sections are compared with the place of this cycle",
        into.bool(given.present).iff(_is_compared(whole)) & ite(_is_compared(whole), same, handed.eq(NO_POSITION_MM)),
        statement="the sections are compared with the place that the time of flight reports in this cycle, and with none where it is not compared",
    )
    yield for_all_inputs(
        "a missed amplitude is remembered for a cycle",
        of_additional.bool(whole.additional.own.amplitude_came).iff(
            of_additional.bool(whole.additional.own.amplitude.present)
        ),
        statement="it is known in the next cycle whether the amplitude came in this one",
    )


# ------------------------------------------------------------------ F


def _differs(whole: FibreTimed) -> Iterator[Property]:
    """Claim F by what is reported of the time of flight, at a position signal and between them."""
    own, into, machine = whole.sections.own, whole.composition.of(whole.sections.machine), whole.sections.machine
    threshold, place = whole.config.fibre.flight_threshold_mm, _of_flight(whole, "position_mm")
    located = earlier_bool(into.num(machine.mode).eq(machine.modes[2]))
    calm = located & ~into.bool(own.reference_accepted) & _is_compared(whole)
    error = into.bool(machine.flag("error"))
    signal = into.num(machine.output("section_event")).eq(v.POSITION_SIGNAL)
    yield for_all_inputs(
        "a time off the section raises F",
        (calm & signal & (abs_(place - _signal_edge(whole)) > threshold)).implies(error),
        statement="in the cycle of a position signal F is raised if the place by time of flight is farther from the section than the threshold",
    )
    position, margin = (into.num(machine.output(name)) for name in ("position_mm", "margin_above_mm"))
    valid = into.bool(machine.flag("valid"))
    quiet = into.num(machine.output("section_event")).eq(v.NO_SIGNAL)
    drift = margin - whole.config.fibre.edge_tolerance_mm
    yield for_all_inputs(
        "a located end agrees with its time",
        (calm & quiet & valid).implies(abs_(place - position) <= threshold + drift),
        statement="an end that stays located without a signal is no farther from the place by time of flight than the threshold and the error of its run",
    )


# ------------------------------------------------------------------ kept of the machines


def _kept(whole: FibreTimed) -> Iterator[Property]:
    """Return what the machines claim by themselves; neither knows of the other."""
    parts = (
        (whole.flight.machine, time_of_flight.properties(whole.flight), _OF_THE_FLIGHT),
        (whole.sections.machine, fibre.properties(whole.sections), _OF_THE_SECTIONS),
    )
    for machine, claims, names in parts:
        found = {claim.name: claim for claim in claims}
        for name in names:
            kept = whole.composition.inherited(machine, found[name])
            yield replace(kept, requirements=tuple(dict.fromkeys((*REQUIREMENTS, *kept.requirements))))


def _reached(whole: FibreTimed) -> Iterator[Property]:
    into, machine = whole.composition.of(whole.sections.machine), whole.sections.machine
    signal = into.num(machine.output("section_event")).eq(v.POSITION_SIGNAL) & into.bool(machine.flag("valid"))
    reason = whole.composition.of(whole.additional.machine).num(whole.additional.machine.output("reason"))
    reached = partial(reachable, requirements=REQUIREMENTS)
    yield reached(
        "a section is compared with a time",
        signal & _is_compared(whole),
        statement="a position signal comes with a place by time of flight",
    )
    yield reached(
        "a place is too wide", reason.eq(TOO_WIDE), statement="a place by time of flight can be too wide to be compared"
    )
    yield reached(
        "a place is left out after a missed amplitude",
        reason.eq(AMPLITUDE_MISSED) & earlier_bool(_is_compared(whole)),
        statement="a place is left out in the cycle after one without an amplitude",
    )
