"""Compositions that a tired engineer might make: right machines, wired wrongly. Each is refused by a claim of the whole.

That a wrong interval does not hold the truth is refused by contracts, in the tests of each composition. The wrong ones here hold it:
another output of the same kind, a source that is not heard, a gate or a reason between two machines left out.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cache
from typing import Any

import pytest

from safeloc.assurance.mutation.members import Composed, composed
from safeloc.assurance.mutation.places import noted
from safeloc.assurance.mutation.rewired import rewired
from safeloc.catalogue import load_target
from safeloc.language.expr import (
    FALSE,
    TRUE,
    Bool,
    Expr,
    Lit,
    Num,
    NumVar,
    Optional,
    Var,
    between,
    ite,
    maximum,
    minimum,
)
from safeloc.models.area.slot import ENTERS_HIGH, ENTERS_LOW
from safeloc.models.marker_device.configuration import MarkerDeviceConfig
from safeloc.models.verification.variables import AXLE_COUNTER, NEIGHBOUR, NOBODY
from safeloc.models.vocabulary.absent import wired_interval
from safeloc.models.vocabulary.reasons import NO_REFERENCE, SENSOR_FAILURE, TOLERANCE
from tests.models.inductive import inductive_in

Wires = Mapping[Var, Expr]
Wrong = Callable[["Wired"], Wires]


class Wired:
    """A composition with its right wires, by names: "machine.input" and "machine.output"."""

    def __init__(self, whole: Composed) -> None:
        self._machines = {one.name: one for one in whole.plan.machines}
        self._right = whole.plan.wires

    def to(self, name: str) -> Var:
        """The wired input."""
        machine, _, var = name.partition(".")
        return next(one for one in self.inputs(machine) if one.name == var)

    def inputs(self, machine: str) -> Iterator[Var]:
        """All inputs of a machine, and the free choices of its world."""
        for one in self._machines[machine].inputs:
            yield from (one.value, one.present) if isinstance(one, Optional) else (one,)
        yield from self._machines[machine].world.choices

    def right(self, name: str) -> Expr:
        """The right term on the wire to an input."""
        return self._right[self.to(name)]

    def of(self, name: str) -> Any:
        """An output."""
        machine, _, output = name.partition(".")
        return self._machines[machine].outputs[output]

    def of_input(self, name: str) -> Optional:
        """An optional input, as the machine itself has it."""
        machine, _, value = name.partition(".")
        return next(
            one for one in self._machines[machine].inputs if isinstance(one, Optional) and one.value.name == value
        )

    def interval(self, machine: str) -> tuple[Num, Num, Num]:
        """Position, margin below, margin above."""
        return wired_interval(self._machines[machine])


def cut(name: str) -> Wrong:
    """The wires on which one input always hears false, or 0."""

    def wrong(of: Wired) -> Wires:
        return {of.to(name): _zero(of, name) if isinstance(of.to(name), NumVar) else FALSE}

    wrong.__name__ = f"{name} cut"
    return wrong


# ------------------------------------------------------------------ the restrictive state behind a source


def _wider_side_for_both(of: Wired) -> Wires:
    """The host gets the wider margin on both sides: no longer the source's interval, but one that holds the truth."""
    _, below, above = of.interval("odometry")
    sides = ("source_margin_below_mm", "source_margin_above_mm")
    return {of.to(f"delocalized.{side}"): maximum(below, above) for side in sides}


def _no_reason(of: Wired) -> Wires:
    return {of.to("delocalized.source_reason"): TOLERANCE}


# ------------------------------------------------------------------ marker device


def _guards_interval_for_the_host(of: Wired) -> Wires:
    """In a cycle with a fix the host gets the guard's interval at end A, which no odometer and no marker has judged."""
    config = MarkerDeviceConfig()
    (place, low, high), given = of.interval("guard"), of.interval("odometry")
    slack, most = config.antenna_tolerance_mm, config.odometry.tolerance_mm
    passed = of.of("guard.passed") & of.of("guard.valid") & of.of("odometry.valid")
    line = config.odometry.position_limit_mm
    passed = passed & (low + slack <= most) & (high + slack <= most) & between(-line, place + config.antenna_mm, line)
    named = ("source_position_mm", "source_margin_below_mm", "source_margin_above_mm")
    theirs = (place + config.antenna_mm, low + slack, high + slack)
    return {
        of.to(f"delocalized.{name}"): ite(passed, one, other)
        for name, one, other in zip(named, theirs, given, strict=True)
    }


