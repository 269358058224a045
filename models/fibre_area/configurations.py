"""Configurations of the area, besides the defaults, in which all its case splits are live in some proof."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.area import AreaConfig
from safeloc.models.fibre_area import FibreAreaConfig
from safeloc.models.sections import SectionsConfig
from safeloc.models.verification import VerificationConfig

NEVER = {
    "models/area/__init__.py: rejected + ite(strange, as_num(1, COUNT), 0) from _rejected(own)": "the first of the sum; with more than one train `sections` proves the others",
}
"Case splits that no configuration makes live, with the reason."
CONFIGURATIONS = Configurations(
    {
        "no emitter is needed": FibreAreaConfig(verification=VerificationConfig(needs_emitter=False)),
        "a count alone makes nothing whole": FibreAreaConfig(
            sections=SectionsConfig(area=AreaConfig(trains=1, period_ms=500, integrity_is_trusted=False))
        ),
    },
    NEVER,
)
