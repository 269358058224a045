"""Check that admissible inputs exist in every state, by witness functions: terms over state that give each input.

A witness function replaces the inputs in the conditions on a step. The resulting term must be established for every state,
or be one case of an established disjunction. The origin of witness functions does not matter: a wrong one proves nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from safeloc.checker.dag import Dag, Rewriting

Terms = frozenset[int]


def covered(
    dag: Dag, asked: Terms, inputs: Iterable[int], known: Terms, witnesses: Sequence[Mapping[int, int]]
) -> bool:
    """Return whether in every state some inputs satisfy all conditions on a step; `known` are terms over state.

    Conditions that share no inputs are met independently.
    """
    return all(
        conditions <= known if not own else _met(dag, known, _instances(dag, own, conditions, witnesses))
        for own, conditions in _groups(dag, asked, frozenset(inputs))
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


def _instances(dag: Dag, own: Terms, conditions: Terms, witnesses: Sequence[Mapping[int, int]]) -> set[Terms]:
    """The conditions with each witness function in the place of the inputs; one that leaves an input open is none."""
    whole = [witness for witness in witnesses if own <= witness.keys()]
    made = {Rewriting(dag, {one: witness[one] for one in own}).all(conditions) for witness in whole}
    return {one for one in made if all(dag.variables(term).isdisjoint(own) for term in one)}


def _met(dag: Dag, known: Terms, instances: set[Terms]) -> bool:
    """Return whether in every state some instance holds: the same in all states, or one for each case of a disjunction."""
    if any(_says(dag, known, one) for one in instances):
        return True
    return any(dag.nodes[term][0] == "or" and _every_case(dag, term, instances) for term in known)


def _every_case(dag: Dag, choice: int, instances: set[Terms]) -> bool:
    return all(
        (case := dag.conjuncts([part])) in instances or any(_says(dag, case, one) for one in instances)
        for part in dag.parts(choice)
    )


def _says(dag: Dag, case: Terms, instance: Terms) -> bool:
    """A case says a condition that is part of it, or of which it says one alternative."""
    return all(
        one in case or (dag.nodes[one][0] == "or" and any(dag.conjuncts([part]) <= case for part in dag.parts(one)))
        for one in instance
    )
