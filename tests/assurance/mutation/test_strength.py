"""How strongly requirements are shown: by what their own properties notice of wrong rows."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

from safeloc.assurance.mutation.judge_machine_mutant import judged
from safeloc.assurance.mutation.results import Judged
from safeloc.assurance.mutation.strength import STRENGTHS, as_data, as_text, keep_strengths, kept_strengths, strengths
from safeloc.proof.cache.store import Store
from safeloc.target import Target
from tests.assurance.mutation.shop import every, known, loaded

LABELS = {"brakes when too fast": ("REQ-1",), "worn brakes stay on": ("REQ-2",)}


@cache
def all_judged() -> tuple[Judged, ...]:
    """All mutants of the brake."""
    return tuple(judged(known(), one) for one in every())


def labelled(**more: str) -> Target:
    """The brake, whose properties name requirements."""
    target, _, _ = loaded()
    labels = LABELS | {name.replace("_", " "): (id_,) for name, id_ in more.items()}
    return replace(
        target, properties=tuple(replace(one, requirements=labels.get(one.name, ())) for one in target.properties)
    )


def test_a_label_that_shows_nothing() -> None:
    """Where no property of the requirement notices a wrong row of it, it is not shown, whatever else notices."""
    none = replace(labelled(), properties=tuple(replace(one, requirements=()) for one in labelled().properties))
    without = strengths(none, all_judged(), len(all_judged()))["REQ-1"]
    assert (0, False, {}) == (without.by_its_own, without.is_shown, without.alone)
    assert without.by_proof > 0
    assert "NOT SHOWN: none of its properties notices a wrong rule of it" == as_text([without])[-1]


def test_only_its_own_rows_and_properties_count() -> None:
    """Counted once more by hand: wrong rows of the requirement that its one property was seen to notice."""
    one = strengths(labelled(), all_judged(), len(all_judged()))["REQ-2"]
    rows = [each.everywhere for each in all_judged() if "REQ-2" in each.requirements]
    assert sum("property worn brakes stay on" in each.by for each in rows) == one.by_its_own


def test_a_property_that_notices() -> None:
    """With the property that has a figure of its own, wrong rules are noticed; what others notice besides is told apart."""
    target = labelled(brakes_when_surely_too_fast="REQ-1")
    one = strengths(target, all_judged(), len(all_judged()))["REQ-1"]
    assert one.is_shown
    assert 0 < one.by_its_own < one.by_proof < one.wrong
    assert "NOT SHOWN" not in "\n".join(as_text([one]))
    assert [True] == [row["shown"] for row in as_data([one])]


def test_what_was_never_asked() -> None:
    """Nothing kept is told as such, and not as not shown."""
    assert [
        "not measured: no run of `safeloc mutate` on the present state of the machines that implement it"
    ] == as_text([])


def test_the_greater_sample_is_kept(tmp_path: Path) -> None:
    """A smaller one does not replace it; another target knows nothing of it."""
    store, whole = Store(tmp_path), len(all_judged())
    assert {} == kept_strengths(store, labelled())
    stamps = [STRENGTHS.stamp(store)]
    for few in (20, whole, 10):
        keep_strengths(store, labelled(), all_judged()[:few], whole)
        stamps.append(STRENGTHS.stamp(store))
    assert ["", stamps[2]] == [stamps[0], stamps[3]] and 3 == len(set(stamps))
    assert strengths(labelled(), all_judged(), whole) == kept_strengths(store, labelled())
    assert {} == kept_strengths(store, labelled(brakes_when_surely_too_fast="REQ-1"))
    assert "(a sample of 20 of 30)" in str(replace(kept_strengths(store, labelled())["REQ-1"], judged=20, of=30))
