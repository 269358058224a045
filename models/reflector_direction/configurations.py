"""Configurations in which reflectors with the direction of travel are proved beside their defaults, so that no case stays folded away."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.reflector_device.configuration import ReflectorDeviceConfig
from safeloc.models.reflector_device.configurations import CONFIGURATIONS as OF_THE_DEVICE
from safeloc.models.reflector_direction.configuration import ReflectorDirectionConfig


def _of_the_device(config: object) -> ReflectorDirectionConfig:
    assert isinstance(config, ReflectorDeviceConfig)
    return ReflectorDirectionConfig(motion=config.motion, balise=config.balise, reflector=config.reflector)


CONFIGURATIONS = Configurations({name: _of_the_device(one) for name, one in OF_THE_DEVICE.named.items()})
