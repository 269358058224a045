"""What must hold of the balise machine, in the words of the requirements (RFL-5, RFL-9, RFL-D4)."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.expr import Bool, Num, abs_, all_of, any_of, as_num, between, exact_to, ite, maximum, minimum, with_unit
from safeloc.models.balise import Balise
from safeloc.models.balise_parts import variables as v
from safeloc.models.balise_parts.interval import Interval
from safeloc.models.balise_parts.linking import NO_REACTION, REPLACE, SERVICE_BRAKE, TRAIN_TRIP, WITHDRAW, Record
from safeloc.models.balise_parts.telegram import FAILED, NOMINAL, REVERSE
from safeloc.models.odometry_parts.distance_device import ADMITTED
from safeloc.models.odometry_parts.variables import LOCATED
from safeloc.spec import Property, always, earlier_bool, earlier_num, within
from safeloc.units import MM, NM

LAW = (
    "admitted distances obey the odometer's law; an announced group that is read whole, undamaged, recent, in the announced "
    "orientation and inside its window lies where the map has it within its accuracies; top speed"
)


def properties(model: Balise) -> list[Property]:
    """Every property of the balise machine."""
    makers = (_safety, _references, _resets, _rejection, _windows, _reactions, _sensors)
    return [prop for maker in makers for prop in maker(model)]


def _safety(model: Balise) -> Iterator[Property]:
    machine, own = model.machine, model.own
    valid, tolerance = machine.flag("valid"), own.config.tolerance_mm
    position, over, under = (exact_to(machine.output(f"{name}_mm"), NM) for name in ("position", "over", "under"))
    yield always(
        "containment",
        valid.implies(between(position - under, own.world.truth, position + over)),
        statement="the reported interval holds the true position of the front end",
        trace=("RFL-5", "RFL-D4"),
        assumption=LAW,
    )
    yield always(
        "tolerance",
        (machine.output("over_mm") <= tolerance) & (machine.output("under_mm") <= tolerance),
        statement="a reported interval is never wider than the tolerable error, on either side",
        trace=("RFL-D4",),
        unconditional=True,
    )
    silent = [machine.output(f"{name}_mm").eq(0) for name in ("position", "over", "under", "reflector", "search")]
    nothing = [
        *silent,
        ~machine.flag("reflector_known"),
        ~machine.flag("wants_linking"),
        machine.output("expected").eq(0),
    ]
    yield always(
        "no report when invalid",
        (~valid).implies(all_of(nothing)),
        statement="nothing is reported, and no group expected, without a valid position",
        trace=("RFL-D4", "RFL-9"),
        unconditional=True,
    )
    yield always(
        "reason stated",
        own.memory.reason.eq(LOCATED).iff(valid),
        statement="a reason is stated exactly while nothing is reported",
        trace=("RFL-D4",),
        unconditional=True,
    )


# ------------------------------------------------------------------ references


def _references(model: Balise) -> Iterator[Property]:
    machine, own = model.machine, model.own
    valid, config = machine.flag("valid"), own.config
    confirmed = "first group is trusted" if config.trust_first_group else "group confirms the candidate"
    yield always(
        "no resurrection",
        (valid & ~earlier_bool(valid)).implies(machine.fired(confirmed) & machine.flag("reference_accepted")),
        statement="a position is reported again only through a group that passed every check",
        trace=("RFL-5", "RFL-D4"),
        unconditional=True,
    )
    accepted = own.memory.verdict.eq(v.ACCEPTED)
    yield always(
        "only whole and undamaged groups count",
        own.memory.verdict.one_of(v.ACCEPTED, v.CANDIDATE).implies(_whole(model)),
        statement="a group counts only if every balise of it was read, with right check bits, no longer ago than permitted, "
        "while running forwards",
        trace=("RFL-D4",),
        unconditional=True,
    )
    if not config.free_references:
        yield always(
            "only announced groups reset",
            (accepted & earlier_bool(valid)).implies(any_of(_entitled(model, slot) for slot in own.linking.slots)),
            statement="a located vehicle takes a position only from a group that was announced, in the announced "
            "orientation, and inside its window: the max safe front end has reached the first place where it can be "
            "read, and the min safe front end had not passed the last one",
            trace=("RFL-D4",),
            unconditional=True,
        )
    yield always(
        "accuracy by precedence",
        (accepted & valid).implies(own.memory.accuracy.eq(_accuracy_by_precedence(model))),
        statement="an accepted group is charged with the location accuracy of linking, else the national one, else the default",
        trace=("RFL-D4",),
        unconditional=True,
    )
    yield always(
        "direction by orientation",
        (own.memory.direction.eq(v.ALONG) & earlier_num(own.memory.direction).ne(v.ALONG)).implies(
            own.memory.verdict.one_of(v.ACCEPTED, v.CANDIDATE)
            & (own.read.total.value.ne(1) | earlier_num(own.memory.group).ne(0))
        ),
        statement="the direction of travel is stated only after a group with an orientation of its own, or a second group",
        trace=("RFL-D4",),
        unconditional=True,
    )


def _whole(model: Balise) -> Bool:
    own = model.own
    complete = own.read.read.value.eq(own.read.total.value)
    recent = own.read.age.value <= own.config.telegram_age_limit_ms
    present = all_of(one.present for one in (own.read.group, own.read.read, own.read.total, own.read.age))
    return all_of([present, complete, recent, own.read.check.value.ne(FAILED), ~own.heading.backwards])


def _entitled(model: Balise, slot: Record) -> Bool:
    """The group in a slot was read, rightly and in its window; all as it was before the step."""
    own = model.own
    group, orientation = earlier_num(slot.group), earlier_num(slot.orientation)
    forwards, backwards = own.read.first.value < own.read.last.value, own.read.last.value < own.read.first.value
    against = (forwards & orientation.eq(REVERSE)) | (backwards & orientation.eq(NOMINAL))
    first, last = _window(model, slot)
    old, moved = _old(model), _moved(model)
    inside = (maximum(old.high, moved.high) >= first) & (old.low <= last)
    return all_of([own.read.group.present, group.ne(0), own.read.group.value.eq(group), ~against, inside])


def _accuracy_in_force(model: Balise) -> Num:
    """The location accuracy where linking gives none, mm."""
    national = model.own.national
    return ite(national.known, national.kept, as_num(model.own.config.default_accuracy_mm, MM))


def _accuracy_of(model: Balise, slot: Record) -> Num:
    """The location accuracy of the group that was in a slot before the step, mm."""
    return ite(earlier_bool(slot.accurate), earlier_num(slot.accuracy), _accuracy_in_force(model))


def _accuracy_by_precedence(model: Balise) -> Num:
    result = _accuracy_in_force(model)
    for slot in reversed(model.own.linking.slots):
        result = ite(_read_of(model, slot), _accuracy_of(model, slot), result)
    return result


def _read_of(model: Balise, slot: Record) -> Bool:
    """What was read has the identity of the group that was in a slot before the step."""
    group = model.own.read.group
    return group.present & earlier_num(slot.group).eq(group.value)


def _window(model: Balise, slot: Record) -> tuple[Num, Num]:
    """The first and the last place of the front end at which the group in a slot before the step can be read, nm."""
    return model.own.config.reader.window(earlier_num(slot.place), _accuracy_of(model, slot))


def _old(model: Balise) -> Interval:
    """The interval before the step."""
    interval = model.own.held.interval
    return Interval(*(earlier_num(term) for term in (interval.position, interval.over, interval.under)))


def _admitted(model: Balise) -> Bool:
    return model.own.odometer.judged.eq(ADMITTED)


def _distance(model: Balise) -> Num:
    """The distance that counted in the step, mm."""
    return ite(_admitted(model), model.own.odometer.step.value, as_num(0, MM))


def _moved(model: Balise) -> Interval:
    """The interval before the step, moved by the measured distance and grown by the odometer's law."""
    odometer = model.own.odometer
    growth = ite(_admitted(model), odometer.most_error, as_num(model.own.config.limits.blind_nm, NM))
    return _old(model).moved(_distance(model), growth)


