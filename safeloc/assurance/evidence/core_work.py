"""Finds the proof cores of a target in several processes; what an earlier run found of the same content is not asked again."""

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
KIND = "cores"
QUESTIONS = 12
"""How often the limit may be used up for one claim."""


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
    """Return the core of each property, in order; `on_core` hears of each as it comes.

    look_in  where an earlier run kept what it found; None looks at nothing
    keep_in  where each core is kept as soon as it is found
    """
    keeping = Keeping(KIND, asked(target, KIND, limits).key, look_in, keep_in)
    by_name = {prop.name: prop for prop in properties}
    found = dict[str, Core]()
    for name, data in kept_or_done([*by_name], lambda left: _work(target, by_name, left, limits), keeping, jobs):
        found[name] = Core(name, why_none=data.reason) if isinstance(data, Lost) else from_data(data)
        on_core(found[name])
    return [found[prop.name] for prop in properties]


def _work(target: Target, properties: Mapping[str, Property], left: Sequence[str], limits: Limits) -> list[Batch]:
    """What is proved of the target for all claims is proved before the processes begin."""
    proved_base(target.system, limits)
    return [Batch((name,), _task(target, properties[name], limits)) for name in left]


def _task(target: Target, prop: Property, limits: Limits) -> Task:
    return Task(
        f"{target.name}: what {prop.name} rests on",
        lambda: [asdict(core(target.system, prop, limits))],
        CLOCK * QUESTIONS * limits.seconds,
    )


def from_data(data: Mapping[str, Any]) -> Core:
    """Return a core from what `asdict` made of it."""
    elements = {name: tuple(Element(**one) for one in data[name]) for name in ("rests_on", "open_")}
    return Core(
        data["claim"], elements["rests_on"], data["steps"], data["kept_by"], elements["open_"], data["why_none"]
    )


def needed_by_none(target: Target, cores: Iterable[Core]) -> list[Element]:
    """Return the clauses and rows that no claim's proof rests on; rows of single machines only.

    Of a composition, a machine's own claims were proved on that machine, with its clauses.
    """
    used = {(one.kind, one.machine, one.name) for core in cores for one in core.rests_on}
    every = [Element("clause", one.machine, one.name) for one in assumed_clauses(target.system)]
    if not target.system.parts:
        [machine] = target.machines
        every += [Element("row", machine.name, row.name) for row in machine.transitions]
    return [one for one in every if (one.kind, one.machine, one.name) not in used]


def as_data(target: Target, cores: Sequence[Core], *, whole: bool) -> dict[str, Any]:
    """Return the cores as data for JSON. `whole`: all claims were asked, so it can be told what none of them needs."""
    data: dict[str, Any] = {"schema": SCHEMA, "target": target.name, "cores": [asdict(one) for one in cores]}
    for one in data["cores"]:
        one["undecided"] = one.pop("open_")
    if whole:
        data["needed_by_none"] = [asdict(one) for one in needed_by_none(target, cores)]
    return data
