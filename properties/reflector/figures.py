"""Figures and words that the claims share: the distance that counts, the interval, where a reflector is seen from."""

from __future__ import annotations

from safeloc.language.expr import Bool, Num, as_num, before, between, exact_to, ite
from safeloc.language.spec import earlier_bool
from safeloc.language.units import MM, NM
from safeloc.models.reflector import ReflectorMachine
from safeloc.models.reflector.echo import Slot
from safeloc.models.reflector.variables import Parts

LAW = (
    "odometer and balise keep their error laws, or a balise lies far away; echoes of reflectors give their range within the "
    "error bound; models are read correctly at the minimum intensity; the map's distances between equal models are right; no "
    "other thing shows a reflector's signature with the minimum intensity"
)
PASSED = ("self-test passed", "self-test passed at the balise")
FAILED = ("self-test failed", "self-test failed at the balise")
SIGHTED = (*PASSED, "reflector found", "reflector tracked", "next reflector takes over")
IN_ZONE = ("PASSING", "COAST", "VIEW")


def was(model: ReflectorMachine, *labels: str) -> Bool:
    """The machine was in one of the named modes before the step."""
    return earlier_bool(model.in_mode(*labels))


def balise_read(own: Parts) -> Bool:
    """A balise was read in this cycle."""
    return own.balise.position.present & own.balise.identity.present


def begun(own: Parts) -> Bool:
    """A balise began a reference measurement in this cycle."""
    return own.procedure.ne(before(own.procedure)) & (own.procedure > 0)


def balise_accuracy(own: Parts) -> Num:
    """The accuracy of the reading, or the national value, mm."""
    told = own.balise.accuracy
    return ite(~told.present, own.config.balise_accuracy_mm, told.value)


def run_since(own: Parts) -> Num:
    """What the reading says was run since the balise was passed, mm."""
    told = own.balise.since
    return ite(~told.present, as_num(0, MM), told.value)


def without_sign(term: Num) -> Num:
    """The magnitude."""
    return ite(term < 0, -term, term)


def counts(own: Parts) -> Bool:
    """A distance was measured, and the highest speed allows it."""
    config = own.config
    most = config.measuring_step_mm - (-config.max_speed_mm_s * config.period_ms // 1_000)
    return (own.odometer.step.value <= most) & (own.odometer.step.value >= -most) & own.odometer.step.present


def ran_mm(own: Parts) -> Num:
    """The distance that counts in this cycle, mm."""
    return ite(~counts(own), as_num(0, MM), own.odometer.step.value)


def rearmost(own: Parts) -> Num:
    """The rear end of the kept interval, nm."""
    return exact_to(own.track.position, NM) - own.track.below


def foremost(own: Parts) -> Num:
    """The front end of the kept interval, nm."""
    return own.track.above + exact_to(own.track.position, NM)


def width(own: Parts) -> Num:
    """The kept interval's width, nm."""
    return own.track.below + own.track.above


def late_mm(own: Parts) -> int:
    """The farthest a vehicle gets in the latency of a frame, in whole mm."""
    config = own.config
    return -(-config.max_speed_mm_s * config.frame_latency_ms // 1_000) + config.measuring_step_mm + 1


def seen_from(own: Parts, position: Num, view_from: Num) -> Num:
    """Where end A stands when a reflector comes into view, nm: the radar stands behind end A by its offset."""
    return exact_to(position, NM) - exact_to(view_from - own.config.radar_offset_mm, NM)


def found_by(own: Parts, position: Num, view_from: Num) -> Num:
    """Where a reflector that is looked for must have been found at the latest, nm."""
    return seen_from(own, position, view_from) + exact_to(as_num(own.config.search_run_mm, MM), NM)


def looked_for(own: Parts) -> Num:
    """Where the reflector stands that was looked for in this cycle, mm; only while it valid and in a view or search zone."""
    return ite(begun(own), own.ahead.position.value, before(own.target.position))


def stands_at(own: Parts, slot: Slot, position: Num) -> Bool:
    """The echo was truly reflected by a reflector that stands at a place of the map, within the survey's accuracy."""
    apart = own.ghosts.origin[slot.number - 1] - exact_to(position, NM)
    return between(-own.config.map_accuracy_mm * 1_000_000, apart, own.config.map_accuracy_mm * 1_000_000)


def strong(own: Parts, slot: Slot) -> Bool:
    """The slot holds an echo of this frame with the minimum intensity."""
    return (slot.intensity >= own.config.minimum_intensity_cdb) & own.frame & slot.range.present
