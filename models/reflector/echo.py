"""Echoes of one radar frame, and what each may be (RFL-2, RFL-10): the target, or not.

A frame carries a few candidate echoes in slots, made by the signal front end from the measured image: the distance
along the track (by time of flight), its error bound, the model by signature, the intensity. An echo is taken for the
target only if it has the minimum intensity, the target's model, a range that fits the interval known so far, and if
no other reflector of that model could fit there. Everything else is a thing beside the track.

Beside the echo's own error, a range is wrong by the radar's scale, in proportion, and by a systematic part of any size.
What the last self-test left open of that part is charged with each range. In a self-test itself nothing is known of it:
there an echo is taken for the target whatever its range, if no other reflector of the model can be heard.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from safeloc.language.declared import Declared
from safeloc.language.expr import (
    Bool,
    Lit,
    Num,
    NumVar,
    Optional,
    any_of,
    choice,
    enumeration,
    exact_to,
    ite,
    members,
    number,
    optional,
)
from safeloc.language.units import MM, NM, PPM, Unit
from safeloc.models.reflector.map_data import Reflector
from safeloc.models.vocabulary.first_of import first_of
from safeloc.models.vocabulary.interval import Interval
from safeloc.models.vocabulary.reflectors import LATERAL_LIMIT_MM, MAX_ERROR_MM, MODEL

CDB = Unit("cdB", scale=Fraction(1, 1000))
"""Hundredths of a decibel; intensities are relative to the receiver's full scale."""
INTENSITY_FLOOR_CDB, INTENSITY_CEILING_CDB = -20_000, 5_000

JUDGED = members(
    "echo",
    "NONE",
    "FITS",
    "NO_FRAME",
    "WEAK",
    "OTHER_MODEL",
    "TOO_CLOSE",
    "NOT_SEARCHED",
    "TOO_COARSE",
    "OUT_OF_WINDOW",
    "AMBIGUOUS",
)
(
    NONE,
    FITS,
    NO_FRAME,
    WEAK,
    OTHER_MODEL,
    TOO_CLOSE,
    NOT_SEARCHED,
    TOO_COARSE,
    OUT_OF_WINDOW,
    AMBIGUOUS,
) = JUDGED


@dataclass(frozen=True, eq=False)
class Slot:
    """One candidate echo: inputs, and how it was judged against the target and against the next reflector.

    range    distance along the track from radar to origin, mm; absent where the slot is empty
    lateral  where the origin lies beside the vehicle's axis, mm, positive to the left
    """

    number: int
    range: Optional
    error: NumVar
    model: NumVar
    intensity: NumVar
    lateral: NumVar
    judged: NumVar
    judged_next: NumVar


def slot(declared: Declared, number_: int, range_limit_mm: int) -> Slot:
    """Return a slot with fresh variables `echo_N_...`."""
    name = f"echo_{number_}"
    return Slot(
        number_,
        declared.sensor(optional(f"{name}_range_mm", MM, 0, range_limit_mm)),
        declared.sensor(number(f"{name}_error_mm", MM, 0, MAX_ERROR_MM)),
        declared.sensor(choice(f"{name}_model", enumeration(MODEL))),
        declared.sensor(number(f"{name}_intensity_cdb", CDB, INTENSITY_FLOOR_CDB, INTENSITY_CEILING_CDB)),
        declared.sensor(number(f"{name}_lateral_mm", MM, -LATERAL_LIMIT_MM, LATERAL_LIMIT_MM)),
        declared.state(choice(f"{name}_judged", enumeration(JUDGED)), first=NONE),
        declared.state(choice(f"{name}_judged_for_next", enumeration(JUDGED)), first=NONE),
    )


@dataclass(frozen=True)
class RadarLaw:
    """What the judgement of echoes depends on: the radar's figures, and how exactly reflectors were surveyed."""

    minimum_intensity_cdb: int
    near_mm: int
    accuracy_nm: int
    tolerance_nm: int
    limit_mm: int
    scale_ppm: int
    strong_nm: int
    left_open_nm: int


