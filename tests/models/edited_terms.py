"""Terms of a machine that are edited wrongly, and the claims that notice: those that are no longer inductive."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cached_property
from inspect import getattr_static
from types import ModuleType

import pytest

from safeloc.language.machine import Machine
from safeloc.language.spec import Property
from tests.models.inductive import inductive

Made = tuple[Machine, Iterable[Property]]


def edited(monkeypatch: pytest.MonkeyPatch, owner: type | ModuleType, name: str, wrong: Callable[..., object]) -> None:
    """Replace a term of the class `owner`, a property or a method, by a wrong one that is given the right one as well.

    The term may be one that the class inherits.
    """
    right = getattr_static(owner, name)
    if isinstance(right, (property, cached_property)):
        getter = right.func if isinstance(right, cached_property) else right.fget
        assert getter is not None
        monkeypatch.setattr(owner, name, property(lambda self: wrong(self, getter(self))))
    else:
        monkeypatch.setattr(owner, name, lambda self, *args: wrong(self, right(self, *args), *args))


def keeps(made: Made, claim: str) -> bool:
    """Whether the claim of that name is inductive with ranges and lemmas."""
    machine, claims = made
    [prop] = [one for one in claims if one.name == claim]
    return inductive(machine, prop)