# ------------------------------------------------------------------ what a telegram does to the interval


def _resets(model: Balise) -> Iterator[Property]:
    own, valid = model.own, model.machine.flag("valid")
    accepted, kept = own.memory.verdict.eq(v.ACCEPTED), valid & earlier_bool(valid)
    interval, moved = own.held.interval, _moved(model)
    yield always(
        "a reset never widens",
        kept.implies((interval.low >= moved.low) & (interval.high <= moved.high) & (interval.margin <= moved.margin)),
        statement="no telegram moves an end of the interval outward or makes the margin greater than odometry alone had it",
        trace=("RFL-D4",),
        unconditional=True,
    )
    yield always(
        "a reset keeps the truth",
        (accepted & valid).implies(between(interval.low, own.world.truth, interval.high)),
        statement="what the telegram and the interval have in common holds the true position",
        trace=("RFL-5", "RFL-D4"),
        assumption=LAW,
    )
    advance = interval.low - _old(model).low
    estimated = exact_to(maximum(_distance(model), 0), NM)
    yield always(
        "min safe front end",
        (kept & ~accepted).implies(advance <= estimated),
        statement="without an accepted group the min safe front end advances by no more than the distance estimated "
        "(OCORA 7244)",
        trace=("RFL-D4",),
        unconditional=True,
    )
    yield always(
        "margins never shrink",
        (kept & ~accepted).implies((interval.over >= _old(model).over) & (interval.under >= _old(model).under)),
        statement="without an accepted group neither margin shrinks",
        trace=("RFL-D4",),
        unconditional=True,
    )
    told = own.reflector.known & ~earlier_bool(own.reflector.known)
    new = own.reflector.place.ne(earlier_num(own.reflector.place)) & own.reflector.known
    counted = own.memory.verdict.one_of(v.ACCEPTED, v.CANDIDATE)
    reach = own.read.reflector.value
    yield always(
        "reflector told by an accepted telegram",
        (told | new).implies(counted & own.reflector.place.eq(own.memory.place + reach)),
        statement="the distance to the next reflector is taken only from a telegram that counts, from its group's place on",
        trace=("RFL-9",),
        unconditional=True,
    )


