"""The family of machines that growth is measured with, and what is told of it."""

from __future__ import annotations

import pytest

from benchmarks.bench_growth import Cost, exponent, table
from benchmarks.composed_line import composed_target, machines_of
from benchmarks.counted_line import line_target, sections
from safeloc.language.verdict import word
from safeloc.proof.provers.limits import Limits
from safeloc.proof.verification.one import Plan, Work


@pytest.mark.thorough
def test_the_machine_of_ten_variables_is_all_proved() -> None:
    """Lemmas, properties and obligations are proved and the tests held: what is timed is a whole verification."""
    target = line_target(10)
    findings = Work(target, 2, lambda *_: None, lambda _: None).verified(Plan(Limits(), examples=5, steps=20, seed=0))
    assert 10 == len(target.system.state)
    assert {"lemma", "property", "obligation", "test"} == {one.kind for one in findings}
    assert [] == [one.id for one in findings if word(one.result) not in ("proved", "held")]


@pytest.mark.parametrize("variables", [10, 30, 100, 300, 1000])
def test_sizes_are_as_near_as_can_be(variables: int) -> None:
    """A section has three variables, and the mode is one: modes, transitions and properties stay the same."""
    target = line_target(variables)
    assert 1 + 3 * sections(variables) == len(target.system.state)
    assert abs(len(target.system.state) - variables) <= 1
    assert (3, 7, 4) == (len(target.machines[0].modes), len(target.machines[0].transitions), len(target.properties))
    assert sections(variables) == len(target.machines[0].lemmas)


@pytest.mark.thorough
def test_the_composition_of_ten_variables_is_all_proved() -> None:
    """Lemmas, the contract, properties and obligations are proved and the tests held."""
    target = composed_target(10)
    findings = Work(target, 2, lambda *_: None, lambda _: None).verified(Plan(Limits(), examples=5, steps=20, seed=0))
    assert {"lemma", "property", "obligation", "test"} == {one.kind for one in findings}
    assert [] == [one.id for one in findings if word(one.result) not in ("proved", "held")]


def test_a_section_and_its_contract_are_proved_machine_by_machine() -> None:
    """What its heads tell a section is guaranteed by them, and what it claims is proved of the section by itself."""
    target = composed_target(10)
    found = {
        one.id.removeprefix("composed_line/"): one
        for one in Work(target, 1, lambda *_: None, lambda _: None).proved(target.properties[:1], Limits())
    }
    assert {"proved"} == {word(one.result) for one in found.values()}
    assert "lemma/contract of section_1 holds" in found
    assert "of section_1 by itself" in found["property/section_1: free holds no axle"].method


@pytest.mark.parametrize("variables", [10, 31, 100, 300, 1000])
def test_sizes_of_compositions_are_as_near_as_can_be(variables: int) -> None:
    """A head has three variables, a section four: each machine stays as it is, and what grows is their number."""
    target, count = composed_target(variables), machines_of(variables)
    assert 3 + 7 * count == len(target.system.state)
    assert abs(len(target.system.state) - variables) <= 3
    assert 2 * count + 1 == len(target.machines)
    assert {3, 4} == {len(part.alone.state) for part in target.system.parts}
    assert (count, 4) == (sum(one.kept_by is not None for one in target.properties), len(target.properties) - count)


def test_the_exponent_is_the_power_of_the_size() -> None:
    """Ten times the size in a thousand times the seconds is 3; the table marks what is steep, within a family."""
    assert 3 == pytest.approx(exponent((10, 0.5), (100, 500)))

    def cost(family: str, size: int, seconds: float) -> Cost:
        return Cost(family, size, size, {"properties": seconds}, 5, [], 100.0)

    _, first, second, third, other = table(
        [cost("line", 10, 1), cost("line", 20, 2), cost("line", 40, 16), cost("localizer", 1, 9)]
    )
    assert "^" not in first + other
    assert "^ 1.00 " in second
    assert "^ 3.00!" in third
