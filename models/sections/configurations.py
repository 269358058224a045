"""Configurations of area and sections, besides the defaults, in which all their case splits are live in some proof."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.area import AreaConfig
from safeloc.models.sections import SectionsConfig

CONFIGURATIONS = Configurations(
    {
        "a report of integrity is not trusted": SectionsConfig(area=AreaConfig(integrity_is_trusted=False)),
        "borders report occupancy alone": SectionsConfig(
            area=AreaConfig(borders="occupancy", entry_report_delay_ms=5_000)
        ),
        "borders report occupancy alone, integrity is not trusted": SectionsConfig(
            area=AreaConfig(borders="occupancy", integrity_is_trusted=False)
        ),
        "detection inside the area": SectionsConfig(area=AreaConfig(trains=2, inner_detection=2)),
        "detection inside the area, integrity is not trusted": SectionsConfig(
            area=AreaConfig(trains=2, inner_detection=2, integrity_is_trusted=False)
        ),
        "detection inside the area, borders report occupancy alone": SectionsConfig(
            area=AreaConfig(trains=2, borders="occupancy", inner_detection=2, entry_report_delay_ms=5_000)
        ),
        "detection inside the area, borders report occupancy alone, integrity is not trusted": SectionsConfig(
            area=AreaConfig(trains=2, borders="occupancy", inner_detection=2, integrity_is_trusted=False)
        ),
    }
)
