"""The project's requirements with their sources, and their traceability.

They are in `requirements.toml` beside this file; transitions and properties name their ids in `requirements`. `traceability`
links both ways: from a requirement to the transitions that implement it and the properties that verify it, and back.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Literal, Protocol

from safeloc.errors import InputError, ModelError
from safeloc.language.machine import Machine
from safeloc.language.renamed import hint
from safeloc.language.spec import Property

FILE = Path(__file__).with_name("requirements.toml")
_STATUSES = ("done", "planned")


@dataclass(frozen=True)
class Requirement:
    """One requirement. `carried_by` names a test that verifies it, if transitions and properties do not."""

    id: str
    kind: str
    machine: str
    status: str
    text: str
    source: str
    carried_by: str = ""

    def is_meant(self, id_: str | None, text: str | None) -> bool:
        """Return whether it has this id, and this text, each any if None; case is ignored."""
        return (id_ is None or id_.casefold() == self.id.casefold()) and (text or "").casefold() in self.text.casefold()


@cache
def requirements() -> tuple[Requirement, ...]:
    """Return all requirements in order; ModelError if the file is wrong."""
    content = tomllib.loads(FILE.read_text(encoding="utf-8"))
    sources = {key: value["publication"] for key, value in content["sources"].items()}
    found = []
    for row in content["requirement"]:
        family = row["id"].partition("-")[0]
        if family not in sources or row["status"] not in _STATUSES or not row["text"].strip():
            raise ModelError(f"{FILE.name}: requirement {row['id']} has no source, an unknown status or no text.")
        found.append(Requirement(source=sources[family], **row))
    names = [one.id for one in found]
    if len(set(names)) != len(names):
        raise ModelError(f"{FILE.name}: ids are not distinct.")
    return tuple(found)


def requirement(name: str) -> Requirement:
    """Return one requirement by id; KeyError for an unknown one."""
    for one in requirements():
        if one.id == name:
            return one
    raise KeyError(f"no requirement {name!r} in {FILE.name}")


class _Traced(Protocol):
    """A traced item: a target of the catalogue, or anything with a name, machines and properties."""

    @property
    def name(self) -> str:
        """The name under which its properties are listed."""
        ...

    @property
    def machines(self) -> Sequence[Machine]:
        """Machines whose transitions implement requirements."""
        ...

    @property
    def properties(self) -> Sequence[Property]:
        """Properties that verify requirements."""
        ...


@dataclass(frozen=True)
class Item:
    """A transition or a property, and the requirements that it names."""

    kind: Literal["transition", "property"]
    machine: str
    name: str
    requirements: tuple[str, ...]

    @property
    def label(self) -> str:
        """The name for a reader: machine and name."""
        return f"{self.machine}: {self.name}"


@dataclass(frozen=True)
class Link:
    """A requirement with the transitions that implement it and the properties that verify it."""

    requirement: Requirement
    transitions: tuple[str, ...]
    properties: tuple[str, ...]

    @property
    def gaps(self) -> tuple[str, ...]:
        """The missing links of a requirement with status done; a named test replaces transitions and properties."""
        if self.requirement.status != "done" or self.requirement.carried_by:
            return ()
        wanted = {"no transition implements it": self.transitions, "no property verifies it": self.properties}
        return tuple(f"{self.requirement.id}: {gap}" for gap, there in wanted.items() if not there)


@dataclass(frozen=True)
class _Traceability:
    """Traceability in both directions: `links` from every requirement, `items` from every transition and property."""

    links: tuple[Link, ...]
    items: tuple[Item, ...]

    def chosen(self, id_: str | None, text: str | None) -> tuple[list[Link], list[Item], list[str]]:
        """Return the requirements of an id and with a text, each any if None, with what leads to them, and their gaps.

        Case is ignored. InputError if there is none.
        """
        links = [link for link in self.links if link.requirement.is_meant(id_, text)]
        if not links:
            wanted = [f"the id {id_!r}" if id_ is not None else "", f"the text {text!r}" if text is not None else ""]
            known = [link.requirement.id for link in self.links]
            raise InputError(f"no requirement has {' and '.join(filter(None, wanted))}.{hint(id_ or '', known)}")
        kept = {link.requirement.id for link in links}
        items = [item for item in self.items if kept & set(item.requirements)]
        return links, items, [gap for gap in self.gaps if kept & set(re.findall(r"[\w-]+", gap))]

    @property
    def gaps(self) -> tuple[str, ...]:
        """Return gaps: done requirements without implementation or verification; items with no, an unknown or a planned one."""
        status = {link.requirement.id: link.requirement.status for link in self.links}
        wrong = [gap for link in self.links for gap in link.gaps]
        for item in self.items:
            if not item.requirements:
                wrong.append(f"{item.kind} {item.label}: names no requirement")
            wrong += [
                f"{item.kind} {item.label}: {name} is {status.get(name, 'no requirement')}"
                for name in item.requirements
                if status.get(name) != "done"
            ]
        return tuple(wrong)


def traceability(traced: Iterable[_Traced]) -> _Traceability:
    """Link requirements with these machines and properties; a machine of two targets counts once."""
    targets = list(traced)
    items = dict.fromkeys(
        [
            Item("transition", m.name, t.name, t.requirements)
            for one in targets
            for m in one.machines
            for t in m.transitions
        ]
        + [Item("property", one.name, prop.name, prop.requirements) for one in targets for prop in one.properties]
    )
    links = [
        Link(one, _naming(items, "transition", one.id), _naming(items, "property", one.id)) for one in requirements()
    ]
    return _Traceability(tuple(links), tuple(items))


def _naming(items: Iterable[Item], kind: str, name: str) -> tuple[str, ...]:
    return tuple(item.label for item in items if item.kind == kind and name in item.requirements)
