"""The world of the reflector machine: the true places of end A and of each echo's origin, and the laws of sensors and map.

    odometer      delivers a distance that obeys its error law, or one that no vehicle can have run, or nothing
    balise        lies at the place that the reading gives; a stray reading comes from a balise far away
    reflector     sends an echo that shows its model, and that has the minimum intensity only within the strong range; the
                  error of its range is the echo's own and the radar's
    radar         adds two errors to every range: a systematic one of any size, which drifts, and one in proportion to the range
    other things  send any echo but one with a reflector's signature at the minimum intensity
    map           has each reflector with its model at its place, its distance to the next one of its model, and to its balise

An echo is what it comes from: a ghost for each slot is the true model of the reflector that sent it, or NONE for any other thing.
What the echo shows is an input, and a law of its own ties the one to the other.

The map gives one reflector in a cycle, and the machine may still search one that the map gave before. The world therefore
remembers two entries of the map: the last one, and the one that the machine still names as its target.
"""

from __future__ import annotations

from collections.abc import Iterable

from safeloc.language.expr import (
    FALSE,
    TRUE,
    Bool,
    Expr,
    Num,
    NumVar,
    Var,
    all_of,
    as_num,
    between,
    exact_to,
    ite,
    maximum,
    with_unit,
)
from safeloc.language.units import MM, MS_PER_S, NM, NM_PER_MM, NM_PER_UM, PPM_PER_ONE
from safeloc.language.world import Law, World
from safeloc.models.reflector.echo import Slot
from safeloc.models.reflector.ghosts import Entry
from safeloc.models.reflector.variables import Parts, ReflectorConfig
from safeloc.models.vocabulary.error_law import ErrorLaw
from safeloc.models.vocabulary.measuring_world import further_error, possible_at_speed, wander_after
from safeloc.models.vocabulary.reflectors import NO_MODEL
from safeloc.models.vocabulary.vehicle_world import ON_THE_LINE, on_line

ODOMETER = "the odometer obeys its error law"
"""The clause that an earlier machine can guarantee if it checks the distance."""
READING = "a balise reading is true, or that of a balise far away"
PRESCRIBED = "the prescribed distance is that of the map"
"""Clauses that the balise machine can guarantee if it gives the readings."""
FAR_STEPS = 16
"""Distance at the highest speed, in cycles: more than all errors that a cycle adds on either side."""


def world(own: Parts, lost: Bool) -> World:
    """Return the world. `lost`: the machine knows no position."""
    seen = own.ghosts
    return own.declared.world(
        moves={
            seen.truth: _after(own),
            seen.wander: _wander_after(own),
            seen.bias: seen.next_bias,
            **_taken(own.ahead.position.present, seen.announced, _next_announced(own)),
            **_taken(named(own, seen.announced), seen.sought, seen.announced),
        },
        clauses=_laws(own, lost),
        reads_machine="the reflector that the machine names as its target, and that it is lost: it reports both",
    )


def named(own: Parts, entry: Entry) -> Bool:
    """Return whether the machine names this entry of the map as its target."""
    target = own.target
    return target.position.eq(entry.position) & target.model.eq(entry.model) & target.clear.eq(entry.clear)


def _next_announced(own: Parts) -> Entry:
    """Return the map's entry of this cycle; only while there is one."""
    return Entry(own.ahead.position.value, own.ahead.model, own.ahead.clear)


def _taken(condition: Bool, entry: Entry, other: Entry) -> dict[Var, Expr]:
    pairs = zip(entry.figures, other.figures, strict=True)
    return {kept: ite(condition, new, kept) for kept, new in pairs if isinstance(kept, NumVar)}


def _laws(own: Parts, lost: Bool) -> dict[str, Bool | Law]:
    return {
        ODOMETER: _odometer_law(own),
        ON_THE_LINE: Law(
            on_line(own.ghosts.truth, _after(own)), "The coordinates of the map do not end before the vehicle does.", ("position_limit_mm",), "[D]",
            "infrastructure", "when the map is made",
        ),
        READING: _balise_law(own, lost),
        "an echo of a reflector has its range": _range_law(own),
        "the radar's systematic error drifts slowly": _drift_law(own),
        "the radar's scale is within its figure": _scale_law(own),
        "no strong echo comes from beyond the strong range": _reach_law(own),
        PRESCRIBED: _prescribed_law(own),
        "a reflector stands where the map has it": _survey_law(own),
        "reflectors of one model are far apart on the map": _clearance_law(own),
        "a recognised reflector shows its own model": _recognition_law(own),
        "other things show no reflector's signature": _clutter_law(own),
    }  # fmt: skip