def _rejection(model: Balise) -> Iterator[Property]:
    own, valid = model.own, model.machine.flag("valid")
    kept = valid & earlier_bool(valid)
    interval, moved = own.held.interval, _moved(model)
    pairs = zip(
        (interval.position, interval.over, interval.under), (moved.position, moved.over, moved.under), strict=True
    )
    as_odometry = all_of(now.eq(alone) for now, alone in pairs)
    yield always(
        "rejected telegrams change nothing",
        (kept & own.memory.verdict.ne(v.ACCEPTED)).implies(as_odometry),
        statement="after a telegram that is not accepted, position and margins are those that odometry alone gives",
        trace=("RFL-D4",),
        unconditional=True,
    )
    for name, fault in _faults(model).items():
        yield always(
            f"{name} changes nothing",
            (kept & fault).implies(as_odometry),
            statement=f"a telegram that is {name} leaves the interval as odometry alone gives it",
            trace=("RFL-D4",),
            unconditional=True,
        )


def _faults(model: Balise) -> dict[str, Bool]:
    """Telegrams that are never believed, in terms of what was read."""
    own = model.own
    read = own.read
    known = any_of(_read_of(model, slot) for slot in own.linking.slots)
    faults = {
        "corrupted": read.check.present & read.check.value.eq(FAILED),
        "incomplete": read.read.present & read.total.present & (read.read.value < read.total.value),
        "stale": read.age.present & (read.age.value > own.config.telegram_age_limit_ms),
        "without an identity": ~read.group.present,
    }
    if own.config.free_references:
        return faults
    passed = {
        "of the expected group but outside its window": _read_of(model, own.linking.slots[0]) & ~_in_window(model),
        "of the expected group but passed the wrong way": _read_of(model, own.linking.slots[0]) & _wrong_way(model),
    }
    return {**faults, "foreign": read.group.present & ~known, **passed}


def _in_window(model: Balise) -> Bool:
    """The expected group's window was open in the step."""
    first, last = _window(model, model.own.linking.slots[0])
    return (maximum(_old(model).high, _moved(model).high) >= first) & (_old(model).low <= last)


def _wrong_way(model: Balise) -> Bool:
    first, last = model.own.read.first, model.own.read.last
    expected = earlier_num(model.own.linking.slots[0].orientation)
    both = first.present & last.present
    forth, back = first.value < last.value, last.value < first.value
    return both & ((forth & expected.eq(REVERSE)) | (back & expected.eq(NOMINAL)))


# ------------------------------------------------------------------ expectation windows


def _windows(model: Balise) -> Iterator[Property]:
    own, valid = model.own, model.machine.flag("valid")
    held = earlier_num(own.linking.slots[0].group).ne(0)
    seen = _announced(model)
    _, last = _window(model, own.linking.slots[0])
    passed = maximum(_old(model).low, _moved(model).low) > last
    kept = valid & earlier_bool(valid)
    yield always(
        "window closes when the min safe front end has passed",
        (kept & held & ~seen & passed).implies(own.memory.ended.eq(1) & _given_up(model)),
        statement="a group that was not read is given up in the very step in which the min safe front end passes the last "
        "place where it can be read, with its linking reaction",
        trace=("RFL-D4",),
        unconditional=True,
    )
    yield always(
        "no window closes early",
        (kept & (own.memory.ended > 0)).implies(seen | (held & passed)),
        statement="an announced group is given up only when it, or a later one, was read, or its window has closed",
        trace=("RFL-D4",),
        unconditional=True,
    )
    yield always(
        "expected until found or given up",
        (kept & held & ~seen & ~passed & ~_relinked(model)).implies(
            own.linking.slots[0].group.eq(earlier_num(own.linking.slots[0].group))
        ),
        statement="a group stays expected until it is read, its window closes, or linking is renewed",
        trace=("RFL-D4",),
        unconditional=True,
    )


