"""Search for the proof cores of a target in several processes; cores of earlier runs with the same content are used again."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict
from typing import Any

from safeloc.assurance.kept_work import Batch, Keeping, kept_or_done
from safeloc.language.spec import Property
from safeloc.proof.cache.store import Store
from safeloc.proof.cache.targets import asked
from safeloc.proof.cores.clauses import assumed_clauses
from safeloc.proof.cores.cores import Core, core
from safeloc.proof.cores.elements import Element
from safeloc.proof.provers.limits import CLOCK, Limits
from safeloc.proof.provers.portfolio import proved_base
from safeloc.proof.provers.workers import Lost, Task
from safeloc.target import Target

SCHEMA = "safeloc-cores/1"
_KIND = "cores"
_QUESTIONS = 12
"""Number of questions with the full limit that one claim may take."""


def cores_of(
    target: Target,
    properties: Sequence[Property],
    limits: Limits,
    *,
    jobs: int,
    on_core: Callable[[Core], None],
    look_in: Store | None = None,
    keep_in: Store | None = None,
) -> list[Core]:
    """Return the core of each property, in order; `on_core` is called with each as soon as it is found.

    look_in  store with cores of earlier runs; None: none is used
    keep_in  store for each new core
    """
    keeping = Keeping(_KIND, asked(target, _KIND, limits).key, look_in, keep_in)
    by_name = {prop.name: prop for prop in properties}
    found = dict[str, Core]()
    for name, data in kept_or_done([*by_name], lambda left: _work(target, by_name, left, limits), keeping, jobs):
        found[name] = Core(name, why_none=data.reason) if isinstance(data, Lost) else from_data(data)
        on_core(found[name])
    return [found[prop.name] for prop in properties]


def _work(target: Target, properties: Mapping[str, Property], left: Sequence[str], limits: Limits) -> list[Batch]:
    """Return the work for these properties. Facts for all claims are proved now, before the processes begin."""
    proved_base(target.system, limits)
    return [Batch((name,), _task(target, properties[name], limits)) for name in left]


def _task(target: Target, prop: Property, limits: Limits) -> Task:
    return Task(
        f"{target.name}: core of {prop.name}",
        lambda: [asdict(core(target.system, prop, limits))],
        CLOCK * _QUESTIONS * limits.seconds,
    )


def from_data(data: Mapping[str, Any]) -> Core:
    """Return a core from its plain data (`asdict`)."""
    elements = {name: tuple(Element(**one) for one in data[name]) for name in ("rests_on", "open_")}
    return Core(
        data["claim"], elements["rests_on"], data["steps"], data["kept_by"], elements["open_"], data["why_none"]
    )


def needed_by_none(target: Target, cores: Iterable[Core]) -> list[Element]:
    """Return the clauses, and for a single machine the rows, that are in the core of no claim.

    In a composition, claims of one machine were proved on that machine, with its clauses.
    """
    used = {(one.kind, one.machine, one.name) for core in cores for one in core.rests_on}
    every = [Element("clause", one.machine, one.name) for one in assumed_clauses(target.system)]
    if not target.system.parts:
        [machine] = target.machines
        every += [Element("row", machine.name, row.name) for row in machine.transitions]
    return [one for one in every if (one.kind, one.machine, one.name) not in used]


def as_data(target: Target, cores: Sequence[Core], *, complete: bool) -> dict[str, Any]:
    """Return the cores as data for JSON. `whole`: these are the cores of all claims, so add the elements in no core."""
    data: dict[str, Any] = {"schema": SCHEMA, "target": target.name, "cores": [asdict(one) for one in cores]}
    for one in data["cores"]:
        one["undecided"] = one.pop("open_")
    if complete:
        data["needed_by_none"] = [asdict(one) for one in needed_by_none(target, cores)]
    return data
