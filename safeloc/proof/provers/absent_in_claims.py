"""Claims whose truth depends on the value of an absent input: a stored number that nobody measured.

Most claims ask for the input's presence; the value disappears once the presence flag is set to false. Of each other claim
a solver is asked if two copies of a step that differ only in that value can differ in the claim.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from safeloc.codegen.smtlib import Query
from safeloc.language.expr import Bool, Expr, Optional, Var
from safeloc.language.folding import Folding
from safeloc.language.nodes import FALSE
from safeloc.language.spec import Property, observe
from safeloc.language.system import TransitionSystem, in_range
from safeloc.language.terms import Substitution, variables
from safeloc.proof.provers.implication import unproved
from safeloc.proof.provers.proved_base import base


def read_while_absent(
    system: TransitionSystem, claims: Iterable[Property], *, seconds: float = 5.0
) -> Iterator[tuple[Property, Optional]]:
    """Yield each claim with each optional input on whose value it depends, or may depend, while the input is absent.

    seconds  limit of effort for each question. What is not decided is yielded: it may be read.
    """
    for claim in claims:
        if claim.kept_by is None:
            for option in _candidates(system, claim):
                if not _independent(system, claim, option, seconds):
                    yield claim, option


def _candidates(system: TransitionSystem, claim: Property) -> list[Optional]:
    """Return the inputs whose value stays in the claim if they are taken as absent."""
    terms = (claim.term, claim.response, claim.further_assumption)
    read = set(variables(terms))
    return [option for option in system.optionals if option.value in read and _stays(option, terms)]


def _stays(option: Optional, terms: tuple[Bool, ...]) -> bool:
    absent = Folding({option.present: FALSE})
    return option.value in set(variables([absent(term) for term in terms]))


def _independent(system: TransitionSystem, claim: Property, option: Optional, seconds: float) -> bool:
    """Return whether the claim's truth after a step is proved to be the same for every value of the absent input."""
    goal = observe(system, claim)
    one = goal.system
    after: dict[Var, Expr] = {var: one.next[var] for var in one.state}
    holds = Substitution(after).bool(goal.good)
    other = replace(option.value, name=f"{option.value.name} (other)")
    same = holds.iff(Substitution({option.value: other}).bool(holds))
    known = base(system, seconds=seconds)
    given = [in_range([*one.state, *one.inputs, other]), one.assume, ~option.present, *known.always.values()]
    return not unproved(Query(f"{system.name} absence in {claim.name}", given, {"same": same}), seconds)
