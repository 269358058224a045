"""Choice of properties by machine, requirement and text.

To make all machines takes seconds, so what a list of all needs of them is kept, under a digest of all source files.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass

from safeloc.catalogue import ENTRIES, load_target
from safeloc.errors import InputError
from safeloc.proof.cache.engine import source_digest, undisturbed
from safeloc.proof.cache.store import Store

_KIND = "properties"


@dataclass(frozen=True)
class ListedProperty:
    """Name, statement and requirements of a property, and the machine that it is of."""

    machine: str
    name: str
    requirements: tuple[str, ...]
    statement: str


@dataclass(frozen=True)
class PropertyChoice:
    """A filter for properties.

    machines     names or addresses of machines; all that ship if none is named
    requirement  id of a requirement that they verify; None: any
    text         text in their name or statement; None: any
    """

    machines: Sequence[str]
    requirement: str | None
    text: str | None

    @property
    def by_text(self) -> bool:
        """True if properties are chosen by requirement or text."""
        return self.requirement is not None or self.text is not None

    def found(self, store: Store | None = None) -> list[ListedProperty]:
        """Return the chosen properties. InputError if there is none.

        store  where those of all machines that ship are looked for, and kept
        """
        listed = _declared(self.machines) if self.machines else _of_all(store)
        found = [one for one in listed if self.accepts(one)]
        if not found:
            raise InputError(f"no property{self._in_words()}; `safeloc list properties` lists all.")
        return found

    def accepts(self, prop: ListedProperty) -> bool:
        """Return whether the filter accepts a property of a chosen machine; case is ignored."""
        requirements = {one.casefold() for one in prop.requirements}
        words = f"{prop.name}\n{prop.statement}".casefold()
        return (self.requirement is None or self.requirement.casefold() in requirements) and (
            self.text or ""
        ).casefold() in words

    def _in_words(self) -> str:
        machines = f" of {', '.join(self.machines)}" if self.machines else ""
        requirement = f" verifies requirement {self.requirement!r}" if self.requirement is not None else ""
        text = f" has {self.text!r} in its name or statement" if self.text is not None else ""
        return f"{machines}{' and'.join(part for part in (requirement, text) if part) or ' is declared'}"


def _declared(machines: Iterable[str]) -> list[ListedProperty]:
    """Return the properties of some machines, which are made for it."""
    return [
        ListedProperty(target.name, prop.name, tuple(prop.requirements), prop.statement)
        for target in map(load_target, dict.fromkeys(machines))
        for prop in target.properties
    ]


def _of_all(store: Store | None) -> list[ListedProperty]:
    """Return the properties of all machines that ship: as they are kept for this source, or else made and kept."""
    key = hashlib.sha256("\0".join([source_digest(), *ENTRIES]).encode()).hexdigest()
    entry = None if store is None else store.get(_KIND, key)
    if entry is not None:
        rows = json.loads(entry.data)
        return [ListedProperty(**{**row, "requirements": tuple(row["requirements"])}) for row in rows]
    found = _declared(ENTRIES)
    if store is not None and undisturbed():
        store.put(_KIND, key, json.dumps(list(map(asdict, found))).encode())
    return found
