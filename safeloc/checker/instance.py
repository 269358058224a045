"""Whether a term says that lawful inputs exist: by showing them, as terms over state, in what a step is allowed.

A term is a choice of cases; each case is to be what is asked of a step with some terms in the place of the inputs. The
terms are found by matching, so nothing has to be believed of where they came from.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from safeloc.checker.dag import Dag, Rewriting

Terms = frozenset[int]


MOST_TRIES = 2000  # terms put in the place of an input; a search that takes more is given up, and says so


class GaveUpError(Exception):
    """Too many terms may stand in the place of inputs: whether some of them meet the conditions is not known."""


class _Tries:
    """How many terms may still be tried."""

    def __init__(self) -> None:
        self._left = MOST_TRIES

    def one(self) -> None:
        """One more; GaveUpError where none is left."""
        self._left -= 1
        if self._left < 0:
            raise GaveUpError(f"the search for inputs was given up after {MOST_TRIES} tries")


def covered(dag: Dag, asked: Terms, inputs: Sequence[int], shown: Terms, facts: Terms) -> bool:
    """Whether of all that is asked of a step some inputs meet it in every state.

    Conditions that share no inputs are met independently: each such group by one of the terms that are shown, or by all
    of them together where these name one choice only. GaveUpError where the search for them takes too long.
    """
    groups, tries = _groups(dag, asked, frozenset(inputs)), _Tries()
    return all(
        conditions <= facts
        if not own
        else any(_every_case(dag, one, conditions, own, tries) for one in shown)
        or _met(dag, shown, conditions, own, tries)
        for own, conditions in groups
    )


def _groups(dag: Dag, asked: Terms, inputs: Terms) -> list[tuple[Terms, Terms]]:
    """Inputs, and the conditions on these and no others; what reads no input is a group without any."""
    groups: list[tuple[Terms, Terms]] = []
    for condition in asked:
        own, conditions = dag.variables(condition) & inputs, frozenset([condition])
        touched = [group for group in groups if group[0] & own or not (group[0] or own)]
        groups = [group for group in groups if group not in touched]
        groups.append((own.union(*(group[0] for group in touched)), conditions.union(*(group[1] for group in touched))))
    return groups


def _every_case(dag: Dag, term: int, conditions: Terms, inputs: Terms, tries: _Tries) -> bool:
    cases = dag.parts(term) if dag.nodes[term][0] == "or" else (term,)
    return all(_met(dag, dag.conjuncts([case]), conditions, inputs, tries) for case in cases)


def _met(dag: Dag, case: Terms, conditions: Terms, inputs: Terms, tries: _Tries) -> bool:
    """Whether with some terms in the place of the inputs every condition is a part of the case.

    The condition that reads fewest inputs goes first: it is settled soon, and a wrong choice is seen where it was made.
    """
    asked: dict[int, Terms] = {one: own for one in conditions if (own := dag.variables(one) & inputs)}
    if not asked:
        return all(_says(dag, case, one) for one in conditions)
    fewest = sorted(asked.values(), key=_fewest)[0]
    now = min(fewest)
    later, touched = inputs - {now}, frozenset(one for one, own in asked.items() if now in own)
    for value in _values(dag, case, conditions, now):
        tries.one()
        after = Rewriting(dag, {now: value}).all(touched)
        settled = frozenset(one for one in after if dag.variables(one).isdisjoint(later))
        if all(_says(dag, case, one) for one in settled) and _met(
            dag, case, (conditions - touched) | (after - settled), later, tries
        ):
            return True
    return False


def _fewest(inputs: Terms) -> tuple[int, int]:
    return len(inputs), min(inputs)


def _says(dag: Dag, case: Terms, condition: int) -> bool:
    """A case says a condition that is part of it, or of which it says one alternative."""
    if dag.nodes[condition][0] == "or" and any(dag.conjuncts([part]) <= case for part in dag.parts(condition)):
        return True
    return condition in case


def _values(dag: Dag, case: Terms, conditions: Terms, variable: int) -> Iterator[int]:
    """Terms that may stand in the place of the input: constants, or what stands there in the case, everywhere."""
    if dag.nodes[variable][2] == "Bool":
        yield from dag.truth.values()
        return
    patterns = [one for one in conditions if dag.variables(one) == {variable}]
    found = [{dag.place(pattern, one, variable) for one in case} - {None} for pattern in patterns]
    yield from sorted(term for term in set.intersection(*found) if term is not None) if found else ()
