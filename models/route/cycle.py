"""One cycle of a hypothesis: it runs on, and what the vehicle sees narrows or refutes it."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.expr import Bool, Num, as_num, exact_to, ite, maximum, minimum
from safeloc.language.units import COUNT, NM, NM_PER_MM
from safeloc.models.route.variables import Hypothesis, Parts
from safeloc.models.turn_off import UNDECIDED as NO_COURSE
from safeloc.models.vocabulary.reflectors import NO_MODEL


@dataclass(frozen=True, eq=False)
class Bounded:
    """A hypothesis: whether it is possible, and bounds of the true distance less the present wander, nm."""

    own: Parts
    possible: Bool
    low: Num
    high: Num

    @property
    def tolerable(self) -> Bool:
        """Both margins of the reported interval are within the tolerance, and its ends are on the line."""
        config = self.own.config
        width = self.high - self.low + 2 * self.own.half_nm
        limit = config.length_limit_mm * NM_PER_MM
        return (width <= (2 * config.tolerance_mm - 2) * NM_PER_MM) & (self.low >= -limit) & (self.high <= limit)


@dataclass(frozen=True, eq=False)
class Cycle:
    """One hypothesis in a cycle."""

    own: Parts
    route: Hypothesis

    @property
    def moved(self) -> tuple[Num, Num]:
        """Bounds after the measured distance, nm."""
        distance, growth = exact_to(self.own.odometer.distance, NM), self.own.odometer.growth
        return self.route.low + distance - growth, self.route.high + distance + growth

    @property
    def seen(self) -> Bool:
        """The vehicle sighted a reflector and recognised its model."""
        return self.own.sighting_range.present & self.own.sighting_model.ne(NO_MODEL)

    @property
    def doubtful(self) -> Bool:
        """The sighted reflector may stand beside another track: it tells nothing of this route."""
        return self.route.other_in_view & ~self.own.sighting_by_own_track

    @property
    def tells(self) -> Bool:
        """A reflector is sighted that tells of this route: it is the own one, or the vehicle runs elsewhere."""
        return self.seen & ~self.doubtful

    @property
    def sighted(self) -> tuple[Num, Num]:
        """Bounds by the sighted reflector, nm: its place on the route less the measured range, with the error of the range."""
        place = exact_to(self.route.reflector.value - self.own.sighting_range.value, NM)
        error = exact_to(self.own.sighting_error, NM) + self.own.half_nm
        return place - error, place + error

    @property
    def has_it(self) -> Bool:
        """The route has a reflector of its own, of the sighted model, where the vehicle would see it."""
        (low, high), (first, last) = self.moved, self.sighted
        right = self.route.reflector.present & self.route.model.eq(self.own.sighting_model)
        return right & (first <= high) & (low <= last)

    @property
    def turns_so(self) -> Bool:
        """The route does not go another way than the turn that was seen."""
        turned, course = self.own.course_taken, self.route.course
        return turned.eq(NO_COURSE) | course.eq(NO_COURSE) | turned.eq(course)

    @property
    def fits(self) -> Bool:
        """The reflector and the turn that the vehicle sees in this cycle are possible on the route."""
        return (~self.tells | self.has_it) & self.turns_so

    @property
    def spread(self) -> Num:
        """The greatest distance from the common start at a start, wander included, nm."""
        return exact_to(self.own.start_error.value, NM) + self.own.half_nm

    @property
    def after(self) -> Bounded:
        """The hypothesis after the cycle: run on and narrowed by a sighting that tells of it, or set to the start."""
        (low, high), (first, last) = self.moved, self.sighted
        begun = self.own.start_error.present
        return Bounded(
            self.own,
            ite(begun, self.route.candidate, self.route.possible & self.fits),
            ite(begun, -self.spread, ite(self.tells, maximum(low, first), low)),
            ite(begun, self.spread, ite(self.tells, minimum(high, last), high)),
        )


def now(own: Parts) -> tuple[Bounded, ...]:
    """Return every hypothesis as it is stored."""
    return tuple(Bounded(own, route.possible, route.low, route.high) for route in own.routes)


def count(bounded: tuple[Bounded, ...]) -> Num:
    """Return the number of possible routes."""
    total = as_num(0, COUNT)
    for one in bounded:
        total = total + ite(one.possible, as_num(1, COUNT), 0)
    return total