def _passed_without_an_interval(of: Wired) -> Wires:
    """The gate `valid` is left out."""
    (place, _, _), passed = of.interval("guard"), of.of("guard.passed")
    config, name = MarkerDeviceConfig(), "odometry.satellite_position_mm"
    return {of.to(f"{name}.present"): passed, of.to(name): ite(passed, place + config.antenna_mm, 0)}


# ------------------------------------------------------------------ the reflector device, reflectors and route


def _wider_of_the_reflectors(of: Wired) -> Wires:
    """The host gets the reflector machine's wider margin on both sides, which holds the truth as well."""
    _, below, above = of.interval("reflector")
    sides = ("source_margin_below_mm", "source_margin_above_mm")
    return {of.to(f"delocalized.{side}"): maximum(below, above) for side in sides}


def _direction_unheard(of: Wired) -> Wires:
    """Route and groups are heard, but not in cycles in which the direction contradicts."""
    name = "reflector.route_contradicted"
    return {of.to(name): _flag(of.right(name)) & ~of.of("travel_direction.contradicts")}


def _read_is_accepted(of: Wired) -> Wires:
    """A balise counts for the direction while the balise machine reports a position, whatever it makes of the telegram."""
    return {of.to("travel_direction.balise_read"): of.of("balise.valid")}


def _precise_reference(of: Wired) -> Wires:
    """A measured reflector brings a position back although nobody has recognised which one it is."""
    name = "delocalized.reference_accepted"
    return {of.to(name): _flag(of.right(name)) | of.of("reflector.valid") & of.of("reflector.precise")}


def _told_is_carried(of: Wired) -> Wires:
    """The host has a position only while one branch is told: every open switch costs it."""
    name = "delocalized.source_valid"
    return {of.to(name): _flag(of.right(name)) & of.of("route.valid")}


def _turns_only_where_watched(of: Wired) -> Wires:
    """A turn counts only while the image is watched, when none is decided yet."""
    name = "route.course_taken"
    return {of.to(name): ite(of.of("turn_off.watching"), _number(of.right(name)), _zero(of, name))}


def _first_candidate_only(of: Wired) -> Wires:
    return {of.to(f"route.route_{one}_candidate"): FALSE for one in (2, 3, 4)}


# ------------------------------------------------------------------ fibre area


def _one_end_located(of: Wired) -> Wires:
    return {of.to("verification.fibre_located"): of.of("front.valid")}


def _trusted_without_a_report(of: Wired) -> Wires:
    return {of.to("area.train_1_trusted"): of.of("verification.trusted")}


def _never_tested(of: Wired) -> Wires:
    return {of.to("verification.chain_tested"): of.of("emitter.failed")}


def _failed_until_tested(of: Wired) -> Wires:
    """A chain that waits for its first pattern is taken for a failed one."""
    return {of.to("verification.chain_failed"): ~of.of("emitter.chain_tested")}


def _only_narrow_places(of: Wired) -> Wires:
    """The front's place only while its margin is narrower than anybody asks for."""
    present = of.to("verification.fibre_position_mm.present")
    (place, below, _), narrow = of.interval("front"), _flag(of.right("verification.fibre_position_mm.present"))
    narrow = narrow & (below <= 1_000)
    return {present: narrow, of.to("verification.fibre_position_mm"): ite(narrow, place, 0)}


def _wider_place(of: Wired) -> Wires:
    """A margin that is no longer the front machine's, but one that holds the front."""
    (_, below, above), present = of.interval("front"), _flag(of.right("verification.fibre_position_mm.present"))
    return {of.to("verification.fibre_margin_below_mm"): ite(present, maximum(below, above) + 1, 0)}


def _nobody_sends(of: Wired) -> Wires:
    """Every record comes from nobody: each is taken for a lost one."""
    return {of.to("verification.reference_from"): NOBODY}


def _counter_taken_for_neighbour(machine: str) -> Wrong:
    """The train is not compared with its counter's place and speed when it comes in."""

    def counter_taken_for_neighbour(of: Wired) -> Wires:
        source = of.right(f"{machine}.reference_from")
        assert isinstance(source, Num)
        return {of.to(f"{machine}.reference_from"): ite(source.eq(AXLE_COUNTER), NEIGHBOUR, source)}

    return counter_taken_for_neighbour


def _neighbour_taken_for_counter(of: Wired) -> Wires:
    source = of.right("verification.reference_from")
    assert isinstance(source, Num)
    return {of.to("verification.reference_from"): ite(source.eq(NEIGHBOUR), AXLE_COUNTER, source)}


