"""The localizer with sources that a user added, such a source by itself, and the localizer with these sources alone."""

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
from safeloc.target import Target

WITH_SOURCES = LOCALIZER.name
"""The machine that takes sources of a user's own."""
SEPARATOR = "+"
"""Stands between the word for what is made and the sources: `localizer+beacons.py:source`."""


def with_own_sources(kind: str, makers: Sequence[Maker], config: BaseModel) -> Target:
    """Return what `KINDS` makes of a user's sources; InputError where one lacks an output or states it in another unit."""
    assert isinstance(config, LocalizerConfig)
    return KINDS[kind](makers, config)


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
    whole = localizer.compose_machines(config, name="own_sources", own=makers, only_own=True)
    return _bare(localized(whole, config), whole.composition.system.name)


def _beside(makers: Sequence[Maker], config: LocalizerConfig) -> Target:
    target = _bare(localized(localizer.compose_machines(config, own=makers), config), WITH_SOURCES)
    return LOCALIZER.for_hosts(target)


def _bare(target: Target, name: str) -> Target:
    """Without the recordings, the simulation and the pictures that ship: they do not know the user's sources."""
    return replace(target, name=name, streams=(), simulate=None, pictures=())


KINDS: Mapping[str, Callable[[Sequence[Maker], LocalizerConfig], Target]] = {
    "contract": _contract,
    "alone": _alone,
    WITH_SOURCES: _beside,
}
"""What is made of a user's sources, by the word for it:

    contract   the source's machine by itself: it keeps what the localizer relies on, whatever other sources there are
    alone      the localizer with these sources and no other
    localizer  the localizer with these sources and its own
"""
