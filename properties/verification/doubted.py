"""Properties of a verified position if the fibre may be wrong in any way, alone or together, from any moment on (FVA-1).

An unnoticed error stays within figures: a place within the stretch that the last record and the top speed leave open, a length
within tolerance and spread, a speed within its figure at the counter, a count not at all. All else is withheld: a wrong reading
in the same cycle, missing readings within `currency_cycles`, a place whose record is too old within the cycles that
`place_doubt_limit_mm` leaves. The figures are sharp at the defaults: a run refutes one unit less.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, partial

from safeloc.language.expr import Bool, Lit, Num, all_of, before, between, exact_to, was, with_unit
from safeloc.language.spec import Property, always, reachable
from safeloc.language.units import NM, UM, UM_S
from safeloc.models.verification import Verification
from safeloc.models.verification.doubted import Doubted
from safeloc.models.verification.variables import AXLE_COUNTER, Parts
from safeloc.properties.verification.requirements import CLAIM, CONTROL, COURSE, ENTRY, MATCH, STAY

LAW = (
    "an axle counter's record that is reported as undisturbed is true, and so is the record that a neighbour "
    "hands over; no train runs faster than the top speed, and no other one takes its place unreported; nothing "
    "is assumed of the messages of the fibre, the emitter or train control"
)
_whatever_the_fibre_tells = partial(always, requirements=(*CLAIM, *STAY), assumption=LAW)


@dataclass(frozen=True, eq=False)
class Figures:
    """Greatest distances of a trusted reading from the truth, in figures of their own."""

    model: Verification
    train: Doubted

    @property
    def own(self) -> Parts:
        """The machine's variables."""
        return self.model.own

    @property
    def trusted(self) -> Bool:
        """A position is reported."""
        return self.model.machine.flag("trusted")

    @cached_property
    def interval_nm(self) -> tuple[Num, Num]:
        """The reported interval, nm."""
        position, below, above = (
            self.model.machine.output(name) for name in ("position_mm", "margin_below_mm", "margin_above_mm")
        )
        return exact_to(position - below, NM), exact_to(position + above, NM)

    def within(self, farthest_nm: Num) -> Bool:
        """Return the condition that the train's front is in the reported interval, or no farther than that beside it."""
        low, high = self.interval_nm
        return between(low - farthest_nm, self.own.truth, high + farthest_nm)

    @cached_property
    def added_run_mm(self) -> int:
        """The run of a cycle at top speed, in whole millimetres."""
        return (self.own.config.max_speed_mm_s * self.own.config.period_ms + 999) // 1_000

    @cached_property
    def runs_nm(self) -> int:
        """Two runs at top speed, nm: the true one, and the one that the machine adds in whole millimetres."""
        return self.own.config.max_speed_mm_s * self.own.config.period_ms * 1_000 + self.added_run_mm * 1_000_000

    @cached_property
    def tolerance_nm(self) -> int:
        """Greatest distance of the fibre's interval from the possible places of the front, nm."""
        return self.own.config.place_tolerance_mm * 1_000_000

    @property
    def at_counter(self) -> Bool:
        """The cycle of a counter's record."""
        return self.own.due & self.own.reference_from.eq(AXLE_COUNTER)


def properties(model: Verification, train: Doubted) -> list[Property]:
    """Return the properties: a wrong reading of the fibre is withheld, or within its figure."""
    figures = Figures(model, train)
    return [
        *_place(figures),
        *_place_at_any_time(figures),
        *_course(figures),
        *_values(figures),
        *_control(figures),
        *_speed(figures),
        *_cycles(figures),
        *_handed_over(figures),
        *_of_this_train(figures),
        *_reached(figures),
    ]


# ------------------------------------------------------------------ place


def _place(figures: Figures) -> Iterator[Property]:
    """Claim the greatest distance of a trusted interval from the front."""
    own, trusted = figures.own, figures.trusted
    wide = own.record_place_high - own.record_place_low + own.config.place_tolerance_mm
    yield _whatever_the_fibre_tells(
        "a place at the counter",
        (figures.at_counter & trusted).implies(
            figures.within(exact_to(wide, NM) + with_unit(own.record_age * figures.runs_nm, NM))
        ),
        statement="in the cycle of a counter's record a trusted interval is no farther from the front than the width of the "
        "record's place, the place tolerance, and two runs at top speed for each cycle that the record is old",
        requirements=(*CLAIM, *ENTRY),
    )
    yield _whatever_the_fibre_tells(
        "a place later",
        trusted.implies(figures.within(figures.train.width + figures.tolerance_nm)),
        statement="later a trusted interval is no farther from the front than that and two runs at top speed for each "
        "cycle since",
    )


