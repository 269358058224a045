"""Case splits of the fibre machine that no configuration makes live."""

from __future__ import annotations

from safeloc.config import Configurations

NEVER = {
    "models/fibre/cycle.py: self.inside - length from self._reads(0)": "turned back: a section of no length",
    "properties/fibre/code.py: own.word_read * 0 from _symbol(model)": "a zero with the unit of a word",
    "properties/fibre/seen.py: self._inside - length_mm from self._like(0)": "turned back: a section of no length",
}
"Case splits that no configuration makes live, with the reason."
CONFIGURATIONS = Configurations({}, NEVER)
