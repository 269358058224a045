"""The world of the balise machine: where the front end really is, over which group its antenna stood, and what the map has of it.

    the odometer  delivers a distance that obeys its error law, or one that no vehicle can have run, or nothing
    the antenna   stood over the group whose telegram is read, within its detection accuracy, and time and counter say how
                  long ago
    the map       has a group within its location accuracy of where it lies, or so far off that no interval reaches there:
                  cross-talk, and groups that were moved
    false groups  of those that come with a place of their own, two do not follow each other

Nothing is said of a telegram whose check bits are wrong, of a group that was not read whole, and of one that was passed in the
other orientation than the map has it. What the map announced is read where the machine keeps it; that it is kept as announced
is a claim.
"""

from __future__ import annotations

from safeloc.language.expr import (
    FALSE,
    Bool,
    Expr,
    Num,
    Var,
    all_of,
    any_of,
    as_num,
    between,
    exact_to,
    ite,
    maximum,
    with_unit,
)
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM
from safeloc.language.world import Law, World
from safeloc.models.balise.reading_world import (
    Rolling,
    accuracy_sent,
    age_law,
    antenna_law,
    counted_wrong_nm,
    counter_law,
    read_rightly,
    run_in_age_nm,
)
from safeloc.models.balise.telegram import LINKED, NOMINAL, REVERSE, UNKNOWN
from safeloc.models.balise.variables import BaliseConfig, Parts
from safeloc.models.vocabulary.measuring_world import (
    THOUSAND,
    Measuring,
    Physics,
    further_error,
    possible_at_speed,
    wander_after,
)
from safeloc.models.vocabulary.vehicle_world import ON_THE_LINE, on_line

ODOMETER = "the odometer obeys its error law"
"""The clause that an earlier machine can be made to keep, if it judges the distance."""
KEPT = "the groups that the map announced are read where the machine keeps them; a claim shows that it keeps them as announced"


def world(own: Parts) -> World:
    """Make the world: the true movement, the odometer's error, and the true place of the group that is read."""
    seen = own.world
    moves: dict[Var, Expr] = {
        seen.truth: after(own),
        seen.wander: _wander_after(own),
        seen.national_accuracy_sent: national(own),
        seen.doubted_group: _doubted(own),
        **_rolling(own).moves,
    }
    if not own.config.checked_distance:
        moves |= measuring(own).moves()
    return own.declared.world(moves, _laws(own), KEPT)


def _laws(own: Parts) -> dict[str, Bool | Law]:
    return {
        ODOMETER: _odometer_law(own),
        ON_THE_LINE: _line_law(own),
        "the antenna stood over the group that is read": _antenna_law(own),
        "the counter measures the run since the reading": counter_law(
            own.read, own.world.true_since, _wander_after(own) - own.world.reading_wander, own.config.odometer.rate_ppm
        ),
        "the age bounds the run since the reading": age_law(
            own.read,
            own.world.true_since,
            own.world.true_cycle_distance,
            period_ms=own.config.period_ms,
            max_speed_mm_s=own.config.max_speed_mm_s,
            measuring_step_mm=own.config.measuring_step_mm,
        ),
        "the map has an announced group, or is far off": _announced_law(own),
        "a group's own place is right, or far off": _own_place_law(own),
        "groups that are far off do not follow each other": _rare_law(own),
    }


def after(own: Parts) -> Num:
    """Return the place of the front end at the end of the cycle, nm."""
    return own.world.truth + own.world.true_cycle_distance


# ------------------------------------------------------------------ the vehicle and its odometer


def physics(config: BaliseConfig) -> Physics:
    """Return the limits of the vehicle's movement, and of its measurement."""
    return Physics.of(config)


def measuring(own: Parts) -> Measuring:
    """Return the world's view of the odometer, where the machine reads it directly."""
    return Measuring(
        own.odometer.law, own.odometer.measured, own.world.last_delivered, own.world.silent, physics(own.config)
    )


def can_be_run(own: Parts) -> Bool:
    """Return whether a distance was delivered that a vehicle can have run; of one that another machine checked, only the
    size counts.
    """
    if not own.config.checked_distance:
        return measuring(own).can_be_run
    return possible_at_speed(own.odometer.measured, physics(own.config).farthest_mm)


def _wander_after(own: Parts) -> Num:
    return wander_after(can_be_run(own), own.world.wander, own.world.next_wander, checked=own.config.checked_distance)


