"""An odometer that under-reads by more than it over-reads: its distances are corrected before the machine gets them.

    python docs/examples/uneven_odometer.py

A worn wheel turns more often for the same way, a braked one less often, so its two rates are seldom equal. The machine's law has one
rate for both sides. `ReadingRates` makes of both rates a correction of each distance, and the law that is left for the
corrected ones; that they keep it is proved. Here the true run is up to 2 % shorter and up to 10 % longer than the wheel measures. With 10 % to either
side the interval would be wider.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import Literal

from safeloc.models.odometry.variables import OdometryConfig
from safeloc.models.vocabulary.error_law import RADAR, WHEEL, ErrorLaw
from safeloc.models.vocabulary.reading_rates import ReadingRates
from safeloc.runtime.embedding import Controller, Interval, Program
from safeloc.runtime.streams.records import DistanceRecord, MarkerRecord, Record
from safeloc.shipped_machines import ENTRIES

PERIOD_MS = 100
ENDS: tuple[Literal["front", "rear"], ...] = ("front", "rear")
UNITS: tuple[Literal["wheel", "radar"], ...] = ("wheel", "radar")
RATES = ReadingRates(under_ppm=100_000, over_ppm=20_000)
TRUE_MM, MEASURED_MM = 2_000, 1_840
"""The run of a cycle, and what each unit measures of it: 8.7 % of what it measures is missing."""
MARKER_EVERY = 100


def figures(*, corrected: bool) -> OdometryConfig:
    """Return the configuration: the laws of corrected distances, or those with the greater rate to both sides."""
    wheel, radar = (
        RATES.law(unit, PERIOD_MS) if corrected else ErrorLaw(**{**unit.model_dump(), "rate_ppm": RATES.under_ppm})
        for unit in (WHEEL, RADAR)
    )
    return OdometryConfig(trust_first_marker=True, first_unit=wheel, second_unit=radar, tolerance_mm=60_000)


def journey(cycles: int = 300, *, corrected: bool = True) -> Iterator[tuple[int, Interval | None]]:
    """Yield the true place and the interval of each cycle. Each unit has a correction of its own, from the start of the journey on."""
    controller = Controller(Program(ENTRIES["odometry"].make(figures(corrected=corrected))))
    corrections = {(end, unit): RATES.correction() for end, unit in product(ENDS, UNITS)}
    for cycle in range(1, cycles + 1):
        records: list[Record] = []
        for end, unit in product(ENDS, UNITS):
            distance = corrections[end, unit].distance_mm(MEASURED_MM) if corrected else MEASURED_MM
            records.append(DistanceRecord(time_ms=cycle * PERIOD_MS, end=end, unit=unit, distance_mm=distance))
        if cycle % MARKER_EVERY == 1:
            records.append(
                MarkerRecord(
                    time_ms=cycle * PERIOD_MS, end="front", marker=1 + cycle // MARKER_EVERY, position_mm=cycle * TRUE_MM,
                    accuracy_mm=500, since_mm=0,
                )
            )  # fmt: skip
        yield cycle * TRUE_MM, controller.step(records).interval


def main() -> None:
    """Tell the widest interval with both rates, and with the greater one to either side."""
    law = figures(corrected=True).first_unit
    print(f"first_unit.rate_ppm = {law.rate_ppm}, constant_mm = {law.constant_mm}, floor_mm_s = {law.floor_mm_s}")
    for corrected, words in ((True, "both rates"), (False, "the greater one")):
        told = [one for _, one in journey(corrected=corrected) if one is not None]
        print(
            f"{words}: {len(told)} intervals, up to {max(one.high_mm - one.low_mm for one in told) / 1_000:.3f} m wide"
        )


if __name__ == "__main__":
    main()
