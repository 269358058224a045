"""Simulated stays of a train in a line area, as steps of the whole, the train itself included.

The streams hold features, not backscatter: messages of a detector within its stated bounds for both ends, its counts, and the
messages of axle counter and emitter. One train runs from the low end to the high end; its troubles are named.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from safeloc.language.nodes import Value
from safeloc.language.units import MS_PER_S, NM_PER_UM, UM_PER_MM
from safeloc.models.fibre.simulate import Drive, Section, below, line, simulate
from safeloc.models.fibre_area import FibreAreaConfig
from safeloc.models.fibre_area.simulated_counters import come_in, heads, inside, passed, sweep
from safeloc.runtime.streams.steps import Cell

Steps = list[dict[str, Cell]]
REMARK = "truth_mm"
LOST_AXLES = 4
_AXLE_SPACING_MM = 5_000
_BLUR_MM = 5_000
"How far the detector's pattern reaches beyond the train."
_PATTERN = ("amplitude_cdb", "run_mm", "flight_position_mm", "reflecting_point_mm")


@dataclass(frozen=True)
class Journey:
    """One train and its messages, once the counters are clear. Cycles count from there; the train comes in at the low end in cycle `enters`.

    from_high    it comes in at the high end; then its speed is negative
    speeds_mm_s  the speed from a cycle on, reached by traction or brakes; negative: back towards the low end
    spacing_mm   distance between the line's sections, the first of which lies so far inside the area
    silent       (from, to) cycles in which the detector does not follow the pattern
    record       cycle in which the train's record comes; None: never
    sender       who sends it: the axle counter, or the neighbouring area, which has it ready when the train comes in
    tested       cycle in which the host requests the emitter's pattern, which comes in the next one
    referred     both ends get a reference in cycle `referred_in`; otherwise the position code has to give their places
    counted_every  cycles between two counts of the axles
    uncounted    (from, to) cycles in which the detector measures the train's length, but counts no axles
    split        cycle in which the last four axles are left behind and stand: the pattern goes on without them
    told_after_mm  run of the train after which the detector's count follows; None: the longest permitted
    unannounced  axles of a train that follows at the same speed and that nobody announces, and the gap to it, mm
    emitter_dead (from, to) cycles in which no test pattern comes
    front_missed, rear_missed  numbers of the sections that the machine of that end does not notice
    front_stuck, rear_stuck  stretch in which the amplitude at that end stays raised, mm
    """

    cycles: int = 150
    enters: int = 0
    from_high: bool = False
    speeds_mm_s: tuple[tuple[int, int], ...] = ((0, 40_000),)
    spacing_mm: int = 1_000_000
    silent: tuple[int, int] | None = None
    length_mm: int = 205_000
    axles: int = 40
    area_mm: tuple[int, int] = (0, 2_000_000)
    cuts_mm: tuple[tuple[int, int], ...] = ((500_000, 1_000_000),)
    record: int | None = 14
    sender: Literal["AXLE_COUNTER", "NEIGHBOUR"] = "AXLE_COUNTER"
    tested: int = 0
    referred: bool = True
    referred_in: int = 0
    counted_every: int = 3
    uncounted: tuple[int, int] | None = None
    split: int | None = None
    counted_after_mm: int | None = None
    unannounced: tuple[int, int] | None = None
    emitter_dead: tuple[int, int] | None = None
    front_missed: tuple[int, ...] = ()
    rear_missed: tuple[int, ...] = ()
    front_stuck: tuple[int, int] | None = None
    rear_stuck: tuple[int, int] | None = None


def _speeds(config: FibreAreaConfig, journey: Journey) -> tuple[int, ...]:
    """Return the speed of every cycle, mm/s; during the sweep it is that of the journey's first cycle."""
    ability = min(config.verification.traction_mm_s2, config.verification.brake_mm_s2)
    most, wanted, speeds = ability * config.verification.period_ms // MS_PER_S, dict(journey.speeds_mm_s), list[int]()
    target = now = wanted.get(0, 0)
    for cycle in range(journey.cycles):
        target = wanted.get(cycle, target)
        now += max(-most, min(most, target - now))
        speeds.append(now)
    return (speeds[0],) * len(sweep(config.axle_section)) + tuple(speeds)


def _start_mm(config: FibreAreaConfig, journey: Journey) -> int:
    """Return the front's place before the first cycle, from which the train comes to its end of the area in time, mm."""
    enters = len(sweep(config.axle_section)) + journey.enters
    run = sum(_speeds(config, journey)[:enters]) * config.fibre.period_ms // MS_PER_S
    begins, ends = journey.area_mm
    return (ends + journey.length_mm + 1 if journey.from_high else begins) - run


