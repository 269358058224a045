"""Figures and words that the claims share: what the vehicle ran in a cycle, where a sighting puts it, what is reported."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.expr import Bool, Num, all_of, any_of, as_num, exact_to, ite, maximum, with_unit
from safeloc.language.spec import earlier_bool, earlier_num
from safeloc.language.units import NM
from safeloc.models.route import Route
from safeloc.models.route.variables import Hypothesis, Parts
from safeloc.models.turn_off import UNDECIDED
from safeloc.models.vocabulary.measured import ADMITTED
from safeloc.models.vocabulary.reflectors import NO_MODEL

LAW = (
    "the true route is among the candidates at the start, and the vehicle within the start's error; the odometer keeps its "
    "error law; what is sighted stands beside the true route at its range, with its model, and the map names it there; a turn "
    "that is seen is taken"
)
REQUIREMENTS = ("RFL-D6",)


def carried(model: Route) -> Bool:
    """At least one route is reported as possible."""
    _, undecided, decided, _ = model.machine.modes
    return model.machine.mode.one_of(undecided, decided)


def bounds(model: Route, route: Hypothesis) -> tuple[Num, Num]:
    """The reported interval along the route, nm."""
    low, high = (model.machine.output(f"route_{route.number}_{end}_mm") for end in ("low", "high"))
    return exact_to(low, NM), exact_to(high, NM)


def most_charged(own: Parts) -> Num:
    """What the odometer may err over the measured distance, nm: the rate counts what lies above the knee."""
    law, config, step = own.config.odometer, own.config, own.odometer.step.value
    knee = law.knee_mm_s * config.period_ms // 1_000
    above = maximum(maximum(step - knee, -step - knee), 0)
    return law.floor_mm_s * config.period_ms * 1_000 + with_unit(above * law.rate_ppm, NM)


def ran(own: Parts) -> tuple[Num, Num]:
    """The least and the most that the vehicle ran in the cycle, nm; blind, anything up to the highest speed."""
    counts, blind = own.odometer.judged.eq(ADMITTED), own.config.max_speed_mm_s * own.config.period_ms * 1_000
    measured = exact_to(own.odometer.step.value, NM)
    least = ite(counts, measured - most_charged(own), as_num(-blind, NM))
    return least, ite(counts, most_charged(own) + measured, as_num(blind, NM))


@dataclass(frozen=True, eq=False)
class Told:
    """What a cycle tells of one route that was possible before.

    low, high   the bounds before the step of the distance less the odometer's wander, nm
    """

    own: Parts
    route: Hypothesis

    @property
    def went_on(self) -> Bool:
        """The route was possible, and there was no new start."""
        return ~self.own.start.present & earlier_bool(self.route.possible)

    @property
    def low(self) -> Num:
        """The low end before the step."""
        return earlier_num(self.route.low)

    @property
    def high(self) -> Num:
        """The high end before the step."""
        return earlier_num(self.route.high)

    @property
    def slack(self) -> Num:
        """By how much the place that a sighting gives may be off, wander included, nm."""
        return as_num(self.own.half_nm, NM) + exact_to(self.own.sighting_error, NM)

    @property
    def place(self) -> Num:
        """Where the sighting puts the vehicle on this route, nm."""
        return exact_to(self.route.reflector.value, NM) - exact_to(self.own.sighting.value, NM)

    @property
    def unseen(self) -> Bool:
        """No reflector of a known model was sighted."""
        return ~self.own.sighting.present | self.own.sighting_model.eq(NO_MODEL)

    @property
    def never_there(self) -> Bool:
        """The route has no such reflector, or the vehicle cannot have come to where it would be sighted."""
        least, most = ran(self.own)
        ahead, behind = self.place - self.high > self.slack + most, self.place - self.low < least - self.slack
        return any_of([~self.route.reflector.present, self.route.model.ne(self.own.sighting_model), ahead, behind])

    @property
    def turned_away(self) -> Bool:
        """A turn was seen that the route does not take."""
        turned, course = self.own.turned, self.route.course
        return all_of([course.ne(turned), turned.ne(UNDECIDED), course.ne(UNDECIDED)])
