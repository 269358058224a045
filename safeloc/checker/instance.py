"""Check that admissible inputs exist in every state, by witness functions: terms over state, one for each input.

The witness functions are substituted for the inputs in the conditions on a step. The resulting term must be established for
every state, or be one case of an established disjunction. Where the functions come from does not matter: a wrong one proves
nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from safeloc.checker.dag import Dag, Rewriting

Terms = frozenset[int]


def covered(
    dag: Dag, asked: Terms, inputs: Iterable[int], known: Terms, witnesses: Sequence[Mapping[int, int]]
) -> bool:
    """Return whether in every state some inputs satisfy all conditions on a step.

    asked  the conditions; those that share no inputs are satisfied independently
    known  established terms over state
    """
    return all(
        conditions <= known if not read else _met(dag, known, _instances(dag, read, conditions, witnesses))
        for read, conditions in _groups(dag, asked, frozenset(inputs))
    )


def _groups(dag: Dag, asked: Terms, inputs: Terms) -> list[tuple[Terms, Terms]]:
    """Return groups of inputs with all conditions that read them; conditions without inputs form a group without inputs."""
    groups: list[tuple[Terms, Terms]] = []
    for condition in asked:
        read, conditions = dag.variables(condition) & inputs, frozenset([condition])
        touched = [group for group in groups if group[0] & read or not (group[0] or read)]
        groups = [group for group in groups if group not in touched]
        read = read.union(*(group[0] for group in touched))
        groups.append((read, conditions.union(*(group[1] for group in touched))))
    return groups


def _instances(dag: Dag, read: Terms, conditions: Terms, witnesses: Sequence[Mapping[int, int]]) -> set[Terms]:
    """Return the conditions with each witness function substituted for the inputs, without those that still read an input."""
    complete = [witness for witness in witnesses if read <= witness.keys()]
    made = {Rewriting(dag, {one: witness[one] for one in read}).all(conditions) for witness in complete}
    return {one for one in made if all(dag.variables(term).isdisjoint(read) for term in one)}


def _met(dag: Dag, known: Terms, instances: set[Terms]) -> bool:
    """Return whether in every state some instance holds: the same in all states, or one for each case of a disjunction."""
    if any(_implies(dag, known, one) for one in instances):
        return True
    return any(dag.nodes[term][0] == "or" and _every_case(dag, term, instances) for term in known)


def _every_case(dag: Dag, choice: int, instances: set[Terms]) -> bool:
    return all(
        (case := dag.conjuncts([part])) in instances or any(_implies(dag, case, one) for one in instances)
        for part in dag.parts(choice)
    )


def _implies(dag: Dag, case: Terms, instance: Terms) -> bool:
    """Return whether every condition of the instance is part of the case, or has an alternative that is."""
    return all(
        one in case or (dag.nodes[one][0] == "or" and any(dag.conjuncts([part]) <= case for part in dag.parts(one)))
        for one in instance
    )
