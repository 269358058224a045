"""A balise group as the antenna read it in one cycle, and the place of the vehicle that follows from it.

A group has one to eight balises; number 1 is its origin, and rising numbers are its nominal direction (SUBSET-026
3.4.2.2). A single balise has no orientation of its own. Number 1 also gives the time of reading.

Place and orientation come with the telegram, or from the map by the group's identity; they are used where linking gives none.
The telegram may give the distance of the next reflector, or the place from where to search for it (RFL-9).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

from safeloc.language.declared import Declared
from safeloc.language.expr import (
    Bool,
    Lit,
    Num,
    Optional,
    abs_,
    all_of,
    any_of,
    as_num,
    boolean,
    choice,
    enumeration,
    exact_to,
    ite,
    members,
    minimum,
    optional,
)
from safeloc.language.units import COUNT, MM, MM_S, MS, NM, NM_PER_MM, PPM
from safeloc.models.vocabulary.cycle_figures import DistanceConfig
from safeloc.models.vocabulary.error_law import ErrorLaw
from safeloc.models.vocabulary.interval import Interval
from safeloc.models.vocabulary.odometer import Odometer

_LARGEST_GROUP = 8
ORIENTATION = members("orientation", "UNKNOWN", "NOMINAL", "REVERSE")
UNKNOWN, NOMINAL, REVERSE = ORIENTATION
_LINK = members("link", "LINKED", "UNLINKED")
LINKED, UNLINKED = _LINK
CHECK = members("check", "PASSED", "FAILED")
PASSED, FAILED = CHECK


@dataclass(frozen=True, eq=False)
class Reading:
    """The inputs of one group reading. Those up to `age` belong to every reading, `since` may be absent.

    total, read      number of balises of the group, and number of those that were read
    first, last      the numbers of the balise read first and of the one read last
    check            PASSED if the check bits of all balises that were read are right
    age              time since the antenna stood over balise 1
    since            distance measured since the antenna stood over balise 1 (latched counter)
    """

    group: Optional
    link: Optional
    check: Optional
    total: Optional
    read: Optional
    first: Optional
    last: Optional
    age: Optional
    since: Optional
    age_limit_ms: int

    @property
    def inputs(self) -> tuple[Optional, ...]:
        """All inputs."""
        return (*self._needed, self.since)

    @property
    def _needed(self) -> tuple[Optional, ...]:
        return (self.group, self.link, self.check, self.total, self.read, self.first, self.last, self.age)

    @cached_property
    def silent(self) -> Bool:
        """There is no reading."""
        return ~any_of(one.present for one in self.inputs)

    @cached_property
    def well_formed(self) -> Bool:
        """All inputs that belong to every reading are there, and the numbers fit each other."""
        total, read = self.total.value, self.read.value
        first, last = self.first.value, self.last.value
        numbers = (read <= total) & (first <= total) & (last <= total) & read.eq(1).iff(first.eq(last))
        return all_of([*(one.present for one in self._needed), numbers])

    @cached_property
    def corrupted(self) -> Bool:
        """Some check bits are wrong: even the identity may be false."""
        return self.check.value.eq(FAILED)

    @cached_property
    def complete(self) -> Bool:
        """Every balise of the group was read."""
        return self.read.value.eq(self.total.value)

    @cached_property
    def stale(self) -> Bool:
        """The reading is older than permitted."""
        return self.age.value > self.age_limit_ms

    @cached_property
    def passed(self) -> Num:
        """The orientation in which the group was passed; UNKNOWN for a single balise."""
        first, last = self.first.value, self.last.value
        return ite(first.eq(last), UNKNOWN, ite(first < last, NOMINAL, REVERSE))

    def against(self, orientation: Num) -> Bool:
        """Return whether the group was passed in the other orientation than expected; never if either is unknown."""
        known = self.passed.ne(UNKNOWN) & orientation.ne(UNKNOWN)
        return known & self.passed.ne(orientation)


@dataclass(frozen=True, eq=False)
class Telegram(Reading):
    """A group reading, and what telegram or map tell of the group; each of these may be absent.

    place            the place of balise 1 along the route
    orientation      the orientation in which a vehicle that runs along the route passes the group
    reflector, search  distance from balise 1 to the next reflector, and to the place where its search may begin
    """

    place: Optional
    orientation: Optional
    reflector: Optional
    search: Optional

    @property
    def inputs(self) -> tuple[Optional, ...]:
        """All inputs."""
        own = (self.place, self.orientation, self.since, self.reflector, self.search)
        return (*self._needed, *own)

    @property
    def expected_along(self) -> Num:
        """The orientation in which the group has to be passed, by telegram or map; UNKNOWN where neither gives it."""
        return ite(self.orientation.present, self.orientation.value, UNKNOWN)


_Needed = tuple[Optional, Optional, Optional, Optional, Optional, Optional, Optional, Optional]


def _needed(declared: Declared, last_identity: int, age_limit_ms: int) -> _Needed:
    """Declare the inputs that belong to every reading."""
    return (
        declared.sensor(optional("telegram_group", COUNT, 1, last_identity)),
        declared.sensor(chosen("telegram_link", _LINK)),
        declared.sensor(chosen("telegram_check", CHECK)),
        declared.sensor(optional("telegram_total", COUNT, 1, _LARGEST_GROUP)),
        declared.sensor(optional("telegram_read", COUNT, 1, _LARGEST_GROUP)),
        declared.sensor(optional("telegram_first", COUNT, 1, _LARGEST_GROUP)),
        declared.sensor(optional("telegram_last", COUNT, 1, _LARGEST_GROUP)),
        declared.sensor(optional("telegram_age_ms", MS, 0, 10 * age_limit_ms)),
    )


def _since(declared: Declared, max_cycle_distance_mm: int) -> Optional:
    return declared.sensor(optional("telegram_since_mm", MM, -10 * max_cycle_distance_mm, 10 * max_cycle_distance_mm))


def reading(declared: Declared, *, last_identity: int, max_cycle_distance_mm: int, age_limit_ms: int) -> Reading:
    """Declare the inputs of a group reading of which no place is known, named `telegram_...`."""
    needed = _needed(declared, last_identity, age_limit_ms)
    return Reading(*needed, _since(declared, max_cycle_distance_mm), age_limit_ms)


def telegram(
    declared: Declared,
    *,
    last_identity: int,
    position_limit_mm: int,
    max_cycle_distance_mm: int,
    age_limit_ms: int,
    reflector_reach_mm: int,
) -> Telegram:
    """Declare the inputs of a group reading, named `telegram_...`."""
    needed = _needed(declared, last_identity, age_limit_ms)
    place = declared.sensor(optional("telegram_position_mm", MM, -position_limit_mm, position_limit_mm))
    orientation = declared.sensor(chosen("telegram_orientation", ORIENTATION))
    return Telegram(
        *needed,
        _since(declared, max_cycle_distance_mm),
        age_limit_ms,
        place,
        orientation,
        declared.sensor(optional("telegram_reflector_mm", MM, 0, reflector_reach_mm)),
        declared.sensor(optional("telegram_search_mm", MM, 0, reflector_reach_mm)),
    )


def chosen(name: str, of: tuple[Lit, ...]) -> Optional:
    """Return an input whose value is a member of an enumeration, or absent."""
    return Optional(choice(name, enumeration(of)), boolean(f"{name}.present"))


class ReaderConfig(DistanceConfig, Protocol):
    """The figures of a configuration that a reading depends on."""

    @property
    def odometer(self) -> ErrorLaw:
        """The error law of the odometer that counts the run since the reading."""
        ...

    @property
    def antenna_mm(self) -> int:
        """Distance of the antenna behind the front end, mm."""
        ...

    @property
    def detection_mm(self) -> int:
        """Detection accuracy of the antenna, mm."""
        ...


def check_telegram_age(limit_ms: int, period_ms: int) -> None:
    """Raise ValueError for an age limit that a telegram of this cycle can exceed."""
    if 10 * limit_ms <= period_ms:
        raise ValueError(
            f"telegram_age_limit_ms {limit_ms} must be above a tenth of period_ms {period_ms}: "
            "a telegram read within a cycle is up to that cycle old at its end."
        )


@dataclass(frozen=True, eq=False)
class Reader:
    """The antenna, and the errors of a reading.

    antenna_mm    distance of the antenna behind the front end
    detection_mm  greatest distance of the antenna from balise 1 when it reports to stand over it
    constant_nm   the odometer's one-off constant, added from the reading on
    floor_nm      the odometer's error in a cycle without any distance
    since_ppm     the odometer's rate, added for the distance run since the reading
    """

    antenna_mm: int
    detection_mm: int
    constant_nm: int
    floor_nm: int
    since_ppm: int
    period_ms: int
    max_speed_mm_s: int
    measuring_step_mm: int

    @classmethod
    def of(cls, config: ReaderConfig) -> Reader:
        """Return the reader of a vehicle that counts distance with the odometer of its configuration."""
        return cls(
            config.antenna_mm,
            config.detection_mm,
            2 * config.odometer.wander_nm,
            config.odometer.floor_mm_s * config.period_ms * 1_000,
            config.odometer.rate_ppm,
            config.period_ms,
            config.max_speed_mm_s,
            config.measuring_step_mm,
        )

    def window(self, place: Num, accuracy: Num) -> tuple[Num, Num]:
        """Return the first and the last possible place of the front end when the antenna reads a group, nm (3.4.4.4.3)."""
        spread = accuracy + self.detection_mm
        front = place + self.antenna_mm
        return exact_to(front - spread, NM), exact_to(front + spread, NM)

    def run_since(self, read: Reading, distance: Num, admitted: Bool, more: Num | None) -> tuple[Num, Num]:
        """Return how far the vehicle may have run backwards and forwards since the reading, nm, where `since` is absent.

        It is the run at the highest speed in the age of the reading, and one measuring step. After a reading of this cycle the
        vehicle ran in the direction measured for the cycle, as far as the odometer's floor and the error that a checking unit
        reports (`more`) allow, and its one-off error, which is added anyway; after an older one the direction is unknown.
        """
        reach = exact_to(Lit(self.max_speed_mm_s, MM_S) * read.age.value, NM)
        least = as_num(self.measuring_step_mm * NM_PER_MM, NM)
        against = least + self._unmeasured(reach, more)
        known = admitted & (read.age.value <= self.period_ms)
        back = ite(known & (distance >= 0), against, reach + least)
        forth = ite(known & (distance <= 0), against, reach + least)
        return back, forth

    def _unmeasured(self, reach: Num, more: Num | None) -> Num:
        """Return how far the vehicle may have run against the measured direction beside its odometer's one-off error, nm."""
        if more is None:
            return minimum(reach, self.floor_nm) if self.floor_nm else as_num(0, NM)
        return minimum(reach, more + self.floor_nm)

    def fix(self, read: Reading, place: Num, accuracy: Num, odometer: Odometer) -> Interval:
        """Return the interval of the front end at the end of the cycle, given the group's place and location accuracy in mm."""
        since = read.since.value_or(as_num(0, MM))
        back, forth = self.run_since(read, odometer.distance, odometer.admitted, odometer.more)
        spread = exact_to(accuracy + self.detection_mm, NM) + self.constant_nm
        drift = abs_(since) * Lit(self.since_ppm, PPM)
        return Interval(
            exact_to(place + self.antenna_mm + since, NM),
            spread + ite(read.since.present, drift, forth),
            spread + ite(read.since.present, drift, back),
        )