def _place_at_any_time(figures: Figures) -> Iterator[Property]:
    """Claim the same without regard to the record's age."""
    own, trusted = figures.own, figures.trusted
    limit = Lit(own.config.place_doubt_limit_mm * 1_000_000 + figures.tolerance_nm, NM)
    yield _whatever_the_fibre_tells(
        "a place at any time",
        trusted.implies(figures.within(limit)),
        statement="a trusted interval is never farther from the front than place_doubt_limit_mm plus the place tolerance, for "
        "every sequence of fibre reports",
    )
    doubt = exact_to(figures.model.machine.output("place_doubt_mm"), NM)
    yield _whatever_the_fibre_tells(
        "the reported doubt holds",
        trusted.implies(figures.within(doubt) & doubt.eq(figures.train.width + figures.tolerance_nm)),
        statement="the machine reports how far from the front a trusted interval can be if the fibre is wrong",
    )


def _course(figures: Figures) -> Iterator[Property]:
    """Claim the greatest change of that distance in one cycle, by the check for jumps."""
    own, (low, high) = figures.own, figures.interval_nm
    was_trusted = before(figures.model.machine.mode).eq(figures.model.machine.modes[2])
    last_low, last_high = (
        exact_to(before(own.front) - before(own.front_margin_below), NM),
        exact_to(before(own.front) + before(own.front_margin_above), NM),
    )
    truth_before = before(own.truth)
    step = Lit(own.config.jump_mm * 1_000_000 + figures.runs_nm, NM)
    ahead = (low - own.truth) - (last_high - truth_before) <= step
    behind = (own.truth - high) - (truth_before - last_low) <= step
    yield _whatever_the_fibre_tells(
        "a place from cycle to cycle",
        (was_trusted & figures.trusted & ~own.due).implies(ahead & behind),
        statement="from one trusted cycle to the next the interval falls behind the front by no more than the far end of "
        "the previous interval did, plus jump_mm and two runs at top speed",
        requirements=(*CLAIM, *COURSE),
    )


# ------------------------------------------------------------------ count, length, speed


def _values(figures: Figures) -> Iterator[Property]:
    """Claim that wrong readings of count, length and ends are withheld."""
    own, trusted = figures.own, figures.trusted
    counted = own.associated & own.fibre_axles.present
    yield _whatever_the_fibre_tells(
        "a wrong count withholds",
        (trusted & counted).implies(own.axles.eq(own.fibre_axles.value)),
        statement="a wrong count withdraws the position in the same cycle, also if other measurements are wrong",
    )
    yield _whatever_the_fibre_tells(
        "a wrong length withholds",
        (trusted & own.associated & own.fibre_length.present).implies(_long(figures, own.fibre_length.value)),
        statement="a length that is farther from the train's than the tolerance and the spread of the record withholds in the same cycle",
    )
    near, far = own.ends_low, own.ends_high
    slack = figures.train.spread + own.config.length_tolerance_mm * 1_000
    yield _whatever_the_fibre_tells(
        "a distance of the ends",
        trusted.implies(
            near.present.implies(exact_to(near.value, UM) <= own.length + slack)
            & far.present.implies(exact_to(far.value, UM) >= own.length - slack)
        ),
        statement="two ends between which the train's length does not fit, with tolerance and spread, withhold in the same cycle",
    )


def _control(figures: Figures) -> Iterator[Property]:
    """Claim that wrong data from train control are withheld."""
    own, trusted = figures.own, figures.trusted
    stated = own.control_axles.present.implies(own.axles.eq(own.control_axles.value))
    long = own.control_length.present.implies(_long(figures, own.control_length.value))
    yield _whatever_the_fibre_tells(
        "wrong data by train control withhold",
        trusted.implies(stated & long),
        statement="a count by train control that is not the train's, or a length beyond tolerance and spread, withholds in the "
        "same cycle",
        requirements=CONTROL,
    )