def _trusted_with_a_count_only(of: Wired) -> Wires:
    return {of.to("report.train_trusted"): of.right("report.count_matches_now")}


def _runs_nowhere(of: Wired) -> Wires:
    return {of.to("report.runs_upwards"): of.right("report.runs_downwards")}


def _only_whole_trains(of: Wired) -> Wires:
    """A report of one believed end never reaches the area."""
    both = _flag(of.right("area.train_1_trusted")) & _flag(of.right("area.train_1_integer"))
    return {of.to("area.train_1_trusted"): both}


def _entry_at_the_other_end(of: Wired) -> Wires:
    """The area's law then speaks of a train at the other end, and every proof holds of that train."""
    event = of.right("area.train_1_event")
    assert isinstance(event, Num)
    other = ite(event.eq(ENTERS_LOW), ENTERS_HIGH, ite(event.eq(ENTERS_HIGH), ENTERS_LOW, event))
    return {of.to("area.train_1_event"): other}


def _counted_without_an_order(of: Wired) -> Wires:
    """Axles are taken for this train's although nobody knows which train was the outermost."""
    return {of.to("entry.counters_count"): of.of("axle_section.healthy")}


def _ways_exchanged(of: Wired) -> Wires:
    """Axles that come in are taken for axles that leave."""
    into, out = "entry.axles_in_high", "entry.axles_out_high"
    return {of.to(into): of.right(out), of.to(out): of.right(into)}


def _gone_in_part(of: Wired) -> Wires:
    """A train that left a part behind is taken out of the order."""
    return {of.to("train_order.leaves_high"): _input(of, "entry.leaves_high")}


def _input(of: Wired, name: str) -> Expr:
    var = of.to(name)
    assert isinstance(var, Expr)
    return var


def _any_pattern(of: Wired) -> Wires:
    """Any pattern in the area is taken for the train's."""
    return {of.to("verification.associated"): _patterns(of) > 0}


def _patterns(of: Wired) -> NumVar:
    var = of.to("train_order.patterns")
    assert isinstance(var, NumVar)
    return var


def _ends_exchanged(of: Wired) -> Wires:
    """The order of trains is that seen in a mirror: another train's pattern is taken for this one's."""
    low, high = "train_order.enters_low", "train_order.enters_high"
    return {of.to(low): of.right(high), of.to(high): of.right(low)}


def _heads_exchanged(of: Wired) -> Wires:
    """The entry takes the axles of one end for those of the other, counted and true: then its laws speak of no real run."""
    names = [
        f"entry.{true}axles_{way}_{end}" for true in ("", "true_") for way in ("in", "out") for end in ("low", "high")
    ]
    other = {"low": "high", "high": "low"}
    return {of.to(name): of.right(f"{name.rpartition('_')[0]}_{other[name.rpartition('_')[2]]}") for name in names}


def _axles_alone(of: Wired) -> Wires:
    """A train whose first wheel stands on a head is in no claim of the area."""
    axles = of.right("entry.axle_between")
    return {of.to("area.axle_between"): axles}


def _earlier_record_kept(of: Wired) -> Wires:
    """A train that comes in is verified against the record of the one before."""
    return {of.to("verification.train_leaves"): of.of("entry.left")}


def assumed(name: str) -> Wrong:
    """The wire on which a ghost always is true: what was to be proved is assumed."""

    def wrong(of: Wired) -> Wires:
        return {of.to(name): TRUE}

    wrong.__name__ = f"{name} assumed"
    return wrong


def _always_undisturbed(of: Wired) -> Wires:
    return {of.to("area.counters_healthy"): TRUE}


def _refuted_as_lost(of: Wired) -> Wires:
    """A refuted permission is told as the lack of a reference."""
    reason, refuted = _number(of.right("delocalized.source_reason")), _flag(of.of("turn_off.contradicts"))
    return {of.to("delocalized.source_reason"): ite(refuted, NO_REFERENCE, reason)}


def _any_reason_on_a_branch(of: Wired) -> Wires:
    """While a route is carried, the reason is always that sensors failed."""
    reason, carried = _number(of.right("delocalized.source_reason")), _flag(of.of("route.valid"))
    return {of.to("delocalized.source_reason"): ite(carried, SENSOR_FAILURE, reason)}


