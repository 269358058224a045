"""Configuration and variables of the guard of a receiver, and the reasons for which it withholds a fix."""

from __future__ import annotations

from pydantic import model_validator

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import NumVar, boolean, choice, enumeration, members, number, optional
from safeloc.language.machine import ANY
from safeloc.language.units import COUNT, MM, MM_S, MS, NM, NM_PER_MM, PER_MILLE, UM_PER_MM, UM_S

FARTHEST_OFF_MM = 10_000_000
"""A fix farther off every track than this is handed in as the fault OFF_TRACK."""

FAULT = members(
    "fault",
    "NONE", "NO_FIX", "MALFORMED", "NOT_FINITE", "STALE", "FUTURE", "DUPLICATE", "OUT_OF_ORDER", "OFF_TRACK",
)  # fmt: skip
NO_FAULT = FAULT[0]
JUDGED = members(
    "judged",
    "NOTHING", "PASSED", "UNCONFIRMED", "NO_FIX", "MALFORMED", "NOT_FINITE", "STALE", "FUTURE", "DUPLICATE",
    "OUT_OF_ORDER", "OFF_TRACK", "AMBIGUOUS", "TOO_COARSE", "JUMP", "SPEED_DISAGREES", "DOUBTFUL",
    "ACROSS", "AGAINST", "OUT_OF_REACH",
)  # fmt: skip
NOTHING, PASSED, UNCONFIRMED = JUDGED[:3]
OFF_TRACK, AMBIGUOUS, TOO_COARSE, JUMP, SPEED_DISAGREES, DOUBTFUL, ACROSS, AGAINST, OUT_OF_REACH = JUDGED[-9:]

HALF_TURN_MRAD = 3_142
"""Half a turn, rounded up: the course of what runs straight against the way."""
QUARTER_TURN_MRAD = 1_571
"""A quarter of a turn: what runs against the way differs from its direction by more."""


