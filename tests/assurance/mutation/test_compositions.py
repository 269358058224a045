"""Wrong machines and wrong wires of a composition: the machine's own claims come first, then those of the whole."""

from __future__ import annotations

from dataclasses import asdict, replace
from functools import cache
from pathlib import Path

import pytest

from safeloc.assurance.mutation.claims import Canon
from safeloc.assurance.mutation.composed_work import JudgingComposed, parts
from safeloc.assurance.mutation.judge_composition_mutant import composition_bench, of_member, of_wire, shared
from safeloc.assurance.mutation.members import Composed, composed, joined
from safeloc.assurance.mutation.places import Places, noted
from safeloc.assurance.mutation.results import BY_PROOF, EQUIVALENT, Judged, Outcome, by_requirement
from safeloc.assurance.mutation.rewired import rewired
from safeloc.assurance.mutation.wires import wire_edits
from safeloc.assurance.mutation.work import Plan
from safeloc.catalogue import load_target
from safeloc.errors import InputError
from safeloc.language.terms import alike
from safeloc.proof.cache.store import Store
from safeloc.proof.provers.limits import Limits
from tests.assurance.mutation import answer
from tests.assurance.mutation.door import lasting, listening, target, truthful

PLAN = Plan(Limits(seconds=2), 0, 2)


@cache
def loaded() -> tuple[Composed, Places]:
    """The composition, and where its terms are written."""
    with noted() as places:
        whole = target()
    return composed(whole, places), places


@cache
def all_judged() -> tuple[Judged, ...]:
    """All mutants of both machines and of the wires."""
    whole, places = loaded()
    return tuple(JudgingComposed(whole, PLAN, lambda _: None).all(parts(whole, places, most=None, seed=0)))


def found(words: str, where: str) -> Judged:
    """The one mutant of these words."""
    [one] = [one for one in all_judged() if one.words == words and where in str(one.where)]
    return one


def test_the_same_machine_makes_the_same_whole() -> None:
    """Made again with nothing wrong, nothing is seen to have changed."""
    whole, _ = loaded()
    canon = Canon()
    was = shared(whole.target.system, canon)
    for name in whole.members:
        now = shared(joined(whole, whole.members[name].machine), canon)
        assert all(now.next[var] is was.next[var] for var in was.state)
        assert {name: now.outputs[name] is term for name, term in was.outputs.items()} == dict.fromkeys(
            was.outputs, True
        )
        assert [(part.inputs_in_range, part.contract) for part in now.parts] == [
            (part.inputs_in_range, part.contract) for part in was.parts
        ]


def test_its_own_claim_comes_first() -> None:
    """What the door's own claim notices is not asked of the whole."""
    one = found("opened keeps its value", "row 'shuts'")
    assert ("door", "property shut is counted") == (one.machine, one.everywhere.by[0])


def test_the_whole_notices_what_the_machine_does_not() -> None:
    """Of the watch by itself nothing is claimed; with it wrong the door opens for fast ones."""
    for words, where in (("50 becomes 51", "output slow"), ("seen_mm_s keeps its value", "row 'sees'")):
        one = found(words, where)
        assert ("no longer proved", ("property open for slow ones only",)) == (one.everywhere.fate, one.everywhere.by)


def test_a_claim_that_two_steps_prove_notices() -> None:
    """One step of induction proves it of no composition, so it is asked over two; what does not concern it survives."""
    with noted() as places:
        whole = lasting()
    made = composed(whole, places)
    on = composition_bench(made, PLAN.limits)
    assert ({}, {"a door that stays shut is counted": 2}) == (on.asked, on.deeper)
    mutants = parts(made, places, most=None, seed=0).members
    kept, deaf = (
        next(one for one in mutants if one.words == words and row in str(one.where))
        for words, row in (("opened keeps its value", "shuts"), ("condition 2 is left out", "opens"))
    )
    counted = of_member(on, kept, everywhere=True)
    assert ("no longer proved", ("property a door that stays shut is counted",)) == (counted.fate, counted.by)
    assert "refuted or not decided in 2 steps of the whole" == counted.how
    assert "survived" == of_member(on, deaf, everywhere=True).fate


