"""Machines and compositions as plain data of our own, and what one step of them is. Nothing here is safeloc's.

A step of a machine: the first row, in order, one of whose sources is the mode and whose guard holds, moves the mode and
sets its variables from what they were before; else nothing moves. Ghosts move in every step.
A step of a composition: its machines one after the other; a wired input hears a term over what the machines before it
have come to in this very step. Names of a composition are `machine.variable`, shared variables keep their own.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

from tests.fuzz.terms import TRUE, Term, every, fast, reads, rewritten, was

Kind = Literal["number", "truth", "colour"]
State = dict[str, int]
COLOURS = ("RED", "GREEN", "BLUE")


@dataclass(frozen=True)
class Var:
    """A variable with inclusive range; an optional input has a second one, `name.present`."""

    name: str
    kind: Kind = "number"
    low: int = 0
    high: int = 1
    optional: bool = False

    @property
    def values(self) -> tuple[int, ...]:
        """All of them."""
        return (False, True) if self.kind == "truth" else tuple(range(self.low, self.high + 1))

    @property
    def least(self) -> int:
        """The first of them; of a wide range nobody could list them."""
        return False if self.kind == "truth" else self.low

    @property
    def absent(self) -> int:
        """What stands for a value that is not there: the one nearest zero."""
        return min(self.values, key=abs) if self.high - self.low < 100 else min(max(0, self.low), self.high)

    @property
    def present(self) -> str:
        """The name of its presence."""
        return f"{self.name}.present"

    @property
    def names(self) -> tuple[str, ...]:
        """Its own name, and that of its presence."""
        return (self.name, self.present) if self.optional else (self.name,)

    @property
    def choices(self) -> list[State]:
        """What an input may be in one step."""
        if not self.optional:
            return [{self.name: value} for value in self.values]
        there = [{self.name: value, self.present: True} for value in self.values]
        return [{self.name: self.absent, self.present: False}, *there]


@dataclass(frozen=True)
class Row:
    """A row of the transition table; modes are numbers."""

    name: str
    sources: tuple[int, ...]
    target: int
    guard: Term = TRUE
    sets: Mapping[str, Term] = field(default_factory=dict)
    rank: int = 0


@dataclass(frozen=True)
class World:
    """One machine with its environment. A first value of None is open; `initially` is a list of conditions."""

    name: str
    modes: int = 1
    inputs: tuple[Var, ...] = ()
    state: Mapping[Var, int | None] = field(default_factory=dict)
    outputs: Mapping[str, Term] = field(default_factory=dict)
    rows: tuple[Row, ...] = ()
    ghosts: Mapping[Var, int | None] = field(default_factory=dict)
    ghost_inputs: tuple[Var, ...] = ()
    ghost_moves: Mapping[str, Term] = field(default_factory=dict)
    assumption: Term = TRUE
    clauses: Mapping[str, Term] = field(default_factory=dict)
    initially: tuple[Term, ...] = ()
    lemmas: Mapping[str, Term] = field(default_factory=dict)

    @cached_property
    def state_names(self) -> tuple[str, ...]:
        """Mode, state and ghosts."""
        return ("mode", *(var.name for var in (*self.state, *self.ghosts)))

    @cached_property
    def variables(self) -> dict[str, Var]:
        """State, ghosts and inputs by name, presences and mode apart."""
        return {var.name: var for var in (*self.state, *self.ghosts, *self.inputs, *self.ghost_inputs)}

    @cached_property
    def own_inputs(self) -> tuple[Var, ...]:
        """Inputs and ghost inputs."""
        return (*self.inputs, *self.ghost_inputs)

    @cached_property
    def ghost_names(self) -> frozenset[str]:
        """Of ghosts and ghost inputs."""
        return frozenset(var.name for var in (*self.ghosts, *self.ghost_inputs))

    @cached_property
    def assumed(self) -> Term:
        """The assumption and all clauses."""
        return every(self.assumption, *self.clauses.values())

    @cached_property
    def lawful(self) -> Callable[[Mapping[str, int]], int]:
        """Whether state before and inputs keep what is assumed."""
        return fast(self.assumed)

    def firsts(self) -> Iterator[State]:
        """Every first state."""
        given = {**self.state, **self.ghosts}
        names = [var.name for var in given]
        conditions = [fast(term) for term in self.initially]
        for values in itertools.product(*(var.values if value is None else (value,) for var, value in given.items())):
            first = {"mode": 0, **dict(zip(names, values, strict=True))}
            if all(condition(first) for condition in conditions):
                yield first

    def choices(self) -> list[State]:
        """Every input there may be in a step."""
        return product(self.own_inputs)

    def moved(self, known: Mapping[str, int]) -> tuple[State, State]:
        """State after a step from state before and inputs, and the number of the row that fired (0: none)."""
        after = {name: known[name] for name in self.state_names}
        fired = 0
        for number, (sources, guard, target, sets) in enumerate(self._rows, 1):
            if known["mode"] in sources and guard(known):
                after["mode"], fired = target, number
                after.update({name: term(known) for name, term in sets.items()})
                break
        after.update({name: term(known) for name, term in self._moves.items()})
        return after, {"fired": fired}

    @cached_property
    def _rows(self) -> list[tuple[frozenset[int], Callable[..., int], int, dict[str, Callable[..., int]]]]:
        return [
            (frozenset(row.sources), fast(row.guard), row.target, {n: fast(t) for n, t in row.sets.items()})
            for row in self.rows
        ]

    @cached_property
    def _moves(self) -> dict[str, Callable[..., int]]:
        return {name: fast(term) for name, term in self.ghost_moves.items()}

    def step(self, known: Mapping[str, int]) -> tuple[State, State, bool]:
        """State after a step, what fired, and whether the step is lawful."""
        after, fired = self.moved(known)
        return after, fired, bool(self.lawful(known))

    def untied(self) -> World:
        """For all inputs: `initially` without what ties the machine to its environment."""
        ghosts = self.ghost_names
        kept = tuple(term for term in self.initially if not (reads(term) & ghosts and reads(term) - ghosts))
        return replace(self, initially=kept)

    def board(self) -> World:
        """What runs on board: no environment and no assumption; of `initially`, what reads no ghost."""
        kept = tuple(term for term in self.initially if not reads(term) & self.ghost_names)
        lemmas = {name: term for name, term in self.lemmas.items() if not reads(term) & self.ghost_names}
        bare = replace(self, ghosts={}, ghost_inputs=(), ghost_moves={}, assumption=TRUE, clauses={})
        return replace(bare, initially=kept, lemmas=lemmas)


def product(inputs: tuple[Var, ...]) -> list[State]:
    """Every combination of what inputs may be."""
    return [
        {name: value for one in chosen for name, value in one.items()}
        for chosen in itertools.product(*(var.choices for var in inputs))
    ]


@dataclass(frozen=True)
class Whole:
    """Several machines in order.

    wires      "machine.input" -> term over the names of earlier machines, and over the state of all before the step
    shared     names of variables that several machines have as one
    discharge  names of machines that assume nothing of the whole, or (machine, clause)
    """

    name: str
    worlds: tuple[World, ...]
    wires: Mapping[str, Term] = field(default_factory=dict)
    shared: frozenset[str] = frozenset()
    discharge: tuple[str | tuple[str, str], ...] = ()

    def called(self, world: World, name: str) -> str:
        """What a machine's variable is called in the whole."""
        return name if name in self.shared or name.removesuffix(".present") in self.shared else f"{world.name}.{name}"

    @cached_property
    def state_names(self) -> tuple[str, ...]:
        """State and ghosts of all machines, shared ones once."""
        names = [self.called(world, name) for world in self.worlds for name in world.state_names]
        return tuple(dict.fromkeys(names))

    @cached_property
    def variables(self) -> dict[str, Var]:
        """State, ghosts and inputs by name, modes apart."""
        return {
            self.called(world, name): replace(var, name=self.called(world, name))
            for world in self.worlds
            for name, var in world.variables.items()
        }

    @cached_property
    def own_inputs(self) -> tuple[Var, ...]:
        """Inputs that are not wired, shared ones once."""
        names = [self.called(world, var.name) for world in self.worlds for var in world.own_inputs]
        inputs = {self.called(world, var.name): var for world in self.worlds for var in world.own_inputs}
        return tuple(replace(inputs[name], name=name) for name in dict.fromkeys(names) if name not in self.wires)

    @cached_property
    def ghost_names(self) -> frozenset[str]:
        """Of ghosts and ghost inputs that are not wired."""
        names = {self.called(world, name) for world in self.worlds for name in world.ghost_names}
        return frozenset(names - set(self.wires))

    @cached_property
    def lemmas(self) -> dict[str, Term]:
        """Of all machines."""
        return {
            f"{world.name}: {name}": self.told(world, term)
            for world in self.worlds
            for name, term in world.lemmas.items()
        }

    @cached_property
    def outputs(self) -> dict[str, Term]:
        """Of all machines."""
        return {
            f"{world.name}.{name}": self.told(world, term)
            for world in self.worlds
            for name, term in world.outputs.items()
        }

    def told(self, world: World, term: Term) -> Term:
        """A machine's term, read after a step, as one of the whole: a wired input is what the wire tells."""

        def leaf(one: Term) -> Term:
            name = self.called(world, one[1])
            return self.wires[name] if one[0] == "var" and name in self.wires else (one[0], name)

        return self._unwired(rewritten(term, leaf))

    def _unwired(self, term: Term) -> Term:
        """Wires may read what is wired itself."""
        while any(name in self.wires for name in reads(term)):
            term = rewritten(term, lambda one: self.wires.get(one[1], one) if one[0] == "var" else one)
        return term

    def firsts(self) -> Iterator[State]:
        """Every first state: machines start apart, shared ghosts alike."""
        for firsts in itertools.product(*(list(world.firsts()) for world in self.worlds)):
            merged: State = {}
            for world, first in zip(self.worlds, firsts, strict=True):
                named = {self.called(world, name): value for name, value in first.items()}
                if any(merged.get(name, value) != value for name, value in named.items()):
                    break
                merged |= named
            else:
                yield merged

    def choices(self) -> list[State]:
        """Every input there may be in a step."""
        return product(self.own_inputs)

    def _local(self, world: World, known: Mapping[str, int], after: Mapping[str, int]) -> State:
        """What one machine reads in a step: its state before, and its inputs, wired or not."""
        local = {name: known[self.called(world, name)] for name in world.state_names}
        for var in world.own_inputs:
            for name in var.names:
                full = self.called(world, name)
                local[name] = self._wired[full](after) if full in self.wires else known[full]
        return local

    @cached_property
    def _wired(self) -> dict[str, Callable[..., int]]:
        return {name: fast(term) for name, term in self.wires.items()}

    def _heard(self, known: Mapping[str, int]) -> Iterator[tuple[World, State, State, State]]:
        """Of each machine in order: what it reads, its state after, and what fired."""
        after: State = {was(name): known[name] for name in self.state_names}
        for world in self.worlds:
            local = self._local(world, known, after)
            moved, fired = world.moved(local)
            yield world, local, moved, fired
            inputs = {name: value for name, value in local.items() if name not in moved}
            after |= {self.called(world, name): value for name, value in {**inputs, **moved}.items()}

    def step(self, known: Mapping[str, int]) -> tuple[State, State, bool]:
        """State after a step, the rows that fired, and whether the step is lawful."""
        after: State = {}
        fired: State = {}
        lawful = True
        for world, local, moved, number in self._heard(known):
            after |= {self.called(world, name): value for name, value in moved.items()}
            fired[f"{world.name}.fired"] = number["fired"]
            lawful = lawful and bool(self._laws[world.name][0](local))
        return after, fired, lawful

    def moved(self, known: Mapping[str, int]) -> tuple[State, State]:
        """State after a step, and the rows that fired."""
        return self.step(known)[:2]

    @cached_property
    def _laws(self) -> dict[str, tuple[Callable[..., int], Callable[..., int]]]:
        """Of each machine: what is assumed of the whole, and what is owed to it."""
        laws = {}
        for world in self.worlds:
            owed = [name for name in world.clauses if (world.name, name) in self.discharge]
            assumed = every(world.assumption, *(term for name, term in world.clauses.items() if name not in owed))
            due = every(*(world.clauses[name] for name in owed))
            if world.name in self.discharge:
                assumed, due = TRUE, world.assumed
            laws[world.name] = fast(assumed), fast(due)
        return laws

    def lawful(self, known: Mapping[str, int]) -> bool:
        """Whether a step keeps what is assumed of the whole."""
        return self.step(known)[2]

    def kept(self, name: str, known: Mapping[str, int]) -> bool:
        """Whether a step keeps what a machine is owed: its assumption, and the ranges of its wired ghosts."""
        for world, local, _, _ in self._heard(known):
            if world.name == name:
                wired = [v for v in world.ghost_inputs if self.called(world, v.name) in self.wires]
                return bool(self._laws[name][1](local)) and all(local[v.name] in v.values for v in wired)
        raise KeyError(name)

    def hears(self, name: str, known: Mapping[str, int]) -> bool:
        """Whether all that a machine hears through wires, ghosts apart, is what it may hear."""
        for world, local, _, _ in self._heard(known):
            if world.name == name:
                return all(self._may_hear(world, var, local) for var in world.inputs)
        raise KeyError(name)

    def _may_hear(self, world: World, var: Var, local: Mapping[str, int]) -> bool:
        if not any(self.called(world, name) in self.wires for name in var.names):
            return True
        there = not var.optional or local[var.present]
        return local[var.name] in var.values and bool(there or local[var.name] == var.absent)

    def untied(self) -> Whole:
        """For all inputs: `initially` without what ties machines to their environment."""
        return replace(self, worlds=tuple(world.untied() for world in self.worlds))

    def board(self) -> Whole:
        """What runs on board."""
        ghosts = {self.called(world, name) for world in self.worlds for name in world.ghost_names}
        wires = {name: term for name, term in self.wires.items() if name not in ghosts}
        return replace(self, worlds=tuple(world.board() for world in self.worlds), wires=wires, discharge=())


Game = World | Whole
