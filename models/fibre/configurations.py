"""Case splits of the fibre machine that no configuration makes live."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.fibre.coupled import CoupledConfig

NEVER = {
    "models/fibre/cycle.py: self.inside - length from self._reads(0)": "turned back: a section of no length",
    "properties/fibre/code.py: own.word_read * 0 from _symbol(model)": "a zero with the unit of a word",
    "properties/fibre/seen.py: self._inside - length_mm from self._like(0)": "turned back: a section of no length",
}
"Case splits that no configuration makes live, with the reason."
CONFIGURATIONS = Configurations({}, NEVER)
COUPLED = Configurations(
    {
        "sections as weak as may be": CoupledConfig(
            coupling_gain_cdb=1_100, damper_loss_cdb=1_100, material_gain_cdb=1_100, material_loss_cdb=1_100
        ),
        "rods to the rail and a guide of ten times the answer": CoupledConfig(
            coupling_gain_cdb=1_800, material_gain_cdb=2_000
        ),
    },
    {split: reason for split, reason in NEVER.items() if split.startswith("models/")},
)