def _after(own: Parts) -> Num:
    """Return the place of end A at the end of the cycle, nm."""
    return own.ghosts.truth + own.ghosts.true_cycle_distance


# ------------------------------------------------------------------ odometer


def farthest_mm(config: ReflectorConfig) -> int:
    """Return the greatest distance that is measured in a cycle at the highest speed, in whole mm."""
    return -(-config.max_speed_mm_s * config.period_ms // MS_PER_S) + config.measuring_step_mm


def can_be_run(own: Parts) -> Bool:
    """Return whether the odometer delivered a distance that a vehicle can have run."""
    return possible_at_speed(own.odometer.measured, farthest_mm(own.config))


def _wander_after(own: Parts) -> Num:
    seen = own.ghosts
    return wander_after(can_be_run(own), seen.wander, seen.next_wander, checked=own.config.checked_distance)


def _run_blind_nm(config: ReflectorConfig) -> int:
    """Return the farthest that the vehicle gets in a cycle, nm."""
    return config.max_speed_mm_s * config.period_ms * (NM_PER_MM // MS_PER_S)


def _odometer_law(own: Parts) -> Law:
    seen, config = own.ghosts, own.config
    counted = ite(can_be_run(own), exact_to(own.odometer.measured.value, NM), as_num(0, NM))
    error = seen.true_cycle_distance - (_wander_after(own) - seen.wander) - counted
    lawful = _allowed(config.odometer, own.odometer.measured.value, config.period_ms)
    most = further_error(own.odometer.more) + ite(can_be_run(own), lawful, as_num(_run_blind_nm(config), NM))
    return Law(
        (error <= most) & (-error <= most),
        "The error of a distance that the odometer measures in a cycle is at most what its rate and floor allow, plus the "
        "change of a one-off part within half its constant, plus the error that a checking unit reports beyond that; or no "
        "vehicle can have run the distance.",
        ("constant_mm", "rate_ppm", "floor_mm_s", "knee_mm_s", "max_speed_mm_s"),
        "[S] SUBSET-041: 5 m + 5 % of every measured distance",
        "supplier",
        "type test; in operation the run between two balises against the map",
    )


def _allowed(law: ErrorLaw, step: Num, period_ms: int) -> Num:
    """Return the error that rate and floor allow in a cycle, nm: the rate counts above the knee only. mm x ppm = nm."""
    knee = law.knee_mm_s * period_ms // MS_PER_S
    above = maximum(maximum(step - knee, -step - knee), 0)
    return with_unit(above * law.rate_ppm, NM) + law.floor_mm_s * period_ms * (NM_PER_MM // MS_PER_S)


def _ran_late(own: Parts, latency_ms: int) -> tuple[Num, Num]:
    """Return the most that the vehicle ran (forwards, backwards) in the last `latency_ms` of the cycle, nm."""
    config, step = own.config, own.odometer.measured.value
    share = -(-latency_ms * PPM_PER_ONE // config.period_ms)
    blind = as_num(-(-_run_blind_nm(config) * share // PPM_PER_ONE), NM)

    def most(measured: Num) -> Num:
        ran = with_unit(maximum(measured * share, 0), NM) + further_error(own.odometer.more)
        return ite(can_be_run(own), ran, blind)

    return most(step), most(-step)


# ------------------------------------------------------------------ balise


def _balise_law(own: Parts, lost: Bool) -> Law:
    config = own.config
    off, allowed, forward, backward = _balise_off(own)
    true = (off <= allowed + forward) & (-off <= allowed + backward)
    away = allowed + forward + backward + _far_nm(config)
    stray = ~lost & ((off > away) | (-off > away))
    return Law(
        _balise_read(own).implies(true | stray),
        "End A passed the place that a reading gives, within the reading's accuracy. Since then it ran the distance that the "
        "counters give, within the odometer's rate, and in the reader's latency no more than that share of the measured "
        "distance. Or the reading is stray: its balise lies farther away than any position error; but the first reading "
        "after a position was lost is never stray.",
        ("balise_accuracy_mm", "balise_latency_ms", "rate_ppm", "tolerance_mm"),
        "[S] OCORA 7242, SUBSET-026 3.16.2 (linking keeps stray readings out); steady speed in a cycle [D]",
        "infrastructure",
        "the balise machine's linking; commissioning of every balise",
    )


def _balise_read(own: Parts) -> Bool:
    return own.balise.identity.present & own.balise.position.present


def _balise_off(own: Parts) -> tuple[Num, Num, Num, Num]:
    """Return the error of a reading, the error allowed by accuracy and run, and the late travel forwards and backwards; nm."""
    balise, config = own.balise, own.config
    since = ite(~balise.since.present, as_num(0, MM), balise.since.value)
    off = _after(own) - exact_to(balise.position.value, NM) - exact_to(since, NM)
    accuracy = exact_to(ite(~balise.accuracy.present, config.balise_accuracy_mm, balise.accuracy.value), NM)
    allowed = accuracy + with_unit(maximum(since, -since) * config.odometer.rate_ppm, NM)
    latched, untimed = _ran_late(own, config.balise_latency_ms), _ran_late(own, config.period_ms)
    forward, backward = (ite(balise.since.present, late, all_) for late, all_ in zip(latched, untimed, strict=True))
    return off, allowed, forward, backward


def _far_nm(config: ReflectorConfig) -> int:
    """Return a distance farther than any stored interval can reach, nm."""
    law = config.odometer
    kept = 2 * (config.tolerance_mm + law.constant_mm) + FAR_STEPS * farthest_mm(config)
    return (kept + 2 * law.floor_mm_s * config.period_ms) * NM_PER_MM


# ------------------------------------------------------------------ echoes


def _strong(own: Parts, slot: Slot) -> Bool:
    """Return whether the slot has an echo with the minimum intensity."""
    return own.frame_present & slot.range.present & (slot.intensity >= own.config.minimum_intensity_cdb)


def _range_law(own: Parts) -> Law:
    forward, backward = _ran_late(own, own.config.frame_latency_ms)

    def kept(slot: Slot, real: Bool, origin: Num, scaled: Num) -> Bool:
        """Return whether the range fits: end A ran on since the frame was taken, and the radar's error is in the range."""
        wrong = own.ghosts.next_bias + scaled
        too_near = origin - _radar(own) - exact_to(slot.range.value, NM) + wrong
        bound = exact_to(slot.error, NM)
        return (real & own.frame_present & slot.range.present).implies(
            between(-bound - forward, too_near, bound + backward)
        )

    return Law(
        all_of(kept(*one, scaled) for one, scaled in zip(_echoes(own), own.ghosts.scaled, strict=True)),
        "When the frame was taken, the range of a reflector's echo was the distance from radar to reflector plus the radar's "
        "error, within the echo's error bound. The frame is no older than its latency, and since then the vehicle ran no more "
        "than that share of the measured distance.",
        ("radar_offset_mm", "frame_latency_ms"),
        own.config.ranging.noise,
        "supplier",
        "type test of the noise; constant error along a view zone",
    )


def _radar(own: Parts) -> Num:
    """Return the radar's place at the end of the cycle, nm: behind end A by its offset."""
    return _after(own) - own.config.radar_offset_mm * NM_PER_MM


def _drift_law(own: Parts) -> Law:
    config, seen = own.config, own.ghosts
    most = config.radar_drift_mm_s * config.period_ms * NM_PER_UM
    return Law(
        between(-most, seen.next_bias - seen.bias, most),
        "The systematic error of the radar has any size at first; from one cycle to the next it changes by no more than the "
        "drift allows.",
        ("radar_drift_mm_s",),
        config.ranging.drift,
        "supplier",
        "type test in the climatic chamber; self-test at every balise",
    )


def _scale_law(own: Parts) -> Law:
    most = own.config.radar_scale_ppm
    return Law(
        all_of(
            slot.range.present.implies(
                between(-with_unit(slot.range.value * most, NM), scaled, with_unit(slot.range.value * most, NM))
            )
            for slot, scaled in zip(own.slots, own.ghosts.scaled, strict=True)
        ),
        "The error in proportion to a range is at most what the radar's scale allows.",
        ("radar_scale_ppm",),
        own.config.ranging.scale,
        "supplier",
        "type test of the clock; a monitor of the chirp's frequency",
    )


def _reach_law(own: Parts) -> Law:
    forward, backward = _ran_late(own, own.config.frame_latency_ms)
    most = own.config.strong_range_mm * NM_PER_MM

    def kept(slot: Slot, real: Bool, origin: Num) -> Bool:
        away = origin - _radar(own)
        return (real & _strong(own, slot)).implies(between(-forward, away, as_num(most, NM) + backward))

    return Law(
        all_of(kept(*one) for one in _echoes(own)),
        "The radar looks ahead: when the frame was taken, a reflector whose echo has the minimum intensity stood ahead of the "
        "radar, and no farther away than the strong range.",
        ("strong_range_mm", "minimum_intensity_cdb"),
        own.config.ranging.reach,
        "supplier",
        "type test with the largest reflector",
    )


def _prescribed_law(own: Parts) -> Law:
    """Return the law of a true reading; a stray one comes from another balise."""
    balise, ahead, system = own.balise, own.ahead, own.config.reference_distance_mm
    telegram, by_map = balise.reference, ahead.reference
    by_hand = ~telegram.present & ~by_map.present if system else FALSE
    away, survey = ahead.position.value - balise.position.value, own.config.map_accuracy_mm

    def agrees(place: Num) -> Bool:
        return between(-survey, place - away, survey)

    agreeing = all_of([
        telegram.present.implies(agrees(telegram.value)),
        by_map.present.implies(agrees(by_map.value)),
        by_hand.implies(agrees(as_num(system, MM))),
    ])  # fmt: skip
    off, allowed, forward, backward = _balise_off(own)
    true = (off <= allowed + forward) & (-off <= allowed + backward)
    return Law(
        (_balise_read(own) & ahead.position.present & true).implies(agreeing),
        "The distance from a balise to its reflector that the telegram, the map or the system prescribes is the distance of "
        "their places on the map, within the survey's accuracy.",
        ("map_accuracy_mm", "reference_distance_mm"),
        "[D] one survey for telegram and map",
        "infrastructure",
        "audit of the line's map: distance from balise to reflector; commissioning of every balise",
    )


def _echoes(own: Parts) -> list[tuple[Slot, Bool, Num]]:
    """Return, of each slot, whether its echo comes from a reflector, and the place of its origin, nm."""
    return list(zip(own.slots, own.ghosts.reflector, own.ghosts.origin, strict=True))


def _survey_law(own: Parts) -> Law:
    accuracy, seen = own.config.map_accuracy_mm * NM_PER_MM, own.ghosts
    places = zip(seen.reflector, seen.origin, seen.on_map, strict=True)
    return Law(
        all_of(
            real.implies(between(-accuracy, origin - exact_to(place, NM), accuracy)) for real, origin, place in places
        ),
        "Every reflector stands where the map has it, within the map's accuracy.",
        ("map_accuracy_mm",),
        "[M] surveying of one place against another",
        "infrastructure",
        "survey when the reflector is set up, and after work on the track",
    )


def _clearance_law(own: Parts) -> Law:
    seen = own.ghosts
    entries = ((TRUE, seen.announced), (TRUE, seen.sought), (own.ahead.position.present, _next_announced(own)))
    sent = list(zip(own.slots, seen.kind, seen.on_map, strict=True))
    return Law(
        all_of(known.implies(_itself_or_clear(own, entry, *one)) for known, entry in entries for one in sent),
        "A reflector that sends an echo with the minimum intensity and has the model of a map entry is that entry's own, or the map has "
        "it at least the entry's clearance away.",
        ("minimum_intensity_cdb",),
        "[D] counted on the map, over all tracks that the radar sees; every reflector is on it, with its model",
        "infrastructure",
        "audit of the line's map: neighbours told apart, reflectors across tracks",
    )


def _itself_or_clear(own: Parts, entry: Entry, slot: Slot, kind: Num, place: Num) -> Bool:
    alike = _strong(own, slot) & kind.eq(entry.model) & kind.ne(NO_MODEL)
    apart = place - entry.position
    return alike.implies(apart.eq(0) | (apart >= entry.clear) | (-apart >= entry.clear))


def _recognition_law(own: Parts) -> Law:
    return Law(
        all_of(
            (_strong(own, slot) & real).implies(slot.model.eq(kind) | slot.model.eq(NO_MODEL))
            for slot, real, kind in zip(own.slots, own.ghosts.reflector, own.ghosts.kind, strict=True)
        ),
        "An echo of a reflector with the minimum intensity shows that reflector's model, or none that is known.",
        ("minimum_intensity_cdb",),
        "[M] signatures told apart, source l. 161, 237 and 304",
        "supplier",
        "type test of every model against every other, at the least intensity and at all angles of view",
    )


def _clutter_law(own: Parts) -> Law:
    unlike: Iterable[Bool] = (
        (_strong(own, slot) & ~real).implies(slot.model.eq(NO_MODEL)) for slot, real, _ in _echoes(own)
    )
    return Law(
        all_of(unlike),
        "A thing beside the track that is no reflector never shows a reflector's signature with the minimum intensity.",
        ("minimum_intensity_cdb",),
        "[M] signatures told apart, source l. 209, 227 and 304",
        "supplier",
        "type test; echoes of no reflector of the map are counted in operation",
    )
