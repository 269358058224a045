"""Targets for a user's own sources: one source alone, the localizer with these sources only, and with its own as well."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from pydantic import BaseModel

from safeloc.errors import InputError
from safeloc.language.system import lower
from safeloc.models import localizer, motion
from safeloc.models.localizer import LocalizerConfig, Vehicle
from safeloc.models.localizer.own_source import Maker, own_source, vehicle_of
from safeloc.models.localizer.target import LOCALIZER, localized
from safeloc.properties import own_source as own_source_properties
from safeloc.reported import Reported
from safeloc.shipped_machines.source_kinds import KINDS, WITH_SOURCES
from safeloc.target import Target


def with_own_sources(kind: str, makers: Sequence[Maker], config: BaseModel) -> Target:
    """Make the target of this kind from a user's sources; InputError if a source lacks an output or has it in another
    unit.
    """
    assert isinstance(config, LocalizerConfig)
    return _MAKERS[kind](makers, config)


def _contract(makers: Sequence[Maker], config: LocalizerConfig) -> Target:
    if len(makers) != 1:
        raise InputError(f"{len(makers)} sources are given; the contract is proved of one source by itself.")
    source = own_source(makers[0], vehicle(config))
    machine, claims = source.machine, tuple(own_source_properties.properties(source))
    return Target(machine.name, (machine,), lower(machine), claims, config, machine.doc, reported=Reported())


def vehicle(config: LocalizerConfig) -> Vehicle:
    """Return the vehicle of a configuration, as a source knows it."""
    return vehicle_of(motion.build(motion.parts(config.motion)), config.widest_mm)


def _alone(makers: Sequence[Maker], config: LocalizerConfig) -> Target:
    model = localizer.compose_machines(config, name="own_sources", own=makers, only_own=True)
    return _bare(localized(model, config), model.composition.system.name)


def _beside(makers: Sequence[Maker], config: LocalizerConfig) -> Target:
    target = _bare(localized(localizer.compose_machines(config, own=makers), config), WITH_SOURCES)
    return LOCALIZER.for_hosts(target)


def _bare(target: Target, name: str) -> Target:
    """Remove the recordings, the simulation and the pictures that ship: they do not know the user's sources."""
    return replace(target, name=name, streams=(), simulate=None, pictures=())


_MAKERS: Mapping[str, Callable[[Sequence[Maker], LocalizerConfig], Target]] = dict(
    zip(KINDS, (_contract, _alone, _beside), strict=True)
)
