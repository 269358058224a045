"""Judge a weaker claim that replaces the original one.

The original is needed if with the weaker claim some claim is no longer proved, or if a mutant of the machine that only the
original detects is no longer detected. Otherwise the weaker claim kills as much.
"""

from __future__ import annotations

from collections.abc import Sequence

from safeloc.assurance.mutation import results
from safeloc.assurance.mutation.claims import held
from safeloc.assurance.mutation.declared import Declared
from safeloc.assurance.mutation.induction import no_longer
from safeloc.assurance.mutation.judge_machine_mutant import Bench, outcome_of
from safeloc.assurance.mutation.mutants import Mutant
from safeloc.assurance.mutation.results import BY_PROOF, Judged, Outcome
from safeloc.assurance.mutation.weaker import Relation, relation
from safeloc.errors import SafelocError
from safeloc.language.spec import Property

Against = Sequence[tuple[Mutant, Judged]]
"""Mutants of the machine, each with its result."""


def of_claim(on: Bench, mutant: Mutant, against: Against) -> tuple[Outcome, Relation | str]:
    """Return the outcome, and the relation of the new claim to the original one; "" if the declaration is refused."""
    declared = on.unchanged.declared
    try:
        weaker = mutant.alone(declared)
        made = held(weaker, on.canon, on.proofs.under_assumption)
    except SafelocError as error:
        return Outcome(results.REFUSED, (), str(error).splitlines()[-1].strip(" -")), ""
    how = relation(_named(declared, mutant.claim), _named(weaker, mutant.claim), on.canon, on.limits.seconds)
    if how != "weaker":
        return Outcome(results.EQUIVALENT if how == "same" else results.NOT_WEAKER, (), ""), how
    failed = no_longer(made, on.proofs, on.canon, on.limits)
    if failed.claims:
        reason = "not all decided within the limits" if failed.undecided else "not proved in one step of induction"
        return Outcome(results.NEEDED, tuple(map(str, failed.claims)), reason), how
    return _weighed(on, weaker, _noticed_alone(mutant.claim, against), len(against)), how


def _named(declared: Declared, name: str) -> Property:
    return next(prop for prop in declared.properties if prop.name == name)


def _noticed_alone(claim: str, against: Against) -> Against:
    """Return the mutants that this claim and no other one was seen to detect, with the term wrong everywhere."""
    names = {f"property {claim}", f"helper {claim}"}
    return [
        (mutant, one)
        for mutant, one in against
        if one.everywhere.fate in BY_PROOF and one.everywhere.by and names.issuperset(one.everywhere.by)
    ]


def _weighed(on: Bench, weaker: Declared, alone: Against, of: int) -> Outcome:
    for mutant, _ in alone:
        make = mutant.alone if mutant.everywhere is None else mutant.everywhere
        found = outcome_of(on, make, weaker)
        if found.fate not in BY_PROOF:
            return Outcome(results.KILLS_LESS, (mutant.id,), found.fate)
    return Outcome(results.KILLS_AS_MUCH, (), f"{len(alone)} of {of} mutants of the machine are noticed by it alone")
