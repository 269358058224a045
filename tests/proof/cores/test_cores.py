"""A proof core holds what the proof needs, and nothing that it can do without."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import pytest

from safeloc.assurance.evidence.core_work import as_data, cores_of, from_data, needed_by_none
from safeloc.language.composition import Clause, compose
from safeloc.language.expr import before, number
from safeloc.language.machine import ANY, Machine, Transition, modes
from safeloc.language.spec import always
from safeloc.language.system import lower
from safeloc.language.units import MM
from safeloc.language.world import World
from safeloc.proof.cache.store import Store
from safeloc.proof.cores.cores import Core, core
from safeloc.proof.cores.elements import Element
from safeloc.proof.provers.limits import Limits
from tests.assurance.evidence.receivers import CLAUSES, LOST, MODE, claims, target

LIMITS = Limits(seconds=20)


def of(name: str) -> Core:
    """The core of one claim of the receivers."""
    [prop] = [one for one in claims() if one.name == name]
    return core(target().system, prop, LIMITS)


def names(one: Core, kind: str) -> set[str]:
    """The elements of one kind."""
    return {element.name for element in one.rests_on if element.kind == kind}


def test_containment_needs_the_clauses_that_tie_it_to_the_truth() -> None:
    """One receiver is enough, since the other one has to agree; that the line ends and how fast it runs is not needed."""
    found = of("containment")
    assert "a run is measured" in names(found, "clause")
    assert 1 == len(names(found, "clause") & {"the first receiver is right", "the second receiver is right"})
    assert not names(found, "clause") & {"the line ends", "it is never fast"}
    assert {"fixed", "run on", "too wide", "receivers contradict each other"} == names(found, "row")
    assert (1, (), "") == (found.steps, found.open_, found.why_none)


def test_a_claim_for_all_inputs_needs_no_clause_but_the_rows_that_could_break_it() -> None:
    """The margin is set by each of its rows."""
    found = of("never wider")
    assert not names(found, "clause")
    assert {"fixed", "run on", "too wide", "receivers contradict each other"} == names(found, "row")


def test_a_claim_that_says_nothing_needs_nothing() -> None:
    """It is proved by the empty set."""
    found = of("nothing")
    assert ((), 1) == (found.rests_on, found.steps)


def test_what_a_run_shows_has_no_core() -> None:
    """There is no proof to look into."""
    assert "shown by a run" == of("located").why_none


def test_what_is_not_proved_has_no_core() -> None:
    """The reason is told, no set."""
    wrong = always("never located", MODE.eq(LOST))
    found = core(target().system, wrong, Limits(seconds=5))
    assert ((), "not proved by induction within the limits") == (found.rests_on, found.why_none)


def test_an_invariant_that_a_prover_finds_is_an_element() -> None:
    """Where induction alone does not prove a claim, the invariant that was found stands in the core."""
    (on,) = modes("ON")
    x, y, go = number("x", MM, 0, 100), number("y", MM, 0, 100), number("go", MM, 0, 1)
    rows = [Transition("both", on, on, (x < 50) & (y < 50), {x: x + go, y: y + go})]
    made = Machine("pair", (on,), [go], {x: 0, y: 0}, {"x": x}, rows)
    found = core(lower(made), always("x is no more than 70 where y is no more than 30", (y > 30) | (x <= 30)), LIMITS)
    assert any(one.kind == "lemma" and "invariant" in one.name for one in found.rests_on), found


def test_rows_that_a_claim_looks_back_at_are_asked_too() -> None:
    """The values after a step are the row's: a claim about a change needs the rows that may change it."""
    (on,) = modes("ON")
    x, y, go = number("x", MM, 0, 100), number("y", MM, 0, 100), number("go", MM, 0, 1)
    rows = [
        Transition("x grows", on, on, (go > 0) & (x < 100), {x: x + 1}),
        Transition("y grows", on, on, (go < 1) & (y < 100), {y: y + 1}),
    ]
    made = Machine("pair", (on,), [go], {x: 0, y: 0}, {"x": x}, rows)
    found = core(lower(made), always("x never falls", x >= before(x)), LIMITS)
    assert {"x grows", "y grows"} == names(found, "row")
    growing = always("x grows with go only", (x > before(x)).implies(go > 0))
    assert {"y grows"} == names(core(lower(made), growing, LIMITS), "row")


def test_what_no_claim_needs_is_told(tmp_path: Path) -> None:
    """Clauses and rows, by name; what was found is kept and taken from there."""
    whole, store = target(), Store(tmp_path)
    first = cores_of(whole, claims(), LIMITS, jobs=2, on_core=lambda _: None, look_in=store, keep_in=store)
    unused = {one.name for one in needed_by_none(whole, first)}
    assert {"the line ends", "it is never fast"} < unused < set(CLAUSES)
    heard = list[Core]()
    again = cores_of(whole, claims(), LIMITS, jobs=2, on_core=heard.append, look_in=store, keep_in=store)
    assert first == again == heard
    told = json.loads(json.dumps(as_data(whole, first, complete=True)))
    assert "safeloc-cores/1" == told["schema"]
    assert unused == {one["name"] for one in told["needed_by_none"]}


def test_data_and_core_are_each_other() -> None:
    """What is kept is what was found."""
    one = Core("c", (Element("row", "m", "r"),), 2, "m", (Element("clause", "m", "x"),), "")
    assert one == from_data(json.loads(json.dumps(asdict(one))))


@pytest.mark.parametrize("kept_by_machine", [True, False])
def test_of_a_composition(kept_by_machine: bool) -> None:
    """A machine's own claim is asked on that machine; one of the whole rests on contracts, lemmas and clauses."""
    (on,) = modes("ON")
    heard, said, sum_ = number("heard", MM, 0, 100), number("said", MM, 0, 100), number("sum", MM, 0, 200)
    speaker = Machine(
        "speaker", (on,), [heard], {said: 0}, {"said": said}, [Transition("say", on, on, heard <= 10, {said: heard})],
        lemmas={"it speaks low": said <= 10},
    )  # fmt: skip
    truth = number("truth", MM, 0, 100)
    told = number("told", MM, 0, 100)
    listener = Machine(
        "listener", (on,), [told], {sum_: 0}, {"sum": sum_}, [Transition("take", on, on, set={sum_: told * 2})],
        world=World({truth: ANY}, [], {truth: truth}, {"what is told is low": told <= 10, "truth is low": truth <= 50}),
        lemmas={"twice": sum_ <= 20},
    )  # fmt: skip
    made = compose(
        "both", [speaker, listener], {told: speaker.output("said")}, discharge=[Clause(listener, "what is told is low")]
    )
    own = always("no more than twenty", sum_ <= 20)
    prop = made.inherited(listener, own) if kept_by_machine else always("all low", made.of(listener).bool(sum_ <= 20))
    found = core(made.system, prop, LIMITS)
    assert ("listener" if kept_by_machine else "") == found.kept_by
    assert "" == found.why_none
    kinds = {one.kind for one in found.rests_on}
    assert ({"clause"} <= kinds) if kept_by_machine else (kinds <= {"lemma", "contract", "range"} and kinds)
