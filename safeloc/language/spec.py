"""Properties, and their compilation into a few extra state variables (observers).

A property is a term over the state AFTER the step, the state before it (`before(x)`, `was(x)`), the step's inputs, and
`machine.fired(...)`. A term of `always` that reads state only has to hold in the first state too.

Past operators and `within` are evaluated over steps, and the first state is no step: `previous(p)` is false in the first
step, and a condition that holds in the first state alone is no trigger and no response. To state something about the first
state, use `always(trigger.implies(...))` over state only, or let the trigger read the state before the step (`before`,
`was`), which in the first step is the first state.

    always(p)  never(p)  within(n, trigger, response)  reachable(p)      once(p)  since(p, q)  previous(p)

`observe` compiles a property into a Goal: the same system with observer variables, and a term `good` over its state.
Provers, the monitor, Hypothesis and replay all read this one Goal, so they cannot disagree on its meaning.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

from safeloc.errors import PropertyError, named_at
from safeloc.language.checks.properties import Reading, check_property, check_reading, check_watching
from safeloc.language.checks.system import check_system
from safeloc.language.expr import TRUE, Bool, BoolVar, Expr, Lit, Num, NumVar, Var, all_of, as_num, before_step, ite
from safeloc.language.machine import Machine
from safeloc.language.nodes import Node, Past, Value
from safeloc.language.renamed import check_keywords
from safeloc.language.system import TransitionSystem, first_without_the_world
from safeloc.language.terms import Substitution, children, in_order, rebuilt, text, variables
from safeloc.language.units import COUNT

_RENAMED = {"given": "further_assumption", "trace": "requirements"}
NO_ASSUMPTION = "none: holds for all inputs in range"


@check_keywords(PropertyError, _RENAMED)
@dataclass(frozen=True, eq=False)
class Property:
    """A named requirement on every run (or, for `reachable`, on some run).

    kind                always: `term` holds in every step; within: after each step with `term`, `response` holds in the
                        same step or at most `steps` later; reachable: `term` holds at some point of some run
    further_assumption  assumed in every step besides the machine's own assumption, over state before, inputs and ghosts;
                        reported with the verdict
    statement           the requirement in words
    requirements        ids of the requirements that it verifies
    assumption          the assumption of the proof, in words
    helper              within: a lemma over state and the number of steps waited, which holds while a trigger waits for its
                        response; proved together with the property
    unconditional       required for ALL inputs in range, also if the environment violates the assumption
    kept_by             in a composition: the machine on which it is proved, and the property in that machine's terms
                        (Composition.inherited)
    """

    name: str
    kind: Literal["always", "within", "reachable"]
    term: Bool
    response: Bool = TRUE
    steps: int = 0
    further_assumption: Bool = TRUE
    statement: str = ""
    requirements: tuple[str, ...] = ()
    assumption: str = ""
    helper: Callable[[NumVar], Bool] | None = None
    unconditional: bool = False
    kept_by: tuple[Machine, Property] | None = None
    src: str = field(default_factory=named_at)

    def __post_init__(self) -> None:
        check_property(self)

    def __str__(self) -> str:
        """Return the name, by which certificates tell it: what else it holds, such as its place in a file, is no part of them."""
        return self.name

    @property
    def relies_on(self) -> str:
        """The assumption of the verdict in words: the machine's assumption, and the property's further one."""
        if self.further_assumption is TRUE:
            return NO_ASSUMPTION if self.unconditional else self.assumption
        further = f"further assumption in every step: {text(self.further_assumption)}"
        return further if self.unconditional or not self.assumption else f"{self.assumption}; {further}"


@check_keywords(PropertyError, _RENAMED)
def always(
    name: str,
    term: Bool,
    *,
    further_assumption: Bool = TRUE,
    statement: str = "",
    requirements: tuple[str, ...] = (),
    assumption: str = "",
    unconditional: bool = False,
) -> Property:
    """Require that `term` holds in every step, and in the first state too if it reads state only."""
    more = (further_assumption, statement or name, requirements, assumption, None, unconditional)
    return Property(name, "always", term, TRUE, 0, *more)


@check_keywords(PropertyError, _RENAMED)
def never(
    name: str,
    term: Bool,
    *,
    further_assumption: Bool = TRUE,
    statement: str = "",
    requirements: tuple[str, ...] = (),
    assumption: str = "",
    unconditional: bool = False,
) -> Property:
    """Require that `term` holds in no step, nor in the first state if it reads state only."""
    negated = ~term if isinstance(term, Bool) else term
    more = (further_assumption, statement or name, requirements, assumption, None, unconditional)
    return Property(name, "always", negated, TRUE, 0, *more)


@check_keywords(PropertyError, _RENAMED)
def within(
    name: str,
    steps: int,
    trigger: Bool,
    response: Bool,
    *,
    further_assumption: Bool = TRUE,
    statement: str = "",
    requirements: tuple[str, ...] = (),
    assumption: str = "",
    helper: Callable[[NumVar], Bool] | None = None,
    unconditional: bool = False,
) -> Property:
    """Require that after each step with `trigger`, `response` holds in the same step or at most `steps` later.

    The first state is no step: a trigger that holds only there requires nothing. PropertyError if `steps` is negative.
    """
    more = (further_assumption, statement or name, requirements, assumption, helper, unconditional)
    return Property(name, "within", trigger, response, steps, *more)


@check_keywords(PropertyError, _RENAMED)
def reachable(
    name: str,
    term: Bool,
    *,
    further_assumption: Bool = TRUE,
    statement: str = "",
    requirements: tuple[str, ...] = (),
    assumption: str = "",
    unconditional: bool = False,
) -> Property:
    """Require that some run reaches `term`; the proof is a witness, the inputs of such a run."""
    more = (further_assumption, statement or name, requirements, assumption, None, unconditional)
    return Property(name, "reachable", term, TRUE, 0, *more)


def _earlier(term: Expr) -> Expr:
    """Return the value that a term over state variables had before the step: `before` and `was` for whole terms."""
    twins: dict[Var, Expr] = {var: before_step(var) for var in variables([term])}
    return Substitution(twins)(term)


def earlier_num(term: Num) -> Num:
    """Return the value that a numeric term over state variables had before the step."""
    result = _earlier(term)
    assert isinstance(result, Num)
    return result


def earlier_bool(term: Bool) -> Bool:
    """Return the truth value that a term over state variables had before the step."""
    result = _earlier(term)
    assert isinstance(result, Bool)
    return result


def previous(term: Bool) -> Bool:
    """Return the condition that `term` held in the step before; it is false in the first step."""
    return Past("previous", (term,))


def once(term: Bool) -> Bool:
    """Return the condition that `term` holds now or held in some earlier step."""
    return Past("once", (term,))


def since(term: Bool, start: Bool) -> Bool:
    """Return the condition that `start` held in some step up to now, and `term` in every step after it up to now."""
    return Past("since", (term, start))


@dataclass(frozen=True, eq=False)
class Goal:
    """A system with observer variables and the state term `good`.

    good       for `always` and `within`, true in every state of every run; for `reachable`, false in some state of some run
    prop       the property from which the goal was made
    observers  the added state variables
    original   the system before
    plain      the system without observers, under the assumption of the property: its runs are the runs of the goal
    helper     proved together with `good`
    """

    system: TransitionSystem
    good: Bool
    prop: Property
    observers: tuple[Var, ...]
    original: TransitionSystem
    plain: TransitionSystem
    helper: Bool = TRUE


def observe(system: TransitionSystem, prop: Property) -> Goal:
    """Compile the property into observer variables on `system`. PropertyError if it reads a variable that it must not."""
    check_system(system)
    observer, waiting = _Observer(system, prop.name), waiting_for(prop)
    helper = prop.helper(waiting) if waiting is not None and prop.helper is not None else None
    check_reading(Reading(system, prop, waiting, helper))
    while_waiting = TRUE if waiting is None or helper is None else (waiting > 0).implies(helper)
    good, plain = observer.goal(prop, waiting), _relied_on(system, prop)
    return Goal(observer.on(plain), good, prop, tuple(observer.moves), system, plain, while_waiting)


def speaks_of(system: TransitionSystem, prop: Property) -> bool:
    """Return whether the system has all variables that the property reads, so that it can be judged there."""
    known: set[Var] = {*system.state, *system.inputs, *system.fired}
    read = variables([prop.term, prop.response, prop.further_assumption])
    return all((var if var.before is None else var.before) in known for var in read)


def waiting_for(prop: Property) -> NumVar | None:
    """Return the variable that counts steps from a trigger without a response (0: none open; `steps` + 1: too late).

    None for a property of another kind than `within`.
    """
    if prop.kind != "within":
        return None
    return NumVar(f"observer.{prop.name}.0.waiting", COUNT, 0, prop.steps + 1, None, prop.src)


def _relied_on(system: TransitionSystem, prop: Property) -> TransitionSystem:
    """Return the system under the assumption of the property; the same object if this is the system's own assumption."""
    if not prop.unconditional:
        return (
            system
            if prop.further_assumption is TRUE
            else replace(system, assume=all_of([system.assume, prop.further_assumption]))
        )
    return replace(system, assume=prop.further_assumption, init=first_without_the_world(system))


