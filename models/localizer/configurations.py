"""Configurations in which the localizer is proved beside its defaults, so that no case of it stays folded away."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.balise.variables import BaliseConfig
from safeloc.models.localizer.configuration import LocalizerConfig
from safeloc.models.motion import MotionConfig
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.models.reflector.variables import ReflectorConfig
from safeloc.models.vocabulary.error_law import RADAR, ErrorLaw

ERRING = ErrorLaw(kind="wheel", constant_mm=3_000, rate_ppm=40_000, floor_mm_s=200, knee_mm_s=2_000)
"""An odometer that errs at standstill, and by its rate above a speed only."""
CHECKED = MotionConfig(odometer=ERRING, check=RADAR)
CREEPING = MotionConfig(check=RADAR, creep_mm_s=500)
_IDENTITIES = BaliseConfig().last_group_identity
_DOUBTING = MotionConfig(check=RADAR, standing_believed=False)
DRIFT = "the localizer's odometer is one that balises and reflectors take: it does not drift"
NEVER = {
    "models/localizer/__init__.py: only_own": "without the sources that ship only where a source of a user's own is proved (--source)",
    "models/motion/world.py: as_num(0, NM).eq(0) from initially(own.around)": "true, where no unit is checked",
    "models/vocabulary/vehicle_world.py: between(-farthest_nm, ran, farthest_nm) from speed_law(seen.true_cycle_distance, farthest)": "the choice has this "
    "range; the clause names it for the register of assumptions",
    "models/vocabulary/error_law.py: above * Lit(self.rate_ppm, PPM) + floor + drift from self.law.growth_nm(abs_(self.mea"
    "sured.value), as_num(0, MS), ...": DRIFT,
    "models/vocabulary/error_law.py: above * Lit(self.rate_ppm, PPM) + floor + drift from self.odometer.law.growth_nm(abs_("
    "self.distance), as_num(0, M ...": DRIFT,
    "properties/localizer_heard.py: reason.eq(NO_REFERENCE) from _told(source, into, said, machine)": "the fibre's wire is this reason, as it "
    "should be; the claim is there for another one",
}
"""Case splits that no configuration makes live, and why."""
CONFIGURATIONS = Configurations(
    {
        "an odometer without a check, no fibre": LocalizerConfig(
            sources=("odometry", "balise", "reflector", "satellite"),
            motion=MotionConfig(odometer=ERRING),
            odometry=OdometryConfig(first_unit=ERRING, tolerance_mm=45_000),
            balise=BaliseConfig(odometer=ERRING, tolerance_mm=45_000),
            reflector=ReflectorConfig(odometer=ERRING, last_balise_identity=_IDENTITIES),
        ),
        "an odometer that errs at standstill": LocalizerConfig(
            motion=CHECKED,
            odometry=OdometryConfig(first_unit=ERRING, single_fault_safe=True, tolerance_mm=45_000),
            balise=BaliseConfig(odometer=CHECKED.reported_law, checked_distance=True, tolerance_mm=45_000),
            reflector=ReflectorConfig(
                odometer=CHECKED.reported_law, checked_distance=True, last_balise_identity=_IDENTITIES
            ),
        ),
        "satellites alone": LocalizerConfig(sources=("satellite",)),
        "a vehicle that may creep unmeasured": LocalizerConfig(
            sources=("odometry", "balise"),
            motion=CREEPING,
            balise=BaliseConfig(odometer=CREEPING.reported_law, checked_distance=True),
        ),
        "a standstill that is not believed": LocalizerConfig(
            sources=("odometry", "balise"),
            motion=_DOUBTING,
            balise=BaliseConfig(odometer=_DOUBTING.reported_law, checked_distance=True),
        ),
    },
    NEVER,
)
