"""What holds of a system before any property is asked: ranges of its variables and its declared lemmas.

Both are PROVED, once per system, and then serve every property as hypotheses:

    always  ranges of the machine's own variables, and every lemma that needs no assumption: for ALL inputs in range
    facts   the other lemmas, and ranges of ghosts, under the assumption

What is not inductive together with the rest is dropped and named in `refuted`; it is never assumed.
"""

from __future__ import annotations

import weakref
from collections.abc import Mapping
from dataclasses import dataclass, replace

import z3

from safeloc.backends.smt import Terms, constant
from safeloc.backends.smtlib import Query, to_smtlib
from safeloc.expr import Bool, NumVar, Substitution, variables
from safeloc.provers.recheck import recheck
from safeloc.system import TransitionSystem, environment, in_range


@dataclass(frozen=True, eq=False)
class Base:
    """Proved facts by name, what was refuted, and the texts that cvc5 has confirmed."""

    always: Mapping[str, Bool]
    facts: Mapping[str, Bool]
    refuted: Mapping[str, str]
    certificates: Mapping[str, str]

    @property
    def everything(self) -> list[Bool]:
        """All proved facts."""
        return [*self.always.values(), *self.facts.values()]


_KNOWN: weakref.WeakKeyDictionary[TransitionSystem, Base] = weakref.WeakKeyDictionary()


def base(system: TransitionSystem, *, seconds: float = 30.0) -> Base:
    """The system's proved base; computed once per system."""
    if system not in _KNOWN:
        _KNOWN[system] = _prove(system, seconds)
    return _KNOWN[system]


def _prove(system: TransitionSystem, seconds: float) -> Base:
    numeric = [var for var in system.state if isinstance(var, NumVar)]
    own = {f"range of {var.name}": in_range([var]) for var in numeric if var not in system.ghosts}
    hidden = {f"range of {var.name}": in_range([var]) for var in numeric if var in system.ghosts}
    refuted: dict[str, str] = {}
    free = {name: term for name, term in system.lemmas.items() if not set(variables([term])) & system.ghosts}
    always = _inductive(system, {**own, **free}, [], environment(system, assume=False), refuted, seconds)
    refuted = {name: why for name, why in refuted.items() if name in own}
    rest = {name: term for name, term in system.lemmas.items() if name not in always}
    facts = _inductive(system, {**hidden, **rest}, list(always.values()), environment(system), refuted, seconds)
    found = Base(always, facts, refuted, {})
    texts = {f"{query.name.replace(' ', '-')}.smt2": to_smtlib(query) for query in step_queries(system, found)}
    for name, text in texts.items():
        recheck(name, text)
    return replace(found, certificates=texts)


def _queries(
    system: TransitionSystem, name: str, kept: Mapping[str, Bool], given: list[Bool], allowed: Bool
) -> tuple[Query, Query]:
    """Initiation and consecution of a conjunction."""
    after = Substitution({var: term for var, term in system.next.items()})
    first = Query(f"{name} initially", [system.init, in_range(system.state), *given], dict(kept))
    later = {key: after.bool(term) for key, term in kept.items()}
    return first, Query(f"{name} in every step", [allowed, *given, *kept.values()], later)


def step_queries(system: TransitionSystem, known: Base) -> list[Query]:
    """The queries that show the base inductive: what a certificate states."""
    always, given = dict(known.always), list(known.always.values())
    board = _queries(system, f"{system.name} always", always, [], environment(system, assume=False))
    facts = _queries(system, f"{system.name} facts", dict(known.facts), given, environment(system))
    return [query for query in (*board, *facts) if query.goals]


def _inductive(
    system: TransitionSystem,
    wanted: Mapping[str, Bool],
    given: list[Bool],
    allowed: Bool,
    refuted: dict[str, str],
    seconds: float,
) -> dict[str, Bool]:
    """The greatest part of `wanted` that is inductive together; what falls out is named in `refuted`."""
    kept = dict(wanted)
    while kept:
        first, later = _queries(system, system.name, kept, given, allowed)
        failed = {**unproved(first, seconds), **unproved(later, seconds)}
        if not failed:
            break
        refuted |= failed
        kept = {name: term for name, term in kept.items() if name not in failed}
    return kept


def unproved(query: Query, seconds: float, seed: int = 0) -> dict[str, str]:
    """Goals that do not follow from the hypotheses, with what z3 said of them: `not inductive` or its reason."""
    named = {var: constant(var) for var in variables([*query.hypotheses, *query.goals.values()])}
    terms, solver = Terms(named), z3.Solver()
    solver.set("timeout", max(1, int(seconds * 1000)))
    solver.set("random_seed", seed)
    solver.add(*(terms.bool(term) for term in query.hypotheses))
    failed: dict[str, str] = {}
    for name, goal in query.goals.items():
        solver.push()
        solver.add(z3.Not(terms.bool(goal)))
        answer = solver.check()
        if answer != z3.unsat:
            failed[name] = "not inductive" if answer == z3.sat else f"solver: {solver.reason_unknown()}"
        solver.pop()
    return failed
