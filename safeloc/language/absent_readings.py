"""Claims that read an input also while it is absent, when it is stored as a number that nobody measured."""

from __future__ import annotations

from safeloc.language.expr import Bool, Optional
from safeloc.language.folding import Folding
from safeloc.language.nodes import FALSE
from safeloc.language.spec import Property
from safeloc.language.system import TransitionSystem
from safeloc.language.terms import variables


def read_while_absent(system: TransitionSystem, claim: Property) -> list[Optional]:
    """Return the optional inputs whose value stays in a claim if they are taken as absent.

    Such a claim may be right, since another condition in it can imply that the input is present. If none does, it says of a
    silent sensor that it measures the stored number.
    """
    terms = (claim.term, claim.response, claim.further_assumption)
    read = set(variables(terms))
    return [option for option in system.optionals if option.value in read and _stays(option, terms)]


def _stays(option: Optional, terms: tuple[Bool, ...]) -> bool:
    absent = Folding({option.present: FALSE})
    return option.value in set(variables([absent(term) for term in terms]))
