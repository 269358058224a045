"""What judging the laws of the worlds costs in `safeloc run`: python -m benchmarks.bench_assumptions [rounds]

Lines of whole drives go through the same vehicles as in the process, from bytes to reports as bytes, with the laws judged and
without, in turns. What counts is the ratio of the least processor times: other work on the machine only adds to them. Target: no
more than a tenth.

    odometry   records: four distances in a cycle, now and then a marker, and the end of the cycle
    localizer  the inputs of each step of a shipped journey; each journey is a vehicle of its own
"""

from __future__ import annotations

import gc
import json
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import islice
from statistics import median

from benchmarks.vehicle_lines import odometry_lines
from safeloc.language.system import without_ghosts
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.runtime.embedding import Program, localizer_program
from safeloc.runtime.service.fleet import Fleet, FleetSettings
from safeloc.runtime.service.lines import LineCutter
from safeloc.runtime.streams.steps import read_steps
from safeloc.shipped_machines import ENTRIES

ROUNDS, CYCLES, PERIOD_MS = "11", 2_000, 100
TARGET = 1.1
Lines = Sequence[bytes]


def journeys(program: Program) -> Lines:
    """Each shipped journey as the steps of a vehicle."""
    names = {var.name for var in without_ghosts(program.target.system).inputs}
    said = []
    for vehicle, path in enumerate(program.target.streams, 1):
        for cycle, step in enumerate(read_steps(path).steps, 1):
            inputs = {name: value for name, value in step.items() if name in names}
            said.append(json.dumps({"vehicle": str(vehicle), "cycle": cycle, **inputs}).encode() + b"\n")
    return said


def spent_s(program: Program, settings: FleetSettings, lines: Lines) -> float:
    """Processor time for all lines, from bytes to reports as bytes."""
    fleet, cutter, cycles = Fleet(program, settings), LineCutter(), 0
    gc.collect()
    begin = time.process_time()
    for data in lines:
        for line in cutter.feed(data):
            for told in fleet.handle("benchmark", line, from_start=True):
                cycles += b'"mode"' in json.dumps(told).encode()
    spent = time.process_time() - begin
    if not cycles or fleet.tally.refused or fleet.tally.breaches:
        raise RuntimeError(f"no lawful drive: {fleet.tally}")
    return spent / cycles


@dataclass(frozen=True)
class Turns:
    """Processor time of a cycle in each round, s: without the laws, and with them judged."""

    without: Sequence[float]
    judged: Sequence[float]

    @property
    def ratio(self) -> float:
        """Of the least times."""
        return min(self.judged) / min(self.without)

    @property
    def ratios(self) -> list[float]:
        """Round by round, in order."""
        return sorted(one / other for one, other in zip(self.judged, self.without, strict=True))


def turns(program: Program, inputs: bool, lines: Lines, rounds: int) -> Turns:
    """Measure both ways, one after the other, in each round."""
    both = [
        (
            spent_s(program, FleetSettings(PERIOD_MS, inputs, assumptions=False), lines),
            spent_s(program, FleetSettings(PERIOD_MS, inputs), lines),
        )
        for _ in range(rounds)
    ]
    return Turns([without for without, _ in both], [judged for _, judged in both])


def _odometry() -> tuple[Program, bool, Lines]:
    config = OdometryConfig(trust_first_marker=True, period_ms=PERIOD_MS)
    return Program(ENTRIES["odometry"].make(config)), False, list(islice(odometry_lines("1", PERIOD_MS), CYCLES))


def _localizer() -> tuple[Program, bool, Lines]:
    program = localizer_program()
    return program, True, journeys(program)


DRIVES: dict[str, Callable[[], tuple[Program, bool, Lines]]] = {"odometry": _odometry, "localizer": _localizer}


def main() -> None:
    """Measures and prints."""
    (rounds,) = sys.argv[1:] or (ROUNDS,)
    for name, drive in DRIVES.items():
        found = turns(*drive(), int(rounds))
        kept = "met" if found.ratio <= TARGET else "MISSED"
        print(
            f"{name:10} {min(found.without) * 1e6:6.0f} us a cycle without, x {found.ratio:.3f} with the laws judged "
            f"(rounds: median x {median(found.ratios):.3f}, from {found.ratios[0]:.3f} to {found.ratios[-1]:.3f}); "
            f"target x {TARGET}: {kept}"
        )


if __name__ == "__main__":
    main()
