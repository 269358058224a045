"""What each vehicle of the fleet does all day: trips of simulated odometry, with its truth, and pauses between them.

Trips are cut from a few simulated runs. A vehicle is switched off between two trips, and moved meanwhile: a new trip begins in
a place that has nothing to do with the last one, so that a place that outlives a pause is a wrong one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from random import Random

from safeloc.models.odometry.simulate import simulate
from safeloc.models.odometry.variables import OdometryConfig

PERIOD_MS = 1_000
HOUR_MS = 3_600_000
DEVICES = 1
CONFIG = f"trust_first_marker = true\nperiod_ms = {PERIOD_MS}\ndevices = {DEVICES}\n"
"""An odometer at the front, and its longest cycle: so a day of 200 vehicles fits into an hour."""

RUNS = 12
RUN_S = 3_600.0
TRIP_S = (2_400, 3_600)
PAUSE_S = (300, 1_200)
IN_DEPOT_S = (28_800, 36_000)
TRIPS_A_DUTY = 14
DAY_S = 86_400
MARKERS = tuple((number + 1, (number - 500) * 250_000) for number in range(1_000))


@dataclass(frozen=True)
class Run:
    """A simulated drive: the records of each cycle as JSON without envelope and time, and the truth at its end, in mm."""

    records: tuple[tuple[str, ...], ...]
    truth_mm: tuple[int, ...]


@dataclass(frozen=True)
class Trip:
    """The first `cycles` of the run with this seed, from a time of the vehicle's own clock on."""

    begin_ms: int
    seed: int
    cycles: int

    @property
    def end_ms(self) -> int:
        """When the last cycle is over."""
        return self.begin_ms + self.cycles * PERIOD_MS

    @property
    def run(self) -> Run:
        """The run; it is simulated when it is first asked for."""
        return run(self.seed)

    def cycle_at(self, time_ms: int) -> int:
        """The cycle, from 0, that is over at this time."""
        return (time_ms - self.begin_ms) // PERIOD_MS - 1

    def truth_mm(self, time_ms: int) -> int:
        """Where the front was; after the last cycle it stands."""
        return self.run.truth_mm[max(0, min(self.cycles - 1, self.cycle_at(time_ms)))]


@cache
def run(seed: int) -> Run:
    """A drive of an hour over a line with a marker every 250 m."""
    config = OdometryConfig(trust_first_marker=True, period_ms=PERIOD_MS, devices=DEVICES)
    steps = simulate(config, seed=seed, seconds=RUN_S, markers=MARKERS)
    return Run(tuple(tuple(_records(step)) for step in steps), tuple(int(step["truth_mm"]) for step in steps))


def _records(step: dict[str, int | bool]) -> Iterator[str]:
    for unit in ("wheel", "radar"):
        if (distance := step.get(f"front_{unit}_mm")) is not None:
            yield f'"kind": "distance", "end": "front", "unit": "{unit}", "distance_mm": {distance}'
    for end in ("front", "rear"):
        if f"{end}_marker" in step:
            more = "".join(
                f', "{name}": {step[f"{end}_marker_{name}"]}'
                for name in ("position_mm", "accuracy_mm", "since_mm")
                if f"{end}_marker_{name}" in step
            )
            yield f'"kind": "marker", "end": "{end}", "marker": {step[f"{end}_marker"]}{more}'


def trips(seed: int, vehicle: int) -> Iterator[Trip]:
    """Without end, from some time of the day before on, so that each vehicle has its hours in the depot at another time.

    About half of the fleet drives at any time.
    """
    chance = Random(f"{seed} {vehicle}")
    begin_ms, left = -1_000 * chance.randrange(DAY_S), TRIPS_A_DUTY
    while True:
        trip = Trip(begin_ms, chance.randrange(RUNS), chance.randint(*TRIP_S))
        yield trip
        pause_s = chance.randint(*(PAUSE_S if left else IN_DEPOT_S))
        left = left - 1 if left else TRIPS_A_DUTY
        begin_ms = trip.end_ms + pause_s * 1_000


def lines(vehicle: str, number: int, time_ms: int, records: Sequence[str]) -> list[bytes]:
    """A cycle: its records and its end, numbered from `number` on."""
    said = (*records, '"kind": "cycle"')
    return [
        f'{{"vehicle": "{vehicle}", "number": {number + place}, "time_ms": {time_ms}, {one}}}\n'.encode()
        for place, one in enumerate(said)
    ]
