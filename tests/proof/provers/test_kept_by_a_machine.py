"""A machine's property for all inputs in range holds in every composition that keeps its inputs in range."""

from __future__ import annotations

from dataclasses import replace

import pytest

from safeloc.errors import ModelError
from safeloc.language.composition import Composition, compose
from safeloc.language.expr import TRUE, Expr, NumVar, Var, before, floor_div, minimum, number
from safeloc.language.interpret import run
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.monitor import check
from safeloc.language.spec import Property, always, reachable
from safeloc.language.units import MM
from safeloc.language.verdict import Held, Proved, Unknown, Violated
from safeloc.language.world import World
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove, proved_base
from safeloc.proof.provers.proved_base import Base, known_base, remember
from safeloc.proof.results import Finding

IDLE, BUSY = modes("IDLE", "BUSY")


class Follower:
    """A source that rises by up to `slope` to at most `most`, and a follower that takes at most half of its input."""

    def __init__(self, *, may_hear: int = 20, assumed: int | None = None, most: int = 20, slope: int = 20) -> None:
        self.step, self.level = number("step", MM, 0, most), number("level", MM, 0, 20)
        self.source = Machine(
            "source", (IDLE, BUSY), [self.step], {self.level: 0}, {"level": self.level},
            [Transition("tell", IDLE, IDLE, set={self.level: minimum(self.step, self.level + slope)})],
            lemmas={"no more than most": self.level <= most},
        )  # fmt: skip
        self.heard, self.kept = number("heard", MM, 0, may_hear), number("kept", MM, 0, 100)
        follow = Transition("follow", IDLE, IDLE, set={self.kept: floor_div(self.heard, 2)})
        self.follower = Machine(
            "follower",
            (IDLE, BUSY),
            [self.heard],
            {self.kept: 0},
            {"kept": self.kept},
            [follow],
            world=World(
                clauses={"assumption": TRUE if assumed is None else self.heard <= assumed},
                reads_machine="the test asks it",
            ),
        )
        wires: dict[Var, Expr] = {self.heard: self.source.output("level")}
        self.whole: Composition = compose("chain", [self.source, self.follower], wires, discharge=[self.follower])

    def small(self) -> Property:
        """It never rises by more than ten."""
        return always("small", self.kept - before(self.kept) <= 10, unconditional=True)

    def finding(self, prop: Property) -> Finding:
        """The finding of the provers for the composition."""
        limits = Limits(seconds=10, depth=5, induction=1)
        (found,) = [one for one in prove(self.whole.system, [prop], limits) if one.id.endswith(prop.name)]
        return found


def test_the_machine_by_itself_is_asked() -> None:
    """The finding is about the composition, and says that the machine alone was proved."""
    chain = Follower()
    found = chain.finding(chain.whole.inherited(chain.follower, chain.small()))
    assert found.id == "chain/property/follower: small"
    assert isinstance(found.result, Proved)
    assert "of follower by itself" in found.method
    texts = found.result.certificates.values()
    own = [text for text in texts if "; property: small" in text]
    assert own
    assert all("; part: follower" in text for text in own)
    assert any("; rule: wires\n; of: follower" in text for text in texts)


def test_what_is_proved_of_the_machines_comes_with_the_base_of_the_whole() -> None:
    """The base of each machine by itself is known with that of the composition, and is the one that the provers find."""
    whole, fresh = Follower().whole.system, Follower().whole.system
    proved_base(whole, Limits(seconds=10))
    for part, again in zip(whole.parts, fresh.parts, strict=True):
        known = known_base(part.alone, 10)
        assert known is not None
        proved, _ = proved_base(again.alone, Limits(seconds=10))
        assert [*map(str, known.always)] == [*map(str, proved.always)]
        assert known.certificates == proved.certificates


def test_where_it_hears_more_than_it_may_the_whole_is_asked() -> None:
    """The machine's input goes up to 8, so it rises by at most 4; in the composition the input is 20."""
    chain = Follower(may_hear=8)
    four = always("four", chain.kept - before(chain.kept) <= 4, unconditional=True)
    found = chain.finding(chain.whole.inherited(chain.follower, four))
    assert isinstance(found.result, Violated)


def test_what_a_machine_breaks_by_itself_may_hold_of_the_whole() -> None:
    """The follower alone may hear 20; the source never says more than 8, and the composition is proved."""
    chain = Follower(most=8)
    low = always("low", chain.kept <= 4, unconditional=True)
    found = chain.finding(chain.whole.inherited(chain.follower, low))
    assert isinstance(found.result, Proved)
    assert "by itself" not in found.method


def test_what_a_machine_breaks_by_itself_is_searched_briefly_in_the_whole() -> None:
    """The source needs ten steps to 10, the search ends after five: undecided, and the reader is sent to the machine's own run."""
    chain = Follower(slope=1)
    found = chain.finding(chain.whole.inherited(chain.follower, always("four", chain.kept <= 4, unconditional=True)))
    assert isinstance(found.result, Unknown)
    assert found.result.reason.startswith("follower by itself breaks 'four'; in the composition k-induction: ")
    assert "Spacer" not in found.result.reason
    assert found.result.depth == 5


def test_it_is_the_same_property() -> None:
    """On a run the verdict is that of a property written over the composition, the state before the step included."""
    chain = Follower()
    asked = chain.whole.inherited(chain.follower, chain.small())
    into = chain.whole.of(chain.follower)
    kept = into(chain.kept)
    assert isinstance(kept, NumVar)
    by_hand = always("by hand", kept - before(kept) <= 10, unconditional=True)
    for levels in ([5, 20, 0, 20], [20]):
        trace = run(chain.whole.system, [{"source.step": level} for level in levels])
        assert isinstance(check(trace, asked), Held)
        assert isinstance(check(trace, by_hand), Held)
    less = chain.whole.inherited(
        chain.follower, always("less", chain.kept - before(chain.kept) <= 2, unconditional=True)
    )
    assert isinstance(check(run(chain.whole.system, [{"source.step": 20}]), less), Violated)


def test_what_is_given_something_more_is_refused() -> None:
    """A property with a further assumption, or one of kind `reachable`, is not inherited."""
    chain = Follower()
    for prop in (replace(chain.small(), further_assumption=chain.heard <= 4), reachable("small", chain.kept > 4)):
        with pytest.raises(ModelError, match=r"^follower: 'small' is not an `always` without further assumption"):
            chain.whole.inherited(chain.follower, prop)


@pytest.mark.parametrize(("assumed", "kept"), [(20, True), (10, False)])
def test_what_a_machine_assumes_has_to_be_owed_and_kept(assumed: int, kept: bool) -> None:
    """The source goes up to 20: a follower whose contract says at most 10 passes nothing on to the composition."""
    chain = Follower(assumed=assumed)
    half = always("half", chain.kept <= assumed // 2)
    found = chain.finding(chain.whole.inherited(chain.follower, half))
    assert isinstance(found.result, Proved if kept else Violated)
    assert ("of follower by itself" in found.method) is kept


def test_nothing_is_taken_for_granted_where_the_base_was_not_proved() -> None:
    """A machine's inputs have to be proved in range; it is not enough that nothing contradicts it."""
    chain = Follower()
    remember(chain.whole.system, Base({}, {}, {}, {}, 1_000))
    found = chain.finding(chain.whole.inherited(chain.follower, chain.small()))
    assert "by itself" not in found.method
