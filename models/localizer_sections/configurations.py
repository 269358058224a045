"""Configurations of the located train in its sections, besides the defaults, in which its claims are proved."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.area import AreaConfig
from safeloc.models.localizer_sections import LocalizerSectionsConfig
from safeloc.models.sections import SectionsConfig

NEVER = {
    "properties/localizer_sections.py: area.num(slot.age).eq(0) from all_of(_reaches_the_area(model))": "the wire is 0, as it should be; "
    "the claim is there for another one",
}
"""Case splits that no configuration makes live, and why."""
CONFIGURATIONS = Configurations(
    {
        "borders report occupancy alone": LocalizerSectionsConfig(
            sections=SectionsConfig(
                area=AreaConfig(trains=1, period_ms=100, limit_mm=1_000_000_000, borders="occupancy")
            )
        )
    },
    NEVER,
)
