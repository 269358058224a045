"""Synchronous composition: several machines take one step together, in declared order, wired output to input.

A later machine reads the values that an earlier one computed in the same step, so a fault acts without delay. An earlier one hears
a later one in the next step: its wire reads the state before the step, with `was` and `before`.

The composition assumes the assumption of each machine, unless the machine is named in `discharge`: then the assumption is
proved from the machines before it, together with the lemmas (assume-guarantee, safeloc.proof.provers.inherited). A single
clause can be discharged as well; the other clauses of that machine are still assumed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, replace

from safeloc.errors import ModelError, declared_at
from safeloc.language.checks.composition import Plan, SharedGhost, check_plan, refuse_ghosts
from safeloc.language.checks.system import check_system
from safeloc.language.composed_names import lemma_name
from safeloc.language.expr import TRUE, Bool, BoolVar, Expr, Lit, NumVar, Optional, Var, all_of, before_step
from safeloc.language.first_values import Any_, Initial
from safeloc.language.machine import Machine
from safeloc.language.nodes import Value
from safeloc.language.renamed import check_keywords
from safeloc.language.spec import Property
from safeloc.language.system import Part, TransitionSystem, absent_is_canonical, in_range, lower
from safeloc.language.terms import Sharing, Substitution, variables

_ChangeOfPlan = Callable[[Plan], Plan]
_change_of_plan: ContextVar[_ChangeOfPlan] = ContextVar("change of plan", default=lambda plan: plan)


@dataclass(frozen=True, eq=False)
class Clause:
    """One clause of a machine's assumption, by its name."""

    machine: Machine
    name: str


@dataclass(frozen=True, eq=False)
class Composition:
    """The composed system, with the rewriting of each machine's terms into terms of the composition.

    after  variable of a machine -> its value after the step, as a term of the composition
    """

    system: TransitionSystem
    parts: Mapping[Machine, Substitution]
    after: Mapping[Var, Expr]

    def of(self, machine: Machine) -> Substitution:
        """Return the rewriting of one machine's terms (properties, outputs, lemmas) into terms of the composition.

        A wired input becomes the term on its wire, evaluated in the step that the property looks at.
        """
        return self.parts[machine]

    def inherited(self, machine: Machine, prop: Property) -> Property:
        """Turn a property of one machine into one of the composition; provers prove it on the machine alone.

        The composition assumes the machine's assumption too, or earlier machines discharge it. Raises ModelError for a
        property with a further assumption, or one that is not of kind `always`.
        """
        if prop.kind != "always" or prop.further_assumption is not TRUE:
            raise ModelError(
                f"{machine.name}: {prop.name!r} is not an `always` without further assumption; prove it on the composition."
            )
        term = inherited_term(self.of(machine), prop)
        return replace(prop, name=f"{machine.name}: {prop.name}", term=term, kept_by=(machine, prop))


def inherited_term(into: Substitution, prop: Property) -> Bool:
    """Rewrite the term of a machine's property as a term of the composition, by the substitution `into`."""
    term = into.bool(prop.term)
    twins = {var: _twin(into(var.before)) for var in variables([term]) if var.before is not None}
    return Substitution(twins).bool(term)


def _twin(var: Expr) -> Expr:
    assert isinstance(var, (NumVar, BoolVar))
    return before_step(var)


@check_keywords(ModelError, {"owes": "discharge"})
def compose(
    name: str,
    machines: Sequence[Machine],
    wires: Mapping[Var, Expr],
    *,
    shared: Sequence[Var] = (),
    discharge: Sequence[Machine | Clause] = (),
) -> Composition:
    """Combine several machines into one TransitionSystem.

    wires      an input variable of a later machine -> a term over the variables of EARLIER machines; a state variable in
               it means the state after the step (so an output is written as `earlier.output("x")`). `was(flag)` and
               `before(number)` mean the value before the step, of state of ANY machine: so a machine hears a later one, a step
               late (in the first step: its first state)
    shared     input or ghost variables that several machines declare as the same Python object; they appear once
    discharge  machines whose assumption is proved from the machines before them instead of assumed; or single clauses

    Every variable is renamed "machine.variable", shared ones keep their name. Raises ModelError for every declaration that
    safeloc.language.checks.composition and safeloc.language.checks.system refuse, such as a wire to an unknown input, a wire
    that reads a machine that is not earlier other than before the step, and a wire that gives an on-board input the value of a ghost.
    """
    given = Plan(name, machines, [lower(machine) for machine in machines], wires, shared, discharge, declared_at())
    plan = _change_of_plan.get()(given)
    check_plan(plan)
    merging = _Merging(plan)
    for machine, system in zip(plan.machines, plan.systems, strict=True):
        merging.add(machine, system)
    return merging.composition()


