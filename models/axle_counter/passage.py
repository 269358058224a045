"""Inputs, state and configuration of the entry record: reported axles, and bounds of speed and run between them."""

from __future__ import annotations

from pydantic import model_validator

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import boolean, choice, enumeration, members, number, optional
from safeloc.language.machine import ANY
from safeloc.language.units import COUNT, MM_S, MS_PER_S, NM, UM, UM_PER_MM, UM_S
from safeloc.models.axle_head import AXLE, NO_AXLE

_FLAW = members(
    "flaw",
    "NONE",
    "POWER_UP",
    "HEAD_FAULT",
    "NO_SPEED",
    "SPEED_CONTRADICTED",
    "TURNED",
    "TOO_MANY",
    "TOO_LONG",
    "LENGTH_UNKNOWN",
    "MAYBE_ANOTHER_TRAIN",
    "HEAD_DAMPED",
)
(
    SOUND, POWER_UP, HEAD_FAULT, NO_SPEED, SPEED_CONTRADICTED, TURNED, TOO_MANY, TOO_LONG, LENGTH_UNKNOWN,
    MAYBE_ANOTHER_TRAIN, HEAD_DAMPED,
) = _FLAW  # fmt: skip


class AxleCounterConfig(Config):
    """Figures of the record."""

    period_ms: int = quantity(100, "ms", 1, 1_000, "[S] EVC cycles <= 100 ms; several axles may pass in one")
    max_speed_mm_s: int = quantity(100_000, "mm/s", 1, 138_889, "[M, sure] 350 km/h, rounded up")
    change_mm_s2: int = quantity(1_500, "mm/s2", 1, 5_000, "[M, fairly sure] traction and brake, figures section 2")
    axles_a_cycle: int = quantity(10, "axles", 1, 400, "[D] 1.8 m apart at 350 km/h in 100 ms: 6, with room")
    axle_gap_mm: int = quantity(
        20_000, "mm", 1_000, 50_000, "[M] longest distance between two axles of a train, as counted: late_mm included"
    )
    axle_limit: int = quantity(1_000, "axles", 2, 100_000, "[D] trains of 250 wagons")
    length_limit_mm: int = quantity(1_500_000, "mm", 10_000, 10_000_000, "[M] longest train")
    length_spread_mm: int = quantity(20_000, "mm", 1, 1_000_000, "[D] wider bounds give no length")

    late_mm: int = quantity(
        650,
        "mm",
        0,
        10_000,
        "[D] run beyond the head of a wheel that a channel counts late: 610 mm, proved with counting_head",
    )
    headway_ms: int = quantity(
        30_000, "ms", 1_000, 3_600_000, "[M, fairly sure] trains that follow each other: a minute"
    )

    @model_validator(mode="after")
    def _a_train_is_heard(self) -> AxleCounterConfig:
        if self.pause_cycles < 1:
            raise ValueError(f"headway_ms ({self.headway_ms}) has to be at least twice period_ms ({self.period_ms}).")
        return self

    @model_validator(mode="after")
    def _a_train_passes(self) -> AxleCounterConfig:
        if self.surest_run_um <= self.axle_gap_mm * UM_PER_MM:
            raise ValueError(
                f"after {self.surest_run_um // UM_PER_MM} mm at most, a train with max_speed_mm_s "
                f"{self.max_speed_mm_s} and change_mm_s2 {self.change_mm_s2} may have stopped. So it never "
                f"certainly runs farther than axle_gap_mm {self.axle_gap_mm}, and no record can come; raise the "
                "speed, or lower the change or the gap."
            )
        return self

    @model_validator(mode="after")
    def _a_length_is_known(self) -> AxleCounterConfig:
        if 2 * self.late_mm >= self.length_spread_mm:
            raise ValueError(
                f"late_mm ({self.late_mm}) at either end of a train takes all of length_spread_mm ({self.length_spread_mm}), so that no length is "
                "known and no record can come; raise length_spread_mm above twice late_mm, or lower late_mm."
            )
        return self

    @property
    def surest_run_um(self) -> int:
        """Greatest run since its last axle that is certain of a train, um: from the highest speed on, braking in every cycle."""
        cycles = max(1, (self.max_speed_mm_s - 1) // self.change_mm_s)
        slower = self.change_mm_s * (cycles * (cycles + 1) // 2 - 1)
        return ((cycles - 1) * self.max_speed_mm_s - slower) * self.period_ms

    @property
    def pause_cycles(self) -> int:
        """Pause, in cycles, after which the next axle may be another train's; both axles may lie at the edges of their cycles."""
        return self.headway_ms // self.period_ms - 1

    @property
    def change_mm_s(self) -> int:
        """Greatest change of speed in one cycle, mm/s rounded up."""
        return -(-self.change_mm_s2 * self.period_ms // MS_PER_S)

    @property
    def run_limit_um(self) -> int:
        """Greatest run up to which the machine follows a passage, um."""
        step = self.max_speed_mm_s * self.period_ms
        return (self.length_limit_mm + self.axle_gap_mm) * UM_PER_MM + step


class Parts:
    """The variables of the machine.

    axle, axles_in_cycle     direction of the axles counted in this cycle (the same for all of them), and their number
    axle_speed_low, axle_speed_high       bounds of the speeds of all of them
    fault            the head is disturbed, or its two channels disagree
    damped           at the end of the cycle a wheel, or what takes its place, damps the head
    over             no train is on the counter; reported by the counters around, or by the operator
    speed_low, speed_high    bounds of the speed now
    run_low, run_high        bounds of the run since the first axle
    length_low, length_high  bounds of the run up to the last axle
    past_low                 lower bound of the run since the last axle
    pause                    cycles since the last axle
    speed, run, length, axles  ghosts: the train's speed, its run since the first axle, that run up to its last axle, its axles so
                               far; upwards along the line
    axle_true_speed                 ghost: its speed when the axle passed
    away                       ghost: the next axle belongs to another passage
    true_pause, last_axle_upwards            ghosts: cycles since the last axle; it passed upwards
    missed                     ghost: a damped head has left an axle uncounted, and no fault came since
    """

    def __init__(self, config: AxleCounterConfig) -> None:
        self.declared = declared = Declared()
        most, far, axles = config.max_speed_mm_s, config.run_limit_um, config.axle_limit
        step = 2 * most * config.period_ms * UM_PER_MM
        self.config = config
        self.axle = declared.sensor(choice("axle", enumeration(AXLE)))
        self.axles_in_cycle = declared.sensor(number("axles_in_cycle", COUNT, 1, config.axles_a_cycle))
        self.axle_speed_low = declared.sensor(optional("axle_speed_low_mm_s", MM_S, 0, most))
        self.axle_speed_high = declared.sensor(optional("axle_speed_high_mm_s", MM_S, 0, most))
        self.fault = declared.sensor(boolean("head_fault"))
        self.damped = declared.sensor(boolean("head_damped"))
        self.over = declared.sensor(boolean("passage_over"))
        self.speed_low = declared.state(number("speed_low_mm_s", MM_S, -most, most), first=0)
        self.speed_high = declared.state(number("speed_high_mm_s", MM_S, -most, most), first=0)
        self.run_low = declared.state(number("run_low_um", UM, -far, far), first=0)
        self.run_high = declared.state(number("run_high_um", UM, -far, far), first=0)
        self.length_low = declared.state(number("length_low_um", UM, -far, far), first=0)
        self.length_high = declared.state(number("length_high_um", UM, -far, far), first=0)
        self.past_low = declared.state(number("past_low_um", UM, -far, far), first=0)
        self.direction = declared.state(choice("direction", enumeration(AXLE)), first=NO_AXLE)
        self.axles_counted = declared.state(number("axles_counted", COUNT, 0, axles), first=0)
        self.pause = declared.state(number("pause_cycles", COUNT, 0, config.pause_cycles), first=0)
        self.flaw = declared.state(choice("flaw", enumeration(_FLAW)), first=POWER_UP)
        self.speed = declared.ghost(number("true_speed_um_s", UM_S, -most * UM_PER_MM, most * UM_PER_MM), first=ANY)
        self.run = declared.ghost(number("true_run_nm", NM, -(10**15), 10**15), first=0)
        self.length = declared.ghost(number("true_length_nm", NM, -(10**15), 10**15), first=0)
        self.axles = declared.ghost(number("true_axles", COUNT, 0, 2**31), first=0)
        self.away = declared.ghost(boolean("train_is_away"), first=True)
        self.true_pause = declared.ghost(
            number("true_pause_cycles", COUNT, 0, config.headway_ms // config.period_ms + 1), first=ANY
        )
        self.last_axle_upwards = declared.ghost(boolean("last_axle_upwards"), first=ANY)
        self.missed = declared.ghost(boolean("axle_missed"), first=False)
        self.next_true_speed = declared.choice(
            number("next_true_speed_um_s", UM_S, -most * UM_PER_MM, most * UM_PER_MM)
        )
        self.axle_true_speed = declared.choice(
            number("axle_true_speed_um_s", UM_S, -most * UM_PER_MM, most * UM_PER_MM)
        )
        self.true_cycle_distance = declared.choice(number("true_cycle_distance_nm", NM, -step, step))
        self.true_distance_to_axle = declared.choice(number("true_distance_to_axle_nm", NM, -step, step))
        self.true_axles_in_cycle = declared.choice(number("true_axles_in_cycle", COUNT, 0, config.axles_a_cycle))


def parts(config: AxleCounterConfig) -> Parts:
    """Return fresh variables for one counter."""
    return Parts(config)