def _odometer_law(own: Parts) -> Law:
    seen, counts, config = own.world, can_be_run(own), own.config
    counted = ite(counts, exact_to(own.odometer.measured.value, NM), as_num(0, NM))
    error = seen.true_cycle_distance - counted - (_wander_after(own) - seen.wander)
    blind = as_num(physics(config).farthest_nm * THOUSAND, NM)
    most = ite(counts, _lawful_thousandths(own), blind) + further_error(own.odometer.more) * THOUSAND
    return Law(
        (error * THOUSAND <= most) & (-error * THOUSAND <= most),
        "What the odometer measures in a cycle is wrong by no more than its rate and floor allow, by the change of a one-off "
        "part within half its constant, and by what a checking unit tells beyond that; or it is a distance that no vehicle can "
        "have run. The rate is that of the MEASURED distance. The vehicle runs no faster than its highest speed.",
        ("constant_mm", "rate_ppm", "floor_mm_s", "knee_mm_s", "max_speed_mm_s", "max_acceleration_mm_s2"),
        "[S] SUBSET-041: 5 m + 5 % of every measured distance",
        "supplier",
        "type test; in operation the run between two groups against the map",
    )


def _lawful_thousandths(own: Parts) -> Num:
    """Return the error law's bound for a cycle, thousandths of a nm: the floor, and the rate times the distance above the knee."""
    law, period = own.config.odometer, own.config.period_ms
    measured, knee = own.odometer.measured.value * THOUSAND, law.knee_mm_s * period
    above = maximum(maximum(measured - knee, -measured - knee), 0)
    return with_unit(above * law.rate_ppm, NM) + law.floor_mm_s * period * THOUSAND**2


def _line_law(own: Parts) -> Law:
    truth = own.world.truth
    return Law(
        on_line(truth, after(own)),
        "The coordinates of the map do not end before the vehicle does.",
        ("position_limit_mm", "tolerance_mm"),
        "[D] 1 000 km of line",
        "infrastructure",
        "when the map is made",
    )


def _rolling(own: Parts) -> Rolling:
    seen = own.world
    ran = ite(can_be_run(own), own.odometer.measured.value, as_num(0, MM))
    return Rolling(seen.rolled, seen.backwards, ran, own.config.reversal_mm)


# ------------------------------------------------------------------ the antenna


def _against(own: Parts, mapped: Num) -> Bool:
    """Return whether the group was passed in the other orientation than the map gives."""
    first, last = own.read.first.value, own.read.last.value
    return ((last > first) & mapped.eq(REVERSE)) | ((first > last) & mapped.eq(NOMINAL))


def _antenna_law(own: Parts) -> Law:
    seen, config = own.world, own.config
    off = after(own) - seen.true_since - config.antenna_mm * NM_PER_MM - seen.read_place
    return antenna_law(own.read, off, config.detection_mm)


# ------------------------------------------------------------------ the map


def national(own: Parts) -> Num:
    """Return the location accuracy in force if linking gives none, mm."""
    return accuracy_sent(own.national.national_accuracy, own.world.national_accuracy_sent)


def _far_nm(own: Parts, accuracy: Num) -> Num:
    """Return the least distance of a misplaced group from its place on the map: beyond every interval and every reading, nm."""
    config = own.config
    fixed = 2 * config.tolerance_mm + 2 * config.detection_mm + config.odometer.constant_mm
    cycle = physics(config).farthest_mm * NM_PER_MM + config.odometer.floor_mm_s * config.period_ms * THOUSAND
    timed = run_in_age_nm(own.read, own.config.max_speed_mm_s) + config.measuring_step_mm * NM_PER_MM
    since = ite(own.read.since.present, counted_wrong_nm(own.read, own.config.odometer.rate_ppm), timed)
    return exact_to(accuracy + fixed, NM) + (since + further_error(own.odometer.more) + cycle) * 2


def _off(own: Parts, place: Num) -> Num:
    """By how much the group lies beyond where the map has it, nm."""
    return own.world.read_place - exact_to(place, NM)


def _near_or_far(own: Parts, place: Num, accuracy: Num) -> Bool:
    off, near = _off(own, place), exact_to(accuracy, NM)
    return between(-near, off, near) | _is_far(own, place, accuracy)


def _is_far(own: Parts, place: Num, accuracy: Num) -> Bool:
    off, far = _off(own, place), _far_nm(own, accuracy)
    return (off > far) | (off < 0 - far)