class GuardConfig(Config):
    """Limits by map and motion, and the number of fixes that have to agree with both before one is passed on."""

    period_ms: int = quantity(100, "ms", 2, 2_000, "[D] a step of the guard; a multiple of 2")
    tolerance_mm: int = quantity(30_000, "mm", 2, 500_000, "[S] OCORA 7239: 30 m on main line")
    window_limit_mm: int = quantity(
        60_000, "mm", 2, 10_000_000, "[D] greatest half width of the window; a wider one is given up"
    )
    max_speed_mm_s: int = quantity(44_445, "mm/s", 1, 138_889, "[D] 160 km/h")
    acceleration_mm_s2: int = quantity(1_500, "mm/s2", 1, 10_000, "[D] 1.5 m/s2, passenger")
    brake_mm_s2: int = quantity(1_500, "mm/s2", 1, 10_000, "[M] the strongest brake, emergency brake included")
    fix_error_mm: int = quantity(10_000, "mm", 1, 500_000, "[M] along the track, of a fix on the track's axis")
    offset_charge_permille: int = quantity(1_500, "per mille", 0, 100_000, "[M] further error, of the distance off")
    offset_limit_mm: int = quantity(10_000, "mm", 0, 1_000_000, "[M] most distance off the track")
    track_clearance_mm: int = quantity(
        30_000, "mm", 0, 1_000_000, "[M] a fix nearer than this to two tracks does not decide between them"
    )
    speed_error_mm_s: int = quantity(1_000, "mm/s", 1, 20_000, "[M] of the receiver's own speed")
    confirmations: int = quantity(5, "fixes", 2, 100, "[M] fixes in a row that must agree with map and motion")
    course_limit_mrad: int = quantity(
        262,
        "mrad",
        1,
        QUARTER_TURN_MRAD - 1,
        "[D] 15 degrees: 9.5 of a 1:6 switch, and the error of a course over course_base_mm",
    )
    course_base_mm: int = quantity(20_000, "mm", 1_000, 1_000_000, "[D] distance between two fixes that give a course")
    course_age_ms: int = quantity(10_000, "ms", 100, 600_000, "[D] most between them; with 20 m: 2 m/s and more")
    rollback_mm: int = quantity(5_000, "mm", 0, 1_000_000, "[S] D_NVROLL 2 m (SUBSET-026 A.3.2), and the way to stop")
    speed_window_ms: int = quantity(4_000, "ms", 4, 60_000, "[D] time over which distance gives speed")
    max_age_ms: int = quantity(1_000, "ms", 0, 60_000, "[M] an older fix is stale")
    position_limit_mm: int = quantity(1_000_000_000, "mm", 1_000, 10_000_000_000, "[D] 1 000 km of line")

    @model_validator(mode="after")
    def _can_pass(self) -> GuardConfig:
        if self.period_ms % 2:
            raise ValueError("period_ms must be even, so that half of an acceleration's way is whole nanometres.")
        if self.worst_error_mm > self.tolerance_mm - 2:
            raise ValueError(
                f"a fix at offset_limit_mm has an error bound of {self.worst_error_mm} mm, which is not within tolerance_mm "
                f"{self.tolerance_mm} less 2: lower fix_error_mm, offset_charge_permille or offset_limit_mm."
            )
        if self.track_clearance_mm < self.offset_limit_mm:
            raise ValueError("track_clearance_mm must not be less than offset_limit_mm: a true fix may be off by that.")
        if self.window_limit_mm < self.tolerance_mm:
            raise ValueError("window_limit_mm must not be less than tolerance_mm.")
        if not 2 <= self.window_steps <= 100:
            raise ValueError(f"speed_window_ms is {self.window_steps} steps of period_ms; it must be 2 to 100.")
        return self

    @property
    def worst_error_mm(self) -> int:
        """Error bound of a fresh fix at the offset limit."""
        return self.fix_error_mm - -self.offset_limit_mm * self.offset_charge_permille // 1_000

    @property
    def window_steps(self) -> int:
        """Steps over which speed is told from distance."""
        return self.speed_window_ms // self.period_ms

    @property
    def speed_change_um_s(self) -> int:
        """The greatest change of speed in a step, whichever way the vehicle runs."""
        return max(self.acceleration_mm_s2, self.brake_mm_s2) * self.period_ms

    @property
    def speed_rise_um_s(self) -> int:
        """The greatest gain of speed in a step."""
        return self.acceleration_mm_s2 * self.period_ms

    @property
    def way_nm(self) -> int:
        """The greatest way that a change of speed adds in a step, a T^2 / 2."""
        return self.speed_change_um_s * self.period_ms // 2

    def lag_nm(self, steps: int) -> int:
        """Return the most by which the distance of so many steps differs from the speed at their end times their duration."""
        return steps * self.way_nm + self.speed_change_um_s * self.period_ms * steps * (steps + 1) // 2


