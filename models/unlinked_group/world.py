"""The world of the unlinked group: how far the front end truly is beyond its balise 1.

    the odometer  delivers a distance that obeys its error law, or one that no vehicle can have run, or nothing
    the antenna   stood over the group whose telegram is read, within its detection accuracy, and time and counter say how
                  long ago

Nothing is said of where the group lies along the line, of a telegram whose check bits are wrong, and of a group that was not
read whole. The true distance counts from the last group that can serve as a reference by what was read of it.
"""

from __future__ import annotations

from safeloc.language.expr import Bool, Expr, Num, Var, all_of, as_num, between, exact_to, ite, maximum
from safeloc.language.units import MM, NM
from safeloc.language.world import Law, World
from safeloc.models.balise.reading_world import (
    Rolling,
    accuracy_sent,
    age_law,
    antenna_law,
    counter_law,
    read_rightly,
)
from safeloc.models.balise.telegram import UNLINKED
from safeloc.models.unlinked_group.variables import LINE_MM, Parts
from safeloc.models.vocabulary.measuring_world import Measuring, Physics
from safeloc.models.vocabulary.vehicle_world import ON_THE_LINE, on_line


def world(own: Parts) -> World:
    """Make the world: the true movement, the odometer's error, and the true distance beyond the last unlinked group."""
    seen = own.world
    moves: dict[Var, Expr] = {
        seen.distance: _distance_after(own),
        seen.wander: _wander_after(own),
        seen.national_accuracy_sent: accuracy_sent(own.national.national_accuracy, seen.national_accuracy_sent),
        **_rolling(own).moves,
        **measuring(own).moves(),
    }
    return own.declared.world(moves, _laws(own))


def _laws(own: Parts) -> dict[str, Bool | Law]:
    return {
        "the odometer obeys its error law": _odometer_law(own),
        ON_THE_LINE: _line_law(own),
        "the antenna stood over the group that is read": antenna_law(
            own.read, own.world.read_beyond, own.config.detection_mm
        ),
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
    }


def _distance_after(own: Parts) -> Num:
    """Return the true distance at the end of the cycle: from the group that is read if it can serve, else from the one before."""
    seen = own.world
    anew = exact_to(as_num(own.config.antenna_mm, MM), NM) + seen.read_beyond + seen.true_since
    return ite(serves(own), anew, seen.distance + seen.true_cycle_distance)


# ------------------------------------------------------------------ the vehicle and its odometer


def measuring(own: Parts) -> Measuring:
    """Return the world's view of the odometer."""
    physics = Physics.of(own.config)
    return Measuring(own.odometer.law, own.odometer.measured, own.world.last_delivered, own.world.silent, physics)


def _wander_after(own: Parts) -> Num:
    return measuring(own).wander_after(own.world.wander, own.world.next_wander)


def _odometer_law(own: Parts) -> Law:
    seen, unit = own.world, measuring(own)
    farthest = unit.physics.farthest_nm
    error = unit.error(seen.true_cycle_distance, seen.wander, seen.next_wander)
    blind = between(-farthest, seen.true_cycle_distance, farthest)
    counts = unit.can_be_run
    return Law(
        (counts & unit.allows(error)) | (~counts & blind),
        "What the odometer measures in a cycle is wrong by no more than its rate and floor allow, and by the change of a one-off "
        "part within half its constant; or it is a distance that no vehicle can have run. The rate is that of the MEASURED "
        "distance. The vehicle runs no faster than its highest speed.",
        ("constant_mm", "rate_ppm", "floor_mm_s", "knee_mm_s", "max_speed_mm_s", "max_acceleration_mm_s2"),
        "[S] SUBSET-041: 5 m + 5 % of every measured distance",
        "supplier",
        "type test; in operation the run between two groups against the map",
    )


def _line_law(own: Parts) -> Law:
    truth = own.world.distance
    return Law(
        on_line(truth, _distance_after(own)),
        f"No vehicle gets farther than {LINE_MM // 10**6} km from a group that it read.",
        source="[D] the length of the line",
        owner="infrastructure",
        check="when the map is made",
    )


def _rolling(own: Parts) -> Rolling:
    seen = own.world
    ran = ite(measuring(own).can_be_run, own.odometer.measured.value, as_num(0, MM))
    return Rolling(seen.rolled, seen.backwards, ran, own.config.reversal_mm)


# ------------------------------------------------------------------ the antenna


def serves(own: Parts) -> Bool:
    """Return whether the group that was read can serve as a reference: unlinked, of several balises, read recently and forwards."""
    read = own.read
    fits = read.total.value >= maximum(read.first.value, read.last.value)
    several = read.total.value > 1
    ordered = read.first.value.ne(read.last.value)
    recent = read.age.value < own.config.telegram_age_limit_ms + 1
    return all_of(
        [read_rightly(own.read), read.link.value.eq(UNLINKED), several, ordered, fits, recent, ~_rolling(own).runs_back]
    )