def _announced_law(own: Parts) -> Law:
    kept = []
    for slot in own.linking.slots:
        accuracy = ite(~slot.accurate, national(own), slot.accuracy)
        named = slot.group.ne(0) & own.read.group.value.eq(slot.group) & ~_against(own, slot.orientation)
        kept.append((read_rightly(own.read) & named).implies(_near_or_far(own, slot.place, accuracy)))
    return Law(
        all_of(kept),
        "A group that the map announced lies within its location accuracy of where the map has it: that of linking, else the "
        "national one, else the default. Or what is read is not that group (cross-talk), or it was moved: then the antenna "
        "stood farther away than both margins, all accuracies and all that is run since the reading together.",
        ("default_accuracy_mm", "tolerance_mm", "detection_mm"),
        "[M] Q_NVLOCACC 12 m; SUBSET-026 3.6.4.2.3; the distance of false groups [D] from the tolerance",
        "infrastructure",
        "survey; every group refused is reported with its reason",
    )


def _placed(own: Parts) -> Bool:
    """Return whether a complete group was read that came with a place, and not in the wrong orientation."""
    orientation = own.read.orientation
    mapped = ite(~orientation.present, UNKNOWN, orientation.value)
    return all_of([read_rightly(own.read), own.read.place.present, ~_against(own, mapped)])


def _far_off(own: Parts) -> Bool:
    """Return whether the group is far from the place that came with it."""
    return _placed(own) & _is_far(own, own.read.place.value, national(own))


def _own_place_law(own: Parts) -> Law:
    return Law(
        _placed(own).implies(_near_or_far(own, own.read.place.value, national(own))),
        "A group lies within the national location accuracy of its place: that of its telegram, or that of the map. Or it lies "
        "as far off as the law of announced groups says of a false one.",
        ("default_accuracy_mm", "tolerance_mm", "detection_mm"),
        "[M] Q_NVLOCACC 12 m; the distance of false groups [D] from the tolerance",
        "infrastructure",
        "survey; every group refused is reported with its reason",
    )


def _rare_law(own: Parts) -> Law:
    false = _far_off(own)
    if own.config.trust_first_group:
        term, statement = (
            ~false,
            "No group lies far from its place: the first group is trusted (trust_first_group).",
        )
    else:
        term = (~own.world.doubted_group.eq(0)).implies(~false)
        statement = (
            "After a group that lies far from its place, no second such group is read until a group of another identity is "
            "read that lies at its place and that a vehicle without a position can accept as its first."
        )
    return Law(
        term, statement, ("trust_first_group",), "[D] cross-talk is rare; the candidate rule withstands one at a time",
        "infrastructure", "every candidate that is not confirmed is reported",
    )  # fmt: skip


def _doubted(own: Parts) -> Num:
    """The identity of the false group, until another one serves; 0: none."""
    group, was = own.read.group.value, own.world.doubted_group
    clears = _serves(own) & group.ne(was)
    return ite(_far_off(own), group, ite(clears, as_num(0, COUNT), was))


def _serves(own: Parts) -> Bool:
    """A vehicle without a position can take the group that was read for its first."""
    read, config = own.read, own.config
    several = any_of([read.link.value.eq(LINKED), read.total.value > 1])
    numbered = all_of(
        [
            read.total.value >= maximum(read.first.value, read.last.value),
            read.first.value.ne(read.last.value).iff(read.read.value > 1),
        ]
    )
    recent = read.age.value < config.telegram_age_limit_ms + 1
    return all_of([_placed(own), several, numbered, recent, ~_rolling(own).runs_back, _fine_enough(own)])


def _fine_enough(own: Parts) -> Bool:
    """The reading puts the front end on the line, no less accurately than the tolerance."""
    config, read = own.config, own.read
    since = ite(read.since.present, read.since.value, as_num(0, MM))
    slack = ite(
        read.since.present,
        counted_wrong_nm(own.read, own.config.odometer.rate_ppm),
        run_in_age_nm(own.read, own.config.max_speed_mm_s) + config.measuring_step_mm * NM_PER_MM,
    )
    known = exact_to(national(own) + (config.detection_mm + config.odometer.constant_mm + 1), NM)
    front = read.place.value + since + config.antenna_mm
    on_line = between(-config.position_limit_mm, front, config.position_limit_mm)
    return (known + slack <= config.tolerance_mm * NM_PER_MM) & on_line


def is_doubted(own: Parts, group: Num) -> Bool:
    """Return whether the group is the one that was false."""
    return FALSE if own.config.trust_first_group else own.world.doubted_group.ne(0) & own.world.doubted_group.eq(group)