class Parts:
    """The variables of one guard.

    advance        input: a period has passed since the step before; else it is the same instant
    fault          input: why what was delivered is no fix; NONE with a fix, and with nothing
    fix, offset, age, ambiguous, elsewhere, speed
                   input: place along the way, distance off the track, age of the fix; other tracks are as near; no way
                   leads there from where the vehicle can be; the receiver's own speed, without direction
    course         input: the angle between the course over ground and the way's direction, mrad; absent where none is told
    forwards_only  input: the way is run in its own direction only; a vehicle is back by rollback_mm at most
    start_anew     input: the host says that no place known before counts any longer
    low .. fast    where the vehicle is and how fast, nm and um/s (while recovering: if the last fix is true)
    anchor_*       where it was some steps ago, from which speed is told
    agreed_fixes         fixes in a row that kept every gate, up to the number asked for
    near_*         where the vehicle is if the last fix near the way is true, nm; the whole line before the first one
    fair_fixes           fixes in a row that map, course and the place last known allow, up to the number asked for
    known_*        where the vehicle is since a row was last full, nm: by direction and highest speed alone, also while nothing is
                   held; the whole line before the first full row. It has been at known_low, and may be rollback_mm behind it
    truth, true_speed, run   ghosts: nm, um/s, and nm since the anchor
    heard_*, row   ghosts: the same of the last fix near the way, and how many in a row each follow from the one before
    sure_*         ghosts: the same of the fixes that the law of the receiver speaks of
    """

    def __init__(self, config: GuardConfig, truth: NumVar | None = None) -> None:
        self.declared = declared = Declared()
        limit, fast = config.position_limit_mm, config.max_speed_mm_s * UM_PER_MM
        reach = reach_nm(config)
        most = 2 * fast * config.period_ms * config.window_steps
        self.config = config
        self.advance = declared.sensor(boolean("advance"))
        self.fault = declared.sensor(choice("fault", enumeration(FAULT)))
        self.fix = declared.sensor(optional("fix_mm", MM, -limit, limit))
        self.offset = declared.sensor(number("fix_offset_mm", MM, 0, FARTHEST_OFF_MM))
        self.age = declared.sensor(number("fix_age_ms", MS, 0, config.max_age_ms + config.period_ms))
        self.ambiguous = declared.sensor(boolean("fix_ambiguous"))
        self.elsewhere = declared.sensor(boolean("fix_elsewhere"))
        self.speed = declared.sensor(optional("fix_speed_mm_s", MM_S, 0, 1_000_000))
        self.course = declared.sensor(optional("fix_course_mrad", PER_MILLE, 0, HALF_TURN_MRAD))
        self.forwards_only = declared.sensor(boolean("forwards_only"))
        self.start_anew = declared.sensor(boolean("start_anew"))
        self.low = declared.state(number("low_nm", NM, -reach, reach), first=0)
        self.high = declared.state(number("high_nm", NM, -reach, reach), first=0)
        self.slow = declared.state(number("slow_um_s", UM_S, -fast, fast), first=0)
        self.fast = declared.state(number("fast_um_s", UM_S, -fast, fast), first=0)
        self.anchor_low = declared.state(number("anchor_low_nm", NM, -reach, reach), first=0)
        self.anchor_high = declared.state(number("anchor_high_nm", NM, -reach, reach), first=0)
        self.anchor_steps = declared.state(number("anchor_steps", COUNT, 0, config.window_steps - 1), first=0)
        self.agreed_fixes = declared.state(number("agreed_fixes", COUNT, 0, config.confirmations), first=0)
        self.fair_fixes = declared.state(number("fair_fixes", COUNT, 0, config.confirmations), first=0)
        self.near_low = declared.state(number("near_low_nm", NM, -reach, reach), first=-reach)
        self.near_high = declared.state(number("near_high_nm", NM, -reach, reach), first=reach)
        self.known_low = declared.state(number("known_low_nm", NM, -reach, reach), first=-reach)
        self.known_high = declared.state(number("known_high_nm", NM, -reach, reach), first=reach)
        self.last_verdict = declared.state(choice("last_verdict", enumeration(JUDGED)), first=NOTHING)
        place = number("truth_nm", NM, -2 * reach, 2 * reach) if truth is None else truth
        self.truth = declared.ghost(place, first=ANY)
        self.true_speed = declared.ghost(number("true_speed_um_s", UM_S, -fast, fast), first=ANY)
        self.run = declared.ghost(number("run_nm", NM, -most, most), first=0)
        self.last_fix_low = declared.ghost(number("last_fix_low_nm", NM, -reach, reach), first=-reach)
        self.last_fix_high = declared.ghost(number("last_fix_high_nm", NM, -reach, reach), first=reach)
        self.row_fixes = declared.ghost(number("row_fixes", COUNT, 0, config.confirmations), first=0)
        self.sure_low = declared.ghost(number("sure_low_nm", NM, -reach, reach), first=-reach)
        self.sure_high = declared.ghost(number("sure_high_nm", NM, -reach, reach), first=reach)
        self.next_truth = declared.choice(number("next_truth_nm", NM, -2 * reach, 2 * reach))
        self.next_speed = declared.choice(number("next_speed_um_s", UM_S, -fast, fast))


def parts(config: GuardConfig, *, truth: NumVar | None = None) -> Parts:
    """Return fresh variables for one machine; `truth`: the true place, if another machine's world moves the vehicle."""
    return Parts(config, truth)


def reach_nm(config: GuardConfig) -> int:
    """Return the farthest places that an interval may contain: the line, and a window at its end."""
    return (config.position_limit_mm + 2 * config.window_limit_mm) * NM_PER_MM
