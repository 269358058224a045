"""Configuration of the fibre device: the area with its train, the counters at both ends, and the time of flight along the cable."""

from __future__ import annotations

from pydantic import model_validator

from safeloc.config import CompositionConfig, quantity
from safeloc.language.units import UM_PER_MM
from safeloc.models.area import AreaConfig
from safeloc.models.axle_counter import AxleCounterConfig
from safeloc.models.fibre import FibreConfig
from safeloc.models.fibre_area import FibreAreaConfig
from safeloc.models.fibre_timed.configuration import FibreTimedConfig
from safeloc.models.time_of_flight import TimeOfFlightConfig
from safeloc.models.verification import VerificationConfig

SIDES = ("low", "high")
"""Ends of the area, with a counter each."""
_LINE_SPEED_MM_S = AreaConfig().max_speed_mm_s


class FibreDeviceConfig(CompositionConfig):
    """One train, its area, and all sensors of the area; all machines act in one step, of one period."""

    area: FibreAreaConfig = FibreAreaConfig(
        fibre=FibreConfig(flight_threshold_mm=155_000),
        verification=VerificationConfig(length_limit_mm=1_600_000, max_speed_mm_s=_LINE_SPEED_MM_S),
    )
    counter: AxleCounterConfig = AxleCounterConfig(
        period_ms=500, axles_a_cycle=40, length_spread_mm=200_000, max_speed_mm_s=_LINE_SPEED_MM_S
    )
    time_of_flight: TimeOfFlightConfig = TimeOfFlightConfig()
    point_reach_mm: int = quantity(
        500_000, "mm", 0, 200_000_000, "[M] engineering default: a surveyed point in every kilometre of cable"
    )
    overhang_mm: int = quantity(
        5_000, "mm", 0, 50_000, "[M, fairly sure] longest distance from the foremost axle to the end of a vehicle"
    )

    @property
    def timed(self) -> FibreTimedConfig:
        """The configuration of one end that is timed. ValidationError where its threshold is too low for a true time."""
        return FibreTimedConfig(
            fibre=self.area.fibre, time_of_flight=self.time_of_flight, point_reach_mm=self.point_reach_mm
        )

    @property
    def longest_record_mm(self) -> int:
        """Greatest length that a counter's record can have, mm rounded up."""
        return -(-self.counter.run_limit_um // UM_PER_MM) + self.counter.late_mm

    @model_validator(mode="after")
    def _one_cycle(self) -> FibreDeviceConfig:
        """Refuse counters and verification with different figures of the same thing."""
        heads, area = self.area.axle_section, self.area.verification
        for figure, name, other in (
            ("period_ms", "area.verification", area.period_ms),
            ("max_speed_mm_s", "area.verification", area.max_speed_mm_s),
            ("max_speed_mm_s", "area.sections.area", self.area.sections.area.max_speed_mm_s),
            ("axle_limit", "area.verification", area.axle_limit),
            ("axles_a_cycle", "area.axle_section", heads.axles_a_cycle),
        ):
            counted = getattr(self.counter, figure)
            if counted != other:
                raise ValueError(f"{name}.{figure} is {other}, but counter.{figure} is {counted}; make them the same.")
        return self

    @model_validator(mode="after")
    def _fits(self) -> FibreDeviceConfig:
        """Refuse figures with which a counter's record would not be an input of the verification."""
        longest, verified = self.longest_record_mm, self.area.verification
        if verified.length_limit_mm < longest:
            raise ValueError(
                f"area.verification.length_limit_mm {verified.length_limit_mm} is below {longest}, by which a counter bounds a "
                "passage (counter.length_limit_mm, axle_gap_mm, late_mm and the run of a cycle); raise it."
            )
        farthest = self.area.sections.area.limit_mm + 2 * longest + self.overhang_mm + 1
        if verified.position_limit_mm < farthest:
            raise ValueError(
                f"area.verification.position_limit_mm {verified.position_limit_mm} is below {farthest}, where a counter at the end "
                "of an area may place a train's front (area.sections.area.limit_mm); raise it."
            )
        return self

    @model_validator(mode="after")
    def _comparable(self) -> FibreDeviceConfig:
        _ = self.timed
        return self
