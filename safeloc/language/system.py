"""Lowering: translation of a machine into one next-value term for each state variable.

Modes, priorities and staying put become terms. Every back end and every prover reads only TransitionSystem.

    lower(machine)                      one machine, ghosts included
    without_ghosts(system)              the on-board system: no environment, no assumption
    composition.compose(...)            several machines, wired output to input, as one system
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from safeloc.errors import UnknownNameError
from safeloc.language.checks.machine import input_variables
from safeloc.language.expr import (
    TRUE,
    Bool,
    BoolVar,
    Expr,
    Lit,
    Num,
    NumVar,
    Optional,
    Var,
    all_of,
    as_bool,
    as_num,
    between,
    ite,
)
from safeloc.language.first_values import ANY, Initial
from safeloc.language.machine import Machine
from safeloc.language.nodes import ChooseBool
from safeloc.language.renamed import hint
from safeloc.language.terms import Sharing, Substitution, conjuncts, numeric, variables
from safeloc.language.transition_table import Transition
from safeloc.language.units import Enumeration


@dataclass(frozen=True, eq=False)
class Part:
    """One machine of a composition. Facts proved for it in isolation carry over as long as its wired inputs stay in range.

    alone            the machine by itself
    into             rewrites terms over its state into terms of the composition
    in_a_step        rewrites terms over its state before the step and its inputs into terms over those of the composition
    inputs_in_range  the condition that its wired inputs are in range, over the composition's state before the step and inputs
    contract         the conditions that the machines before it have to guarantee: the ranges of its wired ghosts, and the
                     discharged part of its assumption
    clauses          every clause of its world by name, over the composition's state before the step and inputs
    guaranteed       names of the clauses that the machines before it guarantee
    """

    alone: TransitionSystem
    into: Substitution
    in_a_step: Substitution
    inputs_in_range: Bool
    contract: Bool
    clauses: Mapping[str, Bool] = field(default_factory=dict)
    guaranteed: tuple[str, ...] = ()

    @property
    def assumed(self) -> dict[str, Bool]:
        """The clauses that the composition assumes, since no machine before it guarantees them; by name."""
        return {name: term for name, term in self.clauses.items() if name not in self.guaranteed}

    @property
    def machine(self) -> Machine:
        """The machine as declared."""
        return self.alone.machines[0]

    @property
    def name(self) -> str:
        """The machine's own name. That of `alone` starts with the composition's, since proofs hold for this configuration."""
        return self.machine.name


@dataclass(frozen=True, eq=False)
class TransitionSystem:
    """A transition system: state, inputs, and a next-value term for each state variable.

    Variables stay in their ranges implicitly; `assume` is the assumption on the environment besides.

    init      the condition on the first state, without the ranges
    next      state variable -> term over state before the step and inputs
    assume    term over state before the step and inputs; TRUE for an on-board system
    outputs   name -> term over state (after the step)
    fired     fired variable of a machine -> term for the number of the transition that fires (0: none)
    lemmas    name -> term over state, to be proved and then used
    ghosts    the variables of the environment, a subset of state and inputs
    initial   state variable -> its declared first value, ANY if left open
    optionals the inputs that may be absent
    machines  the machines from which the system was made
    parts     of a composition: one Part per machine
    stages    of a composition: the state variables of each machine, in the order of the step; only back ends that write
              the step machine by machine read it, and they compute `next` whatever it contains
    composition  of one machine of a composition by itself: the composition's name
    """

    name: str
    state: tuple[Var, ...]
    inputs: tuple[Var, ...]
    init: Bool
    next: Mapping[Var, Expr]
    assume: Bool
    outputs: Mapping[str, Expr]
    fired: Mapping[NumVar, Num]
    lemmas: Mapping[str, Bool]
    ghosts: frozenset[Var]
    initial: Mapping[Var, Initial]
    optionals: tuple[Optional, ...]
    machines: tuple[Machine, ...]
    parts: tuple[Part, ...] = ()
    stages: tuple[frozenset[Var], ...] = ()
    composition: str = ""

    def variable(self, name: str) -> Var:
        """Return a state or input variable by name; UnknownNameError if there is none."""
        for var in (*self.state, *self.inputs):
            if var.name == name:
                return var
        names = [var.name for var in (*self.state, *self.inputs)]
        raise UnknownNameError(f"{self.name} has no variable {name!r}; it has {names}.{hint(name, names)}")


def lower(machine: Machine) -> TransitionSystem:
    """Lower one machine with its ghosts."""
    state = (machine.mode, *machine.state, *machine.world.ghosts)
    guards = _exclusive_guards(machine)
    moved: dict[Var, Expr] = {machine.mode: _chain(guards, {t: t.target for t in guards}, machine.mode)}
    for var in machine.state:
        moved[var] = _chain(guards, {t: t.set.get(var, var) for t in guards}, var)
    moved |= machine.world.moves
    fired = machine.fired_name.unit
    index = {t: Lit(number, fired) for number, t in enumerate(machine.transitions, 1)}
    initial = {machine.mode: machine.modes[0], **machine.state, **machine.world.ghosts}
    optionals = tuple(item for item in machine.inputs if isinstance(item, Optional))
    share = Sharing()
    return TransitionSystem(
        name=machine.name,
        state=state,
        inputs=(*input_variables(machine), *machine.world.choices),
        init=share.bool(all_of([*_initial_terms(initial), machine.initially])),
        next={var: share(term) for var, term in moved.items()},
        assume=share.bool(machine.world.assumption),
        outputs={name: share(term) for name, term in machine.outputs.items()},
        fired={machine.fired_name: share.num(numeric(_chain(guards, index, Lit(0, fired))))},
        lemmas={name: share.bool(term) for name, term in machine.lemmas.items()},
        ghosts=frozenset(machine.world.variables),
        initial=initial,
        optionals=optionals,
        machines=(machine,),
    )


def _exclusive_guards(machine: Machine) -> dict[Transition, Bool]:
    """Return the condition of each transition: its source mode and guard; the order of transitions adds the priority."""
    return {
        t: machine.mode.one_of(*t.sources) & t.when if len(t.sources) < len(machine.modes) else t.when
        for t in machine.transitions
    }


def _chain(guards: Mapping[Transition, Bool], values: Mapping[Transition, Expr | int | bool], stay: Expr) -> Expr:
    """Return the value of the first enabled transition, else `stay`. All chains share the same guard terms in one order."""
    result = stay
    for t in reversed(list(guards)):
        value = values[t]
        if isinstance(result, Num):
            then = as_num(value if isinstance(value, (Num, int)) else 0, result.unit)
            result = ite(guards[t], then, result)
        else:
            then_ = as_bool(value if isinstance(value, (Bool, bool)) else False)
            result = ChooseBool(guards[t], then_, as_bool(result if isinstance(result, Bool) else False))
    return result


def _initial_terms(initial: Mapping[Var, Initial]) -> list[Bool]:
    terms: list[Bool] = []
    for var, value in initial.items():
        if value is ANY:
            continue
        if isinstance(var, NumVar) and isinstance(value, (int, Lit)):
            terms.append(var.eq(value))
        elif isinstance(var, BoolVar) and isinstance(value, bool):
            terms.append(var if value else ~var)
    return terms


def canonical(var: NumVar) -> int:
    """Return the value that an absent optional input holds: the one nearest zero."""
    return min(max(0, var.low), var.high)


def in_range(variables: Sequence[Var]) -> Bool:
    """Return the condition that every numeric variable lies in its declared range."""
    return all_of(_range_term(var) for var in variables if isinstance(var, NumVar))


def _range_term(var: NumVar) -> Bool:
    if isinstance(var.unit, Enumeration):
        return var.one_of(*(Lit(index, var.unit) for index in range(var.low, var.high + 1)))
    return between(var.low, var, var.high)


def environment(system: TransitionSystem, *, assume: bool = True) -> Bool:
    """Return the condition on the inputs of a step: ranges, canonical absent values and, by default, the assumption."""
    admissible = [in_range(system.inputs), absent_is_canonical(system.optionals)]
    return all_of([*admissible, system.assume if assume else TRUE])


def absent_is_canonical(optionals: Sequence[Optional]) -> Bool:
    """Return the condition that every absent input has its canonical value."""
    return all_of(option.present | option.value.eq(canonical(option.value)) for option in optionals)


def without_ghosts(system: TransitionSystem) -> TransitionSystem:
    """Return the system that runs on board; of `init` it keeps the conditions that read no ghost."""
    kept = tuple(var for var in system.state if var not in system.ghosts)
    initial = {var: system.initial[var] for var in kept}
    return replace(
        system,
        state=kept,
        inputs=tuple(var for var in system.inputs if var not in system.ghosts),
        init=all_of(part for part in conjuncts(system.init) if system.ghosts.isdisjoint(variables([part]))),
        next={var: system.next[var] for var in kept},
        assume=TRUE,
        lemmas={},
        ghosts=frozenset(),
        initial=initial,
        parts=(),
        stages=tuple(members - system.ghosts for members in system.stages),
    )


def first_without_the_world(system: TransitionSystem) -> Bool:
    """Return `init` without the conditions that relate on-board state to ghosts: on board the true start is unknown.

    A condition over ghosts alone stays, since it does not restrict the machine.
    """
    return all_of(part for part in conjuncts(system.init) if not _ties(part, system))


def _ties(part: Bool, system: TransitionSystem) -> bool:
    read = set(variables([part]))
    return not (read <= system.ghosts or system.ghosts.isdisjoint(read))
