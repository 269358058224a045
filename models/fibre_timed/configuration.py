"""Configuration of the fibre that is timed: sections, time of flight, and the surveyed points along the cable."""

from __future__ import annotations

from pydantic import model_validator

from safeloc.config import CompositionConfig, quantity
from safeloc.language.units import PPM_PER_ONE
from safeloc.models.fibre import FibreConfig
from safeloc.models.time_of_flight import TimeOfFlightConfig

_PS_PER_S_TO_MM = 10**9


class FibreTimedConfig(CompositionConfig):
    """One end of a train on one fibre; the threshold of F is the one of `fibre`.

    The threshold, less what an edge can be off where a signal is compared, is the greatest margin of a place that is compared.
    """

    fibre: FibreConfig = FibreConfig(flight_threshold_mm=155_000)
    time_of_flight: TimeOfFlightConfig = TimeOfFlightConfig()
    point_reach_mm: int = quantity(
        500_000, "mm", 0, 200_000_000, "[M] engineering default: a surveyed point in every kilometre of cable"
    )

    @property
    def off_at_a_signal_mm(self) -> int:
        """Greatest distance of the end from the edge of the section in the cycle of its signal, mm rounded up: the edge's
        tolerance, and the run of the cycle with its error.
        """
        fibre = self.fibre
        run = fibre.max_cycle_distance_mm
        return fibre.edge_tolerance_mm + run + -(-run * fibre.rate_ppm // PPM_PER_ONE) + fibre.floor_mm

    @property
    def comparable_margin_mm(self) -> int:
        """Greatest margin of a place by time of flight that is compared, mm; with a wider one a true time could raise F."""
        return self.fibre.flight_threshold_mm - self.off_at_a_signal_mm

    @property
    def widest_margin_mm(self) -> int:
        """Greatest margin of a place by time of flight, mm rounded up, with a surveyed point within `point_reach_mm` of the
        distance Ls: at the end of the fibre.
        """
        flight = self.time_of_flight
        way_mm = 2 * (flight.fibre_mm + flight.pattern_error_mm + 1)
        longest_ps = -(-way_mm * _PS_PER_S_TO_MM // flight.slowest_m_s) + flight.time_error_ps
        error_ps, fast, slow = flight.time_error_ps, flight.fastest_m_s, flight.slowest_m_s
        there_and_back = (longest_ps + error_ps) * fast - (longest_ps - error_ps) * slow
        along_the_fibre = there_and_back // (2 * _PS_PER_S_TO_MM) + 2 + 2 * flight.pattern_error_mm
        beyond_mm = max(self.point_reach_mm - along_the_fibre // 2, 0)
        slack = -(-beyond_mm * flight.slack_ppm // PPM_PER_ONE)
        return -(-(along_the_fibre + slack) // 2) + flight.map_error_mm

    @model_validator(mode="after")
    def _one_line(self) -> FibreTimedConfig:
        if self.time_of_flight.position_limit_mm != self.fibre.position_limit_mm:
            raise ValueError(
                f"time_of_flight.position_limit_mm is {self.time_of_flight.position_limit_mm}, but fibre.position_limit_mm is "
                f"{self.fibre.position_limit_mm}; make them the same."
            )
        return self

    @model_validator(mode="after")
    def _comparable(self) -> FibreTimedConfig:
        least = self.widest_margin_mm + self.off_at_a_signal_mm
        if self.fibre.flight_threshold_mm < least:
            raise ValueError(
                f"fibre.flight_threshold_mm is {self.fibre.flight_threshold_mm}, but a true time may give a place that is up to {least} mm "
                f"off the section: {self.widest_margin_mm} by the time of flight (point_reach_mm, slack_ppm, pattern_error_mm), and "
                f"{self.off_at_a_signal_mm} in the cycle of a signal; raise it, or survey more points."
            )
        return self
