"""Properties: what must hold, and how a property becomes a few extra state variables.

A property is a term over the state AFTER the step, `before(x)` / `was(x)` for the state before it, the step's
inputs, and `machine.fired(...)`. A term that reads state only is also required of the first state.
Past operators look over steps: `previous(p)` is false in the first step.

    always(p)  never(p)  within(n, trigger, response)  reachable(p)      once(p)  since(p, q)  previous(p)

`observe` compiles a property into a Goal: the same system with observer variables, and a term `good` over its
state. Provers, the monitor, Hypothesis and replay all read that one Goal, so they cannot disagree on its meaning.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

from safeloc.errors import PropertyError, declared_at
from safeloc.expr import TRUE, Bool, BoolVar, Expr, Lit, Num, NumVar, Var, all_of, as_num, before, ite, was
from safeloc.machine import Machine
from safeloc.nodes import Node, Past, Value
from safeloc.system import TransitionSystem
from safeloc.terms import Substitution, children, in_order, rebuilt, text, variables
from safeloc.units import COUNT

LONGEST_NAME = 120
NO_ASSUMPTION = "none: holds for all inputs in range"


@dataclass(frozen=True, eq=False)
class Property:
    """A named requirement on every run (or, for `reachable`, on some run).

    kind       always: `term` holds in every step; within: each `term` is followed by `response` in at most `steps`
               further steps; reachable: some run comes to `term`
    given      a further assumption on every step, over state before, inputs and ghosts; reported with the verdict
    statement  the requirement in words
    assumption what the proof relies on, in words
    unconditional  required for ALL inputs in range, whether the environment keeps its assumption or not
    helper     within: a lemma over state and the number of steps waited, proved together with the property
    trace      requirement ids
    kept_by    of a composition: the machine that has it by itself, and the property over that machine's own terms
               (Composition.inherited)
    """

    name: str
    kind: Literal["always", "within", "reachable"]
    term: Bool
    response: Bool = TRUE
    steps: int = 0
    given: Bool = TRUE
    statement: str = ""
    trace: tuple[str, ...] = ()
    assumption: str = ""
    helper: Callable[[NumVar], Bool] | None = None
    unconditional: bool = False
    kept_by: tuple[Machine, Property] | None = None
    src: str = field(default_factory=declared_at)

    def __post_init__(self) -> None:
        wrong = _wrong(self)
        if wrong:
            raise PropertyError(f"{self.src}: property {self.name!r}: {wrong}")

    @property
    def relies_on(self) -> str:
        """What the verdict relies on, in words: the assumption and whatever the property is given besides."""
        if self.given is TRUE:
            return NO_ASSUMPTION if self.unconditional else self.assumption
        given = f"given in every step: {text(self.given)}"
        return given if self.unconditional or not self.assumption else f"{self.assumption}; {given}"


def _wrong(prop: Property) -> str:
    """What is wrong with a declaration, in words; empty if nothing."""
    if not prop.name.strip() or len(prop.name) > LONGEST_NAME or not prop.name.isprintable():
        return f"a name is 1 to {LONGEST_NAME} printable characters, on one line."
    if prop.kind not in ("always", "within", "reachable"):
        return f"kind {prop.kind!r} is none of always, within, reachable; use these functions."
    for what, term in (("term", prop.term), ("response", prop.response), ("given", prop.given)):
        if not isinstance(term, Bool):
            return f"its {what} is {term!r}, not a truth-valued term; a constant is written TRUE or FALSE."
    if isinstance(prop.steps, bool) or not isinstance(prop.steps, int) or prop.steps < 0:
        return f"steps is {prop.steps!r}; it must be a whole number, 0 or more."
    return ""


def always(
    name: str,
    term: Bool,
    *,
    given: Bool = TRUE,
    statement: str = "",
    trace: tuple[str, ...] = (),
    assumption: str = "",
    unconditional: bool = False,
) -> Property:
    """`term` holds in every step (and at the start, if it reads state only)."""
    return Property(
        name,
        "always",
        term,
        given=given,
        statement=statement or name,
        trace=trace,
        assumption=assumption,
        unconditional=unconditional,
    )


def never(
    name: str,
    term: Bool,
    *,
    given: Bool = TRUE,
    statement: str = "",
    trace: tuple[str, ...] = (),
    assumption: str = "",
    unconditional: bool = False,
) -> Property:
    """`term` holds in no step."""
    return Property(
        name,
        "always",
        ~term if isinstance(term, Bool) else term,
        given=given,
        statement=statement or name,
        trace=trace,
        assumption=assumption,
        unconditional=unconditional,
    )


def within(
    name: str,
    steps: int,
    trigger: Bool,
    response: Bool,
    *,
    given: Bool = TRUE,
    statement: str = "",
    trace: tuple[str, ...] = (),
    assumption: str = "",
    helper: Callable[[NumVar], Bool] | None = None,
    unconditional: bool = False,
) -> Property:
    """After each `trigger`, `response` holds in the same step or at most `steps` later; PropertyError if negative."""
    return Property(
        name, "within", trigger, response, steps, given, statement or name, trace, assumption, helper, unconditional
    )


def reachable(
    name: str,
    term: Bool,
    *,
    given: Bool = TRUE,
    statement: str = "",
    trace: tuple[str, ...] = (),
    assumption: str = "",
    unconditional: bool = False,
) -> Property:
    """Some run comes to `term`; a proof of it is a witness stream."""
    return Property(
        name,
        "reachable",
        term,
        given=given,
        statement=statement or name,
        trace=trace,
        assumption=assumption,
        unconditional=unconditional,
    )


def earlier(term: Expr) -> Expr:
    """A term over state variables as it was before the step (`before` and `was` for whole terms)."""
    twins: dict[Var, Expr] = {var: before(var) if isinstance(var, NumVar) else was(var) for var in variables([term])}
    return Substitution(twins)(term)


def earlier_num(term: Num) -> Num:
    """The same for a numeric term."""
    result = earlier(term)
    assert isinstance(result, Num)
    return result


def earlier_bool(term: Bool) -> Bool:
    """The same for a truth-valued term."""
    result = earlier(term)
    assert isinstance(result, Bool)
    return result


def previous(term: Bool) -> Bool:
    """`term` held in the step before; false in the first step."""
    return Past("previous", (term,))


def once(term: Bool) -> Bool:
    """`term` holds now or held in some earlier step."""
    return Past("once", (term,))


def since(term: Bool, start: Bool) -> Bool:
    """`start` held in some step up to now, and `term` in every step after it up to now."""
    return Past("since", (term, start))


@dataclass(frozen=True, eq=False)
class Goal:
    """A system with observer variables and the state term `good`.

    For `always` and `within`, every run must keep `good`; for `reachable`, some run must break it.
    `helper` is proved together with `good`. `observers` are the added state variables; `prop` and `original` are where it came from.
    """

    system: TransitionSystem
    good: Bool
    prop: Property
    observers: tuple[Var, ...]
    original: TransitionSystem
    helper: Bool = TRUE


def observe(system: TransitionSystem, prop: Property) -> Goal:
    """The property as extra state on `system`. PropertyError if it reads what the system does not have."""
    _check_reads(system, prop)
    observer = _Observer(system, prop.name)
    good = observer.goal(prop)
    moved = {**system.next, **observer.moves}
    initial = {**system.initial, **observer.initial}
    first = all_of([system.init, *(_is_initially(var, value) for var, value in observer.initial.items())])
    state = (*system.state, *observer.moves)
    assume = prop.given if prop.unconditional else all_of([system.assume, prop.given])
    extended = replace(system, state=state, next=moved, init=first, initial=initial, assume=assume)
    return Goal(extended, good, prop, tuple(observer.moves), system, observer.helper)


def _is_initially(var: Var, value: Value) -> Bool:
    if isinstance(var, NumVar):
        return var.eq(int(value))
    return var if value else ~var


def _check_reads(system: TransitionSystem, prop: Property) -> None:
    known = {*system.state, *system.inputs, *system.fired}
    state = set(system.state)
    for var in variables([prop.term, prop.response]):
        if var.before is not None and var.before not in state:
            raise PropertyError(
                f"{prop.src}: property {prop.name!r} reads {var.name!r}: before() is for state variables."
            )
        if var.before is None and var not in known:
            raise PropertyError(
                f"{prop.src}: property {prop.name!r} reads {var.name!r}, which {system.name} does not have."
            )
    for var in variables([prop.given]):
        if var not in {*system.state, *system.inputs}:
            raise PropertyError(
                f"{prop.src}: property {prop.name!r}: `given` reads {var.name!r}; it may read state before "
                "the step, inputs and ghosts."
            )


class _Observer:
    """Builds observer variables; terms handed over are over after-state, before-state, inputs and fired."""

    def __init__(self, system: TransitionSystem, name: str) -> None:
        self.system, self._prefix = system, name
        self.moves: dict[Var, Expr] = {}
        self.initial: dict[Var, Value] = {}
        self._after: dict[Var, Expr] = {**system.next, **{name: term for name, term in system.fired.items()}}
        self._lifted: dict[Expr, Expr] = {}
        self.helper: Bool = TRUE

    def goal(self, prop: Property) -> Bool:
        match prop.kind:
            case "always":
                return prop.term if self._state_only(prop.term) else ~self._latched(~self._now(prop.term))
            case "reachable":
                return ~prop.term if self._state_only(prop.term) else ~self._latched(self._now(prop.term))
            case "within":
                return self._answered(prop)

    def _state_only(self, term: Bool) -> bool:
        state = set(self.system.state)
        nodes = in_order([term])
        return all(var in state for var in variables([term])) and not any(isinstance(node, Past) for node in nodes)

    def _answered(self, prop: Property) -> Bool:
        waiting = NumVar(self._name("waiting"), COUNT, 0, prop.steps + 1, None, prop.src)
        trigger, response = self._now(prop.term), self._now(prop.response)
        counted = ite(waiting > 0, waiting + 1, ite(trigger, as_num(1, COUNT), as_num(0, COUNT)))
        late = Lit(prop.steps + 1, COUNT)
        self.moves[waiting] = ite(waiting.eq(late), late, ite(response, as_num(0, COUNT), counted))
        self.initial[waiting] = 0
        if prop.helper is not None:
            self.helper = prop.helper(waiting)
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

    def _now(self, term: Bool) -> Bool:
        """The term over state before the step and inputs, past operators replaced by observer variables."""
        for node in in_order([term]):
            if node not in self._lifted:
                self._lifted[node] = self._lift(node)
        result = self._lifted[term]
        assert isinstance(result, Bool)
        return result

    def _lift(self, node: Node) -> Expr:
        if isinstance(node, (NumVar, BoolVar)):
            return node.before if node.before is not None else self._after.get(node, node)
        parts = tuple(self._lifted[child] for child in children(node))
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
class Watch:
    """One system with the observers of several goals: `goods` maps a property to its state term."""

    system: TransitionSystem
    goals: tuple[Goal, ...]
    observers: tuple[Var, ...]


def watch(system: TransitionSystem, goals: Sequence[Goal]) -> Watch:
    """All goals on one system, whose assumption is left as it is."""
    moves, initial, observers = dict(system.next), dict(system.initial), list[Var]()
    terms = [system.init]
    for goal in goals:
        for var in goal.observers:
            moves[var], initial[var] = goal.system.next[var], goal.system.initial[var]
            observers.append(var)
            value = goal.system.initial[var]
            terms.append(_is_initially(var, value if isinstance(value, (int, bool)) else 0))
    state = (*system.state, *observers)
    merged = replace(system, state=state, next=moves, initial=initial, init=all_of(terms))
    return Watch(merged, tuple(goals), tuple(observers))
