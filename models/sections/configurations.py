"""Configurations in which area and sections are proved beside their defaults, so that no case of them stays folded away."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.area import AreaConfig
from safeloc.models.sections import SectionsConfig

CONFIGURATIONS = Configurations(
    {"a report of integrity is not trusted": SectionsConfig(area=AreaConfig(integrity_is_trusted=False))}
)