@dataclass(frozen=True, eq=False)
class Situation:
    """What one cycle's echoes are judged against: the interval known so far, and whether a reflector is looked for.

    by_radar  where the radar, with its systematic error, may have end A by what is known so far
    lag       what the vehicle may have run (forwards, backwards) since the frame was taken, nm
    testing   the echo tests the radar
    known     what is known without the radar in a self-test; only while `testing`
    open      by how much the radar may measure too long, and too short, nm; 0 while `testing`
    """

    frame: Bool
    window: Interval
    by_radar: Interval
    lag: tuple[Num, Num]
    law: RadarLaw
    testing: Bool
    known: Interval
    open: tuple[Num, Num]

    def bare(self, reflector: Reflector, range_: Num, error: Num) -> Interval:
        """What a range (mm) with an error bound says of end A at the end of the cycle, if the radar has no systematic error."""
        forward, backward = self.lag
        bound = exact_to(error, NM) + self.law.accuracy_nm + range_ * Lit(self.law.scale_ppm, PPM)
        return Interval(reflector.place - range_, bound + forward, bound + backward)

    def fix(self, reflector: Reflector, range_: Num, error: Num) -> Interval:
        """What it says whatever the systematic error is that may be there."""
        bare, (long, short) = self.bare(reflector, range_, error), self.open
        return Interval(bare.position, bare.above + long, bare.below + short)

    def alone(self, reflector: Reflector) -> Bool:
        """No other reflector of the model can be heard: from where the vehicle may be, with the minimum intensity."""
        forward, backward = self.lag
        place, clear = exact_to(reflector.place, NM), exact_to(reflector.clear, NM) - self.law.accuracy_nm
        behind = place - self.window.low + forward
        ahead = self.window.high - place + backward + self.law.strong_nm
        return (clear > behind) & (clear > ahead)

    def fine(self, fix: Interval) -> Bool:
        """A self-test with this echo leaves no more open than may be charged, and the position stays tolerable."""
        spread = self.known.width + fix.width
        return (spread <= self.law.left_open_nm) & fix.widened(spread).within(self.law.tolerance_nm, self.law.limit_mm)


@dataclass(frozen=True, eq=False)
class Judgement:
    """One echo, judged for one reflector: the interval it gives, without and with what is charged for the radar's systematic
    error, and the verdict."""

    slot: Slot
    bare: Interval
    fix: Interval
    verdict: Num

    @cached_property
    def fits(self) -> Bool:
        """It passed every check."""
        return self.verdict.eq(FITS)


def judge(slot: Slot, reflector: Reflector, searched: Bool, now: Situation) -> Judgement:
    """The echo as a measurement of the reflector."""
    law, fix = now.law, now.fix(reflector, slot.range.value, slot.error)
    bare = now.bare(reflector, slot.range.value, slot.error)
    room = exact_to(reflector.clear, NM) - now.window.width
    apart = (room > fix.above * 2) & (room > fix.below * 2)
    alone = ite(now.testing, now.alone(reflector), apart)
    fine = fix.within(law.tolerance_nm, law.limit_mm) & now.testing.implies(now.fine(fix))
    verdict = first_of(
        (~slot.range.present, NONE),
        (~now.frame, NO_FRAME),
        (slot.intensity < law.minimum_intensity_cdb, WEAK),
        (slot.model.ne(reflector.model), OTHER_MODEL),
        (slot.range.value < law.near_mm, TOO_CLOSE),
        (~searched, NOT_SEARCHED),
        (~fine, TOO_COARSE),
        (~(now.testing | bare.meets(now.by_radar)), OUT_OF_WINDOW),
        (~alone, AMBIGUOUS),
        default=FITS,
    )
    return Judgement(slot, bare, fix, verdict)


@dataclass(frozen=True, eq=False)
class Recognition:
    """All echoes of a frame, judged for one reflector."""

    judgements: tuple[Judgement, ...]
    reflector: Reflector
    now: Situation

    @cached_property
    def conflict(self) -> Bool:
        """Another echo fits as well, and excludes the chosen one: neither is believed. What is wrong with all is in both."""
        return any_of(one.fits & ~one.bare.meets(self.bare) for one in self.judgements[1:])

    @cached_property
    def accepted(self) -> Bool:
        """The reflector is measured in this cycle."""
        return any_of(one.fits for one in self.judgements) & ~self.conflict

    @cached_property
    def bare(self) -> Interval:
        """The interval of the chosen echo, if the radar has no systematic error; only while `accepted`."""
        return self.now.bare(self.reflector, self.range, self.error)

    @cached_property
    def fix(self) -> Interval:
        """The same, charged for the systematic error that it may have."""
        return self.now.fix(self.reflector, self.range, self.error)

    def of_chosen(self, terms: list[Num]) -> Num:
        """One term a slot: that of the chosen echo, the first that fits (the front end puts the strongest first)."""
        result = terms[-1]
        for term, one in list(zip(terms, self.judgements, strict=True))[-2::-1]:
            result = ite(one.fits, term, result)
        return result

    @cached_property
    def range(self) -> Num:
        """The measured range, mm; only while `accepted`."""
        return self.of_chosen([one.slot.range.value for one in self.judgements])

    @cached_property
    def error(self) -> Num:
        """Its error bound, mm; only while `accepted`."""
        return self.of_chosen([one.slot.error for one in self.judgements])

    @cached_property
    def lateral(self) -> Num:
        """The lateral place of the chosen echo, mm; only while `accepted`."""
        return self.of_chosen([one.slot.lateral for one in self.judgements])


def recognise(slots: tuple[Slot, ...], reflector: Reflector, searched: Bool, now: Situation) -> Recognition:
    """Judge a frame for one reflector."""
    return Recognition(tuple(judge(one, reflector, searched, now) for one in slots), reflector, now)
