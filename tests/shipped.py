"""Shipped machines in their defaults and the registers of their laws, made once in a process, for tests that only look at them."""

from __future__ import annotations

from functools import cache
from typing import Any

from pydantic import BaseModel

from safeloc import catalogue
from safeloc.assurance.register import Assumption, register
from safeloc.catalogue import ENTRIES, load_target
from safeloc.target import Entry, Target

SMALLEST_FIRST = sorted(ENTRIES, key=lambda name: name != "delocalized")
"""All names; where one machine stands for all in `make test`, it is the smallest that reports an interval."""


_MAKE = catalogue._built  # pyright: ignore[reportPrivateUsage]


def made_once(entry: Entry[Any], config: BaseModel) -> Target:
    """Return the machine of an entry with these figures; the same one whenever they are its defaults."""
    plain = ENTRIES.get(entry.name) is entry and not config.model_fields_set and config == entry.config()
    return _with_defaults(entry.name) if plain else _MAKE(entry, config)


@cache
def _with_defaults(name: str) -> Target:
    return _MAKE(ENTRIES[name], ENTRIES[name].config())


@cache
def shipped(name: str) -> Target:
    """Return the machine; a test that changes what it is made of loads its own."""
    return load_target(name)


@cache
def laws_of(name: str) -> tuple[Assumption, ...]:
    """Return the register of its laws."""
    return tuple(register(shipped(name)))
