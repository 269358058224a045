"""The digest of a target, over everything on which its findings depend, field by field, so that no field can be forgotten.

The place of a declaration in its file does not count, except for a transition, whose line a finding states. An object of an
unknown type is refused with a TypeError, never left out.
"""

from __future__ import annotations

import hashlib
import weakref
from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import fields, is_dataclass, replace
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

_PLAIN = (int, str, bytes, float, bool, type(None), Fraction, Enum, Any_)
_NOT_READ = {
    Target: {"simulate", "pictures", "doc", "spec", "configuration", "config_file"},
    Part: {"into", "in_a_step"},
    Property: {"helper"},
}
"""Fields on which no finding depends, and fields whose content enters the digest in another way below."""


def target_digest(target: Target) -> str:
    """Return the SHA-256, in hexadecimal, of a target with the recordings and witnesses that ship with it."""
    total = hashlib.sha256(_declared_digest(target, places=True).encode())
    for path in [*target.streams, *([] if target.witnesses is None else [target.witnesses])]:
        total.update(f"\0{path.name}\0".encode() + hashlib.sha256(path.read_bytes()).digest())
    return total.hexdigest()


def content_digest(target: Target) -> str:
    """Return the SHA-256, in hexadecimal, of what a target declares: no recordings, no witnesses, no places in files.

    A comment that moves a transition in its file leaves it as it is. What tells a place, such as a finding, needs `target_digest`.
    """
    return _declared_digest(target, places=False)


_DECLARED: weakref.WeakKeyDictionary[Target, dict[bool, str]] = weakref.WeakKeyDictionary()
"""Digests without and with places: what a target declares never changes, and a report asks for it several times."""


def _declared_digest(target: Target, *, places: bool) -> str:
    known = _DECLARED.get(target)
    if known is None:
        digest = _Digest()
        digest.add(replace(target, streams=(), witnesses=None))
        known = {False: digest.content.hexdigest(), True: digest.with_places.hexdigest()}
        _DECLARED[target] = known
    return known[places]


class _Place(str):
    """A line of a digest that tells a place in a file."""

    __slots__ = ()


class _Digest:
    """Digests of objects, of their content alone and with places in files; an object that occurs again enters by the number of its first
    occurrence.
    """

    def __init__(self) -> None:
        self.content, self.with_places = hashlib.sha256(), hashlib.sha256()
        self._lines: list[str] = []
        self._met: dict[int, int] = {}
        self._alive: list[object] = []  # so that no other object gets the identity of one that was met

    def add(self, thing: object) -> None:
        """Add one more object, with all its parts."""
        self._lines.clear()
        self._put(thing)
        self.with_places.update("".join(f"{line}\n" for line in self._lines).encode())
        self.content.update("".join(f"{line}\n" for line in self._lines if type(line) is not _Place).encode())

    def _put(self, thing: object) -> None:
        """Append the lines of an object to one list: generators within generators take a fifth longer."""
        line = self._lines.append
        if isinstance(thing, _PLAIN):
            line(f"{type(thing).__name__} {thing!r}")
        elif isinstance(thing, Path):
            line(f"file {thing.name}")
        elif isinstance(thing, Expr):
            self._put_term(thing)
        elif isinstance(thing, BaseModel):
            line(f"{type(thing).__qualname__} {thing.model_dump_json()}")
        elif isinstance(thing, Mapping):
            line(f"mapping of {len(thing)}")
            for key, value in thing.items():
                self._put(key)
                self._put(value)
        elif isinstance(thing, (frozenset, set)):
            line(f"set of {len(thing)}")
            self._put_each(sorted(thing, key=_name))
        elif isinstance(thing, Sequence):
            line(f"sequence of {len(thing)}")
            self._put_each(thing)
        elif is_dataclass(thing) and not isinstance(thing, type):
            self._put_fields(thing)
        else:
            raise TypeError(f"{type(thing).__qualname__} cannot enter a digest, its type is unknown: {thing!r}")

    def _put_each(self, things: Iterable[object]) -> None:
        for thing in things:
            self._put(thing)

    def _put_fields(self, thing: Any) -> None:
        line = self._lines.append
        if self._is_met(thing):
            line(f"as {self._met[id(thing)]}")
            return
        line(f"{type(thing).__qualname__}")
        for name in _names(cast(Hashable, type(thing))):
            line(name)
            self._put(getattr(thing, name))
        if isinstance(thing, Transition):
            line(_Place(thing.src.replace("\\", "/").rpartition("/")[2]))
        if isinstance(thing, Property) and thing.helper is not None:
            self._put(thing.helper(_waiting(thing)))
        if isinstance(thing, Part):
            alone = thing.alone
            terms = [*alone.state, *alone.inputs, *alone.fired, *alone.lemmas.values(), *alone.outputs.values()]
            self._put_each(map(thing.into, terms))
            self._put_each(map(thing.in_a_step, [*alone.state, *alone.inputs]))

    def _put_term(self, term: Expr) -> None:
        """Append the nodes of a term, operands first, without recursion, since terms are deep; each node once per digest."""
        line, met = self._lines.append, self._met
        for node in in_order([term], self):
            self._is_met(node)
            line(type(node).__name__)
            for name in _names(cast(Hashable, type(node))):
                value = getattr(node, name)
                if isinstance(value, Expr) and id(value) in met:
                    line(f"as {met[id(value)]}")
                elif isinstance(value, tuple) and value and isinstance(value[0], Expr):
                    line(f"as {[met[id(part)] for part in value]}")
                else:
                    self._put(value)
        line(f"term {met[id(term)]}")

    def __contains__(self, node: object) -> bool:
        return id(node) in self._met

    def _is_met(self, thing: object) -> bool:
        """Return whether the object was visited before, and mark it as visited."""
        if id(thing) in self._met:
            return True
        self._met[id(thing)] = len(self._met)
        self._alive.append(thing)
        return False


@cache
def _names(kind: Any) -> tuple[str, ...]:
    """Return the names of the fields that enter the digest."""
    left_out = {"src", *_NOT_READ.get(kind, ())}
    return tuple(field.name for field in fields(kind) if field.name not in left_out)


def _waiting(prop: Property) -> NumVar:
    """Return the variable that the property's helper reads: the number of steps waited."""
    waiting = waiting_for(prop)
    if waiting is None:
        raise TypeError(f"{prop.name!r} has a helper, but is no `within`.")
    return waiting


def _name(thing: object) -> str:
    if not isinstance(thing, Var):
        raise TypeError(f"a set of {type(thing).__qualname__} cannot enter a digest: it has no order.")
    return thing.name
