"""Configurations in which the reflector device is proved beside its defaults, so that no case of it stays folded away."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.balise.variables import BaliseConfig
from safeloc.models.localizer.configuration import CHECKED
from safeloc.models.reflector.variables import ReflectorConfig
from safeloc.models.reflector_device.configuration import ReflectorDeviceConfig

_IDENTITIES = BaliseConfig().last_group_identity
CONFIGURATIONS = Configurations(
    {
        "the first group is believed, and a second unit checks the distance": ReflectorDeviceConfig(
            motion=CHECKED,
            balise=BaliseConfig(
                odometer=CHECKED.reported_law, checked_distance=True, tolerance_mm=45_000, trust_first_group=True
            ),
            reflector=ReflectorConfig(
                odometer=CHECKED.reported_law, checked_distance=True, last_balise_identity=_IDENTITIES
            ),
        ),
        "the first group is believed, and the radar is behind the front end": ReflectorDeviceConfig(
            balise=BaliseConfig(trust_first_group=True),
            reflector=ReflectorConfig(radar_offset_mm=2_500, last_balise_identity=_IDENTITIES),
        ),
    }
)
