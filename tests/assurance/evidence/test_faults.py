"""Every clause broken alone and in pairs: what is kept, what is lost, and what becomes of the reported interval."""

from __future__ import annotations

from dataclasses import asdict, replace
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

import pytest

from safeloc.assurance.evidence.cut_sets import CutSets, cut_sets, to_open_psa
from safeloc.assurance.evidence.effects import Effect, Run
from safeloc.assurance.evidence.fault_data import end_in_words
from safeloc.assurance.evidence.fault_work import Breaking, from_data, planned
from safeloc.assurance.evidence.top_event import INTERVAL, top_claims, top_event
from safeloc.assurance.law_ids import ids_of
from safeloc.errors import InputError
from safeloc.language.composition import compose
from safeloc.language.expr import Bool, any_of, boolean, number
from safeloc.language.interpret import run
from safeloc.language.machine import ANY, Machine, Transition, modes
from safeloc.language.nodes import Value
from safeloc.language.spec import always
from safeloc.language.units import MM
from safeloc.language.world import World
from safeloc.proof.cache.store import Store
from safeloc.proof.cores.clauses import ClauseId, assumed_clauses, laws, without
from safeloc.proof.cores.cores import Core
from safeloc.proof.provers.limits import Limits
from safeloc.report.fault_tree import fault_tree
from safeloc.target import Hazard, Target
from tests.assurance.evidence.receivers import target

FIRST, SECOND = (ClauseId("receivers", f"the {name} receiver is right") for name in ("first", "second"))
MEASURED, ENDS, FAST = (
    ClauseId("receivers", name) for name in ("a run is measured", "the line ends", "it is never fast")
)


class Heard:
    """What a run tells of its progress."""

    def __init__(self) -> None:
        self.begun = list[tuple[str, int]]()
        self.results = list[str]()

    def say(self, text: str, planned: int) -> None:
        """What begins."""
        self.begun.append((text, planned))

    def tick(self, line: str) -> None:
        """One more result."""
        self.results.append(line)


def breaking(store: Store | None = None) -> Breaking:
    """With small limits."""
    return Breaking(Limits(seconds=10), 2, Heard(), store, store)


@cache
def cores() -> list[Core]:
    """What the claims of the receivers rest on."""
    return breaking().cores(target())


@cache
def singles() -> dict[ClauseId, Effect]:
    """Each clause of the receivers broken alone."""
    return {one.broken[0]: one for one in breaking().singles(target(), cores())}


def _alone(by: Breaking, whole: Target) -> list[Effect]:
    return by.singles(whole, by.cores(whole))


@pytest.mark.thorough
def test_a_clause_that_is_not_needed_does_no_harm() -> None:
    """Every claim is kept, and the interval holds the truth."""
    assert [*singles()] == [FIRST, SECOND, MEASURED, ENDS, FAST]
    for clause in (FIRST, SECOND, ENDS, FAST):
        one = singles()[clause]
        assert ("contained", {}, (), None) == (one.end, one.lost, one.open_, one.run)
        assert ("containment", "never wider", "nothing") == one.kept


@pytest.mark.thorough
def test_a_wrong_run_is_withdrawn_in_time() -> None:
    """The interval runs on for four cycles after a fix: proved, with the shortest run that ends in a wrong interval."""
    one = singles()[MEASURED]
    assert ("withdrawn", 5, {"containment": 2}) == (one.end, one.within_cycles, one.lost)
    assert ("never wider", "nothing") == one.kept
    assert one.run is not None
    assert (2, "run on") == (one.run.cycles, one.run.fired)
    assert "receivers contradict each other" in one.withdrawn_by


def test_the_shortest_run_is_one_of_the_machine() -> None:
    """It ends with an interval that misses the truth; the other clauses hold in it."""
    found = singles()[MEASURED].run
    assert found is not None
    system = without(target().system, [MEASURED])
    told = run(system, found.inputs, first=found.first).steps[-1]
    place, margin = told.outputs["position_mm"] * 10**6, told.outputs["margin_above_mm"] * 10**6
    assert told.outputs["valid"] and abs(told.state["truth_nm"] - place) > margin