def _sections_below(config: FibreAreaConfig, journey: Journey) -> int:
    """Return the number of sections of the line below the place of the start."""
    sections = line(config.fibre, spacing_mm=journey.spacing_mm)
    return below(sections, _start_mm(config, journey) - journey.length_mm)


def first_state(config: FibreAreaConfig, journey: Journey) -> dict[str, Value]:
    """Return the open values at the start: the area's ends and cuts, and the train's place."""
    low, front = journey.area_mm[0], _start_mm(config, journey) * UM_PER_MM
    rear = front - journey.length_mm * UM_PER_MM
    first: dict[str, Value] = {
        "axle_section.true_axles": 0, "entry.true_axles": journey.axles, "train_order.train_1_inside": False, "train_order.train_1_place_um": (front + rear) // 2,
        "area.low_end_mm": low, "area.high_end_mm": journey.area_mm[1], "area.loose_there": False,
        "area.loose_rear_um": low, "area.loose_front_um": low,
        "area.train_1_true_rear_um": rear, "area.train_1_true_front_um": front,
        "front.truth_nm": front * NM_PER_UM, "rear.truth_nm": rear * NM_PER_UM,
    }  # fmt: skip
    for name in ("front", "rear"):
        first |= {f"{name}.true_edge_nm": 0, f"{name}.true_count": _sections_below(config, journey)}
    first |= {f"{end}.section_is_real": False for end in ("front", "rear")}
    for number, (start, end) in enumerate(journey.cuts_mm, 1):
        first |= {f"section_{number}.from_mm": start, f"section_{number}.to_mm": end}
    return first


def simulate_journey(config: FibreAreaConfig, *, seed: int, journey: Journey | None = None) -> Steps:
    """Return the steps of one stay, with the front's true place as the remark `truth_mm`; while the train comes near, the area is swept."""
    journey = journey or Journey()
    ends, begins = simulated_ends(config, journey, seed), -len(sweep(config.axle_section))
    world = World(config, journey)
    return [world.step(cycle, front, rear) for cycle, (front, rear) in enumerate(zip(*ends, strict=True), begins)]


def simulated_ends(config: FibreAreaConfig, journey: Journey, seed: int) -> tuple[Steps, Steps]:
    """Return the inputs of the fibre machines of both ends."""
    sections: list[Section] = line(config.fibre, spacing_mm=journey.spacing_mm)
    start = _start_mm(config, journey)
    refers_in = len(sweep(config.axle_section)) + journey.referred_in
    drive = Drive(
        _speeds(config, journey),
        referred=journey.referred,
        refers_in=refers_in,
        sections_below=_sections_below(config, journey),
        start_mm=start,
    )
    front = replace(drive, missed=journey.front_missed, stuck_mm=journey.front_stuck)
    rear = replace(drive, missed=journey.rear_missed, stuck_mm=journey.rear_stuck, start_mm=start - journey.length_mm)
    found = [simulate(config.fibre, seed=seed + n, drive=one, sections=sections) for n, one in enumerate((front, rear))]
    return found[0], found[1]


