"""Configuration of a counted entry: the axle counter, the verification of the train, and where the counter is."""

from __future__ import annotations

from pydantic import model_validator

from safeloc.config import CompositionConfig, quantity
from safeloc.language.units import UM_PER_MM
from safeloc.models.axle_counter import AxleCounterConfig
from safeloc.models.verification import VerificationConfig

_FROM_THE_COUNTER = 1_600_000
"""Longest length in a record, mm: that of the longest train, and what its bounds may exceed it by while it passes."""


class CountedEntryConfig(CompositionConfig):
    """One counter at the entrance of an area, and the verification of the train that it has counted, in cycles of one period."""

    counter: AxleCounterConfig = AxleCounterConfig()
    verification: VerificationConfig = VerificationConfig(period_ms=100, length_limit_mm=_FROM_THE_COUNTER)
    counter_mm: int = quantity(0, "mm", -1_000_000_000, 1_000_000_000, "[D] survey of the counting head on the line")
    overhang_mm: int = quantity(
        5_000, "mm", 0, 50_000, "[M, fairly sure] longest distance from the foremost axle to the end of a vehicle"
    )

    @model_validator(mode="after")
    def _one_cycle(self) -> CountedEntryConfig:
        for figure in ("period_ms", "max_speed_mm_s", "axle_limit"):
            counted, verified = getattr(self.counter, figure), getattr(self.verification, figure)
            if counted != verified:
                raise ValueError(
                    f"verification.{figure} is {verified}, but the counter's is {counted}; make them the same."
                )
        return self

    @model_validator(mode="after")
    def _fits(self) -> CountedEntryConfig:
        """Refuse figures with which the counter's record would not be an input of the verification."""
        longest = -(-self.counter.run_limit_um // UM_PER_MM) + self.counter.late_mm
        if self.verification.length_limit_mm < longest:
            raise ValueError(
                f"verification.length_limit_mm {self.verification.length_limit_mm} is below {longest}, by which the counter bounds a "
                "passage (counter.length_limit_mm, axle_gap_mm, late_mm and the run of a cycle); raise it."
            )
        farthest = abs(self.counter_mm) + 2 * longest + self.overhang_mm + 1
        if self.verification.position_limit_mm < farthest:
            raise ValueError(
                f"verification.position_limit_mm {self.verification.position_limit_mm} is below {farthest}, where the counter may "
                "place a train's front; raise it."
            )
        return self
