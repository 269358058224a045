"""Several machines as one step: wired output to input, in declared order, synchronously.

A later machine sees what an earlier one computed in the same step, so a fault acts without delay.

What a machine assumes of its environment is assumed of the whole, unless it is named in `owes`: then the machines
before it have to keep it, which is proved together with the lemmas (assume-guarantee, safeloc.provers.inherited).
A single clause of an assumption can be owed as well; the rest of it is then still assumed of the whole.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from safeloc.errors import ModelError
from safeloc.expr import TRUE, Bool, BoolVar, Expr, Lit, Num, NumVar, Optional, Var, all_of, before, was
from safeloc.machine import Any_, Initial, Machine
from safeloc.nodes import Value
from safeloc.spec import Property
from safeloc.system import Part, TransitionSystem, absent_is_canonical, in_range, lower
from safeloc.terms import Sharing, Substitution, variables


@dataclass(frozen=True, eq=False)
class Clause:
    """A named part of what a machine assumes."""

    machine: Machine
    name: str


@dataclass(frozen=True, eq=False)
class Composition:
    """The whole, and the way from a machine's own terms to terms over the whole."""

    system: TransitionSystem
    parts: Mapping[Machine, Substitution]
    after: Mapping[Var, Expr]

    def of(self, machine: Machine) -> Substitution:
        """Rewrites terms over one machine's variables into terms over the whole (properties, outputs, lemmas).

        A wired input becomes what the wire tells: in a property, in the step that it looks at.
        """
        return self.parts[machine]

    def inherited(self, machine: Machine, prop: Property) -> Property:
        """A property that a machine keeps in every step, as one of the whole; provers ask the machine by itself.

        What the machine assumes is assumed of the whole as well, or owed by the machines before it. ModelError for a
        property that is given something more, or is not of kind `always`.
        """
        if prop.kind != "always" or prop.given is not TRUE:
            raise ModelError(f"{machine.name}: {prop.name!r} is not plainly kept in every step; prove it of the whole.")
        into = self.of(machine)
        term = into.bool(prop.term)
        twins = {var: _before(into(var.before)) for var in variables([term]) if var.before is not None}
        name = f"{machine.name}: {prop.name}"
        return replace(prop, name=name, term=Substitution(twins).bool(term), kept_by=(machine, prop))


def _before(var: Expr) -> Expr:
    assert isinstance(var, (NumVar, BoolVar))
    return before(var) if isinstance(var, NumVar) else was(var)


def compose(
    name: str,
    machines: Sequence[Machine],
    wires: Mapping[Var, Expr],
    *,
    shared: Sequence[Var] = (),
    owes: Sequence[Machine | Clause] = (),
) -> Composition:
    """Several machines as one TransitionSystem.

    wires   an input variable of a later machine -> a term over the variables of EARLIER machines, whose state in it
            means the state after the step (so an output of theirs is written as `earlier.output("x")`)
    shared  input or ghost variables that several machines declare as the very same object, kept once
    owes    machines whose assumption is not assumed of the whole: it is owed by the others, and proved; or a clause of it

    Every variable is renamed "machine.variable", shared ones keep their name. Raises ModelError for a wire to an
    unknown input, a unit that does not fit, a wire that reads a machine that is not earlier or a variable that several
    earlier machines have, shared state, a shared ghost that does not start and move alike everywhere, and what is owed
    to a machine that is not there or has no such clause.
    """
    _check(name, machines, wires, shared)
    _check_owed(name, machines, owes)
    lowered = [(machine, lower(machine)) for machine in machines]
    rename: dict[Machine, Substitution] = {}
    kept: dict[Var, Var] = {var: var for var in shared}
    same = Sharing()
    after: dict[Var, Expr] = {}
    plain: dict[Var, Expr] = {}
    moved: dict[Var, Expr] = {}
    merged = TransitionSystem(
        name, (), (), all_of(()), moved, all_of(()), {}, {}, {}, frozenset(), {}, (), tuple(machines)
    )
    for machine, system in lowered:
        own = {var: kept[var] if var in kept else _renamed(machine, var) for var in (*system.state, *system.inputs)}
        told = {var: Substitution(plain)(wires[var]) for var in system.inputs if var in wires}
        now = Substitution({**own, machine.fired_name: _renamed(machine, machine.fired_name), **told})
        wired = {var: Substitution(after)(wires[var]) for var in system.inputs if var in wires}
        step = Substitution({**own, **wired})
        for var in system.state:
            move = same(step(system.next[var]))
            if moved.setdefault(own[var], move) is not move:
                raise ModelError(
                    f"composition {name!r}: the shared ghost {var.name!r} moves otherwise in {machine.name!r}."
                )
            if _start(merged.initial.get(own[var], system.initial[var])) != _start(system.initial[var]):
                raise ModelError(
                    f"composition {name!r}: the shared ghost {var.name!r} starts otherwise in {machine.name!r}."
                )
            after[var] = move
        after |= {var: step(var) for var in system.inputs}
        plain |= {**own, **told}
        owed, assumed = _divided(machine, system, owes)
        ghosts = in_range([var for var in wired if var in system.ghosts])
        part = Part(
            replace(system, name=f"{name} {machine.name}"),
            now,
            step.bool(_may_be_heard(system, wired)),
            step.bool(all_of([ghosts, owed])),
        )
        rename[machine] = now
        merged = replace(
            merged,
            state=_union(merged.state, [own[var] for var in system.state]),
            inputs=_union(merged.inputs, [own[var] for var in system.inputs if var not in wires]),
            init=all_of([merged.init, now.bool(system.init)]),
            assume=all_of([merged.assume, step.bool(assumed)]),
            outputs={**merged.outputs, **{f"{machine.name}.{key}": now(term) for key, term in system.outputs.items()}},
            fired={**merged.fired, **{_fired(now, key): step.num(term) for key, term in system.fired.items()}},
            lemmas={
                **merged.lemmas,
                **{f"{machine.name}: {key}": now.bool(term) for key, term in system.lemmas.items()},
            },
            ghosts=merged.ghosts | {own[var] for var in system.ghosts if var not in wires},
            initial={**merged.initial, **{own[var]: value for var, value in system.initial.items()}},
            optionals=(*merged.optionals, *_kept_optionals(system, own, wires)),
            parts=(*merged.parts, part),
            stages=(*merged.stages, frozenset(own[var] for var in system.state) - frozenset(merged.state)),
        )
    return Composition(replace(merged, next=moved), rename, after)


