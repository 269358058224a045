"""The id of every law in the register of assumptions: one id for one law with one set of figures, in every report.

    odometry/A3               the third law of the machine `odometry`
    localizer/odometry/A9     a law of the member `odometry` of the composition `localizer`

The first name is always a machine that can be verified. A member of a composition that ships has the id of the same law of the
machine that ships under its name, or else of the first composition in `safeloc list` that has the member and the law. Only a law
that is another there, in words, term, figures, source or owner, has an id of its own.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cache

from safeloc.assurance.law_figures import Figure, configured_figures, figures_of
from safeloc.catalogue import ENTRIES, sources_of, with_defaults
from safeloc.language.digest import term_digest
from safeloc.language.machine import Machine
from safeloc.language.world import Law
from safeloc.proof.cores.clauses import ClauseId
from safeloc.target import Target

_Said = tuple[object, ...]
"""All that a law says, with its figures: laws with the same are one law."""


def ids_of(target: Target) -> dict[ClauseId, str]:
    """Return the id of every law of every machine of the target, such as "odometry/A3"."""
    return {
        ClauseId(machine.name, name): id_
        for machine in target.machines
        for name, id_ in _ids_of_machine(target, machine).items()
    }


def _ids_of_machine(target: Target, machine: Machine) -> dict[str, str]:
    """Return the id of every law of a machine: that of the first machine that ships with this law, or else one of its own."""
    own = _ids_by_order(target, machine)
    elsewhere = [_known(name) for name in _others_with(machine.name, target)]
    if not elsewhere:
        return own
    said = _said(target, machine, configured_figures(target.config))
    return {name: next((one[said[name]] for one in elsewhere if said[name] in one), id_) for name, id_ in own.items()}


def _ids_by_order(target: Target, machine: Machine) -> dict[str, str]:
    prefix = target.name if len(target.machines) == 1 else f"{target.name}/{machine.name}"
    return {name: f"{prefix}/A{number}" for number, name in enumerate(machine.world.laws, 1)}


def _others_with(member: str, target: Target) -> Iterator[str]:
    """Yield the machines that ship and come before this composition as places of a member's law; none for a user's own."""
    if len(target.machines) == 1 or (":" in target.spec and sources_of(target.spec) == [target.spec]):
        return
    if member in ENTRIES and not ENTRIES[member].members:
        yield member
    for name, entry in ENTRIES.items():
        if name == target.name:
            return
        if member in entry.members:
            yield name


@cache
def _known(name: str) -> dict[_Said, str]:
    """Return the ids of all laws of a machine that ships, with its defaults, by what they say."""
    target = with_defaults(name)
    every = configured_figures(target.config)
    known: dict[_Said, str] = {}
    for machine in target.machines:
        ids = _ids_by_order(target, machine)
        known |= {said: ids[law] for law, said in _said(target, machine, every).items()}
    return known


def _said(target: Target, machine: Machine, every: Sequence[Figure]) -> Mapping[str, _Said]:
    """Return all that each law of a machine says, with its figures out of every configured one."""
    section = target.sections.get(machine.name, machine.name)
    return {name: (machine.name, name, *_words(law, section, every)) for name, law in machine.world.laws.items()}


def _words(law: Law, section: str, every: Sequence[Figure]) -> _Said:
    figures = [(one.value, one.unit, one.source) for one in figures_of(law, section, every)]
    return law.statement, term_digest(law.term), law.figures, *figures, law.source, law.owner, law.check
