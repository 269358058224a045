"""Echoes of one radar frame: which of them is the target's (RFL-2, RFL-10).

The signal front end makes a few candidate echoes from the measured image, each in a slot: distance along the track (by time
of flight), error bound of it, model by signature, intensity. The machine takes an echo for the target's only if it has the
minimum intensity, the target's model and a range that fits the interval known so far, and if no other reflector of that
model could stand there. Any other echo comes from a thing beside the track.

A range has three errors: the echo's own, one in proportion to the range (the radar's scale), and a systematic one of any
size. Each interval includes the part of the systematic error that the last self-test could not exclude. During a self-test
nothing is known of the systematic error: an echo counts at any range, provided that the radar can receive no other
reflector of the model.
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
    """One candidate echo: inputs, and the verdicts on it as an echo of the target and of the next reflector.

    range    distance along the track from radar to origin, mm; absent where the slot is empty
    lateral  distance of the origin from the vehicle's axis, mm, positive to the left
    """

    number: int
    range: Optional
    error: NumVar
    model: NumVar
    intensity: NumVar
    lateral: NumVar
    last_verdict: NumVar
    last_verdict_for_next: NumVar


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
        declared.state(choice(f"{name}_last_verdict", enumeration(JUDGED)), first=NONE),
        declared.state(choice(f"{name}_last_verdict_for_next", enumeration(JUDGED)), first=NONE),
    )


@dataclass(frozen=True)
class RadarLaw:
    """The figures that echoes are judged by: the radar's, and the accuracy of the survey of reflectors."""

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
    """The terms of a cycle that its echoes are judged by.

    window    interval without an echo
    by_radar  places at which a radar with its systematic error may measure end A, by `window`
    lag       the most that the vehicle may have run (forwards, backwards) since the frame was taken, nm
    testing   a self-test is under way: the echo tests the radar
    known     interval known without the radar; only while `testing`
    open      the most by which the radar may measure too long, and too short, nm; 0 while `testing`
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
        """Return the interval of end A at the end of the cycle by a range and its error bound, mm, of a radar without systematic error."""
        forward, backward = self.lag
        bound = exact_to(error, NM) + self.law.accuracy_nm + range_ * Lit(self.law.scale_ppm, PPM)
        return Interval(reflector.place - range_, bound + forward, bound + backward)

    def fix(self, reflector: Reflector, range_: Num, error: Num) -> Interval:
        """Return the same interval, widened by the systematic error that the radar may have."""
        bare, (long, short) = self.bare(reflector, range_, error), self.open
        return Interval(bare.position, bare.above + long, bare.below + short)

    def alone(self, reflector: Reflector) -> Bool:
        """Return whether the radar can receive no other reflector of the model with the minimum intensity, from anywhere in the window."""
        forward, backward = self.lag
        place, clear = exact_to(reflector.place, NM), exact_to(reflector.clear, NM) - self.law.accuracy_nm
        behind = place - self.window.low + forward
        ahead = self.window.high - place + backward + self.law.strong_nm
        return (clear > behind) & (clear > ahead)

    def fine(self, fix: Interval) -> Bool:
        """Return whether a self-test with this echo excludes enough of the radar's error, and the position stays tolerable."""
        spread = self.known.width + fix.width
        return (spread <= self.law.left_open_nm) & fix.widened(spread).within(self.law.tolerance_nm, self.law.limit_mm)


@dataclass(frozen=True, eq=False)
class Judgement:
    """One echo, judged for one reflector.

    bare, fix  the interval that it gives, without and with the systematic error that the radar may have
    verdict    FITS, or the reason why the echo is not taken for the reflector's
    """

    slot: Slot
    bare: Interval
    fix: Interval
    verdict: Num

    @cached_property
    def fits(self) -> Bool:
        """The echo passed every check."""
        return self.verdict.eq(FITS)


def judge(slot: Slot, reflector: Reflector, searched: Bool, now: Situation) -> Judgement:
    """Judge the echo as a measurement of the reflector."""
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
        """Another echo fits as well and excludes the chosen one: neither counts. The systematic error, being in both, is left out."""
        return any_of(one.fits & ~one.bare.meets(self.bare) for one in self.judgements[1:])

    @cached_property
    def accepted(self) -> Bool:
        """An echo measures the reflector in this cycle."""
        return any_of(one.fits for one in self.judgements) & ~self.conflict

    @cached_property
    def bare(self) -> Interval:
        """The interval of the chosen echo, if the radar has no systematic error; only while `accepted`."""
        return self.now.bare(self.reflector, self.range, self.error)

    @cached_property
    def fix(self) -> Interval:
        """The same, widened by the systematic error that the radar may have."""
        return self.now.fix(self.reflector, self.range, self.error)

    def of_chosen(self, terms: list[Num]) -> Num:
        """Return, of one term a slot, that of the chosen echo: the first that fits (the front end puts the strongest first)."""
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
        """Error bound of the measured range, mm; only while `accepted`."""
        return self.of_chosen([one.slot.error for one in self.judgements])

    @cached_property
    def lateral(self) -> Num:
        """Lateral place of the chosen echo's origin, mm; only while `accepted`."""
        return self.of_chosen([one.slot.lateral for one in self.judgements])


def recognise(slots: tuple[Slot, ...], reflector: Reflector, searched: Bool, now: Situation) -> Recognition:
    """Judge a frame for one reflector."""
    return Recognition(tuple(judge(one, reflector, searched, now) for one in slots), reflector, now)
