"""Shipped machines in their defaults and the registers of their laws, made once in a process, for tests that only look at them."""

from __future__ import annotations

from functools import cache

from safeloc.assurance.register import Assumption, register
from safeloc.catalogue import ENTRIES, load_target
from safeloc.target import Target

SMALLEST_FIRST = sorted(ENTRIES, key=lambda name: name != "delocalized")
"""All names; where one machine stands for all in `make test`, it is the smallest that reports an interval."""


@cache
def shipped(name: str) -> Target:
    """Return the machine; a test that changes what it is made of loads its own."""
    return load_target(name)


@cache
def laws_of(name: str) -> tuple[Assumption, ...]:
    """Return the register of its laws."""
    return tuple(register(shipped(name)))
