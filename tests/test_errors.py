"""Errors: the tree in the docstring is the tree of classes, and a message points at the user's own line."""

from __future__ import annotations

import re

import pytest

from safeloc import errors
from safeloc.errors import ModelError, SafelocError, UnitError, declared_at
from safeloc.language.expr import Bool, boolean, members, number
from safeloc.language.machine import Transition
from safeloc.language.spec import Property, always
from safeloc.language.units import MM, MS


def drawn() -> dict[str, str]:
    """Class -> the class it hangs from, as drawn in the docstring."""
    found, path = {}, ["SafelocError"]
    for line in (errors.__doc__ or "").splitlines():
        if match := re.match(r"^([│ ]*)[├└]── (\w+)", line):
            depth = len(match[1]) // 4 + 1
            path[depth:] = [match[2]]
            found[match[2]] = path[depth - 1]
    return found


def test_the_tree_is_drawn_as_it_is() -> None:
    """Every error class stands in the docstring under its first base."""
    classes = {
        value.__name__: value.__bases__[0].__name__
        for value in vars(errors).values()
        if isinstance(value, type) and value is not SafelocError and issubclass(value, SafelocError)
    }
    assert drawn() == classes


@pytest.mark.parametrize(
    ("name", "builtin"),
    [
        ("UnitError", TypeError),
        ("TruthValueError", TypeError),
        ("UnknownNameError", KeyError),
        ("InputError", ValueError),
        ("StreamError", ValueError),
        ("EngineError", RuntimeError),
        ("NotProvedError", AssertionError),
    ],
)
def test_errors_are_what_a_host_expects(name: str, builtin: type[Exception]) -> None:
    """A host that catches Python's own error catches ours."""
    assert issubclass(getattr(errors, name), builtin)


def test_the_place_is_the_callers_line() -> None:
    """declared_at names this file, and the line on which the wrong term was written."""
    length, time = number("length", MM, 0, 10), number("time", MS, 0, 10)
    place = declared_at()
    with pytest.raises(UnitError) as caught:
        _ = length + time
    file, _, line = place.rpartition(":")
    assert file == __file__
    assert f"{__file__}:{int(line) + 2}" in str(caught.value)


@pytest.mark.parametrize(("low", "high"), [(1, 0), (-(2**63) - 1, 0), (0, 2**63)])
def test_ranges_are_refused_with_their_place(low: int, high: int) -> None:
    """An empty range and one beyond 64 bits: name, range and file."""
    with pytest.raises(ModelError, match=r"test_errors\.py:\d+: range of 'x' is .* must be non-empty and fit 64 bits"):
        number("x", MM, low, high)


def _handed(name: str, term: Bool) -> Property:
    """Pass the name on, as a helper of a file of properties does."""
    return always(name, term)


def test_a_declaration_is_where_its_name_is_written() -> None:
    """Not in a function that gets the name, through however many of them; a function that makes the name is that place."""
    lit = boolean("lit")

    def twice(name: str) -> Property:
        return _handed(name, lit)

    def made(end: str) -> Property:
        return always(f"{end} is lit", lit)

    here = int(declared_at().rpartition(":")[2])
    one, two, three, four = _handed("a", lit), twice("b"), always("c", lit), made("d")
    row = transition(name="t")
    assert [here + 1] * 3 == [int(one.src.rpartition(":")[2]) for one in (one, two, three)]
    assert here - 2 == int(four.src.rpartition(":")[2])
    assert here + 2 == int(row.src.rpartition(":")[2])


def transition(name: str) -> Transition:
    """Make a row of a table."""
    mode = members("mode", "ON", "OFF")
    return Transition(name, mode[0], mode[1])
