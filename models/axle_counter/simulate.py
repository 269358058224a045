"""Simulated trains that pass a counting head, as steps of the machine that makes their entry record.

A train is given by the distances of its axles behind the first one and by a speed for every cycle. All numbers are whole, so
the truth in the steps is exact: the run since the first axle, the run up to the last one, every axle.

`python -m safeloc.models.axle_counter.simulate` writes the runs that ship, `... simulate FOLDER` those that are made on demand.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from random import Random

from safeloc.language.units import NM_PER_MM, UM_PER_MM
from safeloc.models.axle_counter import AxleCounterConfig
from safeloc.proof.drawn_runs.worked import Steps, WorkedRun, write_named
from safeloc.runtime.streams.steps import Cell

_SPREAD_MM_S = 200  # distance of the reported bounds of an axle's speed from it
_BETWEEN_CYCLES = 300  # the headway
_SLOWEST_MM_S = 12_000  # slower trains may not certainly have passed before another one comes
_HEAD_MM = 360  # of rail on which a wheel damps the head


@dataclass(frozen=True)
class Passage:
    """A train and its passage.

    behind_mm   every axle's distance behind the first one
    speeds      mm/s in every cycle, the first axle passes in the first one; negative: it runs back
    faults      cycle -> cells that differ from those of a healthy head, None: the cell is missing
    untrue      the head's reports are not true in those cycles: the whole run carries no truth
    begins_at   the run begins in this cycle of the passage
    """

    behind_mm: tuple[int, ...]
    speeds: tuple[int, ...]
    faults: Mapping[int, Mapping[str, Cell | None]] = field(default_factory=dict)
    untrue: bool = False
    begins_at: int = 0


def bogies(
    vehicles: int, length_mm: int = 26_400, apart_mm: int = 19_000, wheelbase_mm: int = 2_500
) -> tuple[int, ...]:
    """Return the axles of coaches with two bogies each."""
    middle = [(length_mm - apart_mm) // 2, (length_mm + apart_mm) // 2]
    places = [
        vehicle * length_mm + bogie + side * wheelbase_mm // 2
        for vehicle in range(vehicles)
        for bogie in middle
        for side in (-1, 1)
    ]
    return tuple(place - places[0] for place in places)


def passed(config: AxleCounterConfig, passages: Sequence[Passage]) -> Steps:
    """Return trains one after the other. Quiet cycles before each report that the passage before is over."""
    steps, speed = Steps(), 0
    for passage in passages:
        train = _Train(config, passage).steps()
        between = [] if passage.begins_at else [_quiet(config, speed, over=True)] * _BETWEEN_CYCLES
        steps += [*between, *train[passage.begins_at :]]
        speed = passage.speeds[-1]
    untrue = any(passage.untrue for passage in passages)
    return [_without_truth(step) for step in steps] if untrue else steps


def simulate(config: AxleCounterConfig, *, seed: int) -> Steps:
    """Return four trains of their own length and course; now and then one brakes or accelerates on the counter."""
    rng = Random(seed)
    passages = []
    for _ in range(4):
        behind = bogies(rng.randint(1, 5))
        first, change = rng.randint(_SLOWEST_MM_S, 30_000), rng.choice((0, 0, -60, 80))
        passages.append(Passage(behind, _until_passed(config, behind, first, change)))
    return passed(config, passages)


def _until_passed(
    config: AxleCounterConfig, behind_mm: Sequence[int], first_mm_s: int, change_mm_s: int = 0
) -> tuple[int, ...]:
    """Return speeds for as long as the passage lasts: until the last axle, and farther than two axles are apart."""
    way, run, speeds = behind_mm[-1] + 2 * config.axle_gap_mm, 0, list[int]()
    while run < way * 1_000:
        speeds.append(min(max(first_mm_s + change_mm_s * len(speeds), _SLOWEST_MM_S), config.max_speed_mm_s))
        run += speeds[-1] * config.period_ms
    return tuple(speeds)


def _quiet(config: AxleCounterConfig, speed_mm_s: int, *, over: bool) -> dict[str, Cell]:
    """Return a cycle without an axle; the train is elsewhere, and still runs."""
    speed = speed_mm_s * UM_PER_MM
    return {
        "axle": "NONE", "axles_in_cycle": 1, "head_fault": False, "head_damped": False, "passage_over": over,
        "next_true_speed_um_s": speed, "axle_true_speed_um_s": speed, "true_cycle_distance_nm": speed * config.period_ms,
        "true_distance_to_axle_nm": 0, "true_axles_in_cycle": 0,
    }  # fmt: skip


def _without_truth(step: Mapping[str, Cell]) -> dict[str, Cell]:
    return {name: value for name, value in step.items() if "true" not in name}


class _Train:
    """A train that rolls over the head; its first axle is half of the first cycle's way before the head."""

    def __init__(self, config: AxleCounterConfig, passage: Passage) -> None:
        self._config, self._passage = config, passage
        self._behind = [place * NM_PER_MM for place in passage.behind_mm]
        self._first_nm = passage.speeds[0] * config.period_ms * UM_PER_MM // 2

    def steps(self) -> Steps:
        """Return one step per cycle."""
        run, steps = -self._first_nm, Steps()
        for cycle, speed in enumerate(self._passage.speeds):
            way = speed * self._config.period_ms * UM_PER_MM
            inputs = self._inputs(run, run + way, speed) | self._truth(cycle, run, run + way, speed)
            changed = {**inputs, **self._passage.faults.get(cycle, {})}
            steps.append({name: value for name, value in changed.items() if value is not None})
            run += way
        return steps

    def _axles(self, before: int, after: int) -> list[int]:
        """Return the places of the axles that pass within the cycle, upwards or back."""
        return [place for place in self._behind if min(before, after) < place <= max(before, after)]

    def _is_on_the_head(self, run: int) -> bool:
        """Return whether an axle stands on the head, of which it is counted where it leaves it upwards."""
        return any(0 < place - run <= _HEAD_MM * NM_PER_MM for place in self._behind)

    def _inputs(self, before: int, after: int, speed: int) -> dict[str, Cell]:
        axles, damped = self._axles(before, after), self._is_on_the_head(after)
        if not axles:
            return {**_without_truth(_quiet(self._config, speed, over=False)), "head_damped": damped}
        most = self._config.max_speed_mm_s
        return {
            "axle": "UP" if speed > 0 else "DOWN", "axles_in_cycle": len(axles), "head_fault": False,
            "head_damped": damped, "passage_over": False, "axle_speed_low_mm_s": max(abs(speed) - _SPREAD_MM_S, 0),
            "axle_speed_high_mm_s": min(abs(speed) + _SPREAD_MM_S, most),
        }  # fmt: skip

    def _truth(self, cycle: int, before: int, after: int, speed: int) -> dict[str, Cell]:
        """Return the ghosts of a cycle. In the first one, the run since the first axle begins within the cycle."""
        axles = self._axles(before, after)
        since = 0 if cycle == 0 else before
        last = (axles[-1] if speed > 0 else axles[0]) if axles else since
        return {
            "next_true_speed_um_s": speed * UM_PER_MM, "axle_true_speed_um_s": speed * UM_PER_MM,
            "true_cycle_distance_nm": after - since, "true_distance_to_axle_nm": last - since, "true_axles_in_cycle": len(axles),
        }  # fmt: skip