def test_a_wrong_wire() -> None:
    """A crossed wire lets fast ones in; one that is cut keeps the door shut, which nothing claims it must not be."""
    crossed, cut = found("slow gets the value of silent", "wire"), found("the wire to silent is cut", "wire")
    assert ("no longer proved", ("property open for slow ones only",)) == (
        crossed.everywhere.fate,
        crossed.everywhere.by,
    )
    assert "survived" == cut.everywhere.fate
    assert {"watched_door"} == {crossed.machine, cut.machine}


@pytest.mark.parametrize(
    ("words", "claims"),
    [
        ("slow has the value of the cycle before", ("property open for slow ones only",)),
        ("slow is always true", ("property open for slow ones only",)),
        ("silent has the value of the cycle before", ()),
    ],
)
def test_a_late_and_a_constant_wire(words: str, claims: tuple[str, ...]) -> None:
    """The door opens for what was slow a cycle ago, or for everyone; that it listens late, nothing claims."""
    one = found(words, "wire").everywhere
    assert ("no longer proved" if claims else "survived", claims) == (one.fate, one.by)


def test_a_wire_that_reads_the_truth() -> None:
    """No machine on board may read a ghost: such a wire is refused, in these words."""
    refused = truth_judged("wire reads the truth")
    assert ["refused at birth"] * 2 == [one.fate for one in refused]
    assert "the wire to 'slow', an on-board input, reads the ghost 'is_slow'" in refused[0].how


def test_a_wire_to_the_truth() -> None:
    """A wrong truth changes no output, yet is not equivalent: the contract speaks of it, or it is a question."""
    noticed = ("no longer proved", ("contract of door holds",))
    assert [noticed, ("survived", ())] == [(one.fate, one.by) for one in truth_judged("wire cut")]
    assert [noticed] * 2 == [(one.fate, one.by) for one in truth_judged("another wire of the same unit")]


def test_another_truth_of_an_earlier_machine() -> None:
    """No term of the contract changes, but the facts on which it rests speak of another truth: it is asked again."""
    with noted() as places:
        whole = load_target("fibre_timed")
    made = composed(whole, places)
    wrong = ("the wire to next_truth_nm is cut", "wire to next_truth_nm of time_of_flight")
    [cut] = [edit for edit in wire_edits(made, places) if (edit.mutant.words, *edit.mutant.where) == wrong]
    assert cut.to_a_ghost
    outcome = of_wire(composition_bench(made, PLAN.limits), cut)
    assert ("no longer proved", ("contract of additional holds",)) == (outcome.fate, outcome.by)


def truth_judged(kind: str) -> list[Outcome]:
    """What becomes of the wrong wires of this kind that read or carry the truth."""
    with noted() as places:
        whole = truthful()
    made = composed(whole, places, truthful)
    on = composition_bench(made, PLAN.limits)
    return [
        of_wire(on, edit)
        for edit in wire_edits(made, places)
        if kind == edit.mutant.kind and (edit.to_a_ghost or "ghost" in edit.mutant.words)
    ]


def test_a_claim_speaks_of_the_wire_that_is_there() -> None:
    """A claim about a wired input holds the term on its wire: made again with the cut wire it fails, as it stood it could not."""
    with noted() as places:
        whole = listening()
    fates = []
    for again in (listening, None):
        listened = composed(whole, places, again)
        [cut] = [edit for edit in wire_edits(listened, places) if edit.mutant.words == "the wire to silent is cut"]
        made = of_wire(composition_bench(listened, PLAN.limits), cut)
        fates.append((made.fate, made.by))
    assert [("no longer proved", ("property silence is heard",)), ("survived", ())] == fates