def _speed(figures: Figures) -> Iterator[Property]:
    own, trusted = figures.own, figures.trusted
    yield _whatever_the_fibre_tells(
        "a speed at the counter",
        all_of([figures.at_counter, trusted, own.fibre_speed.present]).implies(_fast(figures)),
        statement="in the cycle of a counter's record the fibre's speed is no farther from the train's than the width of "
        "the record's speed, the speed tolerance, and twice the change by traction or brakes for each cycle that "
        "the record is old",
        requirements=(*CLAIM, *ENTRY),
    )


def _long(figures: Figures, stated: Num) -> Bool:
    slack = figures.train.spread + figures.own.config.length_tolerance_mm * 1_000
    return between(-slack, figures.own.length - exact_to(stated, UM), slack)


def _fast(figures: Figures) -> Bool:
    """Return the condition of the speed: of an older record, the change added in whole mm/s, and the train's true change."""
    own, config = figures.own, figures.own.config
    change = max(config.brake_mm_s2, config.traction_mm_s2) * config.period_ms
    twice = change + (change + 999) // 1_000 * 1_000
    wide = exact_to(own.record_speed_high - own.record_speed_low, UM_S) + config.speed_tolerance_mm_s * 1_000
    slack = wide + with_unit(own.record_age * twice, UM_S)
    return between(-slack, exact_to(own.fibre_speed.value, UM_S) - figures.train.speed, slack)


# ------------------------------------------------------------------ time to withdrawal


def _cycles(figures: Figures) -> Iterator[Property]:
    own, trusted, train = figures.own, figures.trusted, figures.train
    yield _whatever_the_fibre_tells(
        "a fibre without right count or length withholds",
        trusted.implies(train.since_confirmed <= own.config.currency_cycles),
        statement="a train of which the fibre reports neither a right count nor a right length is withheld within "
        "currency_cycles and one cycle",
    )
    serves = own.config.place_doubt_limit_mm // (2 * figures.added_run_mm)
    yield _whatever_the_fibre_tells(
        "a place whose record is old",
        trusted.implies(train.record_ago <= serves),
        statement="a place is withheld from the cycle on in which the last record and the top speed leave more open than "
        "place_doubt_limit_mm",
    )


# ------------------------------------------------------------------ stored and handed-over data


def _handed_over(figures: Figures) -> Iterator[Property]:
    """Claim that the record that is handed over is true."""
    machine, own = figures.model.machine, figures.own
    long = (machine.output("handover_length_low_mm"), machine.output("handover_length_high_mm"))
    place = (machine.output("handover_place_low_mm"), machine.output("handover_place_high_mm"))
    yield _whatever_the_fibre_tells(
        "a record that is handed over is true",
        machine.flag("handover_trusted").implies(
            all_of(
                [
                    own.axles.eq(machine.output("handover_axles")),
                    between(exact_to(long[0], UM), own.length, exact_to(long[1], UM)),
                    between(exact_to(place[0], NM), own.truth, exact_to(place[1], NM)),
                ]
            )
        ),
        statement="the record that is handed over of a trusted train is true: its axles, bounds of its length, and bounds "
        "of its front",
        requirements=("FVA-D1", *STAY, *MATCH),
    )


def _of_this_train(figures: Figures) -> Iterator[Property]:
    """Claim that the reported place is that of a pattern of this train."""
    machine, own = figures.model.machine, figures.own
    yield _whatever_the_fibre_tells(
        "a pattern of nobody",
        figures.trusted.implies(
            own.associated
            & own.located
            & own.fibre_position.present
            & machine.output("position_mm").eq(own.fibre_position.value)
        ),
        statement="the reported position is the place that the fibre reports in that cycle for a pattern of this train, "
        "and of no other",
    )


def _reached(figures: Figures) -> Iterator[Property]:
    own, (low, high) = figures.own, figures.interval_nm
    yield reachable("trusted", figures.trusted, statement="a train can be trusted", requirements=CLAIM)
    yield reachable(
        "trusted and wrong",
        figures.trusted & ~between(low, own.truth, high) & was(own.by_count),
        statement="a wrong place within the figure can be trusted: the figures are needed",
        requirements=CLAIM,
    )