def is_initially(var: Var, value: Value) -> Bool:
    """Return the condition that a variable has this value."""
    if isinstance(var, NumVar):
        return var.eq(int(value))
    return var if value else ~var


class _Observer:
    """Builds the observer variables of a property, whose terms read state after and before the step, inputs and fired."""

    def __init__(self, system: TransitionSystem, name: str) -> None:
        self.system, self._prefix = system, name
        self.moves: dict[Var, Expr] = {}
        self.initial: dict[Var, Value] = {}
        self._after: dict[Var, Expr] = {**system.next, **{name: term for name, term in system.fired.items()}}
        self.lifted: dict[Expr, Expr] = {}

    def on(self, plain: TransitionSystem) -> TransitionSystem:
        """Return the system with the observer variables that have been made so far."""
        moved, initial = {**plain.next, **self.moves}, {**plain.initial, **self.initial}
        first = all_of([plain.init, *(is_initially(var, value) for var, value in self.initial.items())])
        return replace(plain, state=(*plain.state, *self.moves), next=moved, init=first, initial=initial)

    def goal(self, prop: Property, waiting: NumVar | None) -> Bool:
        match prop.kind:
            case "always":
                return prop.term if self._state_only(prop.term) else ~self._latched(~self.read(prop.term))
            case "reachable":
                return ~prop.term if self._state_only(prop.term) else ~self._latched(self.read(prop.term))
            case "within":
                assert waiting is not None
                return self._answered(prop, waiting)

    def _state_only(self, term: Bool) -> bool:
        state = set(self.system.state)
        nodes = in_order([term])
        return all(var in state for var in variables([term])) and not any(isinstance(node, Past) for node in nodes)

    def _answered(self, prop: Property, waiting: NumVar) -> Bool:
        trigger, response = self.read(prop.term), self.read(prop.response)
        counted = ite(waiting > 0, waiting + 1, ite(trigger, as_num(1, COUNT), as_num(0, COUNT)))
        late = Lit(prop.steps + 1, COUNT)
        self.moves[waiting] = ite(waiting.eq(late), late, ite(response, as_num(0, COUNT), counted))
        self.initial[waiting] = 0
        return waiting < late

    def _name(self, what: str) -> str:
        return f"observer.{self._prefix}.{len(self.moves)}.{what}"

    def _latched(self, event: Bool) -> Bool:
        return self._flag("seen", lambda var: var | event)

    def _flag(self, what: str, move: Callable[[BoolVar], Bool]) -> BoolVar:
        var = BoolVar(self._name(what))
        self.moves[var] = move(var)
        self.initial[var] = False
        return var

    def read(self, term: Bool) -> Bool:
        """Return the term over state before the step and inputs, with observer variables for past operators."""
        for node in in_order([term]):
            if node not in self.lifted:
                self.lifted[node] = self._lift(node)
        result = self.lifted[term]
        assert isinstance(result, Bool)
        return result

    def _lift(self, node: Node) -> Expr:
        if isinstance(node, (NumVar, BoolVar)):
            return node.before if node.before is not None else self._after.get(node, node)
        parts = tuple(self.lifted[child] for child in children(node))
        if not isinstance(node, Past):
            return rebuilt(node, parts)
        args = [part for part in parts if isinstance(part, Bool)]
        match node.op:
            case "previous":
                return self._flag("previous", lambda _: args[0])
            case "once":
                return args[0] | self._flag("once", lambda var: var | args[0])
            case "since":
                var = self._flag("since", lambda var: args[1] | (args[0] & var))
                return args[1] | (args[0] & var)


