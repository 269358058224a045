"""Controllers: cycles a second, and memory over many of them.

    python -m benchmarks.bench_embedding [millions of cycles [machine [bare]]]

Speed is of whole cycles, as a host makes them: records (four distances, now and then a marker) or inputs in, a report out;
beside it stands the compiled step alone, with rows made ready. Memory is resident memory while one controller (or, with
`bare`, the compiled step) goes on and on: 0.2 million cycles unless told, 10 take some minutes. Machines are `odometry`, and
`localizer` on the inputs of its shipped journeys, one after the other.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import cycle as forever
from itertools import islice
from pathlib import Path

from safeloc.models.odometry.variables import OdometryConfig
from safeloc.proof.drawn_runs.sampled import recorded_run
from safeloc.runtime.embedding import Controller, Program, localizer_program
from safeloc.runtime.streams.records import DistanceRecord, End, MarkerRecord, Record
from safeloc.shipped_machines import ENTRIES

PERIOD_MS, STEP_MM, MARKER_EVERY = 100, 1_200, 200
ENDS: tuple[End, End] = ("front", "rear")
CYCLES = 20_000
LOOKS = 10
FLAT_KB = 512
Inputs = Sequence[Mapping[str, object]]


def drive(first: int, cycles: int) -> Iterator[list[Record]]:
    """Records of each cycle; the track is a ring of 100 km, so that it never ends."""
    for cycle in range(first, first + cycles):
        time_ms = cycle * PERIOD_MS
        said: list[Record] = [
            DistanceRecord(time_ms=time_ms, end=end, unit=unit, distance_mm=STEP_MM)
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


def driven_inputs() -> Inputs:
    """The inputs that those records stand for."""
    return [{k: v for record in said for k, v in record.inputs().items()} for said in drive(1, CYCLES)]


def journeys(program: Program) -> Inputs:
    """The inputs of all shipped journeys of the program's target."""
    return [step for path in program.target.streams for step in recorded_run(program.system, path, CYCLES).steps]


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


def speeds(program: Program, inputs: Inputs) -> dict[str, float]:
    """By way of stepping."""
    rows = [program.code.read(one) for one in inputs]
    tick, _ = program.code.begin(program.code.first())
    found = {
        "compiled step alone": speed(tick, rows),  # type: ignore[arg-type] # rows
        "Controller.step_inputs": speed(Controller(program).step_inputs, inputs),  # type: ignore[arg-type] # inputs
    }
    if program.name == "odometry":
        said = list(drive(1, CYCLES))
        found["Controller.step, records"] = speed(Controller(program).step, said)  # type: ignore[arg-type] # records
    return found


def endless(program: Program, inputs: Inputs, *, bare: bool) -> Iterable[object]:
    """One cycle after the other."""
    if bare:
        rows = [program.code.read(one) for one in inputs]
        tick, _ = program.code.begin(program.code.first())
        return (tick(row) for row in forever(rows))
    controller = Controller(program)
    if program.name == "odometry":
        return (controller.step(said) for said in drive(1, sys.maxsize - 1))
    return (controller.step_inputs(one) for one in forever(inputs))


def memory(cycles: Iterable[object], count: int) -> Iterator[int]:
    """Resident kB after each tenth."""
    steps = iter(cycles)
    for _ in range(LOOKS):
        for _ in islice(steps, count // LOOKS):
            pass
        yield resident_kb()


def main() -> None:
    """Measures and prints."""
    millions, machine, way = (*sys.argv[1:], *("0.2", "odometry", "controller")[len(sys.argv) - 1 :])
    odometry = machine == "odometry"
    entry = ENTRIES["odometry"]
    program = Program(entry.make(OdometryConfig(trust_first_marker=True))) if odometry else localizer_program()
    inputs = driven_inputs() if odometry else journeys(program)
    for name, found in speeds(program, inputs).items():
        print(f"{name:26}{found:12,.0f} cycles/s")
    count = int(float(millions) * 1_000_000)
    print(f"resident kB over {count:,} cycles of {machine}, {way}:", end="", flush=True)
    resident = []
    for found_kb in memory(endless(program, inputs, bare=way == "bare"), count):
        resident.append(found_kb)
        print(f" {found_kb}", end="", flush=True)
    grown = resident[-1] - resident[0]
    print(f"\n{'flat' if grown <= FLAT_KB else 'GROWING'}: {grown} kB more after the last tenth than after the first")


if __name__ == "__main__":
    main()
