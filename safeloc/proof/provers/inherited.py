"""Assume-guarantee: facts of a machine alone hold in a composition if the other machines guarantee its assumption.

Machine by machine, in the order of the step:

    wires     its wired inputs are in range: proved of the composition; then the machine's facts for all inputs hold
    contract  its discharged assumption: proved of the composition, from facts about the machines before it,
              before AND after the step; then the machine's facts under its assumption hold

No fact of a machine is used before it is proved, and a machine's own proof never uses a later machine. If a discharged
assumption is not proved, the facts of that machine are proved jointly, as if nothing were known of it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, field
from itertools import islice

from safeloc.codegen.smtlib import Query
from safeloc.language.composed_names import lemma_name
from safeloc.language.expr import TRUE, Bool, Expr, NumVar, Var, before_step
from safeloc.language.spec import Property, always
from safeloc.language.system import Part, TransitionSystem, environment
from safeloc.language.terms import Substitution, conjuncts, variables
from safeloc.proof.provers.facts import Fact, about, contract_of, inputs_of, range_of
from safeloc.proof.provers.implication import Failure, Undecided, unproved
from safeloc.proof.provers.limits import deadline
from safeloc.proof.provers.recheck import UNCONFIRMED, certify
from safeloc.proof.provers.relevance import Selection, relevance

PATIENCE = 3  # times the limit: a contract reads several machines, and facts of its machine depend on it


@dataclass(frozen=True, eq=False)
class Alone:
    """Facts proved of a machine alone, over its own state: for all inputs, and under its assumption."""

    always: Mapping[Fact, Bool]
    facts: Mapping[Fact, Bool]
    certificates: Mapping[str, str]


@dataclass(eq=False)
class Inherited:
    """Facts that a composition inherits from its machines.

    kept      the proved contracts (discharged assumptions), over the state before a step and its inputs
    in_range  the machines whose wired inputs are proved to be in range
    """

    always: dict[Fact, Bool] = field(default_factory=dict)
    facts: dict[Fact, Bool] = field(default_factory=dict)
    kept: dict[Fact, Bool] = field(default_factory=dict)
    certificates: dict[str, str] = field(default_factory=dict)
    refuted: dict[Fact, Failure] = field(default_factory=dict)
    in_range: list[str] = field(default_factory=list)


def contracts(system: TransitionSystem) -> dict[Fact, Bool]:
    """Return the discharged assumptions of a composition, over the state before a step and its inputs."""
    return {contract_of(part): part.contract for part in system.parts if part.contract is not TRUE}


def contract_properties(system: TransitionSystem) -> list[tuple[Fact, Property]]:
    """Return these contracts as properties of the composition."""
    state = frozenset(system.state)
    return [(key, always(str(key), _before_the_step(state, term))) for key, term in contracts(system).items()]


def _before_the_step(state: Set[Var], term: Bool) -> Bool:
    twins: dict[Var, Expr] = {var: before_step(var) for var in variables([term]) if var in state}
    return Substitution(twins).bool(term)


def inherit(system: TransitionSystem, alone: Sequence[Alone], seconds: float, *, assumed: bool = True) -> Inherited:
    """Collect the facts of the machines in order; `seconds` limits each proof, and a multiple of it each contract.

    assumed  also facts under the assumption, for which the contracts are proved; else only those for all inputs in range
    """
    found, proof = Inherited(), _Proof(system)
    for part, proved in zip(system.parts, alone, strict=True):
        proof.ends = deadline(seconds * PATIENCE)
        found.certificates |= proved.certificates
        in_range = proof.confirm(inputs_of(part), part.inputs_in_range, found, always=True)
        if in_range:
            found.in_range.append(part.name)
            found.always |= _renamed(part, proved.always)
        contract = assumed and in_range and proof.confirm(contract_of(part), part.contract, found, always=False)
        if contract:
            found.facts |= _renamed(part, proved.facts)
            found.kept |= {} if part.contract is TRUE else {contract_of(part): part.contract}
    return found


def _renamed(part: Part, facts: Mapping[Fact, Bool]) -> dict[Fact, Bool]:
    """Translate facts of a machine to the variables of the composition."""
    ranges = {range_of(var): range_of(_twin(part, var)) for var in part.alone.state if isinstance(var, NumVar)}
    return {
        ranges.get(key, Fact("lemma", lemma_name(part.name, key.of))): part.into.bool(term)
        for key, term in facts.items()
    }


def _twin(part: Part, var: NumVar) -> NumVar:
    twin = part.into(var)
    assert isinstance(twin, NumVar)
    return twin


class _Proof:
    """Proves terms over a step of the composition, each from the facts of the machines that it reads."""

    def __init__(self, system: TransitionSystem) -> None:
        self._system, self.ends = system, deadline(0)
        self._after, self._relevance = Substitution(dict(system.next)), relevance(system)
        self._free = self._selection([environment(system, assume=False)])
        self._lawful = self._selection([environment(system)])
        self._always, self._facts, self._kept = _Known(self), _Known(self), _Known(self)

    def confirm(self, fact: Fact, term: Bool, found: Inherited, *, always: bool) -> bool:
        """Prove by both solvers that the term holds in every step; a failure goes into `refuted`."""
        for known, facts in ((self._always, found.always), (self._facts, found.facts), (self._kept, found.kept)):
            known.learn(facts)
        for number, goals in enumerate(self._alike(term), 1):
            head = about(self._system, fact.kind, of=fact.of, group=number)
            wanted = self._hypotheses(self._relevance.machines(goals.values()), always=always)
            query = Query(f"{self._system.name} {fact} {number}", wanted, goals, head)
            failed = unproved(query, self.ends.left)
            if not failed:
                certificate = certify(query, seconds=self.ends.left, relies_on=list(found.certificates))
                found.certificates[certificate.file] = certificate.text
                failed = {goal: Undecided(UNCONFIRMED) for goal in certificate.undecided}
            if failed:
                found.refuted[fact] = next(iter(failed.values()))
                return False
        return True

    def _hypotheses(self, machines: frozenset[int], *, always: bool) -> list[Bool]:
        """Return what is known of these machines: the environment, then facts before the step, then facts after it."""
        if always:
            some = [self._free, self._always.before, self._always.after]
        else:
            before = [self._always.before, self._facts.before, self._kept.before]
            some = [self._lawful, *before, self._always.after, self._facts.after]
        return [part for one in some for part in one.select(machines)]

    def selection(self) -> Selection:
        """Return an empty selection of hypotheses."""
        return Selection(self._relevance)

    def after(self, term: Bool) -> Bool:
        """Return the term over the state after the step."""
        return self._after.bool(term)

    def _selection(self, hypotheses: Sequence[Bool]) -> Selection:
        made = self.selection()
        made.add(hypotheses)
        return made

    def _alike(self, term: Bool) -> list[dict[int, Bool]]:
        """Group the numbered conjuncts of a term by the machines that they read."""
        groups: dict[frozenset[int], dict[int, Bool]] = {}
        for number, part in enumerate(conjuncts(term), 1):
            groups.setdefault(self._relevance.machines([part]), {})[number] = part
        return list(groups.values())


class _Known:
    """Facts that become more, before a step and after it; what was learned once is not looked at again."""

    def __init__(self, proof: _Proof) -> None:
        self._proof, self._seen = proof, 0
        self.before, self.after = proof.selection(), proof.selection()

    def learn(self, facts: Mapping[Fact, Bool]) -> None:
        """Add the facts that came since the last time; a mapping holds them in the order in which they came."""
        new = list(islice(facts.values(), self._seen, None))
        self._seen += len(new)
        self.before.add(new)
        self.after.add(self._proof.after(one) for one in new)
