"""Wrong worlds and weaker claims: which there are, which way each went, and what becomes of it."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from safeloc.assurance.mutation.choosing import by_id, chosen, judge
from safeloc.assurance.mutation.claims import Canon
from safeloc.assurance.mutation.declared import Declared, declared
from safeloc.assurance.mutation.places import Places, noted
from safeloc.assurance.mutation.results import Judged, Of, as_data, score
from safeloc.assurance.mutation.table import lines
from safeloc.assurance.mutation.weaker import Relation, relation
from safeloc.assurance.mutation.work import Judging, Plan
from safeloc.errors import InputError
from safeloc.language.expr import Bool, boolean, number
from safeloc.language.spec import Property, always, once, previous, reachable, since, within
from safeloc.language.units import MM
from safeloc.proof.cache.store import Store
from safeloc.proof.provers.limits import Limits
from safeloc.target import Target

SPEC = "tests.assurance.mutation.gate:machine"
PLAN = Plan(Limits(seconds=2), 0, 2)
PARTS: tuple[Of, ...] = ("machine", "world", "claims")
A, B = number("a", MM, 0, 99), boolean("b")


@cache
def loaded() -> tuple[Target, Declared, Places]:
    """The gate, its declaration, and where its terms are written."""
    with noted() as places:
        target, whole = declared(SPEC)
    return target, whole, places


@cache
def all_judged() -> tuple[Judged, ...]:
    """All mutants of machine, world and claims of the gate."""
    target, whole, places = loaded()
    some = chosen(whole, places, PARTS, most=None, seed=0)
    return tuple(judge(Judging(target, whole, PLAN, lambda _: None), some))


def found(of: Of, where: str, becomes: str, term: str = "") -> Judged:
    """The one mutant of this part, in this clause or claim."""
    [one] = [
        one for one in all_judged()
        if one.of == of and where in one.where[0] and one.becomes == becomes and term in one.term
    ]  # fmt: skip
    return one


# ------------------------------------------------------------------ clauses


@pytest.mark.thorough
def test_a_clause_that_a_claim_needs() -> None:
    """A world that allows more loses the claim."""
    one = found("world", "nobody is fast", "true_speed_mm_s ≤ (80 mm/s + 1 mm/s)")
    assert ("weaker", "refuted by bounded search") == (one.direction, one.alone.fate)
    assert ("property stays open",) == one.alone.by


@pytest.mark.thorough
def test_a_clause_that_asks_for_too_much() -> None:
    """Left out altogether, or weaker by one, every claim is proved all the same."""
    for becomes in ("true", "noise ≤ 5 count"):
        one = found("world", "there is little noise", becomes)
        assert ("weaker", "asks for more than the claims need") == (one.direction, one.alone.fate)


@pytest.mark.thorough
def test_a_clause_that_excludes_what_nobody_saw() -> None:
    """A world that allows less keeps all claims; without a recording nothing says that it is wrong."""
    one = found("world", "nobody is fast", "true_speed_mm_s < 80 mm/s")
    assert ("stronger", "excludes nothing that was recorded") == (one.direction, one.alone.fate)


def test_a_clause_that_excludes_a_recording(tmp_path: Path) -> None:
    """The recording goes as far as the clause allows: the stronger one is noticed, by file and step."""
    target, whole, places = loaded()
    recording = tmp_path / "gate-fast.jsonl"
    rows = ({"speed_mm_s": speed, "noise": 0, "opened": True, "true_speed_mm_s": speed} for speed in (10, 80))
    recording.write_text("".join(f"{json.dumps(row)}\n" for row in rows), encoding="utf-8")
    [id_] = [found("world", "nobody is fast", "true_speed_mm_s < 80 mm/s").id]
    some = by_id(whole, places, [id_], most=None, seed=0)
    [one] = judge(Judging(replace(target, streams=(recording,)), whole, PLAN, lambda _: None), some)
    assert ("a recording is not lawful any more", "gate-fast, step 2") == (one.alone.fate, one.alone.how)


def test_clauses_that_contradict_each_other() -> None:
    """In a world in which no step is lawful everything would be proved."""
    one = found("world", "there is little noise", "noise < 0 count")
    assert ("stronger", "something never happens", ("no step is lawful",)) == (
        one.direction, one.alone.fate, one.alone.by,
    )  # fmt: skip


def test_what_never_happened_anyway_is_not_told() -> None:
    """That row `shuts` never fires in this world is no matter of the mutant."""
    assert not [one for one in all_judged() if one.of == "world" and "row 'shuts' fires" in one.alone.by]


# ------------------------------------------------------------------ claims


def test_a_claim_that_is_missed() -> None:
    """Left out, or with another figure, a wrong machine is noticed by nobody: it is told which."""
    for becomes in ("", "speed_mm_s ≤ 51 mm/s", "not asked in OPEN"):
        one = found("claims", "opens for slow ones", becomes)
        assert ("weaker", "kills less") == (one.direction, one.alone.fate)
        [missed] = one.alone.by
        assert missed in {other.id for other in all_judged() if other.of == "machine"}


def test_a_weaker_claim_that_kills_as_much() -> None:
    """Nothing that is wrong comes out one step too late, so two steps would do."""
    one = found("claims", "counts", "within 2 steps")
    assert ("weaker", "kills as much") == (one.direction, one.alone.fate)
    assert " mutants of the machine are noticed by it alone" in one.alone.how


def test_what_is_not_weaker_is_set_aside() -> None:
    """A stronger or another claim is no question, and counts nowhere."""
    claims = [one for one in all_judged() if one.of == "claims"]
    told = score([one.alone for one in claims])
    aside = [one for one in claims if one.alone.fate in ("not weaker", "equivalent")]
    assert {"stronger", "other", "same"} == {one.direction for one in aside}
    assert len(aside) == told.set_aside > 0
    assert told.asked + told.set_aside == told.mutants == len(claims)
    assert 0 < told.killed_by_proof < told.asked


def test_each_part_has_a_score() -> None:
    """As lines and as data, machine, world and claims apart."""
    data = as_data("gate", all_judged(), of=len(all_judged()), seed=0, seconds=1.0)
    told = Counter(one.of for one in all_judged())
    assert [told["machine"], told["world"], told["claims"]] == [
        data[part]["mutants"] for part in ("everywhere", "world", "claims")
    ]
    text = "\n".join(lines("gate", all_judged(), of=len(all_judged()), machine_only=False))
    assert "a clause of the world wrong: " in text and "a weaker claim in its place: " in text
    assert "asks for more than the claims need (all claims are proved in the weaker world)" in text


def test_kept_claims_are_kept_for_these_mutants(tmp_path: Path) -> None:
    """Weighed against other mutants of the machine, a weaker claim is another question."""
    target, whole, places = loaded()
    store, heard = Store(tmp_path), list[str]()
    [id_] = [found("claims", "counts", "within 2 steps").id]
    for most in (3, 3, 5):
        judging = Judging(target, whole, PLAN, lambda one: heard.append(one.alone.how), store, store)
        judge(judging, by_id(whole, places, [id_], most=most, seed=0))
    assert [" 3 mutants" in how or " of 3 " in how for how in heard if "noticed by it alone" in how] == [
        True,
        True,
        False,
    ]


def test_an_unknown_mutant_is_refused() -> None:
    """The message says where the ids are listed."""
    _, whole, places = loaded()
    with pytest.raises(InputError, match="gate has no mutant 'gate-0'; --json lists them"):
        by_id(whole, places, ["gate-0"], most=None, seed=0)


# ------------------------------------------------------------------ which claim is weaker


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (A < 5, A < 6, "weaker"),
        (A < 6, A < 5, "stronger"),
        (A < 5, A <= 4, "same"),
        (A < 5, A > 3, "other"),
        (once(A < 5), once(A < 6), "weaker"),
        (~once(A < 5), ~once(A < 6), "stronger"),
        (since(A < 5, B), since(A < 6, B), "weaker"),
        (since(A < 5, B), since(A < 5, B | (A > 9)), "weaker"),
        (since(A < 6, B), since(A < 5, B | (A > 9)), "other"),
        (once(previous(A < 5)), once(previous(A < 6)), "weaker"),
        (once(A < 5), previous(A < 6), "other"),
    ],
)
def test_which_claim_is_weaker(old: Bool, new: Bool, expected: Relation) -> None:
    """Of terms, whatever the machine does; what follows in each step follows of the past."""
    assert expected == _relation(always("p", old), always("p", new))
    assert expected == _relation(reachable("p", old), reachable("p", new))


@pytest.mark.parametrize(
    ("new", "expected"),
    [
        (within("p", 2, B, A < 5), "weaker"),
        (within("p", 0, B, A < 5), "stronger"),
        (within("p", 1, B & (A > 1), A < 5), "weaker"),
        (within("p", 1, B, A < 6), "weaker"),
        (within("p", 2, B, A < 4), "other"),
        (within("p", 1, B, A < 5, further_assumption=B), "weaker"),
    ],
)
def test_which_answer_is_weaker(new: Property, expected: Relation) -> None:
    """Later, to fewer triggers, a weaker one, or under a further assumption."""
    assert expected == _relation(within("p", 1, B, A < 5), new)


def _relation(old: Property, new: Property) -> Relation:
    return relation(old, new, Canon(), 2.0)