@contextmanager
def plans_changed(change: Callable[[Plan], Plan]) -> Iterator[None]:
    """Compose with changed arguments: each `compose` inside this context, in this thread, takes what `change` makes of its own.

    The module of a target calls `compose` itself, and then states claims about the result. So whoever asks for the same claims
    with other wires cannot hand them over as an argument. Inside another such context, its change is applied first.
    """
    outer = _change_of_plan.get()
    token = _change_of_plan.set(lambda plan: change(outer(plan)))
    try:
        yield
    finally:
        _change_of_plan.reset(token)


@dataclass(frozen=True, eq=False)
class _Member:
    """One machine in the composition.

    names  variable of the machine -> its name in the composition
    wired  wired input -> the value that earlier machines compute for it in the step
    now    rewrites terms about one state: a wired input is the term on its wire in that state
    step   rewrites terms about a step: state before it, inputs as read in it
    """

    machine: Machine
    system: TransitionSystem
    names: Mapping[Var, Var]
    wired: Mapping[Var, Expr]
    now: Substitution
    step: Substitution


class _Merging:
    """The composition while it is made: machines are added in the order of the step."""

    def __init__(self, plan: Plan) -> None:
        self._plan, self._shared = plan, frozenset(plan.shared)
        self._names = {
            machine: {var: self._named(machine, var) for var in (*system.state, *system.inputs)}
            for machine, system in zip(plan.machines, plan.systems, strict=True)
        }
        self._now: dict[Machine, Substitution] = {}
        self._in_a_state: dict[Var, Expr] = {}
        self._after: dict[Var, Expr] = {}
        self._moves: dict[Var, Expr] = {}
        self._same = Sharing()
        self._ghosts: list[SharedGhost] = []
        self._system = TransitionSystem(
            plan.name,
            (),
            (),
            all_of(()),
            self._moves,
            all_of(()),
            {},
            {},
            {},
            frozenset(),
            {},
            (),
            tuple(plan.machines),
        )

    def composition(self) -> Composition:
        """Return the composition of the machines added; ModelError for ghosts that machines move or start differently."""
        refuse_ghosts(self._plan, self._ghosts)
        composed = replace(self._system, next=self._moves)
        check_system(composed)
        return Composition(composed, self._now, self._after)

    def add(self, machine: Machine, system: TransitionSystem) -> None:
        """Add the machine, lowered to `system`, behind those added before."""
        one = self._member(machine, system)
        self._move(one)
        self._now[machine] = one.now
        self._system = self._merged(one)

    def _named(self, machine: Machine, var: Var) -> Var:
        return var if var in self._shared else _renamed(machine, var)

    def _before(self, terms: Iterable[Expr]) -> dict[Var, Var]:
        """Return, for each value before the step that the terms read, the state variable of the composition: of any machine."""
        plan = self._plan
        states = {
            var: self._names[machine][var]
            for machine, system in zip(plan.machines, plan.systems, strict=True)
            for var in system.state
        }
        return {var: states[var.before] for var in variables(terms) if var.before is not None}

    def _member(self, machine: Machine, system: TransitionSystem) -> _Member:
        """Return the machine with its renamings; remember the values of its inputs and its terms about a state."""
        names, wires = (
            self._names[machine],
            {var: self._plan.wires[var] for var in system.inputs if var in self._plan.wires},
        )
        before = self._before(wires.values())
        twins = {var: before_step(state) for var, state in before.items()}
        in_a_state, after = Substitution({**self._in_a_state, **twins}), Substitution({**self._after, **before})
        wired_now = {var: in_a_state(term) for var, term in wires.items()}
        wired = {var: after(term) for var, term in wires.items()}
        self._in_a_state |= {**names, **wired_now}
        fired: dict[Var, Expr] = {machine.fired_name: _renamed(machine, machine.fired_name)}
        now, step = Substitution({**names, **fired, **wired_now}), Substitution({**names, **wired})
        return _Member(machine, system, names, wired, now, step)

    def _move(self, one: _Member) -> None:
        """Add the machine's next values. The first machine that moves a shared ghost counts; others are noted for the check."""
        for var in one.system.state:
            name, move = one.names[var], self._same(one.step(one.system.next[var]))
            moves_alike = self._moves.setdefault(name, move) is move
            first = self._system.initial.get(name, one.system.initial[var])
            starts_alike = _start(first) == _start(one.system.initial[var])
            self._ghosts.append(SharedGhost(var, one.machine, moves_alike, starts_alike))
            self._after[var] = move
        self._after |= {var: one.step(var) for var in one.system.inputs}

    def _merged(self, one: _Member) -> TransitionSystem:
        """Return the system so far with this machine."""
        machine, system, names, now, step = one.machine, one.system, one.names, one.now, one.step
        merged, wires = self._system, self._plan.wires
        _, assumed = _divided(machine, system, self._plan.discharge)
        lemmas = {lemma_name(machine.name, key): now.bool(term) for key, term in system.lemmas.items()}
        return replace(
            merged,
            state=_union(merged.state, [names[var] for var in system.state]),
            inputs=_union(merged.inputs, [names[var] for var in system.inputs if var not in wires]),
            init=all_of([merged.init, now.bool(system.init)]),
            assume=all_of([merged.assume, step.bool(assumed)]),
            outputs={**merged.outputs, **{f"{machine.name}.{key}": now(term) for key, term in system.outputs.items()}},
            fired={**merged.fired, **{_fired(now, key): step.num(term) for key, term in system.fired.items()}},
            lemmas={**merged.lemmas, **lemmas},
            ghosts=merged.ghosts | {names[var] for var in system.ghosts if var not in wires},
            initial={**merged.initial, **{names[var]: value for var, value in system.initial.items()}},
            optionals=_joined((*merged.optionals, *_unwired_optionals(system, names, wires))),
            parts=(*merged.parts, self._part(one)),
            stages=(*merged.stages, frozenset(names[var] for var in system.state) - frozenset(merged.state)),
        )

    def _part(self, one: _Member) -> Part:
        """Return the machine as a part: what has to hold of its inputs in the composition for its own facts to carry over."""
        machine, system, step, discharge = one.machine, one.system, one.step, self._plan.discharge
        discharged, _ = _divided(machine, system, discharge)
        ghosts = in_range([var for var in one.wired if var in system.ghosts])
        return Part(
            replace(system, name=f"{self._plan.name} {machine.name}", composition=self._plan.name),
            one.now,
            step,
            step.bool(_wired_inputs_fit(system, one.wired)),
            step.bool(all_of([ghosts, discharged])),
            {key: step.bool(term) for key, term in machine.world.terms.items()},
            _guaranteed(machine, discharge),
        )