def _gone_only_if_reported(of: Wired) -> Wires:
    """A train that is gone since the counters are clear stays in the order."""
    gone = _flag(of.right("train_order.leaves_low"))
    return {of.to("train_order.leaves_low"): gone & _flag(of.to("entry.leaves_low"))}


# ------------------------------------------------------------------ handover


def _no_shared_stretch(of: Wired) -> Wires:
    return {of.to("speaker.shared_from_mm"): of.right("speaker.shared_to_mm")}


def _wider_of_both(of: Wired) -> Wires:
    """The taking area's interval, and that of the giving one with it."""
    low, high = (_number(of.right(f"speaker.taking_{end}_mm")) for end in ("low", "high"))
    other_low, other_high = (_number(of.right(f"speaker.giving_{end}_mm")) for end in ("low", "high"))
    return {
        of.to("speaker.taking_low_mm"): minimum(low, other_low),
        of.to("speaker.taking_high_mm"): maximum(high, other_high),
    }


# ------------------------------------------------------------------ localizer


def _satellites_unheard(of: Wired) -> Wires:
    """Satellites count only with an accepted fix: while they coast they contradict nobody."""
    return {of.to("arbitration.satellite_valid"): _flag(of.right("arbitration.satellite_reference"))}


def _reason_of_another(of: Wired) -> Wires:
    return {of.to("arbitration.odometry_reason"): of.right("arbitration.balise_reason")}


def _reference_of_another(of: Wired) -> Wires:
    return {of.to("arbitration.balise_reference"): _flag(of.right("arbitration.odometry_reference"))}


def _any_echo_a_reference(of: Wired) -> Wires:
    """A measured reflector brings a position back although nobody has recognised which one it is."""
    return {of.to("arbitration.reflector_reference"): of.of("reflector.valid") & of.of("reflector.precise")}


def _revocation_not_sent(of: Wired) -> Wires:
    """Only trust is sent on board, so a revoked position is used there until it is too old."""
    return {of.to("downlink.sent"): of.of("verification.trusted")}


def _one_unit_only(of: Wired) -> Wires:
    return {
        of.to("odometry.front_radar_mm.present"): FALSE,
        of.to("odometry.front_radar_mm"): _zero(of, "odometry.front_radar_mm"),
    }


def _no_distance(of: Wired) -> Wires:
    return {
        of.to("arbitration.distance_mm.present"): FALSE,
        of.to("arbitration.distance_mm"): _zero(of, "arbitration.distance_mm"),
    }


def _no_reference_for_satellites(of: Wired) -> Wires:
    names = ("reference_mm.present", "reference_mm", "reference_accuracy_mm")
    return {
        of.to(f"position.{name}"): FALSE if name.endswith("present") else _zero(of, f"position.{name}")
        for name in names
    }


def _wider_for_the_trackside(of: Wired) -> Wires:
    _, below, above = of.interval("delocalized")
    return {of.to(f"uplink.sent_margin_{side}_mm"): maximum(below, above) for side in ("below", "above")}


def _arbitration_for_the_trackside(of: Wired) -> Wires:
    return {of.to("uplink.sent_valid"): of.of("arbitration.valid")}


# ------------------------------------------------------------------ localizer and sections


def _wider_for_the_ends(of: Wired) -> Wires:
    _, below, above = of.interval("delocalized")
    return {of.to(f"ends.front_margin_{side}_mm"): maximum(below, above) for side in ("below", "above")}


def _trackside_of_whole_trains(of: Wired) -> Wires:
    """A report of the front end alone never reaches the area."""
    return {of.to("area.train_1_trusted"): of.of("trackside.integer")}


def _flag(term: Expr) -> Bool:
    assert isinstance(term, Bool)
    return term


def _number(term: Expr) -> Num:
    assert isinstance(term, Num)
    return term


def _zero(of: Wired, name: str) -> Lit:
    var = of.to(name)
    assert isinstance(var, NumVar)
    return Lit(0, var.unit)


# ------------------------------------------------------------------ reflectors that groups anchor, in a localizer


def _raw_telegram_anchors(of: Wired) -> Wires:
    """Whatever the antenna read is a reading, with the balise machine's interval."""
    read = of.of_input("balise.telegram_group")
    return {of.to("reflector.balise.present"): read.present, of.to("reflector.balise"): read.value}


def _narrower_side_anchors(of: Wired) -> Wires:
    _, below, above = of.interval("balise")
    counts = of.of("balise.reference_accepted")
    return {of.to("reflector.balise_accuracy_mm"): ite(counts, minimum(below, above), 0)}


