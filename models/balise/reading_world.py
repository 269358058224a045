"""The physics of a group reading and of the direction of running, for the worlds of all machines that read groups.

Figures and terms are the world's own: nothing here is what a machine computes.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from safeloc.language.expr import (
    Bool,
    BoolVar,
    Expr,
    Num,
    NumVar,
    Optional,
    Var,
    all_of,
    as_num,
    between,
    exact_to,
    ite,
    maximum,
    minimum,
    with_unit,
)
from safeloc.language.units import MM, NM, NM_PER_MM
from safeloc.language.world import Law
from safeloc.models.balise.telegram import PASSED, Reading
from safeloc.models.vocabulary.measuring_world import THOUSAND


def read_rightly(read: Reading) -> Bool:
    """Return whether every balise of a group was read, with right check bits."""
    parts = (read.check, read.group, read.link, read.read, read.total, read.last, read.first, read.age)
    return all_of([*(one.present for one in parts), read.check.value.eq(PASSED), read.total.value.eq(read.read.value)])


def _rolled_after(rolled: Num, backwards: Bool, ran: Num, reversal_mm: int) -> tuple[Num, Bool]:
    """Return the distance run against the direction without a break, mm, and the direction, after a cycle.

    The vehicle has turned once it ran farther than D_NVROLL (`reversal_mm`) against its direction without a break, as measured.

    rolled, backwards  the same before the cycle
    ran                the run measured in the cycle, mm
    """
    against = maximum(rolled + ite(backwards, ran, 0 - ran), 0)
    turns = reversal_mm < against
    turned = (backwards & ~turns) | (turns & ~backwards)
    return ite(turns, as_num(0, MM), against), turned


@dataclass(frozen=True, eq=False)
class Rolling:
    """The direction of running as the world keeps it (`_rolled_after`).

    rolled, backwards  ghosts: the distance run against the direction without a break, mm, and the direction
    ran                the run measured in the cycle, mm
    """

    rolled: NumVar
    backwards: BoolVar
    ran: Num
    reversal_mm: int

    @cached_property
    def _after(self) -> tuple[Num, Bool]:
        return _rolled_after(self.rolled, self.backwards, self.ran, self.reversal_mm)

    @property
    def moves(self) -> dict[Var, Expr]:
        """The moves of the two ghosts."""
        return dict(zip((self.rolled, self.backwards), self._after, strict=True))

    @property
    def runs_back(self) -> Bool:
        """The vehicle runs backwards at the end of the cycle."""
        return self._after[1]


def accuracy_sent(received: Optional, before: Num) -> Num:
    """Return the national location accuracy in force, mm: the one received in this cycle, else the one `before`."""
    return ite(~received.present, before, received.value)


def antenna_law(read: Reading, off: Num, detection_mm: int) -> Law:
    """Return the law of the antenna; `off`: how far the antenna stood beyond balise 1 of the group that is read, nm."""
    most = detection_mm * NM_PER_MM
    return Law(
        read_rightly(read).implies(between(-most, off, most)),
        "When a telegram with right check bits is read, the antenna stands over balise 1 of its group within the detection "
        "accuracy; the antenna is so far behind the front end as configured.",
        ("antenna_mm", "detection_mm"),
        "[M, sure] safety-related detection accuracy 1 m (SUBSET-036)",
        "supplier",
        "type test of reader and antenna; the antenna's place when the vehicle is commissioned",
    )


def counted_wrong_nm(read: Reading, rate_ppm: int) -> Num:
    """Return the greatest error of the counted run since the reading, nm."""
    since = read.since.value
    return with_unit(maximum(since, 0 - since) * rate_ppm, NM)


def run_in_age_nm(read: Reading, max_speed_mm_s: int) -> Num:
    """Return the run at the highest speed in the age of the reading, nm; mm/s x ms x 1000 = nm."""
    return with_unit(read.age.value * (max_speed_mm_s * THOUSAND), NM)


def counter_law(read: Reading, true_since: NumVar, wander_change: Num, rate_ppm: int) -> Law:
    """Return the law of the latched counter.

    true_since     the true run since the reading, nm
    wander_change  the change of the odometer's one-off error since then, nm
    """
    error, most = true_since - exact_to(read.since.value, NM) - wander_change, counted_wrong_nm(read, rate_ppm)
    return Law(
        (read_rightly(read) & read.since.present).implies(between(-most, error, most)),
        "The run since the reading, as the latched counter measures it, is wrong by no more than the odometer's rate and the "
        "change of its one-off error since then.",
        ("rate_ppm", "constant_mm"),
        "[D] the same wheel counts",
        "supplier",
        "type test; the run between two groups against the map",
    )


def age_law(
    read: Reading,
    true_since: NumVar,
    true_cycle_distance: NumVar,
    *,
    period_ms: int,
    max_speed_mm_s: int,
    measuring_step_mm: int,
) -> Law:
    """Return the law of the age of a reading without a counter.

    true_since           the true run since the reading, nm
    true_cycle_distance  the true run of the cycle, nm: what the odometer measures of it may point the other way
    """
    farthest, least = run_in_age_nm(read, max_speed_mm_s), as_num(measuring_step_mm * NM_PER_MM, NM)
    back, forth = minimum(true_cycle_distance, 0) - least, maximum(true_cycle_distance, 0) + least
    fresh = read.age.value < period_ms + 1
    timed = between(0 - farthest - least, true_since, farthest + least)
    return Law(
        (read_rightly(read) & ~read.since.present).implies(timed & fresh.implies(between(back, true_since, forth))),
        "Since the reading the vehicle ran no farther than at its highest speed for the age of the reading, and one measuring "
        "step. If the reading was taken in this cycle, the vehicle ran since then no farther than in the cycle, and in its direction, "
        "but for a measuring step. What the odometer measures of the cycle may point the other way, as far as its law allows.",
        ("max_speed_mm_s", "measuring_step_mm", "period_ms"),
        "[D] highest speed; no vehicle turns within a cycle but by a measuring step",
        "supplier",
        "type test of reader and time stamp",
    )