def test_two_receivers_that_are_both_wrong_are_a_cut_set() -> None:
    """Pairs are asked of clauses that alone do no harm; the interval stays wrong as long as both agree."""
    both = {one.broken: one for one in breaking().pairs(target(), cores(), [*singles().values()])}
    assert 6 == len(both)
    wrong = both[FIRST, SECOND]
    assert ("wrong", 1) == (wrong.end, wrong.run.cycles if wrong.run is not None else 0)
    assert {"contained"} == {one.end for pair, one in both.items() if pair != (FIRST, SECOND)}
    found = cut_sets(INTERVAL, [*singles().values(), *both.values()])
    assert (((MEASURED,), (FIRST, SECOND)), ()) == (found.found, found.undecided)


def test_without_an_interval_claims_are_told_alone() -> None:
    """Nothing is said of an interval that nobody reports."""
    one = _alone(breaking(), replace(target(), reported=None))
    assert {"no interval"} == {each.end for each in one}
    assert {"containment": 2} == one[2].lost


def _hazardous() -> Target:
    """The receivers as a machine whose place is no interval, but whose wrong place is a hazard."""
    return replace(target(), reported=None, hazard=Hazard("a wrong place is given", ("contain*",)))


def test_a_hazard_is_the_top_event_of_a_machine_without_an_interval() -> None:
    """A run in which it occurs for the clause that it needs, and a proof that it never does for every other one."""
    whole = _hazardous()
    assert "a wrong place is given" == top_event(whole)
    found = {one.broken[0]: one for one in _alone(breaking(), whole)}
    assert {MEASURED: "hazard"} == {clause: one.end for clause, one in found.items() if one.end != "no hazard"}
    shown = found[MEASURED].run
    assert shown is not None and found[MEASURED].lost["containment"] == shown.cycles
    assert "a wrong place is given; shortest run: 2 cycles, ends with 'run on'" == end_in_words(whole, found[MEASURED])
    assert "proved never: a wrong place is given" == end_in_words(whole, found[FIRST])


@pytest.mark.thorough
def test_pairs_lead_to_a_hazard_too() -> None:
    """Two receivers that are wrong alike give a wrong place."""
    whole = _hazardous()
    by = breaking()
    every = by.cores(whole)
    alone = by.singles(whole, every)
    both = by.pairs(whole, every, alone)
    assert {(FIRST, SECOND)} == {one.broken for one in both if one.end == "hazard"}
    assert {"hazard", "no hazard"} == {one.end for one in both}
    assert "a wrong place is given" == cut_sets(top_event(whole), [*alone, *both]).top


@pytest.mark.thorough
def test_a_hazard_stands_beside_the_interval() -> None:
    """What is wrong of the interval stands first; harmless is only what does no harm to either."""
    narrow = replace(target(), hazard=Hazard("it is wide", ("never wider", "nothing")))
    assert "a reported interval misses the truth, or it is wide" == top_event(narrow)
    ends = {one.broken[0]: one.end for one in _alone(breaking(), narrow)}
    assert ("withdrawn", "contained") == (ends[MEASURED], ends[FIRST])
    kept = end_in_words(narrow, Effect((FIRST,), end="contained"))
    assert kept.endswith("; proved never: it is wide")


def test_what_is_not_decided_may_be_a_hazard() -> None:
    """Neither a proof nor a run was found with hardly any effort."""
    found = _alone(Breaking(Limits(seconds=0.0001), 1, Heard()), _hazardous())
    assert "undecided" in {one.end for one in found}
    assert {"undecided", "no hazard", "hazard"} >= {one.end for one in found}


