"""Shipped machines in their defaults and the registers of their laws, made once in a process, for tests that only look at them."""

from __future__ import annotations

from functools import cache

from safeloc.assurance.register import Assumption, register
from safeloc.catalogue import load_target
from safeloc.target import Target


@cache
def shipped(name: str) -> Target:
    """Return the machine; a test that changes what it is made of loads its own."""
    return load_target(name)


@cache
def laws_of(name: str) -> tuple[Assumption, ...]:
    """Return the register of its laws."""
    return tuple(register(shipped(name)))
