"""Controllers: steps a second, and memory over many steps: python -m benchmarks.bench_embedding [millions of steps]

Speed is of whole cycles, as a host makes them: records (four distances, now and then a marker) or inputs in, a report out.
Memory is resident memory while one controller steps on and on; 0.2 million steps unless told, 10 take some ten minutes.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from safeloc.embedding import Controller, Program
from safeloc.models.odometry_parts.variables import OdometryConfig
from safeloc.shipped import ENTRIES
from safeloc.streams.records import DistanceRecord, End, MarkerRecord, Record

PERIOD_MS, STEP_MM, MARKER_EVERY = 100, 1_200, 200
ENDS: tuple[End, End] = ("front", "rear")
STEPS = 20_000
LOOKS = 10
FLAT_KB = 512


def drive(first: int, cycles: int) -> Iterator[list[Record]]:
    """Records of each cycle; the track is a ring of 100 km, so that it never ends."""
    for cycle in range(first, first + cycles):
        time_ms = cycle * PERIOD_MS
        said: list[Record] = [
            DistanceRecord(time_ms=time_ms, end=end, unit=unit, step_mm=STEP_MM)
            for end in ENDS
            for unit in ("wheel", "radar")
        ]
        if cycle % MARKER_EVERY == 1:
            place = cycle * STEP_MM % 100_000_000
            said.append(
                MarkerRecord(
                    time_ms=time_ms, end="front", marker=1 + cycle // MARKER_EVERY % 400, position_mm=place,
                    accuracy_mm=500, since_mm=0,
                )
            )  # fmt: skip
        yield said


def resident_kb() -> int:
    """Memory of this process that is in use."""
    status = Path("/proc/self/status").read_text(encoding="utf-8")
    return int(next(line for line in status.splitlines() if line.startswith("VmRSS")).split()[1])


def speed(step: Callable[[object], object], said: Sequence[object]) -> float:
    """Cycles a second of processor time."""
    begin = time.process_time()
    for one in said:
        step(one)
    return len(said) / (time.process_time() - begin)


def speeds(program: Program) -> dict[str, float]:
    """By way of stepping."""
    said = list(drive(1, STEPS))
    inputs = [{name: value for record in one for name, value in record.inputs().items()} for one in said]
    by_records, by_inputs = Controller(program), Controller(program)
    bare = program.code
    rows = [bare.read(one) for one in inputs]
    tick, _ = bare.begin(bare.first())
    return {
        "compiled step alone": speed(lambda row: tick(*row), rows),
        "Controller.step_inputs": speed(by_inputs.step_inputs, inputs),
        "Controller.step, records": speed(by_records.step, said),
    }


def memory(program: Program, steps: int) -> list[int]:
    """Resident kB after each tenth."""
    controller, found = Controller(program), []
    for look in range(LOOKS):
        for said in drive(1 + look * (steps // LOOKS), steps // LOOKS):
            controller.step(said)
        found.append(resident_kb())
    return found


def main() -> None:
    """Measures and prints."""
    program = Program(ENTRIES["odometry"].make(OdometryConfig(trust_first_marker=True)))
    for name, found in speeds(program).items():
        print(f"{name:26}{found:12,.0f} cycles/s")
    steps = int(float(sys.argv[1]) * 1_000_000) if len(sys.argv) > 1 else 200_000
    resident = memory(program, steps)
    print(f"resident kB over {steps:,} steps: {' '.join(map(str, resident))}")
    grown = resident[-1] - resident[0]
    print(f"{'flat' if grown <= FLAT_KB else 'GROWING'}: {grown} kB more after the last tenth than after the first")


if __name__ == "__main__":
    main()
