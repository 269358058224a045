"""Assume-guarantee: a machine's own facts hold in a composition that guarantees its assumption, and in no other."""

from __future__ import annotations

import pytest

from safeloc.errors import ModelError
from safeloc.language.composition import Clause, Composition, compose
from safeloc.language.expr import Expr, NumVar, Var, number
from safeloc.language.machine import ANY, Machine, Transition, modes
from safeloc.language.spec import always
from safeloc.language.system import lower
from safeloc.language.terms import variables
from safeloc.language.units import MM
from safeloc.language.verdict import Proved, Violated
from safeloc.language.world import World
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
from safeloc.proof.provers.proved_base import base
from tests.declaring import changed
from tests.proof.provers.small import told

IDLE, BUSY = modes("IDLE", "BUSY")


class Chain:
    """A source whose level never passes its limit, and a follower that assumes as much and remembers the level."""

    def __init__(self, limit: int = 10, assumed: int = 10, widest: int = 20, *, discharge: bool = True) -> None:
        self.step, self.level = number("step", MM, 0, 3), number("level", MM, 0, 20)
        fits = self.level + self.step <= limit
        self.source = Machine(
            name="source",
            modes=(IDLE, BUSY),
            inputs=[self.step],
            state={self.level: 0},
            outputs={"level": self.level},
            transitions=[Transition("rise", IDLE, IDLE, fits, {self.level: self.level + self.step})],
            lemmas={"below the limit": self.level <= limit},
        )
        self.seen, self.kept = number("seen", MM, 0, widest), number("kept", MM, 0, 20)
        self.truth, self.next_truth = number("truth", MM, 0, 20), number("next_truth", MM, 0, 20)
        self.follower = Machine(
            name="follower",
            modes=(IDLE, BUSY),
            inputs=[self.seen],
            state={self.kept: 0},
            outputs={"kept": self.kept},
            transitions=[Transition("remember", IDLE, IDLE, set={self.kept: self.seen})],
            world=World(
                ghosts={self.truth: ANY},
                choices=[self.next_truth],
                moves={self.truth: self.next_truth},
                clauses={"assumption": (self.seen <= assumed) & (self.next_truth <= 5)},
                reads_machine="the test asks it",
            ),
            lemmas={"within what is assumed": self.kept <= assumed, "the truth is low": self.kept + self.truth <= 40},
        )
        wires: dict[Var, Expr] = {self.seen: self.source.output("level")}
        if discharge:
            wires[self.next_truth] = number_of(self.source)
        self.whole: Composition = compose(
            "chain", (self.source, self.follower), wires, discharge=[self.follower] if discharge else []
        )


def number_of(machine: Machine) -> NumVar:
    """The machine's level as the follower's truth: it is always at most 10, not at most 5."""
    level = machine.output("level")
    assert isinstance(level, NumVar)
    return level


def test_facts_of_each_machine_hold_in_the_whole() -> None:
    """Only ranges have to be guaranteed: the follower's facts hold under the composition's names."""
    known = base(Chain(discharge=False).whole.system)
    assert "source: below the limit" in told(known.always)
    assert "follower: within what is assumed" in told(known.facts)
    assert "range of follower.kept" in told(known.always)
    assert not known.refuted


def test_what_is_owed_is_proved_and_used() -> None:
    """The source guarantees the follower's assumption: the contract is proved, and then the follower's facts."""
    chain = Chain(limit=5, assumed=5)
    known = base(chain.whole.system)
    assert told(known.kept) == {"contract of follower holds"}
    assert {"follower: within what is assumed", "follower: the truth is low"} <= told([*known.facts, *known.always])
    assert not known.refuted


def test_what_is_owed_is_not_assumed() -> None:
    """The composition's assumption does not contain what its machines guarantee to each other."""
    chain = Chain()
    assert variables([chain.whole.system.assume]) == []
    assert variables([lower(chain.follower).assume]) != []