def _map_counts_from_the_group(of: Wired) -> Wires:
    """The map's distance as it stands, although it counts from the group."""
    given, told = of.right("reflector.next_reference_mm.present"), of.of_input("line.next_reference_mm")
    assert isinstance(given, Bool)
    return {of.to("reflector.next_reference_mm"): ite(given, told.value, 0)}


def _telegram_counts_from_the_group(of: Wired) -> Wires:
    given, told = of.right("reflector.balise_reference_mm.present"), of.of_input("balise.telegram_reflector_mm")
    assert isinstance(given, Bool)
    return {of.to("reflector.balise_reference_mm"): ite(given, told.value, 0)}


def _every_loss_contradicts(of: Wired) -> Wires:
    """Each cycle in which the balise machine has no position withdraws what the reflector machine goes on with."""
    return {of.to("reflector.route_contradicted"): ~of.of("balise.valid")}


# ------------------------------------------------------------------ an area with all its sensors


def _heads_of_one_end(of: Wired) -> Wires:
    """The section counts out at the high end what the low head counts in."""
    return {of.to("axle_section.axles_out_high"): of.right("axle_section.axles_in_low")}


def _one_head_at_fault(of: Wired) -> Wires:
    return {of.to("axle_section.head_fault"): of.right("entry.record_sound")}


def _passes_one_way(of: Wired) -> Wires:
    """Whatever passes the low head comes in."""
    return {of.to("axle_section.true_axles_out_low"): _zero(of, "axle_section.true_axles_out_low")}


def _counters_exchanged(of: Wired) -> Wires:
    """The place of the counter at the other end."""
    return {of.to("reference.high_end_mm"): of.right("reference.low_end_mm")}


def _run_for_length(of: Wired) -> Wires:
    """The run since the first axle as the length: a length beyond the train, which holds it too."""
    run = of.right("reference.low_run_high_um")
    return {of.to("reference.low_length_high_um"): run}


def _amplitude_always_there(of: Wired) -> Wires:
    return {of.to("front.amplitude_cdb.present"): TRUE}


def _enters_at_the_other_end(of: Wired) -> Wires:
    sides = {"low": "high", "high": "low"}
    return {of.to(f"entry.enters_{side}"): of.right(f"entry.enters_{other}") for side, other in sides.items()}


def _rear_timed_for_front(of: Wired) -> Wires:
    """The front's sections are compared with the place to which the rear's light runs."""
    names = ("front.flight_position_mm", "front.flight_position_mm.present")
    return {of.to(name): of.right(name.replace("front", "rear")) for name in names}


