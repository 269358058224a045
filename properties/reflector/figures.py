"""Terms that the properties share: the usable distance, the interval, the places from which a reflector is in view."""

from __future__ import annotations

from safeloc.language.expr import Bool, Num, as_num, before, between, exact_to, ite, maximum, with_unit
from safeloc.language.spec import earlier_bool
from safeloc.language.units import MM, NM
from safeloc.models.reflector import ReflectorMachine
from safeloc.models.reflector.echo import Slot
from safeloc.models.reflector.variables import Parts

LAW = (
    "odometer and balise keep their error laws, or the balise lies far away; the error of a range is at most the echo's error "
    "bound, plus the radar's scale error, plus a systematic error of any size that drifts no faster than stated; an echo with "
    "the minimum intensity comes from within the strong range, and shows the model of the reflector that truly sent it, or none; "
    "reflectors stand where the map has them; its distances, between equal models and from balise to reflector, are right; no other thing shows a reflector's signature with the "
    "minimum intensity"
)
PASSED = ("self-test passed", "self-test passed at the balise")
FAILED = ("self-test failed", "self-test failed at the balise")
SIGHTED = (*PASSED, "reflector found", "reflector tracked", "next reflector takes over")
IN_ZONE = ("PASSING", "COAST", "VIEW")
READY = ("ODOMETRY", "SEARCH", *IN_ZONE)


def was(model: ReflectorMachine, *labels: str) -> Bool:
    """Return whether the machine was in one of the named modes before the step."""
    return earlier_bool(model.in_mode(*labels))


def balise_read(own: Parts) -> Bool:
    """Return whether the vehicle read a balise in this cycle."""
    return own.balise.position.present & own.balise.identity.present


def begun(own: Parts) -> Bool:
    """Return whether a balise began a self-test in this cycle."""
    return own.procedure_balise.ne(before(own.procedure_balise)) & (own.procedure_balise > 0)


def in_test(model: ReflectorMachine) -> Bool:
    """Return whether an echo of the reference reflector tests the radar in this cycle."""
    return begun(model.own) | was(model, "REFERENCE")


def balise_accuracy(own: Parts) -> Num:
    """Return the accuracy of the reading, or the national value, mm."""
    accuracy = own.balise.accuracy
    return ite(~accuracy.present, own.config.balise_accuracy_mm, accuracy.value)


def run_since(own: Parts) -> Num:
    """Return the distance run since the balise, as the reading gives it, mm."""
    since = own.balise.since
    return ite(~since.present, as_num(0, MM), since.value)


def without_sign(term: Num) -> Num:
    """Return the magnitude."""
    return ite(term < 0, -term, term)


