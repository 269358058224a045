"""Configurations of the emitter's machine, besides the defaults, in which all its case splits are live in some proof."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.emitter.variables import EmitterConfig

CONFIGURATIONS = Configurations({"one pattern is enough": EmitterConfig(passes_to_recover=1)})
