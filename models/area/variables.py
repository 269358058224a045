"""Configuration and variables of a line area."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.config import Config, quantity
from safeloc.language.expr import BoolVar, NumVar, boolean, number
from safeloc.language.units import COUNT, MM, UM
from safeloc.models.area.slot import Reach, Slot, slot


class AreaConfig(Config):
    """What the area machine depends on.

    integrity_is_trusted  a train that reports itself whole is believed at both ends; if not, at the end that leads only, and
                          the ground behind it is cleared when it was counted out, or the area was swept
    """

    trains: int = quantity(3, "count", 1, 16, "[D] trains at a time in 10 to 40 km")
    period_ms: int = quantity(1_000, "ms", 10, 10_000, "[S] Wiesmeyr 2020: one position a second")
    max_speed_mm_s: int = quantity(44_445, "mm/s", 1, 138_889, "[D] 160 km/h")
    report_age_limit_ms: int = quantity(1_000, "ms", 0, 60_000, "[S] EUG 22E126: no data older than 1 s")
    count_limit: int = quantity(3_600, "cycles", 1, 1_000_000, "[D] how far waiting times are counted")
    limit_mm: int = quantity(100_000_000, "mm", 1_000, 1_000_000_000, "[D] 100 km to either side")
    integrity_is_trusted: bool = True

    @property
    def reach(self) -> Reach:
        """How far anything gets."""
        cycle = -(-self.max_speed_mm_s * self.period_ms // 1_000)
        return Reach(cycle, self.max_speed_mm_s, self.report_age_limit_ms, self.limit_mm)


@dataclass(frozen=True, eq=False)
class Parts:
    """The variables of the machine.

    low_end, high_end  the axle counters, mm: fixed, any two places
    healthy, clear     the axle counters: undisturbed; no axle is counted in
    loose_low, loose_high  where loose vehicles may be, rear to front
    loose, loose_rear, loose_front  ghosts: some loose vehicle is in the area, and where, um
    """

    config: AreaConfig
    slots: tuple[Slot, ...]
    low_end: NumVar
    high_end: NumVar
    healthy: BoolVar
    clear: BoolVar
    loose_low: NumVar
    loose_high: NumVar
    rejected: NumVar
    loose: BoolVar
    loose_rear: NumVar
    loose_front: NumVar
    next_loose: BoolVar
    next_loose_rear: NumVar
    next_loose_front: NumVar


def parts(config: AreaConfig) -> Parts:
    """Fresh variables for one machine."""
    limit, reach = config.limit_mm, config.reach
    far, step = limit * 1_000, reach.cycle_mm * 1_000
    return Parts(
        config,
        tuple(
            slot(n, reach, config.count_limit, integrity_is_trusted=config.integrity_is_trusted)
            for n in range(1, config.trains + 1)
        ),
        number("low_end_mm", MM, -limit, limit),
        number("high_end_mm", MM, -limit, limit),
        boolean("counters_healthy"),
        boolean("counters_clear"),
        number("loose_low_mm", MM, -limit, limit),
        number("loose_high_mm", MM, -limit, limit),
        number("rejected_events", COUNT, 0, config.trains),
        boolean("loose_there"),
        number("loose_rear_um", UM, -far, far),
        number("loose_front_um", UM, -far, far),
        boolean("next_loose_there"),
        number("next_loose_rear_um", UM, -far - step, far + step),
        number("next_loose_front_um", UM, -far - step, far + step),
    )
