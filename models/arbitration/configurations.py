"""Configurations in which the arbitration is proved beside its defaults, so that no case of it stays folded away."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.arbitration.variables import ArbitrationConfig

NEVER = {
    "models/arbitration/cycle.py: minimum(found, ite(source.valid, source.margin, self._far)) from self.least": "the first of the sources, and the only one where there is one",
}
"""Case splits that no configuration makes live, and why."""
CONFIGURATIONS = Configurations({"a single source": ArbitrationConfig(sources=("balise",))}, NEVER)
