"""The inputs of a target: names in records, ranges, and the machines that tolerate missing inputs."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from functools import cached_property

from safeloc.codegen.compiled import Row
from safeloc.errors import InputError
from safeloc.language.expr import NumVar
from safeloc.language.renamed import hint
from safeloc.language.system import TransitionSystem, canonical, without_ghosts
from safeloc.runtime.border import Channel, Fault, Reason
from safeloc.runtime.embedding.row_layout import Entry, Placed, beginnings, entries_of, limits, routes_of
from safeloc.runtime.streams.cycles import Places
from safeloc.target import Target


class TargetInputs:
    """The inputs of a target without ghosts, with the names that records use for them."""

    def __init__(self, target: Target) -> None:
        self.target = target
        self.system: TransitionSystem = without_ghosts(target.system)
        self.entries: Mapping[str, Entry] = entries_of(self.system)
        self.routes: Mapping[str, tuple[Entry, ...]] = routes_of(self.entries, target.input_of_record)
        self.places: Places = {
            name: tuple([entry.at for entry in found]) for name, found in self.routes.items()
        }.__getitem__
        self.named: Mapping[str, tuple[Entry, ...]] = {
            name: tuple(entry for entry in routed if entry.is_named) for name, routed in self.routes.items()
        }
        self.channels: Sequence[Channel] = [
            limit for name, routed in self.routes.items() if (limit := limits(name, routed)) is not None
        ]
        self.channel_names = frozenset(part for name in self.routes for part in beginnings(name))
        self._flags = {entry.at: entry.present_at for entry in self.entries.values()}
        self._names = frozenset(self.entries)
        self._absent = tuple(canonical(var) if isinstance(var, NumVar) else False for var in self.system.inputs)

    @property
    def name(self) -> str:
        """The target's name."""
        return self.target.name

    @cached_property
    def needed(self) -> tuple[str, ...]:
        """The names of mandatory inputs: they have no presence flag, so each cycle needs a value."""
        return tuple(name for name, entry in self.entries.items() if entry.present_at is None)

    def placed(self, inputs: Mapping[str, int | str]) -> Placed:
        """Return values by place; a name in a record may stand for inputs of several machines."""
        return {entry.at: entry.held(value) for name, value in inputs.items() for entry in self.routes[name]}

    @cached_property
    def silent(self) -> Mapping[str, tuple[frozenset[int], frozenset[int]]]:
        """For each machine that tolerates a step without inputs: places of all its inputs, and of the mandatory ones."""
        needed = {self.entries[name].at for name in self.needed}
        several = len(self.system.machines) > 1
        by_device = {
            name: frozenset(
                entry.at for full, entry in self.entries.items() if not several or full.startswith(f"{name}.")
            )
            for name in self.target.silent
        }
        return {name: (inputs, inputs & needed) for name, inputs in by_device.items() if inputs & needed}

    def complete(self, inputs: Placed) -> tuple[Placed, tuple[Fault, ...]]:
        """Remove all inputs of a machine that lacks a mandatory one, if it tolerates a step without inputs.

        Return the rest, and a fault for each machine that lost inputs in this way.
        """
        faults: list[Fault] = []
        for name, (places, needed) in self.silent.items():
            if not needed <= inputs.keys() and not places.isdisjoint(inputs):
                lacking = min(self.system.inputs[at].name for at in needed if at not in inputs)
                faults.append(Fault(name, Reason.MISSING, f"{lacking}; no other input of {name} is used"))
                inputs = {at: value for at, value in inputs.items() if at not in places}
        return inputs, tuple(faults)

    def unknown(self, names: Collection[str]) -> list[str]:
        """Return the names that are no inputs."""
        return [] if self._names.issuperset(names) else [name for name in names if name not in self.entries]

    def require_known(self, names: Collection[str]) -> None:
        """Raise InputError for a name that is no input."""
        unknown = self.unknown(names)
        if unknown:
            has = ", ".join(self.entries)
            raise InputError(
                f"{self.name} has no input {unknown[0]!r}; it has {has}.{hint(str(unknown[0]), self.entries)}"
            )

    def missing(self, inputs: Placed) -> list[str]:
        """Return the missing mandatory inputs of machines that do not tolerate a step without inputs."""
        return [name for name, at in self._always_needed if at not in inputs]

    @cached_property
    def _always_needed(self) -> list[tuple[str, int]]:
        spared = {at for _, needed in self.silent.values() for at in needed}
        places = [(name, self.entries[name].at) for name in self.needed]
        return [(name, at) for name, at in places if at not in spared]

    def row(self, inputs: Placed) -> Row:
        """Return the row of a step: an input without a value is absent, or has a neutral value if it cannot be absent."""
        row, flags = list(self._absent), self._flags
        for at, value in inputs.items():
            row[at] = value
            present_at = flags[at]
            if present_at is not None:
                row[present_at] = True
        return tuple(row)