@dataclass(frozen=True, eq=False)
class StepReading:
    """The reading of a property's terms in one step.

    system  the system with a variable for each past operator, under the assumption of the property
    of      each term of trigger and response -> the same over state before the step and inputs, all of `system`
    """

    system: TransitionSystem
    of: Mapping[Expr, Expr]


def step_reading(system: TransitionSystem, prop: Property) -> StepReading:
    """Return how each term of the property is read in one step. PropertyError if it reads a variable that it must not."""
    check_reading(Reading(system, prop, None, None))
    observer, plain = _Observer(system, prop.name), _relied_on(system, prop)
    for term in (prop.term, prop.response):
        observer.read(term)
    return StepReading(observer.on(plain), observer.lifted)


@dataclass(frozen=True, eq=False)
class Watch:
    """One system with the observers of several goals."""

    system: TransitionSystem
    goals: tuple[Goal, ...]
    observers: tuple[Var, ...]


def watch(system: TransitionSystem, goals: Sequence[Goal]) -> Watch:
    """Combine all goals on one system, whose assumption stays unchanged. PropertyError if observers of two share a name."""
    check_watching(goals)
    moves, initial, observers = dict(system.next), dict(system.initial), list[Var]()
    terms = [system.init]
    for goal in goals:
        for var in goal.observers:
            moves[var], initial[var] = goal.system.next[var], goal.system.initial[var]
            observers.append(var)
            value = goal.system.initial[var]
            terms.append(is_initially(var, value if isinstance(value, (int, bool)) else 0))
    state = (*system.state, *observers)
    merged = replace(system, state=state, next=moves, initial=initial, init=all_of(terms))
    return Watch(merged, tuple(goals), tuple(observers))