_COUNTERS_RECORD = "the counter's record of the train is its reference"
_THE_LOW_RECORD = "the record of the low end is no wider than the counter's"
_ENDS = "a train is untrusted only for what is said of it"
_LACKS = "a train is withheld only for what is missing"
_ALL_OUT = "a train of which all axles went out has left"
_INTERVAL, _REASON = "the host gets its source's interval", "the host is told its source's reason"
_CONTRADICTS = "direction, route and groups contradict, and nothing else"
_ANCHORED = "groups that contradict withdraw what they anchored"
_REFERENCES = "arbitration hears each reference and each reason"
WRONG: tuple[tuple[str, Wrong, str], ...] = (
    ("supervised_odometry", _wider_side_for_both, _INTERVAL),
    ("supervised_odometry", _no_reason, _REASON),
    ("marker_device", _wider_side_for_both, _INTERVAL),
    ("marker_device", _no_reason, _REASON),
    ("marker_device", _guards_interval_for_the_host, _INTERVAL),
    ("marker_device", cut("guard.advance"), "time passes for the guard in every cycle"),
    ("reflector_device", _wider_of_the_reflectors, "the host gets the reflector machine's interval"),
    ("reflector_device", _direction_unheard, "a contradicted direction withdraws the position"),
    ("reflector_device", cut("reflector.route_contradicted"), _CONTRADICTS),
    ("reflector_device", _read_is_accepted, "the direction counts accepted groups"),
    ("reflector_device", cut("travel_direction.balise_read"), "the direction counts accepted groups"),
    ("reflector_device", cut("travel_direction.backwards"), "a vehicle turns only where it is measured to"),
    (
        "reflector_device",
        cut("travel_direction.passed_model"),
        "a reflector is passed where its distance is run",
    ),
    ("reflector_device", cut("travel_direction.ahead_model"), "the direction hears the nearest reflector ahead"),
    ("reflector_device", cut("met.run_mm"), "a reflector that is near is carried on by the odometer"),
    ("reflector_device", cut("met.turned"), "without a reflector near nothing comes next"),
    ("reflector_device", _precise_reference, "only a reference in the permitted direction ends a loss"),
    ("reflector_device", cut("reflector.route_contradicted"), "a lost route withdraws the position"),
    ("reflector_device", _told_is_carried, "the host gets every position that is reported"),
    ("reflector_device", _turns_only_where_watched, "the route hears the course at a switch"),
    ("reflector_device", _first_candidate_only, "the map's routes are candidates"),
    ("reflector_device", _any_reason_on_a_branch, "the host is told the reflector machine's reason on a branch"),
    ("reflector_device", _refuted_as_lost, "the host is told that course or route are not the permitted ones"),
    ("fibre_area", cut("verification.chain_failed"), "a chain that failed is latched"),
    ("fibre_area", _never_tested, _LACKS),
    ("fibre_area", _failed_until_tested, _ENDS),
    ("fibre_area", _only_narrow_places, _LACKS),
    ("fibre_area", _wider_place, "the reported position is the front's"),
    ("fibre_area", _trusted_with_a_count_only, "a believed end is reported"),
    ("fibre_area", _nobody_sends, _ENDS),
    ("fibre_area", _counter_taken_for_neighbour("verification"), "at the counter speed and place are compared"),
    ("fibre_area", _neighbour_taken_for_counter, "a neighbour's record is compared with no counter"),
    ("fibre_area", cut("report.count_matches_now"), "a train of which all axles are counted is reported whole"),
    ("fibre_area", _runs_nowhere, "a measured run counts for the end that leads"),
    ("fibre_area", _only_whole_trains, "every report reaches the area"),
    ("fibre_area", cut("area.train_1_integer"), "a whole train is confirmed"),
    ("fibre_area", _entry_at_the_other_end, "the area hears of a train at the end where it is counted"),
    ("fibre_area", cut("entry.counters_clear"), "clear counters let the train go"),
    ("fibre_area", cut("entry.counters_count"), _ALL_OUT),
    ("fibre_area", cut("entry.outermost_low"), _ALL_OUT),
    ("fibre_area", cut("entry.axles_out_low"), "a train that leaves a part behind has not left"),
    ("fibre_area", _ways_exchanged, "a train that leaves a part behind has not left"),
    ("fibre_area", _counted_without_an_order, "a train of which axles were not counted is not counted out"),
    ("fibre_area", cut("train_order.counter_fault"), "disturbed counters leave the area unswept"),
    ("fibre_area", cut("train_order.counters_clear"), "clear counters make the order known"),
    ("fibre_area", cut("train_order.enters_low"), "a train that comes in is in the order"),
    ("fibre_area", cut("train_order.leaves_high"), "a train that has left is in the order no more"),
    ("fibre_area", _gone_in_part, "a train that left a part behind stays in the order"),
    ("fibre_area", _any_pattern, "another number of patterns withholds"),
    ("fibre_area", cut("verification.associated"), _LACKS),
    ("fibre_area", _always_undisturbed, "disturbed counters leave the area unswept"),
    ("fibre_area", cut("area.counters_healthy"), "clear counters sweep the area"),
    ("fibre_area", cut("area.counters_clear"), "clear counters sweep the area"),
    ("fibre_area", _ends_exchanged, "the order hears each train at its end"),
    ("fibre_area", _earlier_record_kept, "a train that comes in is verified against no earlier record"),
    ("fibre_area", assumed("area.train_1_next_all_out"), "a train is all out when none of its axles is inside"),
    (
        "fibre_area",
        assumed("report.count_had_all_axles"),
        "all axles are counted of a train that had as many as its reference",
    ),
    ("fibre_area", assumed("report.pattern_is_the_trains"), "the train's pattern is one that holds it"),
    ("fibre_area", cut("entry.axle_between"), "the entry's axle between is an axle between the counters"),
    ("fibre_area", _gone_only_if_reported, "the order hears that clear counters let the train go"),
    ("fibre_area", cut("verification.record_axles"), "the record that is verified is the one that tells the axles"),
    ("fibre_area", cut("verification.record_sound"), "the record that is verified is the one that tells the axles"),
    ("fibre_area", _heads_exchanged, "the entry hears the axles of each head"),
    ("fibre_area", _axles_alone, "a train that is counted is there for the area"),
    ("fibre_area", assumed("area.axle_between"), "nothing but axles or a count keeps a train there"),
    ("fibre_area", cut("entry.counters_occupied"), "disturbed counters leave the area unswept"),
    ("fibre_area", cut("area.axle_between"), "axles between the counters keep the train there"),
    (
        "counted_entry",
        _counter_taken_for_neighbour("verification_doubted"),
        "at the counter place and speed are compared",
    ),
    ("counted_entry", cut("verification_doubted.record_sound"), "an undisturbed record is handed over"),
    ("counted_entry", cut("verification_doubted.record_length_low_mm"), "the record is no wider than the counter's"),
    ("fibre_device", _heads_of_one_end, "the section counts the axles of the counters' heads"),
    ("fibre_device", cut("axle_section.axles_in_high"), "the section counts the axles of the counters' heads"),
    ("fibre_device", _one_head_at_fault, "a head at fault or damped is one of the section"),
    ("fibre_device", cut("axle_section.head_damped"), "a head at fault or damped is one of the section"),
    ("fibre_device", _passes_one_way, "the axles that pass a head pass it for both"),
    ("fibre_device", cut("reference.low_record_ready"), _COUNTERS_RECORD),
    ("fibre_device", cut("reference.high_direction"), _COUNTERS_RECORD),
    ("fibre_device", cut("reference.low_outermost"), _COUNTERS_RECORD),
    ("fibre_device", cut("entry.reference_comes"), _COUNTERS_RECORD),
    ("fibre_device", cut("entry.enters_low"), _COUNTERS_RECORD),
    ("fibre_device", cut("reference.low_record_sound"), "a counter's record is sound without a flaw only"),
    ("fibre_device", assumed("entry.record_sound"), "a counter's record is sound without a flaw only"),
    ("fibre_device", cut("entry.record_axles"), "the axles that passed at the low end are compared"),
    ("fibre_device", cut("reference.high_axles"), "the axles that passed at the high end are compared"),
    ("fibre_device", cut("verification.record_length_low_mm"), _THE_LOW_RECORD),
    ("fibre_device", _run_for_length, _THE_LOW_RECORD),
    ("fibre_device", _counters_exchanged, "the place of who passed at the high end is compared"),
    ("fibre_device", cut("reference.high_run_low_um"), "the place of who passed at the high end is compared"),
    ("fibre_device", cut("verification.record_speed_high_mm_s"), "the speed of who passed at the low end is compared"),
    ("fibre_device", cut("verification.record_age_cycles"), "the neighbour's record is read as it was sent"),
    (
        "fibre_device",
        cut("front.flight_position_mm.present"),
        "front: the sections are compared with the place of this cycle",
    ),
    ("fibre_device", _rear_timed_for_front, "front: the sections are compared with the place of this cycle"),
    ("fibre_device", _amplitude_always_there, "front: sections and comparison hear one amplitude"),
    ("fibre_device", cut("rear.amplitude_cdb"), "rear: sections and comparison hear one amplitude"),
    ("fibre_device", _enters_at_the_other_end, "the entry hears who comes in at each end"),
    ("fibre_device", cut("front_course.place_nm"), "front: the light runs to the end that the sections follow"),
    ("fibre_device", cut("rear.true_run_nm"), "rear: the light runs to the end that the sections follow"),
    ("fibre_device", cut("rear_additional.margin_above_mm"), "rear: a place is compared exactly when it can be"),
    ("fibre_timed", cut("fibre.flight_position_mm.present"), "the sections are compared with the place of this cycle"),
    ("fibre_timed", cut("fibre.flight_position_mm"), "the sections are compared with the place of this cycle"),
    ("fibre_timed", cut("additional.margin_above_mm"), "a place is compared exactly when it can be"),
    ("fibre_timed", cut("additional.place_mm.present"), "a place is compared exactly when it can be"),
    ("fibre_handover", cut("border.giving_distrusts"), "distrust on the way loses the handover"),
    ("fibre_handover", cut("taking.record_axles"), "the record that arrives is the giving area's"),
    ("fibre_handover", cut("taking.reference_from"), "the record that arrives is the giving area's"),
    ("fibre_handover", cut("speaker.taking_trusts"), "each area that may report is heard"),
    ("fibre_handover", cut("speaker.downwards"), "each area that may report is heard"),
    ("fibre_handover", cut("border.front_low_mm"), "a record goes over from the shared stretch on"),
    ("fibre_handover", _no_shared_stretch, "each area that may report is heard"),
    ("fibre_handover", _wider_of_both, "what is reported is what the areas have in common"),
    ("localizer", _satellites_unheard, "arbitration hears what each source states"),
    ("localizer", _reason_of_another, _REFERENCES),
    ("localizer", _reference_of_another, _REFERENCES),
    ("localizer", _any_echo_a_reference, _REFERENCES),
    ("localizer", _revocation_not_sent, "each verdict of the trackside is sent on board"),
    ("localizer", cut("downlink.sent_valid"), "each verdict of the trackside is sent on board"),
    ("localizer", _one_unit_only, "every machine runs on by the vehicle's distance"),
    ("localizer", _no_distance, "every machine runs on by the vehicle's distance"),
    ("localizer", cut("position.usable_3"), "the position hears which satellites are usable"),
    ("localizer", _no_reference_for_satellites, "satellites hear every reference"),
    ("localizer", _wider_for_the_trackside, "the trackside is sent what the host gets"),
    ("localizer", cut("reflector.route_contradicted"), _ANCHORED),
    ("localizer", _every_loss_contradicts, _ANCHORED),
    ("localizer", _raw_telegram_anchors, "a rejected telegram is no reading"),
    ("localizer", _narrower_side_anchors, "an accepted group is handed over"),
    ("localizer", cut("reflector.balise.present"), "an accepted group is handed over"),
    ("localizer", cut("reflector.next_position_mm.present"), "the map's next reflector is searched"),
    ("localizer", _map_counts_from_the_group, "the map's distance is used"),
    ("localizer", _telegram_counts_from_the_group, "the telegram's reflector distance is used"),
    ("localizer", cut("reflector.balise_search_from_mm.present"), "the telegram's search distance is used"),
    ("localizer_sections", _wider_for_the_ends, "both ends are sent together"),
    ("localizer_sections", cut("far_uplink.sent_valid"), "both ends are sent together"),
    ("localizer_sections", cut("trackside.far_valid"), "the trackside hears both links"),
    ("localizer_sections", cut("area.train_1_integer"), "the area hears the trackside"),
    ("localizer_sections", _trackside_of_whole_trains, "the area hears the trackside"),
)
"""A composition, its wrong wires, and the claim that refuses them."""
HARMLESS: tuple[tuple[str, Wrong, str, str], ...] = (
    ("marker_device", _passed_without_an_interval, "positions of the antenna count for end A",
     "the guard passes a fix on only with an interval"),
    ("fibre_area", _one_end_located, _LACKS, "the front's place is there only if both ends are located"),
    ("fibre_area", _trusted_without_a_report, "every report reaches the area", "without a report there is nothing to trust"),
    ("localizer", _arbitration_for_the_trackside, "the trackside is sent what the host gets",
     "arbitration and restrictive state have one tolerance, so the vehicle is restrictive exactly while arbitration reports nothing"),
)  # fmt: skip
"""A composition, other wires, the claim that they might break, and the reason why they do not."""


