"""What holds of a system before any property is asked: ranges of its variables and its declared lemmas.

Both are PROVED, once per system, and then serve every property as hypotheses:

    ranges  of the machine's own variables, for ALL inputs in range, assumption or not
    facts   lemmas, and ranges of ghosts, under the assumption

What is not inductive together with the rest is dropped and named in `refuted`; it is never assumed.
"""

from __future__ import annotations

import weakref
from collections.abc import Mapping
from dataclasses import dataclass

import z3

from safeloc.backends.smt import Terms, constant
from safeloc.backends.smtlib import Query, to_smtlib
from safeloc.expr import Bool, NumVar, Substitution, variables
from safeloc.provers.recheck import recheck
from safeloc.system import TransitionSystem, environment, in_range


@dataclass(frozen=True, eq=False)
class Base:
    """Proved facts by name, what was refuted, and the texts that cvc5 has confirmed."""

    ranges: Mapping[str, Bool]
    facts: Mapping[str, Bool]
    refuted: Mapping[str, str]
    certificates: Mapping[str, str]

    @property
    def everything(self) -> list[Bool]:
        """All proved facts."""
        return [*self.ranges.values(), *self.facts.values()]


_KNOWN: weakref.WeakKeyDictionary[TransitionSystem, Base] = weakref.WeakKeyDictionary()


def base(system: TransitionSystem, *, seconds: float = 30.0) -> Base:
    """The system's proved base; computed once per system."""
    if system not in _KNOWN:
        _KNOWN[system] = _prove(system, seconds)
    return _KNOWN[system]


def _prove(system: TransitionSystem, seconds: float) -> Base:
    own = [var for var in system.state if isinstance(var, NumVar) and var not in system.ghosts]
    hidden = [var for var in system.state if isinstance(var, NumVar) and var in system.ghosts]
    wanted = {f"range of {var.name}": in_range([var]) for var in own}
    refuted: dict[str, str] = {}
    ranges = _inductive(system, wanted, [], environment(system, assume=False), refuted, seconds)
    more = {**{f"range of {var.name}": in_range([var]) for var in hidden}, **system.lemmas}
    facts = _inductive(system, more, list(ranges.values()), environment(system), refuted, seconds)
    texts = {}
    for name, kept, given, allowed in (
        ("ranges", ranges, [], environment(system, assume=False)),
        ("facts", facts, list(ranges.values()), environment(system)),
    ):
        if kept:
            for query in _queries(system, f"{system.name} {name}", kept, given, allowed):
                texts[f"{query.name.replace(' ', '-')}.smt2"] = to_smtlib(query)
    for name, text in texts.items():
        recheck(name, text)
    return Base(ranges, facts, refuted, texts)


def _queries(
    system: TransitionSystem, name: str, kept: Mapping[str, Bool], given: list[Bool], allowed: Bool
) -> tuple[Query, Query]:
    """Initiation and consecution of a conjunction."""
    after = Substitution({var: term for var, term in system.next.items()})
    first = Query(f"{name} initially", [system.init, in_range(system.state), *given], dict(kept))
    later = {key: after.bool(term) for key, term in kept.items()}
    return first, Query(f"{name} in every step", [allowed, *given, *kept.values()], later)


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
