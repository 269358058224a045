"""Several machines as one step: wired output to input, in declared order, synchronously.

A later machine sees what an earlier one computed in the same step, so a fault acts without delay.

What a machine assumes of its environment is assumed of the whole, unless it is named in `discharge`: then the machines
before it have to keep it, which is proved together with the lemmas (assume-guarantee, safeloc.proof.provers.inherited).
A single clause of an assumption can be owed as well; the rest of it is then still assumed of the whole.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from safeloc.errors import ModelError, declared_at
from safeloc.language.checks.composition import Plan, SharedGhost, check_plan, refuse_ghosts
from safeloc.language.checks.system import check_system
from safeloc.language.expr import TRUE, Bool, BoolVar, Expr, Lit, NumVar, Optional, Var, all_of, before, was
from safeloc.language.machine import Any_, Initial, Machine
from safeloc.language.nodes import Value
from safeloc.language.renamed import refuse_old_keywords
from safeloc.language.spec import Property
from safeloc.language.system import Part, TransitionSystem, absent_is_canonical, in_range, lower
from safeloc.language.terms import Sharing, Substitution, variables


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
        property with a further assumption, or is not of kind `always`.
        """
        if prop.kind != "always" or prop.further_assumption is not TRUE:
            raise ModelError(f"{machine.name}: {prop.name!r} is not plainly kept in every step; prove it of the whole.")
        term = inherited_term(self.of(machine), prop)
        return replace(prop, name=f"{machine.name}: {prop.name}", term=term, kept_by=(machine, prop))


def inherited_term(into: Substitution, prop: Property) -> Bool:
    """What a machine's own property says of the whole; `into` rewrites the machine's terms into the whole's."""
    term = into.bool(prop.term)
    twins = {var: _before(into(var.before)) for var in variables([term]) if var.before is not None}
    return Substitution(twins).bool(term)


def lemma_name(machine: Machine, name: str) -> str:
    """How a machine's lemma is called in a composition."""
    return f"{machine.name}: {name}"


def contract_text(machine: str) -> str:
    """How what a machine assumes of those before it is called in a composition."""
    return f"what {machine} is owed is kept"


def _before(var: Expr) -> Expr:
    assert isinstance(var, (NumVar, BoolVar))
    return before(var) if isinstance(var, NumVar) else was(var)


@refuse_old_keywords(ModelError, {"owes": "discharge"})
def compose(
    name: str,
    machines: Sequence[Machine],
    wires: Mapping[Var, Expr],
    *,
    shared: Sequence[Var] = (),
    discharge: Sequence[Machine | Clause] = (),
) -> Composition:
    """Several machines as one TransitionSystem.

    wires      an input variable of a later machine -> a term over the variables of EARLIER machines, whose state in it
               means the state after the step (so an output of theirs is written as `earlier.output("x")`)
    shared     input or ghost variables that several machines declare as the very same object, kept once
    discharge  machines whose assumption is not assumed of the whole: it is owed by the others, and proved; or a clause of it

    Every variable is renamed "machine.variable", shared ones keep their name. Raises ModelError for whatever
    safeloc.language.checks.composition and safeloc.language.checks.system refuse, such as a wire to an unknown input, a wire that reads a
    machine that is not earlier, and a ghost that something on board would hear.
    """
    lowered = [(machine, lower(machine)) for machine in machines]
    plan = Plan(name, machines, [system for _, system in lowered], wires, shared, discharge, declared_at())
    check_plan(plan)
    rename: dict[Machine, Substitution] = {}
    kept: dict[Var, Var] = {var: var for var in shared}
    same = Sharing()
    after: dict[Var, Expr] = {}
    plain: dict[Var, Expr] = {}
    moved: dict[Var, Expr] = {}
    together: list[SharedGhost] = []
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
            moves_alike = moved.setdefault(own[var], move) is move
            first = merged.initial.get(own[var], system.initial[var])
            starts_alike = _start(first) == _start(system.initial[var])
            together.append(SharedGhost(var, machine, moves_alike, starts_alike))
            after[var] = move
        after |= {var: step(var) for var in system.inputs}
        plain |= {**own, **told}
        owed, assumed = _divided(machine, system, discharge)
        ghosts = in_range([var for var in wired if var in system.ghosts])
        part = Part(
            replace(system, name=f"{name} {machine.name}", whole=name),
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
                **{lemma_name(machine, key): now.bool(term) for key, term in system.lemmas.items()},
            },
            ghosts=merged.ghosts | {own[var] for var in system.ghosts if var not in wires},
            initial={**merged.initial, **{own[var]: value for var, value in system.initial.items()}},
            optionals=_joined((*merged.optionals, *_kept_optionals(system, own, wires))),
            parts=(*merged.parts, part),
            stages=(*merged.stages, frozenset(own[var] for var in system.state) - frozenset(merged.state)),
        )
    refuse_ghosts(plan, together)
    whole = replace(merged, next=moved)
    check_system(whole)
    return Composition(whole, rename, after)


def _may_be_heard(system: TransitionSystem, wired: Mapping[Var, Expr]) -> Bool:
    """Ranges of the inputs that are wired, ghosts apart, and of what is absent among them."""
    optionals = [option for option in system.optionals if option.value in wired or option.present in wired]
    return all_of([in_range([var for var in wired if var not in system.ghosts]), absent_is_canonical(optionals)])


def _divided(machine: Machine, system: TransitionSystem, discharge: Sequence[Machine | Clause]) -> tuple[Bool, Bool]:
    """What the machine assumes, divided into what is owed by the machines before it and what is assumed of the whole."""
    if machine in discharge:
        return system.assume, TRUE
    named = {one.name for one in discharge if isinstance(one, Clause) and one.machine is machine}
    if not named:
        return TRUE, system.assume
    owed = [term for name, term in machine.clauses.items() if name in named]
    kept = [term for name, term in machine.clauses.items() if name not in named]
    return all_of(owed), all_of([machine.assumption, *kept])


def _start(value: Initial) -> Value | Any_:
    return value.value if isinstance(value, Lit) else value


def _renamed(machine: Machine, var: Var) -> Var:
    return replace(var, name=f"{machine.name}.{var.name}")


def _fired(now: Substitution, key: NumVar) -> NumVar:
    term = now(key)
    assert isinstance(term, NumVar)
    return term


def _union(first: tuple[Var, ...], more: Sequence[Var]) -> tuple[Var, ...]:
    return tuple(dict.fromkeys((*first, *more)))


def _joined(optionals: Sequence[Optional]) -> tuple[Optional, ...]:
    """One for each pair of value and presence: machines that share an optional input share one of them."""
    return tuple({(option.value.name, option.present.name): option for option in optionals}.values())


def _kept_optionals(system: TransitionSystem, own: Mapping[Var, Var], wires: Mapping[Var, Expr]) -> list[Optional]:
    kept = []
    for option in system.optionals:
        value, present = own[option.value], own[option.present]
        if option.value not in wires and option.present not in wires:
            assert isinstance(value, NumVar) and not isinstance(present, NumVar)
            kept.append(Optional(value, present))
    return kept
