"""Configurations of the localizer on a map with switches, besides the defaults, in which its claims are proved."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.localizer import LocalizerConfig
from safeloc.models.localizer_track.configuration import LocalizerTrackConfig

CONFIGURATIONS = Configurations({"all five sources": LocalizerTrackConfig(localizer=LocalizerConfig())})
