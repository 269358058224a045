"""Configuration of a train and its area: those of the machines in the step, which have one cycle."""

from __future__ import annotations

from pydantic import model_validator

from safeloc.config import Config, quantity
from safeloc.models.area import AreaConfig, refuse_inner_detection
from safeloc.models.area.separation import Following
from safeloc.models.axle_section import AxleSectionConfig
from safeloc.models.emitter import EmitterConfig
from safeloc.models.fibre import FibreConfig
from safeloc.models.fibre_area.parting import PartingConfig
from safeloc.models.sections import SectionsConfig
from safeloc.models.verification import VerificationConfig


class FibreAreaConfig(Config):
    """Configurations of the machines in the step; all of them have one cycle."""

    axle_section: AxleSectionConfig = AxleSectionConfig()
    fibre: FibreConfig = FibreConfig()
    emitter: EmitterConfig = EmitterConfig()
    verification: VerificationConfig = VerificationConfig()
    sections: SectionsConfig = SectionsConfig(
        area=AreaConfig(trains=1, period_ms=500), following=Following(accuracy_mm=860_000)
    )
    parting: PartingConfig = PartingConfig()
    record_wait_cycles: int = quantity(240, "cycles", 1, 100_000, "[D] 2 min: 740 m at 22 km/h past the counter")

    @model_validator(mode="after")
    def _axles_are_counted(self) -> FibreAreaConfig:
        if self.sections.area.borders != "counted":
            raise ValueError(
                f'sections.area.borders is "{self.sections.area.borders}", but the train of fibre_area is counted in and out by '
                'its axles; make it "counted", or use `sections` for an area whose borders report occupancy alone.'
            )
        refuse_inner_detection(self.sections.area)
        return self

    @model_validator(mode="after")
    def _one_cycle(self) -> FibreAreaConfig:
        periods = {
            "fibre": self.fibre.period_ms,
            "verification": self.verification.period_ms,
            "sections.area": self.sections.area.period_ms,
        }
        if len(set(periods.values())) > 1:
            raise ValueError(f"period_ms differs: {periods}; the machines act in one step, give all of them one cycle.")
        return self
