"""Configuration and variables of a line area."""

from __future__ import annotations

from typing import Literal

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import TRUE, Bool, boolean, number
from safeloc.language.machine import ANY, current_mode, modes
from safeloc.language.units import COUNT, MM, UM
from safeloc.models.area.followers import Followers, followers
from safeloc.models.area.inner import inner_sections
from safeloc.models.area.slot import Reach, slot


class AreaConfig(Config):
    """Figures of the area machine.

    integrity_is_trusted  a report that the train is whole is believed at both ends; if not, a report is believed at the leading end
                          only, and the ground behind the train becomes clear when it is counted out, or the area was swept
    borders               counted: axle counters at both ends count every vehicle in and out; occupancy: train detection says whether the
                          area is occupied, and whether it is clear just outside each end. Trains then tell themselves when they come in
                          and have left, and other vehicles may come in at an end that is not clear outside
    entry_report_delay_ms  where borders report occupancy alone: the longest time from a train's coming in until it is reported
    inner_detection       detection sections inside the area, at any places; each says whether it is clear
    """

    trains: int = quantity(3, "count", 1, 16, "[D] trains at a time in 10 to 40 km")
    period_ms: int = quantity(1_000, "ms", 10, 10_000, "[S] Wiesmeyr 2020: one position a second")
    max_speed_mm_s: int = quantity(44_445, "mm/s", 1, 138_889, "[D] 160 km/h")
    report_age_limit_ms: int = quantity(1_000, "ms", 0, 60_000, "[S] EUG 22E126: no data older than 1 s")
    count_limit: int = quantity(3_600, "cycles", 1, 1_000_000, "[D] how far waiting times are counted")
    limit_mm: int = quantity(100_000_000, "mm", 1_000, 1_000_000_000, "[D] 100 km to either side")
    integrity_is_trusted: bool = True
    borders: Literal["counted", "occupancy"] = "counted"
    entry_report_delay_ms: int = quantity(0, "ms", 0, 60_000, "[D] 0: in the cycle in which detection becomes occupied")
    inner_detection: int = quantity(
        0, "count", 0, 16, "[D] detection sections inside the area, such as those of stations"
    )

    @property
    def reach(self) -> Reach:
        """Limits of all motion."""
        cycle = -(-self.max_speed_mm_s * self.period_ms // 1_000)
        late = -(-self.max_speed_mm_s * self.entry_report_delay_ms // 1_000) if self.borders == "occupancy" else 0
        return Reach(cycle, self.max_speed_mm_s, self.report_age_limit_ms, self.limit_mm, cycle + late)


def refuse_inner_detection(area: AreaConfig) -> None:
    """Raise ValueError for detection inside the area, in a machine that speaks of the whole stretch between a train's ends.

    A gap between the parts of a train may be clear; the claims of such a machine do not tell the parts apart.
    """
    if area.inner_detection:
        raise ValueError(
            f"sections.area.inner_detection is {area.inner_detection}, but this machine's claims take all between a train's ends "
            "for occupied, also a gap between parts that is clear; make it 0, or use `sections` for detection inside the area."
        )


class Parts:
    """The variables of the machine.

    low_end, high_end  places of the axle counters, mm: fixed, any two places
    healthy, clear     the axle counters, or train detection: undisturbed; no axle is counted in, or nobody is in the area
    loose_low, loose_high  bounds of loose vehicles, rear to front
    loose_there, loose_rear, loose_front  ghosts: some loose vehicle is in the area; its true ends, um
    axle_between  ghost: after the cycle an axle is between the counters; where nobody counts axles it is not asked
    inner      detection sections inside the area
    followers  vehicles that come in uncounted at borders that report occupancy alone; None where every vehicle is counted
    """

    followers: Followers | None
    axle_between: Bool

    def __init__(self, config: AreaConfig) -> None:
        self.declared = declared = Declared()
        limit, reach = config.limit_mm, config.reach
        far, step = limit * 1_000, reach.cycle_mm * 1_000
        self.config = config
        self.modes = modes("UNSWEPT", "SWEPT")
        self.healthy = declared.sensor(boolean("counters_healthy"))
        self.clear = declared.sensor(boolean("counters_clear"))
        self.low_end = declared.state(number("low_end_mm", MM, -limit, limit), first=ANY)
        self.high_end = declared.state(number("high_end_mm", MM, -limit, limit), first=ANY)
        self.loose_low = declared.state(number("loose_low_mm", MM, -limit, limit), first=-limit)
        self.loose_high = declared.state(number("loose_high_mm", MM, -limit, limit), first=limit)
        self.loose_there = declared.ghost(boolean("loose_there"), first=ANY)
        self.loose_rear = declared.ghost(number("loose_rear_um", UM, -far, far), first=ANY)
        self.loose_front = declared.ghost(number("loose_front_um", UM, -far, far), first=ANY)
        self.inner = inner_sections(declared, config.inner_detection, limit)
        trusted = config.integrity_is_trusted
        self.slots = tuple(
            slot(declared, n, reach, config.count_limit, integrity_is_trusted=trusted, inner=self.inner)
            for n in range(1, config.trains + 1)
        )
        counted = config.borders == "counted"
        self.axle_between = declared.choice(boolean("axle_between")) if counted else TRUE
        self.rejected_events = declared.state(number("rejected_events", COUNT, 0, config.trains), first=0)
        self.next_loose_there = declared.choice(boolean("next_loose_there"))
        self.next_loose_rear = declared.choice(number("next_loose_rear_um", UM, -far - step, far + step))
        self.next_loose_front = declared.choice(number("next_loose_front_um", UM, -far - step, far + step))
        ends = (self.low_end, self.high_end)
        self.followers = None if counted else followers(declared, reach, ends, config.trains, self.inner)

    @property
    def unswept(self) -> Bool:
        """Loose vehicles may be in the area."""
        return current_mode(self.modes).eq(self.modes[0])


def parts(config: AreaConfig) -> Parts:
    """Return fresh variables for one machine."""
    return Parts(config)
