"""docs/renamed_claims.toml: every new name is one of today, and no old name is one any more."""

from __future__ import annotations

import tomllib
from collections import defaultdict
from collections.abc import Iterator, Mapping

import pytest

from safeloc.language.composed_names import contract_text, inputs_text
from safeloc.shipped_machines import ENTRIES
from safeloc.target import Target
from tests.rooms import ROOT
from tests.shipped import shipped

RENAMED: Mapping[str, Mapping[str, str]] = tomllib.loads(
    (ROOT / "docs/renamed_claims.toml").read_text(encoding="utf-8")
)
MACHINES = sorted(RENAMED.keys() - {"*"})


def named(target: Target) -> Iterator[tuple[str, str]]:
    """Yield each machine of a target with the names of its properties, lemmas, transitions and clauses."""
    yield from ((target.name, prop.name) for prop in target.properties)
    yield from ((member, prop.name) for member, properties in target.members.items() for prop in properties)
    for machine in target.machines:
        transitions = (transition.name for transition in machine.transitions)
        yield from ((machine.name, name) for name in (*machine.lemmas, *transitions, *machine.world.clauses))


def names() -> Mapping[str, set[str]]:
    """The names of each machine in every shipped target, and in every named configuration of a target that the table has."""
    found: dict[str, set[str]] = defaultdict(set)
    for name, entry in ENTRIES.items():
        more = entry.configurations.named.values() if name in RENAMED else ()
        for target in (shipped(name), *map(entry.make, more)):
            for machine, one in named(target):
                found[machine].add(one)
    return found


def test_every_new_name_exists_and_no_old_one_does() -> None:
    """A name that changes again, or a claim that goes, changes the table as well."""
    today = names()
    gone = {machine: left for machine in MACHINES if (left := {*RENAMED[machine].values()} - today[machine])}
    old = {machine: still for machine in MACHINES if (still := today[machine] & RENAMED[machine].keys())}
    assert ({}, {}) == (gone, old)


@pytest.mark.parametrize("machine", sorted(RENAMED))
def test_no_two_names_became_one(machine: str) -> None:
    """Results before and after correspond one to one."""
    table = RENAMED[machine]
    assert len(table) == len({*table.values()})
    assert set() == table.keys() & {*table.values()}


def test_names_made_for_every_composition() -> None:
    """Contracts and wired inputs; MACHINE is the name of any machine of the composition."""
    assert [contract_text("MACHINE"), inputs_text("MACHINE")] == list(RENAMED["*"].values())
