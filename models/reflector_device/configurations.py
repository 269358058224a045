"""Configurations in which the reflector device is proved beside its defaults, so that no case of it stays folded away."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.balise.variables import BaliseConfig
from safeloc.models.motion import MotionConfig
from safeloc.models.reflector.variables import ReflectorConfig
from safeloc.models.reflector_device.configuration import MOST_ROUTES, ReflectorDeviceConfig
from safeloc.models.route.variables import RouteConfig
from safeloc.models.vocabulary.error_law import RADAR, ErrorLaw

ERRING = ErrorLaw(kind="wheel", constant_mm=3_000, rate_ppm=40_000, floor_mm_s=200, knee_mm_s=2_000)
"""An odometer that errs at standstill, and by its rate above a speed only."""
_CHECKED_ERRING = MotionConfig(odometer=ERRING, check=RADAR)
_IDENTITIES = BaliseConfig().last_group_identity
_DRIFT = "the odometer is one that balises and reflectors take: it does not drift"
NEVER = {
    "models/motion/world.py: as_num(0, NM).eq(0) from initially(own.around)": "true, where no unit is checked",
    "models/vocabulary/vehicle_world.py: between(-farthest_nm, ran, farthest_nm) from speed_law(seen.true_cycle_distance, farthest)": "the choice has this "
    "range; the clause names it for the register of assumptions",
    "models/vocabulary/error_law.py: above * Lit(self.rate_ppm, PPM) + floor + drift from self.law.growth_nm(abs_(self.mea"
    "sured.value), as_num(0, MS), ...": _DRIFT,
    "models/vocabulary/error_law.py: above * Lit(self.rate_ppm, PPM) + floor + drift from self.odometer.law.growth_nm(abs_("
    "self.distance), as_num(0, M ...": _DRIFT,
    "properties/reflector_device/located.py: _in_source_num(whole, given.since.value).eq(0) from maker(whole)": "the wire is 0, as it should be; the claim is there for another one",
}
"""Case splits that no configuration makes live, and why."""


def _route(motion: MotionConfig) -> RouteConfig:
    return RouteConfig(
        routes=MOST_ROUTES,
        start_error_mm=20_000,
        odometer=motion.reported_law,
        checked_distance=motion.check is not None,
    )


CONFIGURATIONS = Configurations(
    {
        "the first group is believed, and a second unit checks an odometer that errs at standstill": ReflectorDeviceConfig(
            motion=_CHECKED_ERRING,
            balise=BaliseConfig(
                odometer=_CHECKED_ERRING.reported_law,
                checked_distance=True,
                tolerance_mm=45_000,
                trust_first_group=True,
            ),
            reflector=ReflectorConfig(
                odometer=_CHECKED_ERRING.reported_law, checked_distance=True, last_balise_identity=_IDENTITIES
            ),
            route=_route(_CHECKED_ERRING),
        ),
        "the first group is believed, the odometer errs at standstill, the radar is behind the front end": ReflectorDeviceConfig(
            motion=MotionConfig(odometer=ERRING),
            balise=BaliseConfig(odometer=ERRING, trust_first_group=True),
            reflector=ReflectorConfig(odometer=ERRING, radar_offset_mm=2_500, last_balise_identity=_IDENTITIES),
            route=_route(MotionConfig(odometer=ERRING)),
        ),
    },
    NEVER,
)
