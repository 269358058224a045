"""Variables of a train that may part: readings of its pattern, and the true ends of its vehicles (FVA-9)."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import Bool, Num, abs_, boolean, ite, minimum, number, with_unit
from safeloc.language.machine import ANY
from safeloc.language.units import MM, MS, UM, UM_PER_MM
from safeloc.models.area.slot import Reach


class PartingConfig(Config):
    """Figures of the count of a train that may lose vehicles, and of the lost vehicles."""

    count_run_mm: int = quantity(
        800_000,
        "mm",
        0,
        10_000_000,
        "[D] the detector reports no count whose profile began more than 750 m of run ago "
        "(safeloc.sensing.fibre, Counting.count_valid_run_mm), plus 50 m of error of its places",
    )
    roll_back_mm: int = quantity(
        20_000, "mm", 0, 10_000_000, "[M] the brake pipe parts with the coupling; run back until the part's brakes hold"
    )

    @property
    def straight_limit_mm(self) -> int:
        """Run in one direction that is just longer than the count's run, mm; a longer one is not counted."""
        return self.count_run_mm + 1

    @property
    def since_limit_um(self) -> int:
        """Run since the train was whole that is just longer than a count allows, um; a longer one is not counted."""
        return self.straight_limit_mm * UM_PER_MM


@dataclass(frozen=True)
class ReportedRun:
    """The measured run of a pattern: its limit in a cycle (mm), and its error law (ppm of the run, and mm)."""

    limit_mm: int
    rate_ppm: int
    floor_mm: int


