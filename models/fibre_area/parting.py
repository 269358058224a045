"""Variables of a train that may part: what is told of its pattern, and what really became of its vehicles (FVA-9)."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.config import Config, quantity
from safeloc.language.expr import Bool, BoolVar, Num, NumVar, Var, abs_, boolean, ite, minimum, number, with_unit
from safeloc.language.units import MM, MS, UM, UM_PER_MM
from safeloc.models.area.slot import Reach


class PartingConfig(Config):
    """What a count tells of a train that may lose vehicles, and what becomes of those."""

    count_run_mm: int = quantity(
        800_000,
        "mm",
        0,
        10_000_000,
        "[D] the detector tells no count whose profile began more than 750 m of run ago (safeloc.sensing.fibre, "
        "Counting.told_run_mm), and 50 m that its places are off",
    )
    roll_back_mm: int = quantity(
        20_000, "mm", 0, 10_000_000, "[M] the brake pipe parts with the coupling; run back until the part's brakes hold"
    )

    @property
    def straight_limit_mm(self) -> int:
        """Run one way that is more than the count's run; farther is not counted."""
        return self.count_run_mm + 1

    @property
    def since_limit_um(self) -> int:
        """Run since the train was whole that is more than a count allows; farther is not told apart."""
        return self.straight_limit_mm * UM_PER_MM


@dataclass(frozen=True)
class ToldRun:
    """The run of a pattern that is told in a cycle: the farthest (mm), and what it may be wrong by (ppm of it, and mm)."""

    limit_mm: int
    rate_ppm: int
    floor_mm: int


@dataclass(frozen=True, eq=False)
class Parts:
    """The variables of the machine.

    trusted, counted  the verification trusts the train; its count matched in this cycle
    gone              the train was counted out
    low, high         bounds of the pattern, from its low end to its high end; usable: within the line's range
    front_low, rear_high  the same ends from inside: where the high end is at least, the low end at most
    longest           the greatest length that the reference allows, from end to end
    upwards, downwards  the pattern ran towards the high (low) end in this cycle
    run               how far it ran in this cycle, as told; `told_run`: what that is good for
    age               how old the pattern's reading is
    straight          how far it ran one way, at least, without a cycle in which it did not: above 0 upwards
    told, told_low, told_high  what the area is told

    Ghosts; places in um as they were when the pattern was read:

    pattern_rear, pattern_front  the pattern's ends, rounded outward
    had_all           the count that this cycle's verification rests on is that of a train with all axles of the reference
    rear_is, front_is   nothing was lost at the pattern's low (high) end
    since             run since the train was last whole, either way added up
    body_rear, body_front  where its ends would be had it lost nothing
    lowest, highest   how far these have come down (up) since the train was last whole
    step              run of the train in this cycle
    next_rear, next_front  ends of the train now, with every part that it lost
    """

    config: PartingConfig
    reach: Reach
    told_run: ToldRun
    trusted: BoolVar
    counted: BoolVar
    gone: BoolVar
    usable: BoolVar
    low: NumVar
    high: NumVar
    front_low: NumVar
    rear_high: NumVar
    longest: NumVar
    upwards: BoolVar
    downwards: BoolVar
    run: NumVar
    age: NumVar
    straight: NumVar
    told: BoolVar
    told_low: NumVar
    told_high: NumVar
    pattern_rear: NumVar
    pattern_front: NumVar
    had_all: BoolVar
    rear_is: BoolVar
    front_is: BoolVar
    since: NumVar
    body_rear: NumVar
    body_front: NumVar
    lowest: NumVar
    highest: NumVar
    next_rear_is: BoolVar
    next_front_is: BoolVar
    next_body_rear: NumVar
    next_body_front: NumVar
    step: NumVar
    next_rear: NumVar
    next_front: NumVar

    @property
    def inputs(self) -> list[Var]:
        """What is heard in a cycle."""
        told: list[Var] = [self.trusted, self.counted, self.gone, self.usable, self.low, self.high]
        return [*told, self.front_low, self.rear_high, self.longest, self.upwards, self.downwards, self.run, self.age]

    @property
    def choices(self) -> list[Var]:
        """What the world chooses in a cycle."""
        pattern: list[Var] = [
            self.pattern_rear,
            self.pattern_front,
            self.had_all,
            self.next_rear_is,
            self.next_front_is,
        ]
        return [*pattern, self.next_body_rear, self.next_body_front, self.step, self.next_rear, self.next_front]

    # -------------------------------------------------------------- the world's moves

    @property
    def next_whole(self) -> Bool:
        """The pattern is the whole train."""
        return self.next_rear_is & self.next_front_is

    @property
    def next_since(self) -> Num:
        """Run since it was last whole, after the cycle."""
        return ite(self.next_whole, 0, minimum(self.since + abs_(self.step), self.config.since_limit_um))

    @property
    def next_counts(self) -> Bool:
        """It was whole so lately that a count may still tell all its axles."""
        return self.next_since <= self.config.count_run_mm * UM_PER_MM

    @property
    def ran(self) -> Num:
        """What can have been run in the age of the reading, um."""
        return with_unit(self.age * self.reach.max_speed_mm_s, UM)


def parts(config: PartingConfig, reach: Reach, told_run: ToldRun, pattern_limit_um: int, length_limit_mm: int) -> Parts:
    """Fresh variables for one train up to `length_limit_mm` long, whose pattern may be anywhere within `pattern_limit_um`."""
    limit, far, oldest = reach.limit_mm, reach.limit_mm * UM_PER_MM, 2 * reach.report_age_limit_ms
    most, step, straight = config.since_limit_um, reach.cycle_mm * UM_PER_MM, config.straight_limit_mm
    body = pattern_limit_um + most

    def place(name: str) -> NumVar:
        return number(name, MM, -limit, limit)

    def ghost(name: str, limit_um: int) -> NumVar:
        return number(name, UM, -limit_um, limit_um)

    return Parts(
        config, reach, told_run,
        boolean("train_trusted"), boolean("count_matches_now"), boolean("train_gone"), boolean("ends_usable"),
        place("pattern_low_mm"), place("pattern_high_mm"), place("pattern_front_low_mm"), place("pattern_rear_high_mm"),
        number("longest_mm", MM, 0, length_limit_mm),
        boolean("runs_upwards"), boolean("runs_downwards"),
        number("run_mm", MM, -told_run.limit_mm, told_run.limit_mm),
        number("reading_age_ms", MS, 0, oldest),
        number("run_one_way_mm", MM, -straight, straight),
        boolean("trusted_now"), place("reported_low_mm"), place("reported_high_mm"),
        ghost("pattern_rear_um", pattern_limit_um), ghost("pattern_front_um", pattern_limit_um),
        boolean("count_had_all_axles"), boolean("rear_is_the_trains"), boolean("front_is_the_trains"),
        number("run_since_whole_um", UM, 0, most),
        ghost("body_rear_um", body), ghost("body_front_um", body), ghost("lowest_um", body), ghost("highest_um", body),
        boolean("next_rear_is_the_trains"), boolean("next_front_is_the_trains"),
        ghost("next_body_rear_um", body), ghost("next_body_front_um", body),
        ghost("step_um", pattern_limit_um),
        ghost("next_rear_um", far + step), ghost("next_front_um", far + step),
    )  # fmt: skip
