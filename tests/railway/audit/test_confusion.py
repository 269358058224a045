"""By how many missed or misread reflectors one sequence looks like another."""

from __future__ import annotations

from itertools import combinations, product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.railway.audit.confusion import Sighting, common_suffix, faults_towards


def seen(models: str, distance_mm: int = 100_000) -> list[Sighting]:
    """Reflectors of these models, evenly spaced, each with an identity of its own."""
    return [Sighting(model, distance_mm * index, f"{models}{index}") for index, model in enumerate(models)]


def by_models(truth: str, believed: str) -> int | None:
    """Faults by the models alone."""
    return faults_towards(seen(truth), seen(believed), None, True)


def test_the_sequences_of_figure_3() -> None:
    """One miss makes ADCD look like ACD or like its suffix DCD; one misreading makes ADAB look like ADAD (l. 284)."""
    assert [1, 1, 1, 1, 1] == [
        by_models(*pair.split()) for pair in ("ADCD ACD", "ADCD DCD", "ADAB ADAD", "ADAD ADCD", "ACD DCD")
    ]
    assert [None, None] == [by_models("ACD", "ADCD"), by_models("DCD", "ADCD")]


def test_suffixes() -> None:
    """Who joins at the end of a route sees what the routes share there."""
    assert [3, 1, 0, 2] == [
        common_suffix(seen(one), seen(other))
        for one, other in (("ADCD", "DCD"), ("ADAD", "ACD"), ("ADAB", "ADAD"), ("ACD", "DCD"))
    ]


def brute_force(truth: str, believed: str) -> int | None:
    """Every choice of reflectors that are read at all; the rest are missed, unlike ones misread."""
    kept = [combination for combination in combinations(truth, len(believed))]
    costs = [sum(a != b for a, b in zip(one, believed, strict=True)) + len(truth) - len(believed) for one in kept]
    return min(costs, default=None)


@given(st.text("ABC", max_size=6), st.text("ABC", max_size=6))
def test_faults_are_the_fewest(truth: str, believed: str) -> None:
    """No way of missing and misreading reflectors takes fewer."""
    assert brute_force(truth, believed) == by_models(truth, believed)


@given(st.text("AB", max_size=5), st.lists(st.booleans(), min_size=5, max_size=5))
def test_what_is_shared_costs_nothing(models: str, shared: list[bool]) -> None:
    """Common beginnings and ends, left out for speed, change nothing."""
    truth = seen(models)
    believed = [one for one, keep in zip(truth, shared, strict=False) if keep]
    assert len(truth) - len(believed) == faults_towards(truth, believed, None, True)


@pytest.mark.parametrize(("off", "expected"), [(500, 0), (501, None), (-500, 0), (-501, None)])
def test_places_are_looked_at(off: int, expected: int | None) -> None:
    """Equal models at places farther apart than the gate are not taken for each other."""
    truth, believed = [Sighting("A", 1_000, "a")], [Sighting("A", 1_000 + off, "b")]
    assert expected == faults_towards(truth, believed, 500, True)


@pytest.mark.parametrize(("off", "expected"), [(700, 0), (701, None), (-700, 0), (-701, None)])
def test_a_sighting_that_is_placed_less_accurately_has_a_wider_gate(off: int, expected: int | None) -> None:
    """A balise adds what it errs more than a reflector, with and without a common start."""
    truth, believed = ([Sighting("balise 1", place, "1", True, 200)] for place in (1_000, 1_000 + off))
    assert expected == faults_towards(truth, believed, 500, True)
    before = Sighting("A", 0, "a")
    assert expected == faults_towards([before, *truth], [before, *believed], 500, False)


def test_places_tell_what_models_do_not() -> None:
    """ADCD with its D missed is ACD, but C stands elsewhere."""
    truth = [Sighting(m, p, m + str(p)) for m, p in (("A", 160), ("D", 360), ("C", 540), ("D", 900))]
    believed = [Sighting(m, p, m + str(p)) for m, p in (("A", 160), ("C", 380), ("D", 900))]
    assert 1 == faults_towards(truth, believed, None, True)
    assert 2 == faults_towards(truth, believed, 60, True)
    assert None is faults_towards(truth, believed, 10, True)


def test_another_start_shifts_the_places() -> None:
    """Without a common start the first sighting of the believed route may be any of the true one."""
    truth, believed = seen("ABCD"), seen("CD")
    assert 4 == faults_towards(truth, believed, 500, True)
    assert 2 == faults_towards(truth, believed, 500, False)
    assert 4 == faults_towards(truth, [], 500, False)
    assert None is faults_towards([], believed, 500, False)


def test_balises_are_missed_but_not_misread() -> None:
    """An identity is read or not read (its telegram is checked)."""
    one, other = Sighting("balise 1", 0, "1", True), Sighting("balise 2", 0, "2", True)
    assert None is faults_towards([one], [other], 500, True)
    assert None is faults_towards([one], [Sighting("A", 0, "a")], 500, True)
    assert 1 == faults_towards([one, *seen("A")], seen("A"), 500, True)


def test_sequences_of_all_models_up_to_three() -> None:
    """Equal sequences are confused at once, and only they."""
    every = ["".join(models) for length in range(4) for models in product("AB", repeat=length)]
    for one, other in product(every, every):
        assert (by_models(one, other) == 0) == (one == other)