def test_a_hazard_of_an_unknown_property_is_refused() -> None:
    """The message says which, and what is near."""
    wrong = replace(target(), hazard=Hazard("it is wrong", ("containmnt",)))
    with pytest.raises(
        InputError, match=r"receivers: the hazard names the property 'containmnt'; there is none\..*containment"
    ):
        top_claims(wrong)


@pytest.mark.thorough
def test_what_was_found_is_kept(tmp_path: Path) -> None:
    """A second run takes it from there, and it is the same."""
    store = Store(tmp_path)
    first = _alone(breaking(store), target())
    heard = Heard()
    again = _alone(Breaking(Limits(seconds=10), 1, heard, store, None), target())
    assert first == again
    assert [("proof cores of receivers", len(cores())), ("breaking clauses of receivers", 5)] == heard.begun
    assert planned(target()) == len(heard.results)
    told = {"contained": "the interval stays right", "wrong": "the interval can be wrong", "undecided": "undecided"}
    words = [told.get(one.end, "a wrong interval is withdrawn in time") for one in first]
    shown = [f"without {one.broken[0]}: {word}" for one, word in zip(first, words, strict=True)]
    assert shown == heard.results[-len(first) :]


def test_what_is_not_decided_is_said() -> None:
    """With hardly any effort neither is claimed; it may be a cut set."""
    found = _alone(Breaking(Limits(seconds=0.0001), 1, Heard()), target())
    assert "undecided" in {one.end for one in found}
    assert cut_sets(INTERVAL, found).undecided


def test_effect_and_data_are_each_other() -> None:
    """What is kept is what was found."""
    inputs: tuple[dict[str, Value], ...] = ({"x": 1}, {"x": 2})
    one = Effect((FIRST,), ("a",), {"b": 3}, ("c",), "wrong", 0, Run({"s": True}, inputs, "row"), ("row",))
    assert one == from_data(asdict(one))


# ------------------------------------------------------------------ clauses of a composition


def _pair() -> tuple[Machine, Machine]:
    (on,) = modes("ON")
    made = []
    for name in ("one", "two"):
        truth, next_ = number("truth", MM, 0, 9), number("next", MM, 0, 9)
        world = World({truth: ANY}, [next_], {truth: next_}, {"stays": next_ < 9, "is low": truth < 8})
        made.append(Machine(name, (on,), [], {}, {}, [Transition("stay", on, on)], world=world))
    return made[0], made[1]


def _two_ears() -> Target:
    """Two machines that hear the same thing, each with one law that matters and two that do not: the hazard is that both hear wrongly."""
    (on,) = modes("ON")
    machines, right = list[Machine](), list[Bool]()
    for name in ("one", "two"):
        heard, said, calm = boolean("heard"), boolean("said"), boolean("calm")
        laws = {"it hears rightly": heard.iff(said), "it is calm": calm, "it says little": ~said | calm}
        world = World({}, [said, calm], {}, laws)
        machines.append(Machine(name, (on,), [heard], {}, {}, [Transition("stay", on, on)], world=world))
        right.append(heard.iff(said))
    whole = compose("ears", machines, {})
    claim = always(
        "one of both is right", any_of(whole.of(own)(term) for own, term in zip(machines, right, strict=True))
    )
    hazard = Hazard("both hear wrongly", ("one of both is right",))
    return Target("ears", tuple(machines), whole.system, (claim,), hazard=hazard)


def test_pairs_of_different_machines_are_proved_by_sets() -> None:
    """Nine pairs: the one that does harm is found, and fewer proofs than pairs are asked for the others."""
    heard = Heard()
    by, whole = Breaking(Limits(seconds=10), 2, heard), _two_ears()
    alone = by.singles(whole, by.cores(whole))
    heard.results.clear()
    both = by.pairs(whole, by.cores(whole), alone)
    assert {"no hazard"} == {one.end for one in alone}
    wrong = [one.broken for one in both if one.end == "hazard"]
    assert [(ClauseId("one", "it hears rightly"), ClauseId("two", "it hears rightly"))] == wrong
    assert 9 == len(both)
    assert {"no hazard", "hazard"} == {one.end for one in both}
    sets = [line for line in heard.results if "clauses:" in line]
    assert [line for line in sets if "no harm" in line]
    assert 9 > len([line for line in heard.results if line.startswith("without")])


