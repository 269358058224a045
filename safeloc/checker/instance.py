"""Whether a term says that lawful inputs exist: by showing them, as terms over state, in what a step is allowed.

A term is a choice of cases; each case is to be what is asked of a step with some terms in the place of the inputs. The
terms are found by matching, so nothing has to be believed of where they came from.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from safeloc.checker.dag import Dag, Rewriting

Terms = frozenset[int]


def covered(dag: Dag, asked: Terms, inputs: Sequence[int], shown: Terms, facts: Terms) -> bool:
    """Whether of all that is asked of a step some inputs meet it in every state.

    Conditions that share no inputs are met independently: each such group by one of the terms that are shown, or by all
    of them together where these name one choice only.
    """
    groups = _groups(dag, asked, frozenset(inputs))
    return all(
        conditions <= facts
        if not own
        else any(_every_case(dag, one, conditions, own) for one in shown) or _met(dag, shown, conditions, sorted(own))
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


def _every_case(dag: Dag, term: int, conditions: Terms, inputs: Terms) -> bool:
    cases = dag.parts(term) if dag.nodes[term][0] == "or" else (term,)
    return all(_met(dag, dag.conjuncts([case]), conditions, sorted(inputs)) for case in cases)


def _met(dag: Dag, case: Terms, conditions: Terms, inputs: Sequence[int]) -> bool:
    """Whether with some terms in the place of the inputs every condition is a part of the case."""
    if not inputs:
        return all(_says(dag, case, one) for one in conditions)
    now, later = inputs[0], frozenset(inputs[1:])
    for value in _values(dag, case, conditions, now):
        after = Rewriting(dag, {now: value}).all(conditions)
        settled = frozenset(one for one in after if dag.variables(one).isdisjoint(later))
        if all(_says(dag, case, one) for one in settled) and _met(dag, case, after - settled, inputs[1:]):
            return True
    return False


def _says(dag: Dag, case: Terms, condition: int) -> bool:
    """A case says a condition that is part of it, or of which it says one alternative."""
    if dag.nodes[condition][0] == "or" and any(dag.conjuncts([part]) <= case for part in dag.parts(condition)):
        return True
    return condition in case


def _values(dag: Dag, case: Terms, conditions: Terms, variable: int) -> Iterator[int]:
    """Terms that may stand in the place of the input: constants, or what stands there in the case."""
    if dag.nodes[variable][2] == "Bool":
        yield from dag.truth.values()
        return
    for pattern in conditions:
        if dag.variables(pattern) == {variable}:
            found = {dag.place(pattern, one, variable) for one in case} - {None}
            yield from (one for one in found if one is not None)
            return