def _wired_inputs_fit(system: TransitionSystem, wired: Mapping[Var, Expr]) -> Bool:
    """Return the condition that wired inputs (ghosts apart) are in range, and that absent ones have their canonical value."""
    optionals = [option for option in system.optionals if option.value in wired or option.present in wired]
    return all_of([in_range([var for var in wired if var not in system.ghosts]), absent_is_canonical(optionals)])


def _guaranteed(machine: Machine, discharge: Sequence[Machine | Clause]) -> tuple[str, ...]:
    """Return the names of the machine's clauses that earlier machines guarantee."""
    if machine in discharge:
        return tuple(machine.world.clauses)
    return tuple(one.name for one in discharge if isinstance(one, Clause) and one.machine is machine)


def _left(machine: Machine, discharge: Sequence[Machine | Clause]) -> dict[str, Bool]:
    """Return the clauses of the machine that the composition assumes, by name."""
    guaranteed = _guaranteed(machine, discharge)
    return {name: term for name, term in machine.world.terms.items() if name not in guaranteed}


def _divided(machine: Machine, system: TransitionSystem, discharge: Sequence[Machine | Clause]) -> tuple[Bool, Bool]:
    """Divide the machine's assumption into the part that is discharged and the part that the composition assumes."""
    if machine in discharge:
        return system.assume, TRUE
    named = {one.name for one in discharge if isinstance(one, Clause) and one.machine is machine}
    if not named:
        return TRUE, system.assume
    discharged = [term for name, term in machine.world.terms.items() if name in named]
    return all_of(discharged), all_of(_left(machine, discharge).values())


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
    """Return one Optional for each pair of value and presence: machines that share an optional input share it."""
    return tuple({(option.value.name, option.present.name): option for option in optionals}.values())


def _unwired_optionals(system: TransitionSystem, names: Mapping[Var, Var], wires: Mapping[Var, Expr]) -> list[Optional]:
    found = []
    for option in system.optionals:
        value, present = names[option.value], names[option.present]
        if option.value not in wires and option.present not in wires:
            assert isinstance(value, NumVar) and not isinstance(present, NumVar)
            found.append(Optional(value, present))
    return found