# ------------------------------------------------------------------ named runs

COACHES = bogies(5)
_STEADY_MM_S = 20_000
Passages = Sequence[Passage]
_NOT_TOLD: Mapping[str, Cell | None] = {
    "axle": "NONE", "axles_in_cycle": 1, "axle_speed_low_mm_s": None, "axle_speed_high_mm_s": None
}  # fmt: skip


def _steady(config: AxleCounterConfig) -> Passage:
    return Passage(COACHES, _until_passed(config, COACHES, _STEADY_MM_S))


def _service(config: AxleCounterConfig) -> Passages:
    return [_steady(config), Passage(bogies(1), _until_passed(config, bogies(1), 16_000))]


def _braking(config: AxleCounterConfig) -> Passages:
    """Brake with 1 m/s2 over the counter."""
    return [Passage(COACHES, _until_passed(config, COACHES, 22_000, -config.change_mm_s * 2 // 3))]


def _turning(config: AxleCounterConfig) -> Passages:
    """Brake to a stand over the counter and run back."""
    change = config.change_mm_s - 10
    down = [max(6_000 - change * cycle, 0) for cycle in range(45)]
    back = [max(-change * cycle, -3_000) for cycle in range(130)]
    return [Passage(COACHES, (*down, *back)), _steady(config)]


def _crawling(config: AxleCounterConfig) -> Passages:
    """Let a train run so slowly that it has not certainly passed when the next one comes at the headway."""
    crawl, wagon = 2_000, bogies(1)
    cycles = (wagon[-1] + config.axle_gap_mm) * 1_000 // (crawl * config.period_ms) + 5
    return [Passage(wagon, (crawl,) * cycles), _steady(config), _steady(config)]


def _spoilt(cells: Mapping[str, Cell | None], *, untrue: bool = False) -> Callable[[AxleCounterConfig], Passages]:
    """Return passages in which one axle's cycle differs; the next train is as it should be."""

    def passages(config: AxleCounterConfig) -> Passages:
        train = _steady(config)
        cycle = [number for number, step in enumerate(_Train(config, train).steps()) if step["axle"] == "UP"][5]
        return [replace(train, faults={cycle: cells}, untrue=untrue), train]

    return passages


def _stays_damped(config: AxleCounterConfig) -> Passages:
    """Let a channel stay damped under the last axle, until the head is repaired, which it reports as a fault."""
    train = _steady(config)
    steps = _Train(config, train).steps()
    last = [number for number, step in enumerate(steps) if step["axle"] == "UP"][-1]
    faults: dict[int, Mapping[str, Cell | None]] = {cycle: {"head_damped": True} for cycle in range(last, len(steps))}
    faults[last] = {**_NOT_TOLD, "head_damped": True}
    faults[len(steps) - 1] = {"head_fault": True}
    return [replace(train, faults=faults), train]


def _power_up(config: AxleCounterConfig) -> Passages:
    """Start the machine while a train is on the counter."""
    return [replace(_steady(config), untrue=True, begins_at=30), _steady(config)]


def _worked(outcome: str, passages: Callable[[AxleCounterConfig], Passages]) -> WorkedRun[AxleCounterConfig]:
    return WorkedRun(outcome, lambda config: passed(config, passages(config)))


RUNS: Mapping[str, WorkedRun[AxleCounterConfig]] = {
    "axle_counter-service": _worked("Two trains, 20 and 4 axles: a sound record of each.", _service),
    "axle_counter-turned": _worked("The train turns on the counter: no record, flaw TURNED; the next has one.", _turning),
    "axle_counter-crawling": _worked(
        "A train has not certainly passed when the next one comes at the headway: no record of either, flaw "
        "MAYBE_ANOTHER_TRAIN; the third one has one.",
        _crawling,
    ),
    "axle_counter-direction-unknown": _worked(
        "The head does not know the direction of an axle: no record, flaw HEAD_FAULT; the next train has one.",
        _spoilt({**_NOT_TOLD, "head_fault": True}),
    ),
    "axle_counter-head-stays-damped": _worked(
        "A channel stays damped under the last axle, and the head leaves it uncounted without a fault: no record, flaw HEAD_DAMPED; the "
        "next train has one.",
        _stays_damped,
    ),
    "axle_counter-no-speed": _worked(
        "The speed of an axle does not come: no record, flaw NO_SPEED; the next train has one.",
        _spoilt({"axle_speed_low_mm_s": None}),
    ),
}  # fmt: skip
"""The recordings that ship, by name."""
ON_DEMAND: Mapping[str, WorkedRun[AxleCounterConfig]] = {
    "axle_counter-braking": _worked(
        "The train brakes on the counter: the record's bounds contain its length; speed times time would not.", _braking
    ),
    "axle_counter-power-up": _worked(
        "Started while a train passes: no record of the rest of it; the next train has one.", _power_up
    ),
    "axle_counter-miscount": _worked(
        "The head misses an axle without reporting a fault, and is free: the record is one axle short. This machine cannot "
        "notice it; the comparison with the fibre's count does.",
        _spoilt(_NOT_TOLD, untrue=True),
    ),
}  # fmt: skip
"""Runs that do not ship, by name: another one shows each of their transitions and cases."""


if __name__ == "__main__":
    write_named(__file__, RUNS, ON_DEMAND, AxleCounterConfig())