def counts(own: Parts) -> Bool:
    """Return whether a distance was measured that the highest speed allows."""
    config = own.config
    most = config.measuring_step_mm - (-config.max_speed_mm_s * config.period_ms // 1_000)
    return (
        (own.odometer.measured.value <= most) & (own.odometer.measured.value >= -most) & own.odometer.measured.present
    )


def ran_mm(own: Parts) -> Num:
    """Return the usable distance of this cycle, mm; 0 if there is none."""
    return ite(~counts(own), as_num(0, MM), own.odometer.measured.value)


def further_error(own: Parts) -> Num:
    """Return the error that a checking unit reports beyond the odometer's law, nm."""
    return as_num(0, NM) if own.odometer.more is None else own.odometer.more


def law_nm(own: Parts) -> Num:
    """Return the error that the odometer's law allows in this cycle, and the error reported beyond it, nm; mm x ppm = nm."""
    law, config = own.config.odometer, own.config
    far, knee_mm = without_sign(own.odometer.measured.value), law.knee_mm_s * config.period_ms // 1_000
    above = maximum(far - knee_mm, 0) if knee_mm else far
    measured = with_unit(above * law.rate_ppm, NM) + law.floor_mm_s * config.period_ms * 1_000
    blind = as_num(config.max_speed_mm_s * config.period_ms * 1_000, NM)
    return ite(counts(own), measured, blind) + further_error(own)


def ran_late(own: Parts, latency_ms: int) -> tuple[Num, Num]:
    """Return the farthest travel (forwards, backwards) in the last `latency_ms` of the cycle, nm."""
    config, share = own.config, -(-latency_ms * 1_000_000 // own.config.period_ms)
    ran = with_unit(own.odometer.measured.value * share, NM)
    blind = as_num(-(-config.max_speed_mm_s * config.period_ms * share // 1_000), NM)
    return (
        ite(counts(own), ite(ran > 0, ran, as_num(0, NM)) + further_error(own), blind),
        ite(counts(own), ite(ran < 0, -ran, as_num(0, NM)) + further_error(own), blind),
    )


def echo_sides(own: Parts, range_: Num, error: Num) -> tuple[Num, Num]:
    """Return how far end A may be (ahead of, behind) the place that an echo gives, nm, if the radar has no systematic error."""
    config = own.config
    forward, backward = ran_late(own, config.frame_latency_ms)
    share = with_unit(range_ * config.radar_scale_ppm, NM)
    sure = share + exact_to(as_num(config.map_accuracy_mm, MM) + error, NM)
    return forward + sure, backward + sure


def known_place(own: Parts) -> Num:
    """Return the place of end A in a self-test without the radar, mm: by the balise and the distance run since."""
    return ite(begun(own), run_since(own) + own.balise.position.value, ran_mm(own) + before(own.anchor.position))


def reading_sides(own: Parts) -> tuple[Num, Num]:
    """Return how far end A may be (ahead of, behind) the place that a balise reading gives, nm."""
    config = own.config
    base = with_unit(config.odometer.rate_ppm * without_sign(run_since(own)), NM) + exact_to(balise_accuracy(own), NM)
    late, untimed = ran_late(own, config.balise_latency_ms), ran_late(own, config.period_ms)
    dated = own.balise.since.present
    return ite(~dated, untimed[0], late[0]) + base, ite(~dated, untimed[1], late[1]) + base


def known_sides(own: Parts) -> tuple[Num, Num]:
    """Return how far end A may be (ahead of, behind) that place, nm: by the errors of the reading and of the odometer since."""
    (ahead, behind), law = reading_sides(own), law_nm(own)
    return (
        ite(begun(own), ahead, law + before(own.anchor.above)),
        ite(begun(own), behind, law + before(own.anchor.below)),
    )


def rearmost(own: Parts) -> Num:
    """Return the rear end of the stored interval, nm."""
    return exact_to(own.track.position, NM) - own.track.below


def foremost(own: Parts) -> Num:
    """Return the front end of the stored interval, nm."""
    return own.track.above + exact_to(own.track.position, NM)


def width(own: Parts) -> Num:
    """Return the width of the stored interval, nm."""
    return own.track.below + own.track.above


def seen_from(own: Parts, position: Num, view_from: Num) -> Num:
    """Return the place of end A at which a reflector comes into view, nm: the radar stands behind end A by its offset."""
    return exact_to(position, NM) - exact_to(view_from - own.config.radar_offset_mm, NM)


def found_by(own: Parts, position: Num, view_from: Num) -> Num:
    """Return the place of end A at which the search for a reflector ends, nm."""
    return seen_from(own, position, view_from) + exact_to(as_num(own.config.search_run_mm, MM), NM)


def looked_for(own: Parts) -> Num:
    """Return the place of the reflector that was searched in this cycle, mm; only in a search zone, view zone or self-test."""
    return ite(begun(own), own.ahead.position.value, before(own.target.position))


def looked_for_model(own: Parts) -> Num:
    """Return the model of that reflector."""
    return ite(begun(own), own.ahead.model, before(own.target.model))


def stands_at(own: Parts, slot: Slot, position: Num) -> Bool:
    """Return whether the echo's origin is at a place of the map, within the survey's accuracy."""
    apart = own.ghosts.origin[slot.number - 1] - exact_to(position, NM)
    return between(-own.config.map_accuracy_mm * 1_000_000, apart, own.config.map_accuracy_mm * 1_000_000)


def strong(own: Parts, slot: Slot) -> Bool:
    """Return whether the slot holds an echo of this frame with the minimum intensity."""
    return (slot.intensity >= own.config.minimum_intensity_cdb) & own.frame_present & slot.range.present