def test_a_contract_that_is_broken_is_shown_by_a_run() -> None:
    """The source rises to 10, the follower assumes 5: violated, with a run; the follower's facts are not used."""
    chain = Chain(limit=10, assumed=5)
    kept = chain.whole.of(chain.follower)
    prop = always("remembered", kept.bool(chain.kept <= 5))
    findings = {one.id: one.result for one in prove(chain.whole.system, [prop], Limits(depth=8))}
    broken = findings["chain/lemma/contract of follower holds"]
    assert isinstance(broken, Violated)
    assert broken.trace is not None
    assert isinstance(findings["chain/property/remembered"], Violated)


def test_a_contract_that_is_kept_is_a_finding() -> None:
    """A proved contract is reported like a lemma, with the text that was re-checked."""
    chain = Chain(limit=5, assumed=5)
    findings = {one.id: one.result for one in prove(chain.whole.system, [], Limits())}
    proved = findings["chain/lemma/contract of follower holds"]
    assert isinstance(proved, Proved)
    assert any("contract-of-follower-holds" in file for file in proved.certificates)


def test_a_wire_that_leaves_the_range_loses_the_facts() -> None:
    """The follower's input goes up to 4, the source up to 10: facts for all inputs in range are not inherited."""
    chain = Chain(limit=10, assumed=10, widest=4, discharge=False)
    known = base(chain.whole.system)
    assert "wired inputs of follower are in range" in told(known.refuted)
    assert "range of source.level" in told(known.always)


def owed_by_clause(limit: int, assumed: int) -> Composition:
    """The chain in which the source has to guarantee the clause of a low level; that the truth is low is still assumed."""
    chain = Chain(limit=limit, assumed=assumed, discharge=False)
    clauses = {"the truth is low": chain.next_truth <= 5, "the level is low": chain.seen <= assumed}
    follower = changed(chain.follower, clauses=clauses)
    wires: dict[Var, Expr] = {chain.seen: chain.source.output("level")}
    return compose("chain", (chain.source, follower), wires, discharge=[Clause(follower, "the level is low")])


def test_a_clause_is_owed_and_the_rest_is_assumed() -> None:
    """The composition still assumes only the part about the truth; both together give the follower's facts."""
    whole = owed_by_clause(limit=5, assumed=5)
    known = base(whole.system)
    assert [var.name for var in variables([whole.system.assume])] == ["follower.next_truth"]
    assert told(known.kept) == {"contract of follower holds"}
    assert "follower: within what is assumed" in told(known.facts)
    assert not known.refuted


def test_a_clause_that_is_not_kept_loses_the_facts() -> None:
    """The source rises to 10, the clause says 5: not proved, and no fact of the follower under it is used."""
    known = base(owed_by_clause(limit=10, assumed=5).system)
    assert {"contract of follower holds", "follower: within what is assumed"} <= told(known.refuted)
    assert not known.kept


def test_what_cannot_be_owed_is_refused() -> None:
    """A machine outside the composition, and a clause that the machine does not have, are refused."""
    chain = Chain(discharge=False)
    wires: dict[Var, Expr] = {chain.seen: chain.source.output("level")}
    with pytest.raises(
        ModelError,
        match=r"^composition 'chain' \(.*:\d+\): `discharge` names 'follower', which is no machine of it; it has \['source'\]\.$",
    ):
        compose("chain", [chain.source], {}, discharge=[chain.follower])
    with pytest.raises(
        ModelError,
        match=r"^composition 'chain' \(.*:\d+\): `discharge` names the clause 'high', which 'follower' does not have; it has \['assumption'\]\.$",
    ):
        compose("chain", [chain.source, chain.follower], wires, discharge=[Clause(chain.follower, "high")])


@pytest.mark.parametrize("limit", [4, 5])
def test_a_state_term_follows_from_facts_alone(limit: int) -> None:
    """A property of states that follows from the facts needs no step: it is proved from them."""
    chain = Chain(limit=limit, assumed=5)
    prop = always("remembered", chain.whole.of(chain.follower).bool(chain.kept <= 5))
    [result] = [one.result for one in prove(chain.whole.system, [prop], Limits()) if one.kind == "property"]
    assert isinstance(result, Proved)