class World:
    """The train, the counters and the emitter. Cycles below 0 are of the sweep."""

    def __init__(self, config: FibreAreaConfig, journey: Journey) -> None:
        self._config, self._journey = config, journey
        self._sweep = sweep(config.axle_section)
        self._since, self._left = 0, False
        self._lost_um, self._run_since_mm = 0, 0
        start = _start_mm(config, journey)
        self._axles_mm = [start - journey.length_mm] * journey.axles
        self._others_mm = _others_mm(journey, start - journey.length_mm)
        self._others_noticed = False
        self._speeds = _speeds(config, journey)

    def step(self, cycle: int, front: dict[str, Cell], rear: dict[str, Cell]) -> dict[str, Cell]:
        """Return one cycle."""
        high = _cell(front, REMARK)
        low = _cell(rear, REMARK)
        self._run_since_mm += abs(self._ran_mm(cycle)) if self._parted(cycle) else 0
        inputs = self._counters(cycle, low, high) | self._patterns(cycle, low, high)
        for name, end in (("front", front), ("rear", rear)):
            hidden = {REMARK, *(_PATTERN if self._silent(cycle) else ())}
            inputs |= {f"{name}.{key}": value for key, value in end.items() if key not in hidden}
        inputs |= self._emitter(cycle) | self._record(cycle, high) | self._seen(cycle, high - low)
        return inputs | self._truth(cycle, low, high) | {REMARK: high}

    def _emitter(self, cycle: int) -> dict[str, Cell]:
        """Request the pattern in the first cycle; send it then and whenever it is due."""
        emitter, silent = self._config.emitter, _during(cycle, self._journey.emitter_dead)
        self._since += cycle >= 0
        heard = not silent and (cycle == self._journey.tested + 1 or self._since >= emitter.due_cycles - 1)
        self._since = 0 if heard else min(self._since, emitter.due_cycles)
        step: dict[str, Cell] = {
            "emitter.test_requested": cycle == self._journey.tested,
            "emitter.next_chain_works": not silent,
        }
        if heard:
            step |= {"emitter.heard_pattern": emitter.pattern, "emitter.heard_place_mm": emitter.place_mm}
        return step

    @property
    def axles_mm(self) -> Sequence[int]:
        """Places of the train's axles after the last cycle, from its foremost one."""
        return self._axles_mm

    @property
    def others_mm(self) -> Sequence[int]:
        """The same of the train that nobody announced."""
        return self._others_mm

    def _silent(self, cycle: int) -> bool:
        return _during(cycle, self._journey.silent)

    def _counters(self, cycle: int, low_mm: int, high_mm: int) -> dict[str, Cell]:
        """Return what the counters at both ends report, and the axles that passed them."""
        begins, ends = self._journey.area_mm
        entered = not self._left and cycle > self._journey.enters
        out = (entered and high_mm < begins, entered and low_mm > ends)
        self._left = self._left or any(out)
        own, others = self._axles_passed(cycle, low_mm, high_mm)
        passes = {name: own[name] + others[name] for name in own}
        swept = {f"axle_section.{name}": cell for name, cell in self._sweep[cycle].items()} if cycle < 0 else {}
        return {
            **heads(passes, passes), **swept,
            **self._enters(cycle),
            "entry.leaves_low": out[0], "entry.leaves_high": out[1],
            "entry.reference_comes": self._journey.sender if cycle == self._journey.record else "NOBODY",
            "entry.axles_of_one_that_enters": self._journey.axles, **come_in("own", own), **come_in("other", others),
        }  # fmt: skip

    def _enters(self, cycle: int) -> dict[str, Cell]:
        """Announce the train in the cycle in which it comes in."""
        comes = int(cycle == self._journey.enters)
        here, there = ("high", "low") if self._journey.from_high else ("low", "high")
        return {f"entry.enters_{here}": comes, f"entry.enters_{there}": 0}

    def _axles_passed(self, cycle: int, low_mm: int, high_mm: int) -> tuple[dict[str, int], dict[str, int]]:
        """Return the axles of the train, and of one that nobody announced, that came into the area and left it since the previous cycle."""
        before, others, ends = self._axles_mm, self._others_mm, self._journey.area_mm
        self._axles_mm, self._others_mm = self._axle_places(cycle, low_mm, high_mm), _others_mm(self._journey, low_mm)
        self._others_noticed |= cycle >= (self._journey.record or cycle) and self._others_inside > 0
        return passed(before, self._axles_mm, ends), passed(others, self._others_mm, ends)

    @property
    def _others_inside(self) -> int:
        """Axles in the area of the train that nobody announced."""
        return inside(self._others_mm, self._journey.area_mm)

    def _axle_places(self, cycle: int, low_mm: int, high_mm: int) -> list[int]:
        """Return the place of every axle, evenly along the train; lost axles stay."""
        axles, parted = self._journey.axles, self._parted(cycle)
        places = [high_mm - (high_mm - low_mm) * number // (axles - 1) for number in range(axles)]
        return [*places[:-LOST_AXLES], *self._axles_mm[-LOST_AXLES:]] if parted else places

    def _patterns(self, cycle: int, low_mm: int, high_mm: int) -> dict[str, Cell]:
        """Return the fibre's patterns between the counters, and the truth of the order of trains."""
        begins, ends = self._journey.area_mm
        seen = not self._silent(cycle) and low_mm <= ends and high_mm >= begins
        there = cycle >= self._journey.enters and inside(self._axles_mm, (begins, ends)) > 0
        first_mm = (low_mm, high_mm)
        if others := self._others_inside > 0:
            first_mm = (self._others_mm[-1], self._others_mm[0])
        return {
            "train_order.patterns": seen + others, "train_order.pattern_1_low_mm": first_mm[0] - _BLUR_MM if seen else 0,
            "train_order.pattern_1_high_mm": first_mm[1] + _BLUR_MM if seen else 0,
            "train_order.next_train_1_inside": there, "train_order.next_train_1_place_um": (low_mm + high_mm) // 2 * UM_PER_MM,
            "train_order.pattern_1_owner": int(seen),
        }  # fmt: skip

    def _record(self, cycle: int, front_mm: int) -> dict[str, Cell]:
        """Return the counter's record, valid in the cycle in which it comes."""
        journey, speed = self._journey, self.speed_mm_s(cycle)
        return {
            "entry.record_sound": True, "entry.record_axles": journey.axles,
            "verification.record_length_low_mm": journey.length_mm - 4_000,
            "verification.record_length_high_mm": journey.length_mm + 4_000,
            "verification.record_speed_low_mm_s": speed - 300, "verification.record_speed_high_mm_s": speed + 300,
            "verification.record_place_low_mm": front_mm - 5_000, "verification.record_place_high_mm": front_mm + 5_000,
            "verification.record_age_cycles": 0,
        }  # fmt: skip

    def _seen(self, cycle: int, length_mm: int) -> dict[str, Cell]:
        """Return the detector's readings of the pattern."""
        journey = self._journey
        step: dict[str, Cell] = {
            "verification.next_true_axles": self._axles(), "verification.next_true_length_um": length_mm * UM_PER_MM,
            "report.reading_age_ms": 0,
        }  # fmt: skip
        if not self._silent(cycle):
            step["verification.fibre_speed_mm_s"] = self.speed_mm_s(cycle)
        if cycle % journey.counted_every == 0 and not self._silent(cycle):
            step["verification.fibre_length_mm"] = length_mm
            if not _during(cycle, journey.uncounted):
                step["verification.fibre_axles"] = self._axles()
        return step

    def _parted(self, cycle: int) -> bool:
        """Return the condition that the train has lost its last axles."""
        return self._journey.split is not None and cycle >= self._journey.split

    def speed_mm_s(self, cycle: int) -> int:
        """Return the speed of a cycle, mm/s; negative towards the low end."""
        return self._speeds[cycle + len(self._sweep)]

    def _ran_mm(self, cycle: int) -> int:
        """Return the run of a cycle, mm; negative towards the low end."""
        return self.speed_mm_s(cycle) * self._config.fibre.period_ms // MS_PER_S

    def _axles(self) -> int:
        """Return the detector's count: it contains lost axles until the train has run on."""
        journey = self._journey
        after = self._config.parting.count_run_mm if journey.counted_after_mm is None else journey.counted_after_mm
        return journey.axles - (LOST_AXLES if self._run_since_mm > after else 0)

    def _truth(self, cycle: int, low_mm: int, high_mm: int) -> dict[str, Cell]:
        """Return the train itself: a part left behind stands where it was, and is the train's rear."""
        complete = not self._parted(cycle)
        self._lost_um = low_mm * UM_PER_MM if complete else self._lost_um
        low, high = (place * UM_PER_MM for place in self._journey.area_mm)
        loose = self._others_noticed and self._others_inside > 0
        if loose:
            low, high = self._others_mm[-1] * UM_PER_MM, self._others_mm[0] * UM_PER_MM
        return {
            "report.next_rear_is_the_trains": complete, "report.next_front_is_the_trains": True,
            "report.next_body_rear_um": low_mm * UM_PER_MM, "report.next_body_front_um": high_mm * UM_PER_MM,
            "report.true_cycle_distance_um": self._ran_mm(cycle) * UM_PER_MM,
            "report.next_rear_um": self._lost_um, "report.next_front_um": high_mm * UM_PER_MM,
            "area.next_loose_there": loose, "area.next_loose_rear_um": low, "area.next_loose_front_um": high,
        }  # fmt: skip


def _others_mm(journey: Journey, rear_mm: int) -> list[int]:
    """Return the place of every axle of the train that nobody announced, from its foremost one, behind the rear of the train before it."""
    axles, gap_mm = journey.unannounced or (0, 0)
    return [rear_mm - gap_mm - number * _AXLE_SPACING_MM for number in range(axles)]


def _during(cycle: int, cycles: tuple[int, int] | None) -> bool:
    return cycles is not None and cycles[0] <= cycle < cycles[1]


def _cell(step: dict[str, Cell], name: str) -> int:
    value = step[name]
    assert isinstance(value, int)
    return value
