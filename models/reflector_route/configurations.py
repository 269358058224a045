"""Configurations in which reflectors with the route are proved beside their defaults, so that no case stays folded away."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.reflector_device.configuration import ReflectorDeviceConfig
from safeloc.models.reflector_device.configurations import CONFIGURATIONS as OF_THE_DEVICE
from safeloc.models.reflector_route.configuration import MOST_ROUTES, ReflectorRouteConfig
from safeloc.models.route.variables import RouteConfig


def _of_the_device(config: object) -> ReflectorRouteConfig:
    assert isinstance(config, ReflectorDeviceConfig)
    return ReflectorRouteConfig(
        motion=config.motion,
        balise=config.balise,
        reflector=config.reflector,
        route=RouteConfig(
            routes=MOST_ROUTES,
            start_error_mm=20_000,
            odometer=config.motion.reported_law,
            checked_distance=config.motion.check is not None,
        ),
    )


CONFIGURATIONS = Configurations({name: _of_the_device(one) for name, one in OF_THE_DEVICE.named.items()})
