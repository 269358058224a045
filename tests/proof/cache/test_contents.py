"""The digest of a target: the same for the same, another for everything that a finding may depend on."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from safeloc.catalogue import ENTRIES, load_target
from safeloc.language.expr import number
from safeloc.language.machine import ANY, Machine, Transition, modes
from safeloc.language.nodes import Lit
from safeloc.language.spec import Property, always, within
from safeloc.language.system import lower
from safeloc.language.units import COUNT
from safeloc.proof.cache.contents import content_digest, target_digest
from safeloc.reported import Reported
from safeloc.target import Target
from tests.declaring import declared

SLOW, FAST = modes("SLOW", "FAST")
X, N, START = number("x", COUNT, 0, 100), number("n", COUNT, 0, 100), number("start", COUNT, 0, 9)


def machine(**changed: object) -> Machine:
    """A machine with something of every kind."""
    rows = [Transition("go", SLOW, FAST, X > 40, {N: X}), Transition("rest", FAST, SLOW, X < N, requirements=("R-1",))]
    given: dict[str, object] = {
        "inputs": [X],
        "state": {N: 0},
        "outputs": {"told": N},
        "transitions": rows,
        "ghosts": {START: ANY},
        "moves": {START: START},
        "clauses": {"low": X < 90},
        "initially": START > 2,
        "lemmas": {"small": N <= 100},
    }
    return declared(name="kept", modes=(SLOW, FAST), **{**given, **changed})


def asked(made: Machine) -> tuple[Property, ...]:
    """An `always` and a `within`, the second with a helper."""
    return (
        always("small", N <= 100, statement="n stays small"),
        within("rests", 5, made.mode.eq(FAST), made.mode.eq(SLOW), helper=lambda waiting: waiting <= 5),
    )


def target(made: Machine | None = None, **changed: object) -> Target:
    """A target with all that may be declared of one."""
    made = machine() if made is None else made
    given: dict[str, object] = {"properties": asked(made), "reported": Reported()}
    return Target(made.name, (made,), lower(made), **{**given, **changed})  # type: ignore[arg-type]


CHANGES: dict[str, Callable[[], Target]] = {
    "guard": lambda: target(
        machine(transitions=[Transition("go", SLOW, FAST, X > 41, {N: X}), *machine().transitions[1:]])
    ),
    "update": lambda: target(
        machine(transitions=[Transition("go", SLOW, FAST, X > 40, {N: 7}), *machine().transitions[1:]])
    ),
    "name": lambda: target(
        machine(transitions=[Transition("goes", SLOW, FAST, X > 40, {N: X}), *machine().transitions[1:]])
    ),
    "rank": lambda: target(
        machine(transitions=[Transition("go", SLOW, FAST, X > 40, {N: X}, rank=1), *machine().transitions[1:]])
    ),
    "requirement": lambda: target(
        machine(transitions=[machine().transitions[0], replace(machine().transitions[1], requirements=("R-2",))])
    ),
    "first value": lambda: target(machine(state={N: 1})),
    "output": lambda: target(machine(outputs={"told": N + 1})),
    "assumption": lambda: target(machine(clauses={"low": X <= 90})),
    "initially": lambda: target(machine(initially=START > 3)),
    "ghost": lambda: target(machine(ghosts={START: 4})),
    "lemma": lambda: target(machine(lemmas={"small": N <= 99})),
    "lemma's name": lambda: target(machine(lemmas={"little": N <= 100})),
    "range of an input": lambda: target(
        machine(inputs=[X, number("y", COUNT, 0, 1)]),
    ),
    "property": lambda: target(properties=(always("small", N <= 99, statement="n stays small"), *asked(machine())[1:])),
    "statement": lambda: target(properties=(always("small", N <= 100, statement="n is small"), *asked(machine())[1:])),
    "no property": lambda: target(properties=()),
    "order": lambda: target(properties=asked(machine())[::-1]),
    "steps": lambda: target(properties=(asked(machine())[0], replace(asked(machine())[1], steps=6))),
    "helper": lambda: target(
        properties=(asked(machine())[0], replace(asked(machine())[1], helper=lambda waiting: waiting <= 4))
    ),
    "further assumption": lambda: target(
        properties=(replace(asked(machine())[0], further_assumption=X < 50), asked(machine())[1])
    ),
    "unconditional": lambda: target(properties=(replace(asked(machine())[0], unconditional=True), asked(machine())[1])),
    "reported": lambda: target(reported=None),
    "truth": lambda: target(reported=Reported(truth="elsewhere_nm")),
    "said": lambda: target(input_of_record={"speed": "x"}),
    "given figures": lambda: target(given={"limit": 5}),
}


def test_the_same_has_the_same_digest() -> None:
    """Declared twice, wherever that stands in a file."""
    assert target_digest(target()) == target_digest(target())


@pytest.mark.parametrize("name", CHANGES)
def test_what_findings_depend_on_changes_the_digest(name: str) -> None:
    """One thing at a time."""
    assert target_digest(target()) != target_digest(CHANGES[name]())


def test_changes_differ_from_each_other() -> None:
    """None of them is taken for another."""
    assert len(CHANGES) == len({target_digest(make()) for make in CHANGES.values()})


def test_a_recording_counts_by_name_and_content(tmp_path: Path) -> None:
    """Each byte of it; not the folder that it stands in."""
    first, second = tmp_path / "one.jsonl", tmp_path / "two.jsonl"
    first.write_text('{"x": 1}\n')
    second.write_text('{"x": 1}\n')
    (tmp_path / "else").mkdir()
    moved = tmp_path / "else" / "one.jsonl"
    moved.write_bytes(first.read_bytes())
    with_first = target_digest(target(streams=(first,)))
    assert len({with_first, target_digest(target(streams=(first,), witnesses=first))}) == 2
    shipped = {target_digest(target(witnesses=path)) for path in (None, first, second)}
    assert len(shipped) == 3
    assert with_first == target_digest(target(streams=(moved,)))
    assert with_first != target_digest(target(streams=(second,)))
    moved.write_text('{"x": 2}\n')
    assert with_first != target_digest(target(streams=(moved,)))


def test_what_cannot_be_told_is_refused() -> None:
    """Rather than left out."""
    with pytest.raises(TypeError, match="cannot enter a digest"):
        target_digest(target(input_of_record={"speed": object()}))
    with pytest.raises(TypeError, match="has no order"):
        target_digest(target(input_of_record={"speed": frozenset([1, 2])}))


@pytest.mark.thorough
def test_shipped_machines_have_digests_of_their_own() -> None:
    """Loaded twice the same; none that of another."""
    digests = {name: target_digest(load_target(name)) for name in ENTRIES}
    assert len(ENTRIES) == len(set(digests.values()))
    assert digests["localizer"] == target_digest(load_target("localizer"))


def test_the_digest_is_the_same_in_another_process() -> None:
    """Whatever the order of sets is there."""
    code = (
        "from safeloc.catalogue import load_target; from safeloc.proof.cache.contents import content_digest, target_digest;"
        "print(target_digest(load_target('localizer_sections')))"
    )
    ran = [
        subprocess.run(
            [sys.executable, "-c", code], env={"PYTHONHASHSEED": seed}, capture_output=True, text=True, check=True
        )
        for seed in ("1", "2")
    ]
    assert ran[0].stdout == ran[1].stdout


def test_a_literal_counts_by_value() -> None:
    """Two systems that differ in one number only."""
    made = machine()
    system = lower(made)
    changed = replace(system, outputs={"told": Lit(1, COUNT)})
    assert target_digest(Target("kept", (made,), system, ())) != target_digest(Target("kept", (made,), changed, ()))


def test_the_content_of_a_target_has_no_places_and_no_recordings(tmp_path: Path) -> None:
    """A row that stands elsewhere in its file, and a recording, are in the digest for findings alone; a term is in both."""
    [first, *others] = machine().transitions
    elsewhere = target(machine(transitions=[replace(first, src="moved.py:1"), *others]))
    stream = tmp_path / "kept-run.jsonl"
    stream.write_text("{}", encoding="utf-8")
    for other in (elsewhere, target(streams=(stream,))):
        assert target_digest(other) != target_digest(target())
        assert content_digest(other) == content_digest(target())
    assert content_digest(target(machine(lemmas={"small": N <= 99}))) != content_digest(target())
