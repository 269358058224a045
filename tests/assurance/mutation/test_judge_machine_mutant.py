"""What becomes of mutants: what notices them, what does the same, and what is left as a question."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from safeloc.assurance.mutation.claims import Canon, held
from safeloc.assurance.mutation.declared import declared, remade
from safeloc.assurance.mutation.induction import as_it_is, no_longer
from safeloc.assurance.mutation.judge_machine_mutant import bench, judged, unproved
from safeloc.assurance.mutation.mutants import sample
from safeloc.assurance.mutation.places import noted
from safeloc.assurance.mutation.playing import played, tells_otherwise
from safeloc.assurance.mutation.results import Judged, Outcome, as_data, by_requirement, from_data, kills_alone, score
from safeloc.assurance.mutation.table import lines
from safeloc.assurance.mutation.work import Judging, Plan
from safeloc.language.expr import ite
from safeloc.proof.cache.store import Store
from safeloc.proof.provers.limits import Limits
from tests.assurance.mutation import gate
from tests.assurance.mutation.shop import every, known, loaded, mutant, outcome

PLAN = Plan(Limits(seconds=2), 0, 2)


def _quietly(_: Judged) -> None:
    """Nobody hears of it."""


def test_kinds_of_claims() -> None:
    """Every kind occurs; that rows exclude each other is no claim of a layer, but asked apart."""
    with noted():
        _, whole = declared("axle_head")
    found = held(whole, Canon())
    assert {"property", "lemma", "range", "helper"} == {claim.kind for layer in found.layers for claim in layer.claims}
    assert found.exclusions


def test_a_claim_with_the_machines_term_proves_itself() -> None:
    """A wrong term that the claim shares survives everywhere; with the machine alone wrong the claim notices."""
    one = outcome("bound off by one unit", "one unit less", "'brakes'")
    assert ("survived", "refuted by bounded search") == (one.everywhere.fate, one.alone.fate)
    assert ("property brakes when too fast",) == one.alone.by
    assert one.proves_itself


def test_a_figure_of_its_own_notices() -> None:
    """Dropping the limit altogether breaks the claim that has a figure of its own, also where the other is wrong as well."""
    one = outcome("comparison turned", "< becomes >", "'brakes'")
    assert "refuted by a run" == one.everywhere.fate
    assert ("property brakes when surely too fast",) == one.everywhere.by
    assert not one.proves_itself


def test_refused_at_birth() -> None:
    """A comparison that never changes is refused when the machine is declared."""
    one = outcome("bound off by one unit", "<= becomes <")
    assert "refused at birth" == one.everywhere.fate
    assert "in its guard never changes: brakings lies between 0 and 3." in one.everywhere.how


def test_a_variable_that_is_never_read() -> None:
    """Writing it otherwise is the same machine, proved by two copies side by side."""
    one = outcome("update skipped", "spare keeps its value")
    assert ("equivalent", "the same outputs on every run under the assumption, by two copies side by side") == (
        one.everywhere.fate,
        one.everywhere.how,
    )


def test_something_never_happens() -> None:
    """A row that is never enabled is noticed: that it fires is an obligation."""
    one = outcome("condition dropped", "never enabled", "'releases'")
    assert ("something never happens", ("row 'releases' fires",)) == (one.everywhere.fate, one.everywhere.by)


def test_a_survivor_says_what_is_otherwise() -> None:
    """No claim speaks of the number of brakings: the mutant survives, and a run shows the other output."""
    one = outcome("update skipped", "brakings keeps its value")
    assert "survived" == one.everywhere.fate
    assert "brakings 0 instead of 1" in one.everywhere.how


def test_a_range_is_a_claim() -> None:
    """A counter that may leave its range is noticed by the range alone."""
    one = outcome("min for max", "min becomes max")
    assert "range brakings" in one.everywhere.by


def test_every_mutant_comes_to_one_end() -> None:
    """The score counts each once; what is not equivalent and not killed by a proof is a question."""
    all_ = [judged(known(), one) for one in every()]
    told = score([one.everywhere for one in all_])
    assert len(all_) == sum(told.fates.values()) == told.mutants
    assert 0 < told.by_property <= told.killed_by_proof < told.mutants
    assert {"REQ-1", "REQ-2"} == set(by_requirement(all_))
    assert set(kills_alone(all_)) >= {"range brakings"}
    text = "\n".join(lines("brake", all_, of=len(all_), machine_only=False))
    assert (
        "PROVES ITSELF: with the machine alone wrong refuted by bounded search (property brakes when too fast)" in text
    )
    assert "written: self.speed > LIMIT_MM_S" in text
    assert "PROVES ITSELF" not in "\n".join(lines("brake", all_, of=len(all_), machine_only=True))


def test_a_score_without_mutants() -> None:
    """Nothing that could be killed is nothing that was missed."""
    assert 1.0 == score([Outcome("equivalent")]).share


def test_the_machine_as_it_is_breaks_nothing() -> None:
    """Run along its own runs, the machine breaks no claim and tells nothing else."""
    _, whole, _ = loaded()
    same = played(held(whole, known().canon), known().known)
    assert ((), "", "") == (same.broken, same.differs, same.other)
    assert {("row", 1), ("row", 2), ("mode", 1)} <= same.seen


def test_another_canon_is_another_machine() -> None:
    """What is not seen to be the same is run, and comes out the same."""
    _, whole, _ = loaded()
    same = played(held(whole, Canon()), known().known)
    assert ((), "", "") == (same.broken, same.differs, same.other)


def test_kept_results(tmp_path: Path) -> None:
    """What was judged once is not judged again; another plan is another question."""
    target, whole, _ = loaded()
    few, store, heard = sample(every(), 4, 1), Store(tmp_path), list[str]()
    first = Judging(target, whole, PLAN, lambda one: heard.append(one.id), keep_in=store).of_machine(few)
    assert sorted(one.id for one in few) == sorted(heard)
    none = replace(whole, properties=())  # with it nothing could be proved: it is not looked at
    again = Judging(target, none, PLAN, _quietly, look_in=store).of_machine(few)
    assert first == again
    other = replace(PLAN, seed=1)
    assert len(few) == len(Judging(target, whole, other, _quietly, look_in=store).of_machine(few))


def test_results_come_back_from_json() -> None:
    """The data of a result is read back as it was."""
    one = outcome("update skipped", "spare keeps its value")
    data = as_data("brake", [one], of=1, seed=0, seconds=1.0)
    assert "safeloc-mutation/1" == data["schema"]
    assert {"mutants": 1, "judged": 1} == {name: data[name] for name in ("mutants", "judged")}
    listed = {name: list(value) if isinstance(value, tuple) else value for name, value in data["results"][0].items()}
    assert one == from_data(listed)


def test_a_recording_that_comes_out_otherwise(tmp_path: Path) -> None:
    """What no claim speaks of may still show in a recording."""
    target, whole, _ = loaded()
    recording = tmp_path / "braked.jsonl"
    recording.write_text('{"speed_mm_s": 90, "released": true}\n', encoding="utf-8")
    recorded = bench(replace(target, streams=(recording,)), whole, Limits(seconds=2), 0)
    seen = judged(recorded, mutant("figure replaced by zero", "1 becomes 0"))
    assert ("a recording comes out otherwise", ()) == (seen.everywhere.fate, seen.everywhere.by)
    assert "braked, step 1: brakings 0 instead of 1" == seen.everywhere.how


def test_claims_for_all_inputs_are_searched_for_all_inputs() -> None:
    """A range on board and a claim without the assumption are searched together, also where only a fast vehicle breaks the range."""
    _, whole = declared("tests.assurance.mutation.gate:machine")
    canon, limits, of = Canon(), Limits(seconds=2), gate.latest()
    opens, shuts, counts = whole.machine.transitions
    fast = replace(counts, set={of.ran: ite(of.speed > gate.FASTEST_MM_S, of.noise, 2)})
    wrong = [replace(opens, when=of.opened), fast, shuts]
    _, known = as_it_is(whole, canon, limits)
    mutant_ = held(replace(whole, machine=remade(whole.machine, transitions=wrong)), canon)
    failed = no_longer(mutant_, known, canon, limits)
    assert {"range ran", "property opens for slow ones"} <= set(map(str, failed.claims))
    noticed, run = unproved(mutant_, failed, limits)
    assert "refuted by bounded search" == noticed.fate
    assert {"range ran", "property opens for slow ones"} <= set(noticed.by)
    assert run is not None
    assert not tells_otherwise(held(whole, canon), held(whole, canon), run)


def test_unknown_mutants_have_no_place() -> None:
    """A kind and words that no mutant has are a mistake of the test itself."""
    with pytest.raises(ValueError, match="not enough values"):
        mutant("no such kind", "at all")


@pytest.mark.parametrize(
    ("everywhere", "alone", "expected"),
    [
        ("survived", "refuted by a run", True),
        ("a recording comes out otherwise", "no longer proved", True),
        ("a recording comes out otherwise", "a recording comes out otherwise", False),
        ("refuted by a run", "refuted by a run", False),
        ("survived", "equivalent", False),
    ],
)
def test_what_proves_itself(everywhere: str, alone: str, expected: bool) -> None:
    """No proof notices the term wrong everywhere, and one kills the machine alone wrong; a recording is no proof."""
    one = outcome("update skipped", "spare keeps its value")
    assert expected == replace(one, everywhere=Outcome(everywhere), alone=Outcome(alone)).proves_itself
