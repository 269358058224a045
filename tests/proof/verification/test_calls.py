"""Verification from Python: the calls return what the commands print, and use the cache only if they get one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from safeloc.catalogue import load_target
from safeloc.errors import InputError
from safeloc.language.expr import Bool, number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import always
from safeloc.language.system import lower
from safeloc.language.units import MM_S
from safeloc.language.verdict import word
from safeloc.language.world import World
from safeloc.proof.cache.store import Store
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.obligations import obligations
from safeloc.proof.provers.portfolio import prove
from safeloc.proof.results import Finding
from safeloc.proof.verification.calls import (
    chosen_properties,
    expected_of_proof,
    expected_of_tests,
    prove_target,
    run_property_tests,
    verify_target,
)
from safeloc.proof.verification.one import Plan
from safeloc.target import Target

ASSUMPTION = ["assumption", "assumption lasts", "dead ends"]
PLAN = Plan(Limits(depth=6, seconds=20), examples=4, steps=10, seed=1)


@pytest.fixture(scope="module")
def delocalized() -> Target:
    """A small machine without its recordings."""
    return replace(load_target("delocalized"), streams=())


def ids(findings: list[Finding]) -> list[str]:
    """The ids of findings, in order."""
    return [one.id for one in findings]


def test_all_properties_and_obligations_are_proved(delocalized: Target) -> None:
    """Without `only` every finding is reported during the work; the estimate of their number is not too high."""
    seen: list[Finding] = []
    findings = prove_target(delocalized, limits=PLAN.limits, jobs=1, on_finding=seen.append)
    assert {"proved"} == {word(one.result) for one in findings}
    assert {"property", "obligation"} <= {one.kind for one in findings}
    assert sorted(ids(findings)) == sorted(ids(seen))
    assert len(delocalized.properties) < expected_of_proof(delocalized, None) <= len(findings)


@pytest.mark.thorough
def test_side_by_side_as_one_after_the_other(delocalized: Target) -> None:
    """Properties and obligations in one queue have the results, in the order, that they have in two."""
    apart = [
        *prove(delocalized.system, delocalized.properties, PLAN.limits),
        *obligations(delocalized.system, PLAN.limits, properties=delocalized.properties),
    ]
    together = prove_target(replace(delocalized, witnesses=None), limits=PLAN.limits, jobs=2)
    assert [(one.id, word(one.result)) for one in apart] == [(one.id, word(one.result)) for one in together]


def test_only_the_named_property_is_proved(delocalized: Target) -> None:
    """With the obligations of the assumption alone; an unknown name is refused with the names that exist."""
    name = delocalized.properties[0].name
    findings = prove_target(delocalized, only=[name], jobs=1)
    assert ASSUMPTION == [one.id.split("/")[-1] for one in findings if one.kind == "obligation"]
    assert "obligation" not in {one.kind for one in prove_target(delocalized, only=[], jobs=1)}
    assert [name] == [one.id.split("/")[-1] for one in findings if one.kind == "property"]
    with pytest.raises(InputError, match=r"^delocalized has no property 'none'; it has "):
        chosen_properties(delocalized, ["none"])


SPEED, TRUE_SPEED = number("speed_mm_s", MM_S, 0, 100), number("true_speed_mm_s", MM_S, 0, 100)


def under(laws: dict[str, Bool]) -> Target:
    """A machine that tells its speed, with a claim that is wrong, under laws of the world."""
    (on,) = modes("ON")
    seen = number("seen_mm_s", MM_S, 0, 100)
    world = World({TRUE_SPEED: 0}, (), {TRUE_SPEED: SPEED}, laws)
    stays = Transition("sees", on, on, set={seen: SPEED}, requirements=("REQ-1",))
    made = Machine("seer", (on,), [SPEED], {seen: 0}, {"seen": seen}, [stays], world=world)
    return Target("seer", (made,), lower(made), (always("slow", seen <= 10),))


def test_an_assumption_that_nothing_keeps_is_told_with_one_property() -> None:
    """Of laws that exclude each other a wrong claim follows; so what is asked of one claim alone does not hold either."""
    contradicting = under({"fast": SPEED > 50, "slow": SPEED < 20})
    found = {one.id.split("/", 1)[1]: word(one.result) for one in prove_target(contradicting, only=["slow"], jobs=1)}
    assert "proved" == found["property/slow"]
    assert {"violated"} == {found[f"obligation/{name}"] for name in ASSUMPTION}
    lawful = under({"slow": SPEED < 5})
    assert {"proved"} == {word(one.result) for one in prove_target(lawful, only=["slow"], jobs=1)}


def test_a_store_keeps_what_was_proved(delocalized: Target, tmp_path: Path) -> None:
    """The second call returns the cached findings; `fresh` ignores them."""
    only, store = [delocalized.properties[0].name], Store(tmp_path)
    first = prove_target(delocalized, only=only, jobs=1, store=store)
    again = prove_target(delocalized, only=only, jobs=1, store=store)
    fresh = prove_target(delocalized, only=only, jobs=1, store=store, fresh=True)
    assert ids(first) == ids(again) == ids(fresh)
    assert [False, True, False] == [all(one.kept_since for one in found) for found in (first, again, fresh)]


def test_property_tests_alone(delocalized: Target) -> None:
    """Tests prove nothing: a property that no run violates is held."""
    findings = run_property_tests(delocalized, PLAN, jobs=1)
    assert {"test"} == {one.kind for one in findings}
    assert {"held"} == {word(one.result) for one in findings}
    assert expected_of_tests(delocalized) >= len(findings)


@pytest.mark.thorough
def test_everything_of_a_target(delocalized: Target) -> None:
    """One call makes proofs, obligations and tests."""
    assert {"property", "obligation", "test"} <= {one.kind for one in verify_target(delocalized, PLAN, jobs=1)}
