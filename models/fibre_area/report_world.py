"""The world of a train that may part: at any moment it may lose vehicles at its trailing end.

    the count   was true of the train at some moment within the last `count_run_mm` of its run, no matter how long ago
    the train   runs as one body; a pattern is the part of it that still shakes the ground
    lost parts  stay where they are lost, or run on after the train; they run back by `roll_back_mm` at most, or as far as
                the train itself has come back since, which may push them

A standing train may lose vehicles at either end, a running one at its trailing end. As long as the count is that of the
reference, the reference's length bounds the distance between the leading end and that trailing end.
"""

from __future__ import annotations

from safeloc.language.expr import Bool, Num, all_of, between, exact_to, ite, maximum, minimum, with_unit
from safeloc.language.units import NM, NM_PER_MM, UM, UM_PER_MM
from safeloc.language.world import Law, World
from safeloc.models.fibre_area.parting import Parts


def world(own: Parts) -> World:
    """Return the world: the train with all its lost parts."""
    complete = own.next_complete
    low, high = minimum(own.lowest, own.next_body_rear), maximum(own.highest, own.next_body_front)
    return own.declared.world(
        moves={
            own.rear_is_the_trains: own.next_rear_is_the_trains,
            own.front_is_the_trains: own.next_front_is_the_trains,
            own.run_since_complete: own.next_since,
            own.body_rear: own.next_body_rear,
            own.body_front: own.next_body_front,
            own.lowest: ite(complete, own.next_body_rear, low),
            own.highest: ite(complete, own.next_body_front, high),
        },
        clauses=_clauses(own),
    )


def _clauses(own: Parts) -> dict[str, Law]:
    up, down = own.upwards & ~own.downwards, own.downwards & ~own.upwards
    return {
        "a count is that of the train within its last run": _count(own),
        "a complete train fills its pattern": Law(
            own.next_complete.implies(own.next_body_rear.eq(own.pattern_rear) & own.next_body_front.eq(own.pattern_front)),
            "A train that lost nothing lies from end to end of its pattern.",
            source="[D] a definition of the body",
            owner="nobody",
        ),
        "a pattern is part of the train": _part(own),
        "the train is no longer than its reference": _length(own),
        "the reported run was run": _run(own, up, down),
        "the leading high end stays the train's": _stays(own.front_is_the_trains & up & ~own.gone, own.next_front_is_the_trains, "high"),
        "the leading low end stays the train's": _stays(own.rear_is_the_trains & down & ~own.gone, own.next_rear_is_the_trains, "low"),
        "the train's high end is near the pattern's": _read(own, own.next_front_is_the_trains, own.next_front, own.pattern_front, "high"),
        "the train's low end is near the pattern's": _read(own, own.next_rear_is_the_trains, own.next_rear, own.pattern_rear, "low"),
        "lost parts stay behind": _lost(own),
    }  # fmt: skip


def _count(own: Parts) -> Law:
    return Law(
        (own.pattern_is_the_trains & own.count_had_all_axles).implies(own.next_counts),
        "A count with all axles of the reference, of this train's pattern, is that of the whole train at some moment within the last run "
        "over which the detector keeps one count: no matter how long the train stood, or where it turned.",
        ("count_run_mm",),
        "[D] safeloc.sensing.fibre, Counting: two profiles of 300 m and what lies between; [S] FVA-3",
        "supplier",
        "the count is compared at every further axle counter",
    )


def _part(own: Parts) -> Law:
    moved = own.next_body_rear.eq(own.body_rear + own.true_cycle_distance) & own.next_body_front.eq(
        own.body_front + own.true_cycle_distance
    )
    inside = (own.next_body_rear <= own.pattern_rear) & (own.pattern_front <= own.next_body_front)
    return Law(
        (~own.next_complete & own.next_counts).implies(moved & own.pattern_is_the_trains.implies(inside)),
        "A train runs as one body; after it lost vehicles its pattern is what is left of that body.",
        source="[D] vehicles do not stretch; a part that stands does not shake the ground",
        owner="nobody",
    )


def _length(own: Parts) -> Law:
    long = own.next_body_front - own.next_body_rear
    return Law(
        (own.trusted & own.next_counts).implies(long <= exact_to(own.longest, UM)),
        "A train that is verified against a reference is no longer, from end to end and with all its vehicles, "
        "than the greatest length of that reference.",
        source="[D] proved of the axle counter from axle to axle; both overhangs are added by the host",
        owner="infrastructure",
        check="length and distance of both ends, in every cycle; the record of every further axle counter",
    )


def _run(own: Parts, up: Bool, down: Bool) -> Law:
    bounds, step = own.reported_run, exact_to(own.true_cycle_distance, NM)
    off = with_unit(own.run * bounds.rate_ppm, NM)
    short, floor = exact_to(own.run, NM), bounds.floor_mm * NM_PER_MM
    far = (step + floor >= short - off) & (own.true_cycle_distance >= 0)
    near = (step - floor <= short - off) & (own.true_cycle_distance <= 0)
    return Law(
        up.implies(far) & down.implies(near),
        "A pattern that is reported as running towards an end ran that way, and no less than reported, but for "
        "rate and floor.",
        ("rate_ppm", "floor_mm"),
        source="[D] as of the run that the fibre machine reads",
        owner="supplier",
        check="place at every counter that the train passes",
    )


def _stays(leads: Bool, next_is: Bool, end: str) -> Law:
    return Law(
        leads.implies(next_is),
        f"While the train runs towards its {end} end, it loses no vehicle there, and the measured direction of "
        "running is true.",
        source="[D] a coupling parts under traction or brake; what leads is not left behind",
        owner="operator",
        check="train integrity monitoring",
    )


def _read(own: Parts, known: Bool, place: Num, read: Num, end: str) -> Law:
    return Law(
        known.implies(between(read - own.ran, place, read + own.ran)),
        f"In the age of a reading the train's {end} end runs no farther than at the line's highest speed.",
        ("max_speed_mm_s",),
        "[D] line speed",
        "operator",
        "speed supervision",
    )


def _lost(own: Parts) -> Law:
    back = own.config.roll_back_mm * UM_PER_MM + own.ran
    low, high = minimum(own.lowest, own.next_body_rear), maximum(own.highest, own.next_body_front)
    return Law(
        (~own.next_complete & own.next_counts).implies(
            all_of([own.next_rear >= low - back, own.next_front <= high + back])
        ),
        "A part that was lost stays where it was lost or runs on after the train; it runs back no farther than "
        "until its brakes hold, unless the train itself comes back and pushes it.",
        ("roll_back_mm", "max_speed_mm_s"),
        "[M] continuous brake: the pipe parts with the coupling",
        "operator",
        "brake test; no vehicle without brake at the end of a train",
    )
