"""Configurations in which the machine of the unlinked group is proved beside its defaults, so that no case stays folded away."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.balise.configurations import ERRING
from safeloc.models.unlinked_group.variables import UnlinkedGroupConfig

CONFIGURATIONS = Configurations(
    {
        "an odometer that errs at standstill": UnlinkedGroupConfig(odometer=ERRING, tolerance_mm=60_000),
        "packets tell short distances": UnlinkedGroupConfig(reach_mm=60_000, tolerance_mm=60_000),
    }
)