class Parts:
    """The variables of the machine.

    trusted, count_matches_now  the verification trusts the train; its count matched in this cycle
    gone              the train was counted out, or another one comes in with its number
    low, high         bounds of the pattern, from its low end to its high end; usable: within the line's range
    front_low, rear_high  the same ends from inside: lower bound of the high end, upper bound of the low end
    longest           the greatest length that the reference allows, from end to end
    upwards, downwards  the pattern ran towards the high (low) end in this cycle
    run               its measured run in this cycle; `told_run`: limit and error law of that
    age               age of the pattern's reading
    run_one_way          its run in one direction so far, at least, without a pause: above 0 upwards
    trusted_now, reported_low, reported_high  the report to the area

    Ghosts; places in um at the time of the pattern's reading:

    pattern_rear, pattern_front  the pattern's ends, rounded outward
    count_had_all_axles           the count in this cycle's verification is that of a train with all axles of the reference
    pattern_is_the_trains  the pattern that is taken for this train's is this train's
    rear_is_the_trains, front_is_the_trains   no vehicle was lost at the pattern's low (high) end
    run_since_complete             run since the train was last whole, both directions added up
    body_rear, body_front  ends of the train as if it had lost no vehicle
    lowest, highest   lowest and highest place of these ends since the train was last whole
    true_cycle_distance              run of the train in this cycle
    next_rear, next_front  ends of the train now, with every part that it lost
    """

    def __init__(
        self,
        config: PartingConfig,
        reach: Reach,
        reported_run: ReportedRun,
        pattern_limit_um: int,
        length_limit_mm: int,
    ) -> None:
        self.declared = declared = Declared()
        limit, far, oldest = reach.limit_mm, reach.limit_mm * UM_PER_MM, 2 * reach.report_age_limit_ms
        most, step, straight = config.since_limit_um, reach.cycle_mm * UM_PER_MM, config.straight_limit_mm
        pattern, body = pattern_limit_um, pattern_limit_um + most
        self.config, self.reach, self.reported_run = config, reach, reported_run
        self.trusted = declared.sensor(boolean("train_trusted"))
        self.count_matches_now = declared.sensor(boolean("count_matches_now"))
        self.gone = declared.sensor(boolean("train_gone"))
        self.usable = declared.sensor(boolean("ends_usable"))
        self.low = declared.sensor(number("pattern_low_mm", MM, -limit, limit))
        self.high = declared.sensor(number("pattern_high_mm", MM, -limit, limit))
        self.front_low = declared.sensor(number("pattern_front_low_mm", MM, -limit, limit))
        self.rear_high = declared.sensor(number("pattern_rear_high_mm", MM, -limit, limit))
        self.longest = declared.sensor(number("longest_mm", MM, 0, length_limit_mm))
        self.upwards = declared.sensor(boolean("runs_upwards"))
        self.downwards = declared.sensor(boolean("runs_downwards"))
        self.run = declared.sensor(number("run_mm", MM, -reported_run.limit_mm, reported_run.limit_mm))
        self.age = declared.sensor(number("reading_age_ms", MS, 0, oldest))
        self.run_one_way = declared.state(number("run_one_way_mm", MM, -straight, straight), first=0)
        self.trusted_now = declared.state(boolean("trusted_now"), first=False)
        self.reported_low = declared.state(number("reported_low_mm", MM, -limit, limit), first=0)
        self.reported_high = declared.state(number("reported_high_mm", MM, -limit, limit), first=0)
        self.rear_is_the_trains = declared.ghost(boolean("rear_is_the_trains"), first=False)
        self.front_is_the_trains = declared.ghost(boolean("front_is_the_trains"), first=False)
        self.run_since_complete = declared.ghost(number("run_since_complete_um", UM, 0, most), first=most)
        self.body_rear = declared.ghost(number("body_rear_um", UM, -body, body), first=ANY)
        self.body_front = declared.ghost(number("body_front_um", UM, -body, body), first=ANY)
        self.lowest = declared.ghost(number("lowest_um", UM, -body, body), first=ANY)
        self.highest = declared.ghost(number("highest_um", UM, -body, body), first=ANY)
        self.pattern_rear = declared.choice(number("pattern_rear_um", UM, -pattern, pattern))
        self.pattern_front = declared.choice(number("pattern_front_um", UM, -pattern, pattern))
        self.count_had_all_axles = declared.choice(boolean("count_had_all_axles"))
        self.pattern_is_the_trains = declared.choice(boolean("pattern_is_the_trains"))
        self.next_rear_is_the_trains = declared.choice(boolean("next_rear_is_the_trains"))
        self.next_front_is_the_trains = declared.choice(boolean("next_front_is_the_trains"))
        self.next_body_rear = declared.choice(number("next_body_rear_um", UM, -body, body))
        self.next_body_front = declared.choice(number("next_body_front_um", UM, -body, body))
        self.true_cycle_distance = declared.choice(number("true_cycle_distance_um", UM, -pattern, pattern))
        self.next_rear = declared.choice(number("next_rear_um", UM, -far - step, far + step))
        self.next_front = declared.choice(number("next_front_um", UM, -far - step, far + step))

    # -------------------------------------------------------------- the world's moves

    @property
    def next_complete(self) -> Bool:
        """The pattern is the whole train."""
        return self.next_rear_is_the_trains & self.next_front_is_the_trains

    @property
    def next_since(self) -> Num:
        """Run since the train was last whole, after the cycle, um."""
        return ite(
            self.next_complete,
            0,
            minimum(self.run_since_complete + abs_(self.true_cycle_distance), self.config.since_limit_um),
        )

    @property
    def next_counts(self) -> Bool:
        """The train was whole so recently that a count may still contain all its axles."""
        return self.next_since <= self.config.count_run_mm * UM_PER_MM

    @property
    def ran(self) -> Num:
        """Greatest run in the age of the reading, um."""
        return with_unit(self.age * self.reach.max_speed_mm_s, UM)


def parts(
    config: PartingConfig, reach: Reach, reported_run: ReportedRun, pattern_limit_um: int, length_limit_mm: int
) -> Parts:
    """Return fresh variables for one train up to `length_limit_mm` long; its pattern lies within `pattern_limit_um`."""
    return Parts(config, reach, reported_run, pattern_limit_um, length_limit_mm)
