"""Configurations in which the emitter's machine is proved beside its defaults, so that no case of it stays folded away."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.emitter.variables import EmitterConfig

CONFIGURATIONS = Configurations({"one pattern is enough": EmitterConfig(passes_to_recover=1)})
