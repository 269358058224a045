"""A digest of a target: of all that its findings depend on, read field by field, so that no field can be forgotten.

Where a declaration stands in its file does not count, except for a transition, whose line a finding tells. What cannot be
digested is refused with a TypeError, never left out.
"""

from __future__ import annotations

import hashlib
from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from enum import Enum
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any, cast

from pydantic import BaseModel

from safeloc.language.expr import Expr, NumVar, Var
from safeloc.language.machine import Any_, Transition
from safeloc.language.spec import Property, waiting_for
from safeloc.language.system import Part
from safeloc.language.terms import in_order
from safeloc.target import Target

PLAIN = (int, str, bytes, float, bool, type(None), Fraction, Enum, Any_)
NOT_READ = {Target: {"simulate", "pictures", "doc", "spec"}, Part: {"into"}, Property: {"helper"}}
"""Fields that no finding depends on, and such as are told below in another way."""


def target_digest(target: Target) -> str:
    """Return the SHA-256, in hexadecimal, of a target with the recordings that ship with it."""
    reading = _Reading()
    for one in (target, *(_Stream(path.name, path.read_bytes()) for path in target.streams)):
        reading.add(one)
    return reading.total.hexdigest()


@dataclass(frozen=True)
class _Stream:
    name: str
    content: bytes


class _Reading:
    """Tells objects to a digest: what was told before by the number that it had."""

    def __init__(self) -> None:
        self.total = hashlib.sha256()
        self._met: dict[int, int] = {}
        self._held: list[object] = []  # so that no other object gets the identity of one that was met

    def add(self, thing: object) -> None:
        """Tell one more object, with all that it is made of."""
        self.total.update("".join(f"{word}\n" for word in self._told(thing)).encode())

    def _told(self, thing: object) -> Iterator[str]:
        if isinstance(thing, PLAIN):
            yield f"{type(thing).__name__} {thing!r}"
        elif isinstance(thing, Path):
            yield f"file {thing.name}"
        elif isinstance(thing, Expr):
            yield from self._term(thing)
        elif isinstance(thing, BaseModel):
            yield f"{type(thing).__qualname__} {thing.model_dump_json()}"
        elif isinstance(thing, Mapping):
            yield f"mapping of {len(thing)}"
            yield from self._each(part for pair in thing.items() for part in pair)
        elif isinstance(thing, (frozenset, set)):
            yield f"set of {len(thing)}"
            yield from self._each(sorted(thing, key=_name))
        elif isinstance(thing, Sequence):
            yield f"sequence of {len(thing)}"
            yield from self._each(thing)
        elif is_dataclass(thing) and not isinstance(thing, type):
            yield from self._fields(thing)
        else:
            raise TypeError(f"{type(thing).__qualname__} cannot be told to a digest: {thing!r}")

    def _each(self, things: Iterable[object]) -> Iterator[str]:
        for thing in things:
            yield from self._told(thing)

    def _fields(self, thing: Any) -> Iterator[str]:
        if self._is_met(thing):
            yield f"as {self._met[id(thing)]}"
            return
        yield f"{type(thing).__qualname__}"
        for name in _names(cast(Hashable, type(thing))):
            yield name
            yield from self._told(getattr(thing, name))
        if isinstance(thing, Transition):
            yield thing.src.replace("\\", "/").rpartition("/")[2]
        if isinstance(thing, Property) and thing.helper is not None:
            yield from self._told(thing.helper(_waiting(thing)))
        if isinstance(thing, Part):
            alone = thing.alone
            own = [*alone.state, *alone.inputs, *alone.fired, *alone.lemmas.values(), *alone.outputs.values()]
            yield from self._each(map(thing.into, own))

    def _term(self, term: Expr) -> Iterator[str]:
        """Its nodes, parts before wholes, without recursion, since terms are deep; each node once for the whole digest."""
        for node in in_order([term], self):
            self._is_met(node)
            yield type(node).__name__
            for name in _names(cast(Hashable, type(node))):
                value = getattr(node, name)
                if isinstance(value, Expr) and value in self:
                    yield f"as {self._met[id(value)]}"
                elif isinstance(value, tuple) and value and isinstance(value[0], Expr):
                    yield f"as {[self._met[id(part)] for part in value]}"
                else:
                    yield from self._told(value)
        yield f"term {self._met[id(term)]}"

    def __contains__(self, node: object) -> bool:
        return id(node) in self._met

    def _is_met(self, thing: object) -> bool:
        """Return whether the object was visited before, and mark it as visited."""
        if id(thing) in self._met:
            return True
        self._met[id(thing)] = len(self._met)
        self._held.append(thing)
        return False


@cache
def _names(kind: Any) -> tuple[str, ...]:
    """The fields that count."""
    left_out = {"src", *NOT_READ.get(kind, ())}
    return tuple(field.name for field in fields(kind) if field.name not in left_out)


def _waiting(prop: Property) -> NumVar:
    """Return the variable that the property's helper reads: the number of steps waited."""
    waiting = waiting_for(prop)
    if waiting is None:
        raise TypeError(f"{prop.name!r} has a helper, but is no `within`.")
    return waiting


def _name(thing: object) -> str:
    if not isinstance(thing, Var):
        raise TypeError(f"a set of {type(thing).__qualname__} cannot be told to a digest: it has no order.")
    return thing.name
