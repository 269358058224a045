"""Achieved separation of two trains whose movement authority ends at virtual sections: a figure of the configuration.

Small sections approach moving block (source 003, l. 620-631). The distance from the front of the train behind to the
rear of the train ahead, both at one speed, consists of:

    a section's length      the section that the train ahead still touches is not clear, wherever its rear end is in it
    the rear's interval     accuracy, and the run of both trains while a report grows old
    the cycle               a section is reported clear at the end of the cycle in which it becomes clear
    delivery and reaction   from the report to the brake: the train behind runs on
    the braking distance    to a stand before the first section that is not clear

The machines prove that a clear section is clear; a train's own supervision keeps it away from sections that are not.
"""

from __future__ import annotations

from safeloc.config import Config, quantity
from safeloc.language.units import MS_PER_S
from safeloc.models.area import AreaConfig


class Following(Config):
    """Two trains, one behind the other."""

    speed_mm_s: int = quantity(44_445, "mm/s", 1, 138_889, "[D] 160 km/h, both of them")
    section_mm: int = quantity(500_000, "mm", 0, 100_000_000, "[D] length of the virtual sections; 0: moving block")
    accuracy_mm: int = quantity(40_000, "mm", 0, 10_000_000, "[D] of a train's end: 35 m and what is added, signals.md")
    delivery_ms: int = quantity(1_000, "ms", 0, 600_000, "[M] from a section's report to the authority on board")
    reaction_ms: int = quantity(3_000, "ms", 0, 60_000, "[M] on-board reaction and build-up of the brake")
    brake_mm_s2: int = quantity(700, "mm/s2", 1, 5_000, "[M] service brake")
    train_mm: int = quantity(200_000, "mm", 0, 10_000_000, "[D] length of the train ahead")

    @property
    def braking_mm(self) -> int:
        """Braking distance, mm rounded up."""
        return _up(self.speed_mm_s**2, 2 * self.brake_mm_s2)


def separation_mm(area: AreaConfig, following: Following) -> int:
    """Return the least distance from a train's front to the rear of the one ahead that never hinders it, mm, rounded up."""
    speed, age = following.speed_mm_s, area.report_age_limit_ms
    aged = _up((speed + area.max_speed_mm_s) * age, MS_PER_S)
    run = _up(speed * (area.period_ms + following.delivery_ms + following.reaction_ms), MS_PER_S)
    return following.section_mm + following.accuracy_mm + aged + run + following.braking_mm


def headway_ms(area: AreaConfig, following: Following) -> int:
    """Return the time from one train's front to the next one's at one place, ms, rounded up."""
    return _up((separation_mm(area, following) + following.train_mm) * MS_PER_S, following.speed_mm_s)


def _up(value: int, divisor: int) -> int:
    return -(-value // divisor)