def test_a_wrong_term_on_a_wire() -> None:
    """Each part of the gate is left out or turned; what leaves the value as it is, is equivalent and no question."""
    with noted() as places:
        whole = listening()
    listened = composed(whole, places, listening)
    on = composition_bench(listened, PLAN.limits)
    gate = [edit for edit in wire_edits(listened, places) if "silent & (silent | slow)" in edit.mutant.source]
    part = [edit for edit in wire_edits(listened, places) if edit.mutant.source == "silent | slow"]
    told = [(edit.mutant.words, of_wire(on, edit).fate) for edit in (*gate, *part)]
    noticed, equal = "no longer proved", "equivalent"
    assert [
        ("and becomes or", noticed), ("condition 1 is left out", noticed), ("condition 2 is left out", equal),
        ("or becomes and", noticed), ("condition 1 is left out", noticed), ("condition 2 is left out", equal),
    ] == told  # fmt: skip


def test_a_wrong_output_is_wrong_on_a_late_wire_too() -> None:
    """The wire has a copy of the output's term, over the state before the step; each wrong output is noticed by the claim of the whole."""
    with noted() as places:
        made = answer.target()
    whole = composed(made, places)
    brake = whole.members["brake"].machine
    wrong = replace(brake, outputs={"strong": brake.outputs["strong"] | (brake.mode.ne(brake.modes[0]))})
    heard = made.system.variable("judge.mode")
    assert alike(joined(whole, brake).next[heard], made.system.next[heard])
    assert not alike(joined(whole, wrong).next[heard], made.system.next[heard])
    judged = JudgingComposed(whole, PLAN, lambda _: None).all(parts(whole, places, most=None, seed=0))
    of_output = [one for one in judged if "output strong" in str(one.where)]
    assert len(of_output) >= 5
    assert all(one.everywhere.fate in BY_PROOF or one.everywhere.fate == EQUIVALENT for one in of_output)


def test_another_output_of_the_machine() -> None:
    """The next one of its kind, on one wire at a time."""
    whole, places = loaded()
    others = [edit.mutant for edit in wire_edits(whole, places) if edit.mutant.kind == "another output of the machine"]
    assert [
        ("watch.slow becomes watch.silent", ("wire to slow of door",)),
        ("watch.silent becomes watch.slow", ("wire to silent of door",)),
    ] == [(one.words, one.where) for one in others]


def test_made_again_with_the_right_wires_nothing_has_changed() -> None:
    """In the variables of the first one, values before the step included."""
    with noted() as places:
        whole = listening()
    listened, canon = composed(whole, places, listening), Canon()
    made = rewired(listened, listened.plan.wires)
    now, was = shared(made.system, canon), shared(whole.system, canon)
    assert all(now.next[var] is was.next[var] for var in was.state)
    assert [alike(one.term, other.term) for one, other in zip(made.claims, listened.claims, strict=True)] == [
        True,
        True,
    ]


def test_what_nothing_notices_survives() -> None:
    """Nobody claims that silence is asked for."""
    assert "survived" == found("condition 2 is left out", "opens").everywhere.fate


def test_every_mutant_is_told_once() -> None:
    """Machines and wires, each with its own requirement."""
    whole, places = loaded()
    some = parts(whole, places, most=None, seed=0)
    assert some.of == some.number == len(all_judged()) == len({one.id for one in all_judged()})
    assert {"REQ-1", "REQ-2"} == set(by_requirement(all_judged()))
    assert 10 == len(wire_edits(whole, places))


def test_what_was_judged_is_kept(tmp_path: Path) -> None:
    """A second run takes it from there, and it is the same."""
    whole, places = loaded()
    store, some = Store(tmp_path), parts(whole, places, most=5, seed=1)
    first = JudgingComposed(whole, PLAN, lambda _: None, keep_in=store).all(some)
    heard = list[Judged]()
    again = JudgingComposed(whole, PLAN, heard.append, look_in=store).all(some)
    assert [asdict(one) for one in first] == [asdict(one) for one in again]
    assert sorted(one.id for one in again) == sorted(one.id for one in heard)


def test_an_unknown_mutant_is_refused() -> None:
    """The message says where the ids are."""
    whole, places = loaded()
    with pytest.raises(InputError, match="watched_door has no mutant 'door-0'; --json lists them"):
        parts(whole, places, most=None, seed=0, only=["door-0"])


def test_a_composition_that_was_not_noted_is_refused() -> None:
    """How it is wired must have been seen."""
    with pytest.raises(InputError, match="how its machines are wired is not known"):
        composed(target(), Places())
