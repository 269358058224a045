"""Terms in full: nothing is shortened, parts that occur twice are written once, and before they are used."""

from __future__ import annotations

import re

import pytest

from safeloc.catalogue import load_target
from safeloc.language.expr import between, ite, minimum, number
from safeloc.language.nodes import Expr, Num
from safeloc.language.units import MM
from safeloc.report.exact import Exact, Line, spelled_alone
from safeloc.report.machines import machine_data

A, B = number("a_mm", MM, 0, 100), number("b_mm", MM, 0, 100)


def test_a_part_that_occurs_twice_is_named() -> None:
    """Once written, then a number; short parts and variables stand where they are."""
    gap = minimum(A + B, 50) - minimum(A, B)
    exact = Exact({"one": between(0, gap, 9), "two": gap + A}, {})
    assert exact.lines == (Line("#1", "min((a_mm + b_mm), 50 mm) − min(a_mm, b_mm)"),)
    assert exact.texts == {"one": "(0 mm ≤ #1) and (#1 ≤ 9 mm)", "two": "#1 + a_mm"}


def test_a_definition_is_named_by_the_model() -> None:
    """Its name stands in the terms, however often it occurs."""
    near = (A - B) < 5
    exact = Exact({"pick": ite(near, A, B)}, {"near": near})
    assert exact.lines == (Line("near", "(a_mm − b_mm) < 5 mm"),)
    assert exact.texts == {"pick": "a_mm if near else b_mm"}


def test_an_assumption_is_spelled_out() -> None:
    """With nothing but the model's own names in it, unless that would fill pages."""
    gap = minimum(A + B, 50) - minimum(A, B)
    written = "min((a_mm + b_mm), 50 mm) − min(a_mm, b_mm)"
    texts, lines = spelled_alone([between(0, gap, 9)], {"near": A < 5})
    assert texts == [f"(0 mm ≤ ({written})) and (({written}) ≤ 9 mm)"]
    assert lines == ()
    near = (A - B) < 5
    texts, lines = spelled_alone([near | (A < 3), B < 4], {"near": near, "far": A > 90})
    assert texts == ["near or (a_mm < 3 mm)", "b_mm < 4 mm"]
    assert lines == (Line("near", "(a_mm − b_mm) < 5 mm"),)


def test_parts_of_a_long_assumption_are_letters_that_stand_beside_it() -> None:
    """No number of a list elsewhere; a letter that is a variable's name is left out; each letter is told before its use."""
    a = number("a", MM, 0, 100)
    deep: Num = a
    for _ in range(12):
        deep = minimum(deep + B, deep - B)
    texts, lines = spelled_alone([deep < 3], {})
    assert "#" not in "".join([*texts, *(line.text for line in lines)])
    assert [line.name for line in lines[:2]] == ["b", "c"]
    known = {"a", "b_mm", "mm", "min"}
    for line in lines:
        assert set(re.findall(r"[a-z_]+", line.text)) <= known
        known.add(line.name)
    assert set(re.findall(r"[a-z_]+", texts[0])) <= known


def test_equal_terms_built_twice_are_one() -> None:
    """It does not matter how a model was written."""
    first, second = (minimum(A + B, 50) + 1000 for _ in range(2))
    assert len(Exact({"one": first, "two": second}, {}).lines) == 1


def test_a_term_that_doubles_forty_times_stays_short() -> None:
    """As a line of text it would have a million million characters."""
    term: Num = A
    for _ in range(40):
        term = minimum(term + B, term - B)
    roots: dict[str, Expr] = {"deep": term}
    exact = Exact(roots, {})
    assert sum(len(line.text) for line in exact.lines) < 5_000


@pytest.mark.parametrize("name", ["odometry", "delocalized", "supervised_odometry"])
def test_shipped_machines_are_written_in_full(name: str) -> None:
    """No ellipsis anywhere, and every number is defined before it is used."""
    for part in machine_data(load_target(name))["parts"]:
        known: set[str] = set()
        for line in part["definitions"]:
            assert set(re.findall(r"#\d+", line["text"])) <= known
            known.add(line["name"])
        updates = [row["term"] for row in part["updates"]]
        laws = [term for law in part["clauses"] for term in [*law["terms"], *(one["text"] for one in law["parts"])]]
        assert not any("#" in text for text in laws)
        texts = [*laws, *updates, *(row["guard"] for row in part["table"])]
        texts += [row["term"] for row in part["variables"]]
        assert all(set(re.findall(r"#\d+", text)) <= known for text in texts)
        assert not any("…" in text for text in [*texts, *(line["text"] for line in part["definitions"])])


def test_updates_say_which_transitions_make_them() -> None:
    """Every transition's every update is in exactly one row of its variable."""
    target = load_target("delocalized")
    (part,), (machine,) = machine_data(target)["parts"], target.machines
    for number_, transition in enumerate(machine.transitions, 1):
        for var in transition.set:
            rows = [row for row in part["updates"] if row["variable"] == var.name and number_ in row["transitions"]]
            assert len(rows) == 1
