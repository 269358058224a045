"""A claim that is broken a step after a recording is refuted from there, where a search from the first state does not come."""

from __future__ import annotations

from dataclasses import replace

from safeloc.language.composition import Composition, compose
from safeloc.language.expr import Bool, boolean, number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import Property, always, observe
from safeloc.language.system import lower
from safeloc.language.units import COUNT
from safeloc.language.verdict import Unknown, Verdict, Violated
from safeloc.proof.provers.from_known_runs import ENGINE, broken_onward
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove, prove_one
from safeloc.proof.provers.recorded_witnesses import Recording

WAITS, READY = modes("WAITS", "READY")
FAR = 40
GO, SHOUT, HEARD = boolean("go"), boolean("shout"), boolean("heard")
WAITED, LOUD = number("waited", COUNT, 0, FAR), boolean("loud")
CLOCK = Machine(
    "clock", (WAITS, READY), [GO], {WAITED: 0}, {"waited": WAITED},
    [
        Transition("ready", WAITS, READY, GO & WAITED.eq(FAR), rank=0),
        Transition("wait", WAITS, WAITS, GO & (WAITED < FAR), {WAITED: WAITED + 1}, rank=1),
    ],
)  # fmt: skip
"""It is ready after 41 steps in which it goes."""
BELL = Machine(
    "bell", (WAITS, READY), [HEARD, SHOUT], {LOUD: False}, {"loud": LOUD},
    [Transition("ring", WAITS, WAITS, HEARD & SHOUT, {LOUD: True})],
)  # fmt: skip


def whole() -> Composition:
    """The bell rings once the clock is ready, and somebody shouts."""
    ready: Bool = CLOCK.mode.eq(READY)
    return compose("tower", [CLOCK, BELL], {HEARD: ready})


def silent(tower: Composition) -> Property:
    """It never rings."""
    return always("never loud", ~tower.of(BELL).bool(LOUD), unconditional=True)


QUIET = Recording({}, [{"clock.go": True, "bell.shout": False}] * (FAR + 2))
"""A recording in which nobody shouts."""
SHORT = Limits(depth=5, induction=1, seconds=3.0)


def verdict(*recordings: Recording) -> Verdict:
    """What is said with these recordings."""
    tower = whole()
    found = prove(tower.system, [silent(tower)], SHORT, recordings=recordings)
    return next(one.result for one in found if one.id.endswith("never loud"))


def test_it_is_refuted_from_the_recording() -> None:
    """By a run of its length and a step, as short as it can be made."""
    found = verdict(QUIET)
    assert isinstance(found, Violated)
    assert found.trace is not None
    assert found.engine == ENGINE
    assert len(found.trace.steps) == FAR + 2


def test_without_the_recording_it_is_found_otherwise_or_not_at_all() -> None:
    """A bounded search of five steps does not come there."""
    found = verdict()
    assert isinstance(found, Unknown) or (isinstance(found, Violated) and found.engine != ENGINE)


def test_a_machine_by_itself_is_searched_from_its_first_states() -> None:
    """Its runs are short enough; recordings are of a composition."""
    alone = lower(CLOCK)
    goal = observe(alone, always("never ready", CLOCK.mode.ne(READY), unconditional=True))
    assert broken_onward([goal], [Recording({}, [{"go": True}] * (FAR + 1))], SHORT) == {}
    assert broken_onward([], [QUIET], SHORT) == {}


def test_a_recording_that_is_not_near_says_nothing() -> None:
    """The other engines are asked then."""
    tower = whole()
    goal = observe(tower.system, silent(tower))
    early = replace(QUIET, steps=QUIET.steps[:3])
    assert broken_onward([goal], [early], SHORT) == {}
    found = prove_one(goal, replace(SHORT, seconds=1.0), [early])
    assert not isinstance(found, Violated) or found.engine != ENGINE