def _announced(model: Balise) -> Bool:
    """A credible telegram of an announced group was read."""
    own = model.own
    credible = own.memory.verdict.ne(v.NONE) & ~own.memory.verdict.one_of(
        v.MALFORMED, v.CORRUPTED, v.STALE, v.REVERSING
    )
    held = (_read_of(model, slot) & earlier_num(slot.group).ne(0) for slot in own.linking.slots)
    return credible & any_of(held)


def _given_up(model: Balise) -> Bool:
    slot = model.own.linking.slots[0]
    strong = earlier_num(slot.reaction)
    acted = model.own.memory.reaction
    enough = ite(strong.eq(TRAIN_TRIP), acted.eq(TRAIN_TRIP), strong.eq(NO_REACTION) | acted.ne(NO_REACTION))
    return model.own.memory.given_up.eq(earlier_num(slot.group)) & enough


def _relinked(model: Balise) -> Bool:
    order = model.own.linking.offered.order
    return order.present & order.value.one_of(REPLACE, WITHDRAW)


# ------------------------------------------------------------------ reactions


def _reactions(model: Balise) -> Iterator[Property]:
    own, valid = model.own, model.machine.flag("valid")
    memory, located = own.memory, earlier_bool(valid)
    braking = memory.reaction.one_of(SERVICE_BRAKE, TRAIN_TRIP)
    _, last = _window(model, own.linking.slots[0])
    misses = all_of(
        [located, earlier_num(own.linking.slots[0].group).ne(0), ~_announced(model), _moved(model).low > last]
    )
    yield always(
        "two missed brake",
        (misses & (earlier_num(memory.missed) >= 1)).implies(braking),
        statement="when the second announced group in a row is missed, at least the service brake is ordered in the same "
        "step, whatever its linking reaction",
        trace=("RFL-D4",),
        unconditional=True,
    )
    yield always(
        "missed groups are counted",
        (valid & located).implies(memory.missed.eq(_count(model))),
        statement="groups given up one after the other are counted until one is accepted",
        trace=("RFL-D4",),
        unconditional=True,
    )
    wrong = memory.verdict.eq(v.WRONG_DIRECTION) & located & _announced(model)
    yield always(
        "wrong direction trips",
        wrong.implies(memory.reaction.eq(TRAIN_TRIP)),
        statement="an announced group passed in the other orientation trips the train in the same step (3.16.2.3.2)",
        trace=("RFL-D4",),
        unconditional=True,
    )
    yield always(
        "no reaction without a linking error",
        memory.reaction.ne(NO_REACTION).implies((memory.ended > 0) & located),
        statement="a group that linking does not speak of, or a damaged telegram, is rejected without any reaction "
        "(3.16.2.4.3); only a group given up causes one",
        trace=("RFL-D4",),
        unconditional=True,
    )


def _count(model: Balise) -> Num:
    memory = model.own.memory
    reset = memory.verdict.eq(v.ACCEPTED) & _announced(model)
    return ite(reset, 0, minimum(earlier_num(memory.missed) + memory.ended, 2))


# ------------------------------------------------------------------ the odometer


def _sensors(model: Balise) -> Iterator[Property]:
    own, machine = model.own, model.machine
    odometer = own.odometer
    yield within(
        "silence delocalizes",
        own.config.gap_limit_cycles,
        ~odometer.step.present,
        odometer.step.present | ~machine.flag("valid"),
        statement="when the odometer is silent, nothing is reported after the permitted gap at the latest",
        trace=("RFL-D4",),
        unconditional=True,
        helper=lambda waited: waited <= odometer.gap,
    )
    limits, gap = own.config.limits, earlier_num(odometer.gap)
    change = odometer.step.value - earlier_num(odometer.last)
    allowed = with_unit((gap + 1) * limits.max_step_change_mm, MM)
    gate = (abs_(odometer.step.value) <= limits.max_step_mm) & (
        (gap > limits.gap_limit) | between(-allowed, change, allowed)
    )
    yield always(
        "odometer gate",
        odometer.judged.eq(ADMITTED).implies(odometer.step.present & gate),
        statement="a distance is admitted only below the top speed, and within the greatest change of speed since the "
        "last one",
        trace=("RFL-D4",),
        unconditional=True,
    )
