"""Independence of claims from the machine: the sub-terms that a claim or a clause shares with its machine.

If a claim consists of terms of the machine, a wrong edit of such a term changes both, and the claim stays proved. Terms are
compared by structure, not by name: a formula that was written twice counts as shared. Outputs and state variables do not
count, since claims are about them. Neither do named values of one variable, such as two modes, since they compute nothing. A
wire that tells the state before the step puts its term both into a row and into a claim that reads the input; so terms over the
state of several machines do not count.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from safeloc.language.checks.machine import read_of_machine
from safeloc.language.nodes import Choose, ChooseBool, Compare, Expr, Lit, Not, NumVar, Or, Var
from safeloc.language.spec import Property
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.terms import Sharing, Substitution, children, in_order, text, variables
from safeloc.language.units import Enumeration
from safeloc.target import Target

_LEAST_NODES = 6
"""Least number of nodes: smaller terms, such as a comparison with a figure, occur in every formula of the same rule."""


@dataclass(frozen=True)
class Shared:
    """A sub-term that a claim or a clause has in common with what a machine computes.

    of     the claim ("property containment") or the clause ("clause the vehicle stays on the line of odometry")
    nodes  distinct nodes of the sub-term
    term   the sub-term, written out
    used   uses in the machine: "next value of x", "output y"
    src    file and line of the claim or of the machine
    reason  the declared reason why the clause has the same term as the machine; "" without one
    """

    of: str
    nodes: int
    term: str
    used: tuple[str, ...]
    src: str
    reason: str = ""


def shared_terms(target: Target) -> list[Shared]:
    """Return the largest sub-terms, of at least six nodes, that claims and clauses of the target share with its machines."""
    claims = _Comparison(target.system)
    found = [
        one for prop in target.properties for one in claims.shared(f"property {prop.name}", _terms(prop), prop.src)
    ]
    for machine in target.machines:
        laws = _Comparison(lower(machine))
        for name, law in machine.world.laws.items():
            common = laws.shared(f"clause {name} of {machine.name}", [law.term], machine.src)
            found += [replace(one, reason=law.shares) for one in common]
    return found


def by_term(found: Iterable[Shared]) -> list[list[Shared]]:
    """Return the shared sub-terms grouped by term, the largest term first."""
    groups: dict[str, list[Shared]] = {}
    for one in found:
        groups.setdefault(one.term, []).append(one)
    return sorted(groups.values(), key=lambda group: -group[0].nodes)


@dataclass(frozen=True)
class _Follows:
    """A clause or a ghost's move that reads values computed by its machine.

    of      the clause or move ("clause 'the vehicle stays on the line' of odometry")
    reads   names of the values
    reason  the reason declared by the world
    """

    of: str
    reads: tuple[str, ...]
    reason: str


def follows_machine(target: Target) -> list[_Follows]:
    """Return each clause and each ghost's move that reads values computed by its machine."""
    return [
        _Follows(f"{what} of {machine.name}", tuple(var.name for var in read), machine.world.reads_machine)
        for machine in target.machines
        for what, read in read_of_machine(machine).items()
    ]


def _terms(prop: Property) -> list[Expr]:
    return [prop.term, prop.response, prop.further_assumption]


class _Comparison:
    """All terms that a system computes, for comparison with a claim."""

    def __init__(self, system: TransitionSystem) -> None:
        self._share = Sharing()
        self._outputs = {self._share(term) for output in system.outputs.values() for term in _put_out(output)}
        self._used: dict[Expr, list[str]] = {}
        self._machines: dict[Expr, frozenset[int]] = {
            var: frozenset({number}) for number, members in enumerate(system.stages) for var in members
        }
        for what, term in _computed(system):
            for node in in_order([self._share(term)]):
                if len(self._read(node)) <= 1:
                    self._used.setdefault(node, []).append(what)

    def _read(self, node: Expr) -> frozenset[int]:
        """Return the machines whose state the term reads; its operands are known already."""
        if node not in self._machines:
            self._machines[node] = frozenset[int]().union(*(self._machines[part] for part in children(node)))
        return self._machines[node]

    def shared(self, of: str, terms: Iterable[Expr], src: str) -> Iterator[Shared]:
        """Yield the largest shared sub-terms of these terms, each once."""
        seen: set[Expr] = set()
        waiting = [self._share(_at_one_time(term)) for term in terms]
        while waiting:
            node = waiting.pop()
            if node in seen or node in self._outputs or _names_values(node):
                continue
            seen.add(node)
            nodes = self._size(node)
            if node in self._used and nodes >= _LEAST_NODES:
                yield Shared(of, nodes, text(node), tuple(dict.fromkeys(self._used[node])), src)
            else:
                waiting += children(node)

    def _size(self, term: Expr) -> int:
        """Return the distinct nodes of a term; an output within it is one, whatever it is computed from."""
        seen: set[Expr] = set()
        waiting = [term]
        while waiting:
            node = waiting.pop()
            if node not in seen:
                seen.add(node)
                waiting += () if node in self._outputs else children(node)
        return len(seen)


def _computed(system: TransitionSystem) -> Iterator[tuple[str, Expr]]:
    """Yield the terms that the machines compute, without those of ghosts."""
    yield from ((f"next value of {var.name}", term) for var, term in system.next.items() if var not in system.ghosts)
    yield from ((f"output {name}", term) for name, term in system.outputs.items())
    yield from (("transition that fires", term) for term in system.fired.values())


def _put_out(term: Expr) -> Iterator[Expr]:
    """Yield an output and each alternative of its choices, since a wire may pass on an alternative without the condition."""
    yield term
    if isinstance(term, (Choose, ChooseBool)):
        yield from _put_out(term.then)
        yield from _put_out(term.other)


def _names_values(term: Expr) -> bool:
    """Return whether a term only compares one enumeration variable with values, such as the modes with a report."""
    parts = in_order([term])
    read = [part for part in parts if isinstance(part, NumVar)]
    named = len(read) == 1 and isinstance(read[0].unit, Enumeration)
    return named and all(isinstance(part, (Compare, Lit, Not, NumVar, Or)) for part in parts)


def _at_one_time(term: Expr) -> Expr:
    """Return the term with each value before the step replaced by its variable: the formula is the same one step later."""
    earlier: dict[Var, Expr] = {var: var.before for var in variables([term]) if var.before is not None}
    return Substitution(earlier)(term)
