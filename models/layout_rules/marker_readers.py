"""Figures of a vehicle with a marker reader at either end, for the audit of a line (MRK-1)."""

from __future__ import annotations

from pydantic import Field, model_validator

from safeloc.config import Config, quantity
from safeloc.language.units import NM_PER_MM, PPM_PER_ONE
from safeloc.models.vocabulary.measured import max_cycle_distance_mm


class MarkerReaders(Config):
    """Figures of a vehicle with a marker reader at either end, under the names that the odometry machine has for them."""

    vehicle_length_mm: int = quantity(204_700, "mm between both readers", 0, 2_000_000, "[S] V90 + 10 Facs 124")
    vehicle_length_tolerance_mm: int = quantity(300, "mm", 0, 50_000, "[S] OCORA: up to + 0.30 m")
    marker_accuracy_mm: int = quantity(
        12_000, "mm", 0, 63_000, "[M] Q_NVLOCACC 12 m, for markers without an own figure"
    )
    reader_latency_ms: int = quantity(12, "ms", 0, 1_000, "[S] balise reader 10 +- 2 ms")
    period_ms: int = quantity(100, "ms", 10, 1_000, "[S] SUBSET-041: application cycle up to 100 ms")
    max_speed_mm_s: int = quantity(44_445, "mm/s", 1, 138_889, "[D] 160 km/h")
    max_acceleration_mm_s2: int = quantity(2_500, "mm/s2", 1, 10_000, "[M] 2.5 m/s2 with track brake")
    measuring_step_mm: int = quantity(14, "mm", 0, 10_000, "[S] 100 pulses a turn: 13.4 mm")
    pending_markers: int = quantity(4, "count", 1, 8, "[D] markers under one vehicle")
    groups_are_markers: bool = Field(
        default=True,
        description="the readers read balise groups too, each as a marker at its first balise",
        json_schema_extra={"unit": "yes or no", "source": "[S] the readers' figures are those of balise readers"},
    )

    @model_validator(mode="after")
    def _reads_in_time(self) -> MarkerReaders:
        if self.reader_latency_ms > self.period_ms:
            raise ValueError(
                "reader_latency_ms must not exceed period_ms; an older reading is stale and must be dropped."
            )
        if self.vehicle_length_mm - self.vehicle_length_tolerance_mm <= self.cycle_run_mm:
            raise ValueError(
                f"vehicle_length_mm {self.vehicle_length_mm} is within the run of a cycle, {self.cycle_run_mm} mm, and the length's "
                "tolerance: both readers could pass a marker in one cycle, and the trailing reading would not count."
            )
        return self

    @property
    def cycle_run_mm(self) -> int:
        """The farthest run of a cycle, mm, rounded up."""
        return max_cycle_distance_mm(self.max_speed_mm_s, self.period_ms, 0)

    @property
    def measured_in_a_cycle_mm(self) -> int:
        """The greatest distance that is measured in a cycle, mm."""
        return max_cycle_distance_mm(self.max_speed_mm_s, self.period_ms, self.measuring_step_mm)

    @property
    def unsteady_nm(self) -> int:
        """The run that a change of speed adds to that within the reader's latency, nm, rounded up."""
        return -(-self.max_acceleration_mm_s2 * self.period_ms * self.reader_latency_ms // 2)

    def late_nm(self, rate_ppm: int) -> int:
        """Return the run within the reader's latency, by an odometer of that rate, as the machine bounds it, nm."""
        share_ppm = -(-self.reader_latency_ms * PPM_PER_ONE // self.period_ms)
        wrong_ppm = -(-rate_ppm * share_ppm // PPM_PER_ONE)
        return self.measured_in_a_cycle_mm * (share_ppm + wrong_ppm) + self.unsteady_nm

    def fix_error_nm(self, accuracy_mm: int, rate_ppm: int) -> int:
        """Return the error of a position just read from a marker of that accuracy, without the odometer's constant, nm."""
        return (accuracy_mm + self.vehicle_length_tolerance_mm) * NM_PER_MM + self.late_nm(rate_ppm)