def test_clauses_of_a_composition_are_those_of_its_machines() -> None:
    """Broken in the whole, and in the machine by itself."""
    both = compose("both", _pair(), {})
    every = assumed_clauses(both.system)
    assert [ClauseId(machine, name) for machine in ("one", "two") for name in ("stays", "is low")] == [*every]
    broken = without(both.system, [ClauseId("two", "stays")])
    assert [*every][:2] + [*every][3:] == [*assumed_clauses(broken)]
    assert broken.parts[0].alone is both.system.parts[0].alone
    assert broken.parts[1].alone.assume is not both.system.parts[1].alone.assume
    assert (
        "both/one/A2" == ids_of(Target("both", _pair(), both.system, (), spec="own.py:both"))[ClauseId("one", "is low")]
    )


def test_a_clause_that_is_not_assumed_is_refused() -> None:
    """The message names the clauses there are."""
    with pytest.raises(KeyError, match="assumes no clause receivers: nothing; it assumes receivers: the first"):
        without(target().system, [ClauseId("receivers", "nothing")])
    assert "supplier" == laws(target().system)[FIRST].owner


# ------------------------------------------------------------------ tables and pictures


def test_the_fault_tree_is_open_psa() -> None:
    """One `or` of events and of `and`s; every event is defined once; what is not decided stands in a comment."""
    sets = CutSets(INTERVAL, ((MEASURED,), (FIRST, SECOND)), ((ENDS,),))
    text = to_open_psa("receivers", sets, ids_of(target()))
    root = ElementTree.fromstring(text.partition("\n")[2])
    gate = root.find("define-fault-tree/define-gate")
    assert gate is not None
    assert ["label", "or"] == [one.tag for one in gate]
    assert ["basic-event", "and"] == [one.tag for one in gate[1]]
    defined = [one.get("name") for one in root.findall("model-data/define-basic-event")]
    assert defined == [one.get("name") for one in gate.iter("basic-event")] == [
        "receivers_A3", "receivers_A1", "receivers_A2",
    ]  # fmt: skip
    assert "not decided: receivers/A4" in text


def test_one_event_needs_no_gate_and_none_is_never_true() -> None:
    """An `or` of one would be no formula of the format."""
    alone = ElementTree.fromstring(
        to_open_psa("receivers", CutSets(INTERVAL, ((MEASURED,),), ()), ids_of(target())).partition("\n")[2]
    )
    assert alone.find("define-fault-tree/define-gate/basic-event") is not None
    none = ElementTree.fromstring(to_open_psa("receivers", CutSets(INTERVAL, (), ()), {}).partition("\n")[2])
    constant = none.find("define-fault-tree/define-gate/constant")
    assert constant is not None and "false" == constant.get("value")


@pytest.mark.parametrize(
    "sets",
    [
        CutSets(INTERVAL, ((MEASURED,), (FIRST, SECOND)), ((ENDS,),)),
        CutSets("a section is reported clear with a vehicle in it", (), ()),
    ],
)
def test_the_picture_names_every_set(sets: CutSets) -> None:
    """In words, the undecided ones marked; it is well-formed."""
    drawn = fault_tree("receivers", sets, ids_of(target()))
    told = "".join(ElementTree.fromstring(drawn).itertext())
    assert "".join(sets.top.split()) in "".join(told.split())
    for one in (*sets.found, *sets.undecided):
        assert " AND ".join(f"{ids_of(target())[clause]} {clause.name}" for clause in one) in told
    assert ("(not decided)" in told) is bool(sets.undecided)
    assert ("no breach of one clause" in told) is not bool(sets.found)
