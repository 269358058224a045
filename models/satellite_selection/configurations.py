"""Configurations in which the selection is proved beside its defaults, so that no case of it stays folded away."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.satellite_selection.variables import SelectionConfig

CONFIGURATIONS = Configurations(
    {
        "pseudorange alone, no warm-up": SelectionConfig(compared="pseudorange", warm_up_cycles=1),
        "Doppler alone": SelectionConfig(compared="doppler"),
        "removed by both figures only": SelectionConfig(removal="both"),
        "none without a current almanac": SelectionConfig(almanac="required"),
    },
)
