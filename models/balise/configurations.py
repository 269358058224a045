"""Configurations in which the balise machine is proved beside its defaults, so that no case of it stays folded away."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.balise.variables import BaliseConfig
from safeloc.models.vocabulary.error_law import ErrorLaw

ERRING = ErrorLaw(kind="wheel", constant_mm=3_000, rate_ppm=40_000, floor_mm_s=200, knee_mm_s=2_000)
"""An odometer that errs at standstill, and by its rate above a speed only."""
NEVER = {
    "models/balise/__init__.py: ite(known, place, as_num(0, MM)) from _lies(one, FALSE, one.place)": "the row forgets the place",
    "models/vocabulary/error_law.py: above * Lit(self.rate_ppm, PPM) + floor + drift from self.law.growth_nm(abs_(self.measured.value), as_num(0, MS), ...": "an odometer that drifts is refused: odometer.drift_mm_s2 must be 0",
    "models/vocabulary/interval.py: between(-limit_mm * NM_PER_MM, self.position, limit_mm * NM_ ... from interval.usable(own.config.tolerance_mm, own.config.position ...": "the kept place has this range; the question is live of a place yet to be kept",
    "properties/balise/step.py: exact_to(Lit(law.floor_mm_s * period, UM), NM) + with_unit(a ... from self._lawful_nm": "of claims made only for an odometer without an error at standstill",
}
"""Case splits that no configuration makes live, and why."""
CONFIGURATIONS = Configurations(
    {
        "an odometer that errs at standstill": BaliseConfig(odometer=ERRING),
        "the first group is believed": BaliseConfig(trust_first_group=True),
        "references come freely": BaliseConfig(free_references=True),
        "a second unit has checked the distance": BaliseConfig(odometer=ERRING, checked_distance=True),
    },
    NEVER,
)
