"""A law of a machine that the wires of a composition make true: without it the composition keeps its claims."""

from __future__ import annotations

from safeloc.assurance.evidence.effects import effect
from safeloc.assurance.evidence.wired_facts import with_wired_facts
from safeloc.language.composition import Composition, compose
from safeloc.language.expr import Expr, Var, boolean, ite, number
from safeloc.language.machine import ANY, Machine, Transition, modes
from safeloc.language.spec import Property, always
from safeloc.language.units import COUNT
from safeloc.language.world import World
from safeloc.proof.cores.clauses import ClauseId, without
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.proved_base import base
from safeloc.target import Target

RUNNING = modes("RUNNING")
NONE, KNOWN = modes("NONE", "KNOWN")
NEW, CAME = boolean("new"), boolean("came")
TRAIN, NEXT, OTHER, ANOTHER = (number(name, COUNT, 0, 9) for name in ("train", "next_train", "other", "next_other"))
SEEN, NEXT_SEEN, RECORD, STORED = (number(name, COUNT, 0, 9) for name in ("seen", "next_seen", "record", "stored"))
SAME = ClauseId("keeper", "it is the same train")


def _track() -> Machine:
    """Its world knows which train is there; a new one may come."""
    moves: dict[Var, Expr] = {TRAIN: ite(NEW, NEXT, TRAIN), OTHER: ANOTHER}
    world = World({TRAIN: ANY, OTHER: ANY}, [NEXT, ANOTHER], moves)
    return Machine("track", RUNNING, [NEW], {}, {}, [], world=world)


def _keeper() -> Machine:
    """Stores the record of a train, and assumes that the train stays the same until another record comes."""
    laws = {SAME.name: CAME | NEXT_SEEN.eq(SEEN), "a record is true": CAME.implies(RECORD.eq(NEXT_SEEN))}
    world = World({SEEN: ANY}, [NEXT_SEEN], {SEEN: NEXT_SEEN}, laws)
    rows = [Transition("stored", (NONE, KNOWN), KNOWN, CAME, {STORED: RECORD})]
    return Machine("keeper", (NONE, KNOWN), [CAME, RECORD], {STORED: 0}, {}, rows, world=world)


def _together(*, right: bool) -> tuple[Composition, Property]:
    """Both; the keeper's train is that of the track, or, with a wrong wire, another one."""
    track, keeper = _track(), _keeper()
    whole = compose("both", [track, keeper], {CAME: NEW, NEXT_SEEN: TRAIN if right else OTHER})
    claim = always("a known train is stored", keeper.mode.eq(KNOWN).implies(SEEN.eq(STORED)))
    return whole, whole.inherited(keeper, claim)


def _kept(*, right: bool) -> bool:
    whole, claim = _together(right=right)
    target = Target("both", whole.system.machines, whole.system, (claim,))
    return (claim.name,) == effect(target, (SAME,), {claim.name}, Limits(depth=5, seconds=5)).kept


def test_a_law_that_the_wires_make_true_is_not_needed() -> None:
    """With a wire from another train it is: the claim is lost."""
    assert [True, False] == [_kept(right=right) for right in (True, False)]


def test_the_facts_are_proved_and_not_assumed() -> None:
    """In the first state both may differ, so equality is told of a machine that has left its first mode."""
    whole, _ = _together(right=True)
    system = with_wired_facts(without(whole.system, [SAME]))
    assert {"by wires: keeper.seen is track.train"} == {*system.lemmas} - {*whole.system.lemmas}
    assert {} == base(system).refuted


def test_without_wires_between_ghosts_nothing_is_added() -> None:
    """Neither to a composition whose ghosts move by themselves, nor to a single machine."""
    track, keeper = _track(), _keeper()
    apart = compose("apart", [track, keeper], {CAME: NEW}).system
    assert apart is with_wired_facts(apart)
