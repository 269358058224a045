"""Hypothesis profiles: `ci` repeats the same examples in every run, `deep` looks for new ones and takes longer.

SAFELOC_HYPOTHESIS=deep pytest tests
"""

from __future__ import annotations

import os

from hypothesis import HealthCheck, settings

SLOW_BUT_FINE = (HealthCheck.too_slow, HealthCheck.data_too_large)

settings.register_profile(
    "ci", derandomize=True, deadline=None, max_examples=60, database=None, suppress_health_check=SLOW_BUT_FINE
)
settings.register_profile("deep", deadline=None, max_examples=1000, suppress_health_check=SLOW_BUT_FINE)
settings.load_profile(os.environ.get("SAFELOC_HYPOTHESIS", "ci"))
