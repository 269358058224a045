"""Configurations in which the reflector machine is proved besides its defaults, so that proofs cover cases which the defaults fold away."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.reflector.range_sensors import LaserConfig, LightConfig, UltrasoundConfig
from safeloc.models.reflector.variables import ReflectorConfig
from safeloc.models.vocabulary.error_law import ErrorLaw

ERRING = ErrorLaw(kind="wheel", constant_mm=3_000, rate_ppm=40_000, floor_mm_s=200, knee_mm_s=2_000)
"""An odometer that errs at standstill, and by its rate above a speed only."""
NEVER = {
    "models/vocabulary/error_law.py: above * Lit(self.rate_ppm, PPM) + floor + drift from self.law.growth_nm(abs_(self.measured.value), as_num(0, MS), ...": "an odometer that drifts is refused: odometer.drift_mm_s2 must be 0",
    "models/reflector/echo.py: ite(now.testing, now.alone(reflector), apart) from judge(one, reflector, searched, now)": "so for the next reflector alone: a self-test measures the reference reflector, never the one behind it",
    "properties/reflector/not_found.py: between(-far, own.run_since_balise, far) from yield from maker(model)": "its sides are the bounds of the declared range: the claim is proved by the range obligation",
}
"""Case splits that no configuration makes live, with the reason."""
CONFIGURATIONS = Configurations(
    {
        "radar behind the front end": ReflectorConfig(radar_offset_mm=2_500),
        "an odometer that errs at standstill": ReflectorConfig(odometer=ERRING),
        "an odometer without a one-off error": ReflectorConfig(
            odometer=ErrorLaw(kind="eddy_current", constant_mm=0, rate_ppm=10_000)
        ),
        "the self-test's distance is the system's": ReflectorConfig(reference_distance_mm=60_000),
        "a second unit has checked the distance": ReflectorConfig(
            odometer=ERRING, checked_distance=True, radar_offset_mm=2_500
        ),
        "ultrasound in place of the radar": UltrasoundConfig(echo_slots=1),
        "light in place of the radar": LightConfig(echo_slots=1),
        "laser in place of the radar": LaserConfig(echo_slots=1),
    },
    NEVER,
)
