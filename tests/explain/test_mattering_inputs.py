"""What matters in a run: steps left out, inputs at rest, and the rows that say the rest."""

from __future__ import annotations

import pytest

from safeloc.explain.mattering_inputs import Row, mattering_rows, open_first, simplest
from safeloc.explain.pytest_file import name_of_test, pytest_file
from safeloc.language.interpret import run
from safeloc.language.monitor import check
from safeloc.language.trace import Trace
from safeloc.language.verdict import Violated
from tests.explain.pump import TOO_MANY, target

STREAM = [{"go": False, "extra": 2}, {"go": True, "extra": 3}, *[{"go": True, "extra": 0}] * 6]


def shortest() -> Trace:
    """A roundabout run, made simple."""
    found = check(run(target().system, STREAM, first={"label": 5}), TOO_MANY)
    assert isinstance(found, Violated)
    assert found.trace is not None
    return simplest(found.trace, TOO_MANY, 10.0)


def test_what_does_not_matter_is_at_rest() -> None:
    """The idle first step is gone, and so are all values but the one that begins."""
    rows = mattering_rows(shortest())
    assert rows == [Row(1, "begin", {"go": "true"}), *(Row(number, "count", {}) for number in range(2, 6))]


def test_a_present_input_is_never_at_rest() -> None:
    """Also where its value is the one nearest to zero: that it came may matter."""
    rows = mattering_rows(run(target().system, [{"go": False, "extra": 0}, {"go": False}]))
    assert [row.inputs for row in rows] == [{"extra": "0"}, {}]


def test_open_first_values_are_kept() -> None:
    """Only of variables whose first value is open."""
    assert open_first(run(target().system, [], first={"label": 5})) == {"label": 5}


def test_the_test_file_fails_as_long_as_the_machine_does() -> None:
    """Its text is a program that runs the same inputs; here it is run with the target at hand in place of a file."""
    text = pytest_file(target(TOO_MANY), TOO_MANY, shortest(), None)
    assert 'load_target("pump")' in text
    names: dict[str, object] = {}
    exec(compile(text, "test_pump.py", "exec"), names)
    names["load_target"] = lambda _: target(TOO_MANY)
    made = names["test_too_many_strokes"]
    assert callable(made)
    with pytest.raises(AssertionError, match="   5  count"):
        made()


def test_names_and_words_of_a_user_are_text() -> None:
    """Quotes in them end no string of the file."""
    odd = target(TOO_MANY).properties[0]
    object.__setattr__(odd, "statement", 'say "go"\n\\')
    try:
        compile(pytest_file(target(odd), odd, shortest(), None), "test_pump.py", "exec")
    finally:
        object.__setattr__(odd, "statement", "at most 3 strokes")
    assert name_of_test('Say "Go" to 3') == "test_say_go_to_3"
    assert name_of_test("¿?") == "test_property"