def _may_be_heard(system: TransitionSystem, wired: Mapping[Var, Expr]) -> Bool:
    """Ranges of the inputs that are wired, ghosts apart, and of what is absent among them."""
    optionals = [option for option in system.optionals if option.value in wired or option.present in wired]
    return all_of([in_range([var for var in wired if var not in system.ghosts]), absent_is_canonical(optionals)])


def _divided(machine: Machine, system: TransitionSystem, owes: Sequence[Machine | Clause]) -> tuple[Bool, Bool]:
    """What the machine assumes, divided into what is owed by the machines before it and what is assumed of the whole."""
    if machine in owes:
        return system.assume, TRUE
    named = {one.name for one in owes if isinstance(one, Clause) and one.machine is machine}
    if not named:
        return TRUE, system.assume
    owed = [term for name, term in machine.clauses.items() if name in named]
    kept = [term for name, term in machine.clauses.items() if name not in named]
    return all_of(owed), all_of([machine.assumption, *kept])


def _check_owed(name: str, machines: Sequence[Machine], owes: Sequence[Machine | Clause]) -> None:
    for one in owes:
        machine = one.machine if isinstance(one, Clause) else one
        if machine not in machines:
            raise ModelError(f"composition {name!r}: {machine.name!r} is owed something and is not part of it.")
        if isinstance(one, Clause) and one.name not in machine.clauses:
            raise ModelError(
                f"composition {name!r}: {machine.name!r} has no clause {one.name!r}; it has {list(machine.clauses)}."
            )


def _start(value: Initial) -> Value | Any_:
    return value.value if isinstance(value, Lit) else value


def _check(name: str, machines: Sequence[Machine], wires: Mapping[Var, Expr], shared: Sequence[Var]) -> None:
    names = [machine.name for machine in machines]
    if len(set(names)) != len(names):
        raise ModelError(f"composition {name!r}: machines {names} must have distinct names.")
    earlier: set[Var] = set()
    twice: set[Var] = set()
    inputs: set[Var] = set()
    for machine in machines:
        system = lower(machine)
        own = {*system.state, *system.inputs}
        held = [var.name for var in shared if var in set(system.state) - system.ghosts]
        if held:
            raise ModelError(
                f"composition {name!r}: {held} is state of {machine.name!r}; only inputs and ghosts can be shared."
            )
        for var in system.inputs:
            if var in wires:
                _check_wire(name, var, wires[var], earlier, twice)
        inputs |= set(system.inputs)
        twice |= (earlier & own) - set(shared)
        earlier |= own
    unknown = [var.name for var in wires if var not in inputs]
    if unknown:
        raise ModelError(f"composition {name!r}: wires lead to {unknown}, which are no inputs of {names}.")


def _check_wire(name: str, var: Var, term: Expr, earlier: set[Var], twice: set[Var]) -> None:
    if isinstance(var, NumVar) != isinstance(term, Num):
        raise ModelError(f"composition {name!r}: the wire to {var.name!r} mixes a number and a truth value.")
    if isinstance(var, NumVar) and isinstance(term, Num) and not term.unit.same(var.unit):
        raise ModelError(
            f"composition {name!r}: the wire to {var.name!r} carries {term.unit.name}, not {var.unit.name}."
        )
    late = [read.name for read in variables([term]) if read not in earlier]
    if late:
        raise ModelError(f"composition {name!r}: the wire to {var.name!r} reads {late}, which no earlier machine has.")
    unclear = [read.name for read in variables([term]) if read in twice]
    if unclear:
        raise ModelError(
            f"composition {name!r}: the wire to {var.name!r} reads {unclear}, which several earlier machines have; "
            "declare one for each machine."
        )


def _renamed(machine: Machine, var: Var) -> Var:
    return replace(var, name=f"{machine.name}.{var.name}")


def _fired(now: Substitution, key: NumVar) -> NumVar:
    term = now(key)
    assert isinstance(term, NumVar)
    return term


def _union(first: tuple[Var, ...], more: Sequence[Var]) -> tuple[Var, ...]:
    return tuple(dict.fromkeys((*first, *more)))


def _kept_optionals(system: TransitionSystem, own: Mapping[Var, Var], wires: Mapping[Var, Expr]) -> list[Optional]:
    kept = []
    for option in system.optionals:
        value, present = own[option.value], own[option.present]
        if option.value not in wires and option.present not in wires:
            assert isinstance(value, NumVar) and not isinstance(present, NumVar)
            kept.append(Optional(value, present))
    return kept
