"""The antecedents (cases) of a property: the trigger of `within`, and the condition before `implies`.

If such a case never occurs, the property is vacuously true. `p.implies(q)` is `~p | q`, so every disjunction has the
case that its first part is false. That includes a plain `a | b`: b is never needed if a always holds. `a.iff(b)` and
`x.one_of(...)` have no case, since they require something in every step.

A wire of a composition may carry a constant, which simplifies the property before its cases are listed: `ite(p, a, b)`
becomes `p | b` if a is true, and its case is `~p`; `p | a` becomes p if a is false, and has no case.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from safeloc.language.composition import inherited_term
from safeloc.language.expr import TRUE, Bool, BoolVar, Expr, Lit, NumVar, Var, before, was
from safeloc.language.first_values import Initial
from safeloc.language.folding import settled
from safeloc.language.nodes import And, Compare, Not, Or
from safeloc.language.render import infix
from safeloc.language.spec import Goal, Property, always, observe, once, previous, reachable
from safeloc.language.system import Part, TransitionSystem
from safeloc.language.terms import Substitution, alike, conjuncts, variables

_LONGEST = 110


@dataclass(frozen=True, eq=False)
class Antecedent:
    """A case of a property: if it never occurs, the property, or one of its parts, requires nothing."""

    prop: Property
    term: Bool

    @property
    def words(self) -> str:
        """The case in words for a reader; long terms are shortened."""
        what = "its trigger" if self.prop.kind == "within" else "the case"
        return f"{what} ({infix(self.term, _LONGEST)})"


def antecedents(prop: Property) -> list[Bool]:
    """Return the cases of a property, in order; none for `reachable`, and none for parts required in every step."""
    if prop.kind == "within":
        return [prop.term]
    if prop.kind == "reachable":
        return []
    return [~part.parts[0] for part in conjuncts(settled(prop.term)) if isinstance(part, Or) and not _is_claim(part)]


def cases(prop: Property) -> list[Antecedent]:
    """Return the cases of a property, in order, each together with the property."""
    return [Antecedent(prop, term) for term in antecedents(prop)]


def occurs(system: TransitionSystem, antecedent: Antecedent, name: str) -> Goal:
    """Return the goal that the case occurs in a state or step that the property looks at, under the property's assumption.

    A property that looks at steps does not see a case that occurs in the first state only.
    """
    prop, term = antecedent.prop, antecedent.term
    goal = _comes(system, prop, term, name)
    state_only = not goal.observers
    return _comes(system, prop, once(term), name) if state_only and not of_states(system, prop) else goal


def case_name(prop: Property, place: int) -> str:
    """Return the name of the result about one case; `place` counts from 1."""
    return f"case {place} of {prop.name}"


def occurs_alone(system: TransitionSystem, prop: Property, place: int) -> tuple[Part, Goal] | None:
    """Return one machine of a composition, and the goal that a case of a property occurs in this machine by itself.

    The case is given by its place, from 0. The machine is the one whose property is inherited, under the assumption of
    that property; otherwise the only machine whose variables the case reads. None if there is no such machine.
    """
    return _inherited_case(system, prop, place) or _case_of_one(system, cases(prop)[place])


def _inherited_case(system: TransitionSystem, prop: Property, place: int) -> tuple[Part, Goal] | None:
    if prop.kept_by is None:
        return None
    machine, original = prop.kept_by
    part = next(part for part in system.parts if part.machine is machine)
    for case in cases(original)[place : place + 1]:  # none if a wire made a case that the machine's property lacks
        if _becomes(part, case, cases(prop)[place]):
            return part, occurs(part.alone, case, "case")
    return None


def _becomes(part: Part, original: Antecedent, inherited: Antecedent) -> bool:
    """Return whether a case of a machine's property, rewritten as a term of the composition, is the inherited case."""
    return alike(settled(inherited_term(part.into, replace(original.prop, term=original.term))), inherited.term)


def _case_of_one(system: TransitionSystem, case: Antecedent) -> tuple[Part, Goal] | None:
    for part in system.parts if case.prop.further_assumption is TRUE else ():
        term = _over(part, case.term)
        if term is not None:
            never_occurs = always("case", ~term, unconditional=case.prop.unconditional)
            return part, occurs(part.alone, Antecedent(never_occurs, term), "case")
    return None


def _over(part: Part, term: Bool) -> Bool | None:
    """Rewrite a term of the composition over one machine's own variables; None if it reads others, wired inputs, or inputs before the step."""
    machine_variables = (*part.alone.state, *part.alone.inputs, *part.alone.fired)
    back = {into: var for var in machine_variables if isinstance(into := part.into(var), Var)}
    kept, replaced = {*part.alone.state}, dict[Var, Expr]()
    for var in variables([term]):
        twin = back.get(var if var.before is None else var.before)
        if twin is None or (var.before is not None and twin not in kept):
            return None  # it is another machine's, or the machine has as an input what another one keeps: it knows no value before
        replaced[var] = twin if var.before is None else before(twin) if isinstance(twin, NumVar) else was(twin)
    return Substitution(replaced).bool(term)


def of_states(system: TransitionSystem, prop: Property) -> bool:
    """Return whether a property is required of every state, the first one included, instead of every step."""
    return prop.kind == "always" and not observe(system, prop).observers


@dataclass(frozen=True, eq=False)
class Seen:
    """An observer of a case: `term` is true after a step in which the case occurred.

    moves    observer variable -> its next value
    initial  observer variable -> its first value
    """

    term: Bool
    moves: Mapping[Var, Expr]
    initial: Mapping[Var, Initial]


def seen(system: TransitionSystem, antecedent: Antecedent, name: str) -> Seen:
    """Build the observer that shows after each step whether the case occurred."""
    if of_states(system, antecedent.prop):
        return Seen(antecedent.term, {}, {})
    # `previous` stores the value of the last step; the last observer, by which the goal stores whether it was ever true, is dropped
    goal = _comes(system, antecedent.prop, previous(antecedent.term), name)
    *observers, _ = goal.observers
    flag = observers[-1]
    assert isinstance(flag, BoolVar)
    moves = {var: goal.system.next[var] for var in observers}
    return Seen(flag, moves, {var: goal.system.initial[var] for var in observers})


def _comes(system: TransitionSystem, prop: Property, term: Bool, name: str) -> Goal:
    return observe(
        system, reachable(name, term, further_assumption=prop.further_assumption, unconditional=prop.unconditional)
    )


def _is_claim(term: Or) -> bool:
    """Return whether a disjunction is an `iff` or a `one_of`."""
    return _is_iff(term) or _is_choice(term)


def _is_iff(term: Or) -> bool:
    """Return whether the term has the form (p and q) or (not p and not q)."""
    if len(term.parts) != 2:
        return False
    both, neither = term.parts
    if not (isinstance(both, And) and isinstance(neither, And) and len(both.parts) == len(neither.parts) == 2):
        return False
    return all(_opposite(one, other) for one, other in zip(both.parts, neither.parts, strict=True))


def _opposite(one: Bool, other: Bool) -> bool:
    return (isinstance(one, Not) and one.inner is other) or (isinstance(other, Not) and other.inner is one)


def _is_choice(term: Or) -> bool:
    """Return whether every part compares the same number with a constant."""
    compared = [
        part for part in term.parts if isinstance(part, Compare) and part.op == "==" and isinstance(part.right, Lit)
    ]
    return len(compared) == len(term.parts) and len({part.left for part in compared}) == 1
