"""Terms that the properties share: the travel of a cycle, the place that a sighting gives, the reported interval."""

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
    "the true route is among the candidates at the start, and the vehicle is within the start's error; the odometer keeps its "
    "error law; a sighted reflector stands beside the true route at the sighted range, with the recognised model, and the map "
    "names it there, or beside another track that the map has in view, and not where the own track's image stands; the vehicle takes "
    "a turn that is seen"
)
REQUIREMENTS = ("RFL-D6",)


def carried(model: Route) -> Bool:
    """Return whether the machine reports at least one possible route."""
    _, undecided, decided, _ = model.machine.modes
    return model.machine.mode.one_of(undecided, decided)


def given_up(model: Route) -> Bool:
    """Return whether the machine stops reporting in a cycle without a new start."""
    return earlier_bool(carried(model)) & ~model.own.start_error.present & ~carried(model)


def bounds(model: Route, route: Hypothesis) -> tuple[Num, Num]:
    """Return the ends of the reported interval along the route, nm."""
    low, high = (model.machine.output(f"route_{route.number}_{end}_mm") for end in ("low", "high"))
    return exact_to(low, NM), exact_to(high, NM)


def _most_added_error(own: Parts) -> Num:
    """Return the greatest error of the measured distance, nm: the rate counts the part above the knee."""
    law, config, step = own.config.odometer, own.config, own.odometer.measured.value
    knee = law.knee_mm_s * config.period_ms // 1_000
    above = maximum(maximum(step - knee, -step - knee), 0)
    return law.floor_mm_s * config.period_ms * 1_000 + with_unit(above * law.rate_ppm, NM) + _further(own)


def _further(own: Parts) -> Num:
    """Return the error that a checking unit reports beyond the law, nm; 0 without such a unit."""
    return as_num(0, NM) if own.odometer.more is None else own.odometer.more


def ran(own: Parts) -> tuple[Num, Num]:
    """Return the least and the greatest travel of the cycle, nm; without a usable distance, the highest speed either way."""
    counts, farthest = own.odometer.last_verdict.eq(ADMITTED), own.config.max_speed_mm_s * own.config.period_ms * 1_000
    measured, blind = exact_to(own.odometer.measured.value, NM), _further(own) + farthest
    least = ite(counts, measured - _most_added_error(own), -blind)
    return least, ite(counts, _most_added_error(own) + measured, blind)


@dataclass(frozen=True, eq=False)
class CycleEvidence:
    """The evidence of one cycle about a route that was possible before.

    low, high   bounds before the step of the true distance less the odometer's wander, nm
    """

    own: Parts
    route: Hypothesis

    @property
    def went_on(self) -> Bool:
        """The route was possible, and there was no new start."""
        return ~self.own.start_error.present & earlier_bool(self.route.possible)

    @property
    def low(self) -> Num:
        """Low end before the step, nm."""
        return earlier_num(self.route.low)

    @property
    def high(self) -> Num:
        """High end before the step, nm."""
        return earlier_num(self.route.high)

    @property
    def slack(self) -> Num:
        """Greatest error of the place that a sighting gives, wander included, nm."""
        return as_num(self.own.half_nm, NM) + exact_to(self.own.sighting_error, NM)

    @property
    def place(self) -> Num:
        """Place of the vehicle on this route by the sighting, nm."""
        return exact_to(self.route.reflector.value, NM) - exact_to(self.own.sighting_range.value, NM)

    @property
    def unseen(self) -> Bool:
        """The vehicle sighted no reflector of a known model."""
        return ~self.own.sighting_range.present | self.own.sighting_model.eq(NO_MODEL)

    @property
    def silent(self) -> Bool:
        """Return whether no reflector of a known model was sighted, or one that may stand beside another track."""
        elsewhere = all_of([self.route.other_in_view, ~self.own.sighting_by_own_track])
        return self.unseen | elsewhere

    @property
    def never_there(self) -> Bool:
        """The route has no such reflector, or the vehicle cannot be where it would sight it."""
        least, most = ran(self.own)
        ahead, behind = self.place - self.high > self.slack + most, self.place - self.low < least - self.slack
        return any_of([~self.route.reflector.present, self.route.model.ne(self.own.sighting_model), ahead, behind])

    @property
    def turned_away(self) -> Bool:
        """The vehicle saw a turn that the route does not take."""
        turned, course = self.own.course_taken, self.route.course
        return all_of([course.ne(turned), turned.ne(UNDECIDED), course.ne(UNDECIDED)])

    @property
    def refuted(self) -> Bool:
        """The route was impossible before, or what is seen refutes it."""
        seen = self.never_there & ~self.silent
        return ~earlier_bool(self.route.possible) | self.turned_away | seen