@cache
def composition(name: str) -> Composed:
    """The composition as it ships, which can be made again with other wires."""
    with noted() as places:
        target = load_target(name)
    return composed(target, places)


def holds(name: str, wires: Wires, claim: str) -> bool:
    """Whether a claim is inductive with the lemmas."""
    whole = composition(name)
    made = rewired(whole, {**whole.plan.wires, **wires})
    [prop] = [one for one in made.claims if one.name == claim]
    return inductive_in(made.system, prop, claim)


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize(
    ("name", "wrong", "claim"), WRONG, ids=[f"{name} {wrong.__name__.strip('_')}" for name, wrong, _ in WRONG]
)
def test_a_wrong_composition_is_refused(name: str, wrong: Wrong, claim: str) -> None:
    """By the claim that is named."""
    assert not holds(name, wrong(Wired(composition(name))), claim)


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(("name", "claim"), sorted({(name, claim) for name, _, claim in WRONG}))
def test_the_right_composition_keeps_it(name: str, claim: str) -> None:
    """So that a refusal is due to the wire."""
    assert holds(name, {}, claim)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("name", "other", "claim", "reason"), HARMLESS, ids=[one[1].__name__.strip("_") for one in HARMLESS]
)
def test_harmless_wires_are_not_refused(name: str, other: Wrong, claim: str, reason: str) -> None:
    """Otherwise the claim would refuse whatever is written differently."""
    assert holds(name, other(Wired(composition(name))), claim), reason
