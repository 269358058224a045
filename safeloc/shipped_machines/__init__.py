"""Search for the machines that ship: each folder of `models/` with a file `target.py` declares one or more in its
`ENTRIES`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from importlib import import_module
from pkgutil import iter_modules
from typing import Any

from safeloc import models
from safeloc.errors import ModelError
from safeloc.target import Entry, Family

ORDER = {family: number for number, family in enumerate(Family)}


def folders() -> list[str]:
    """Return the folders of `models/` that declare a machine, by name."""
    every = [module.name for module in iter_modules(models.__path__) if module.ispkg]
    return sorted(name for name in every if _has_target(name))


def _has_target(folder: str) -> bool:
    inside = [f"{path}/{folder}" for path in models.__path__]
    return any(module.name == "target" for module in iter_modules(inside))


def declared(folder: str) -> Iterator[Entry[Any]]:
    """Yield the entries that a folder declares. ModelError if its `target.py` has no tuple `ENTRIES` of them."""
    module = import_module(f"{models.__name__}.{folder}.target")
    entries = getattr(module, "ENTRIES", None)
    if not isinstance(entries, tuple) or not entries or not all(isinstance(one, Entry) for one in entries):
        raise ModelError(
            f"{module.__file__}: ENTRIES is {entries!r}; declare a tuple of entries: ENTRIES = (Entry(...),)."
        )
    yield from (replace(entry, folder=folder) for entry in entries)


def found() -> dict[str, Entry[Any]]:
    """Return all entries by name, sorted by family, place and name.

    ModelError if two folders declare a machine of the same name.
    """
    entries: dict[str, Entry[Any]] = {}
    for entry in (one for folder in folders() for one in declared(folder)):
        other = entries.setdefault(entry.name, entry)
        if other is not entry:
            raise ModelError(f"models/{other.folder} and models/{entry.folder} both declare a machine {entry.name!r}.")
    ordered = sorted(entries.values(), key=lambda one: (ORDER[one.family], one.place, one.name))
    return {entry.name: entry for entry in ordered}


class _Shipped(Mapping[str, Entry[Any]]):
    """The entries by name, searched for at the first access: a user's own machine needs none of them."""

    def __init__(self) -> None:
        self._asked: dict[str, Entry[Any]] = {}

    @cached_property
    def _entries(self) -> dict[str, Entry[Any]]:
        return {name: self._asked.get(name, entry) for name, entry in found().items()}

    def __getitem__(self, name: str) -> Entry[Any]:
        """Return the entry; most stand in a folder of their name, and then no other folder is imported."""
        if name not in self._asked and "_entries" not in vars(self) and name.isidentifier() and _has_target(name):
            self._asked |= {entry.name: entry for entry in declared(name)}
        return self._asked[name] if name in self._asked else self._entries[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._entries)

    def __len__(self) -> int:
        return len(self._entries)


ENTRIES: Mapping[str, Entry[Any]] = _Shipped()
"""The machines that ship, by name, in the order of `safeloc list`."""
