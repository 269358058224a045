"""Machines: declared once and frozen; terms about what fired; names for the reader."""

from __future__ import annotations

import pickle
from dataclasses import FrozenInstanceError, replace

import pytest

from safeloc.errors import ModelError, UnitError, UnknownNameError
from safeloc.language.expr import boolean, enumeration, members, number
from safeloc.language.interpret import holds
from safeloc.language.machine import ANY, Machine, Model, Transition, current_mode, modes
from safeloc.language.units import MM

A, B = modes("A", "B")
P, N = boolean("p"), number("n", MM, 0, 9)
BACK = Transition("back", (A, B), A, ~P)
MACHINE = Machine("m", (A, B), [P], {N: ANY}, {"n": N, "some": N > 0}, [Transition("go", A, B, P), BACK])


def test_declared_once_then_frozen() -> None:
    """Neither a machine nor a transition can be changed afterwards."""
    with pytest.raises(FrozenInstanceError):
        MACHINE.name = "other"  # type: ignore[misc]
    with pytest.raises(FrozenInstanceError):
        BACK.rank = 3  # type: ignore[misc]


def test_each_part_knows_its_line() -> None:
    """Machine and transition carry the file and line they were written on."""
    assert MACHINE.src.startswith(f"{__file__}:")
    assert BACK.src.startswith(f"{__file__}:")
    assert MACHINE.src != BACK.src


def test_sources_are_always_a_tuple() -> None:
    """One source mode or several read alike."""
    assert [t.sources for t in MACHINE.transitions] == [(A,), (A, B)]


@pytest.mark.parametrize(
    ("number_", "go", "either", "stayed"), [(0, False, False, True), (1, True, True, False), (2, False, True, False)]
)
def test_what_fired_is_a_term(number_: int, go: bool, either: bool, stayed: bool) -> None:
    """fired() holds for the named transitions, stayed() for none of them."""
    values = {MACHINE.fired_name: number_}
    assert holds(MACHINE.fired("go"), values) is go
    assert holds(MACHINE.fired("go", "back"), values) is either
    assert holds(MACHINE.stayed(), values) is stayed


def test_an_unknown_transition_is_refused() -> None:
    """The message names the machine, what it lacks and what it has, and is printed as it is, without quotes."""
    with pytest.raises(UnknownNameError, match=r"m has no transition \['gone'\]; it has \['go', 'back'\]") as raised:
        MACHINE.fired("go", "gone")
    assert isinstance(raised.value, KeyError)
    assert str(raised.value).startswith(__file__)


def test_outputs_by_kind() -> None:
    """output() gives numbers, flag() truth values."""
    assert MACHINE.output("n") is N
    assert repr(MACHINE.flag("some")) == repr(MACHINE.outputs["some"])


def test_the_mode_may_be_made_first() -> None:
    """Terms that read the mode can be built before the machine, which then takes that very variable."""
    first, second = modes("FIRST", "SECOND")
    mode = current_mode((first, second))
    guard = mode.eq(first) & P
    machine = Machine("early", (first, second), [P], {}, {}, [Transition("go", (first, second), second, guard)])
    assert machine.mode is mode
    assert holds(guard, {mode: 0, P: True})


def test_modes_made_twice_have_two_variables() -> None:
    """Two machines of one function are told apart, also where their modes have the same names; a changed copy is not."""
    again = Machine("again", modes("A", "B"), [P], {}, {}, [])
    assert enumeration(tuple(again.modes)) == enumeration((A, B))
    assert again.mode is not MACHINE.mode
    assert replace(MACHINE, transitions=[]).mode is MACHINE.mode is current_mode((A, B))


def test_the_mode_is_one_variable_in_a_worker_process_too() -> None:
    """A machine that was sent to one is whole: its mode variable is that of its modes."""
    sent = pickle.loads(pickle.dumps(MACHINE))
    assert sent.mode is current_mode(sent.modes) is not MACHINE.mode
    assert sent.transitions[0].source.unit.current is sent.mode


def test_only_modes_have_a_mode_variable() -> None:
    """Members of another enumeration are no modes."""
    with pytest.raises(ModelError, match=r"test_machine.py:\d+: RED is no mode; make modes with modes\(...\)"):
        current_mode(members("colour", "RED", "GREEN"))


def test_modes_are_an_enumeration() -> None:
    """Modes are numbered in the order given; a plain number is no member."""
    assert [mode.value for mode in (A, B)] == [0, 1]
    assert enumeration((A, B)).members == ("A", "B")
    with pytest.raises(UnitError, match="is a number, not a member of an enumeration"):
        enumeration(((N + 1).right,))  # type: ignore[attr-defined]


def test_any_stays_one_value() -> None:
    """ANY survives being sent to a worker process, so `is ANY` goes on to work there."""
    assert pickle.loads(pickle.dumps(ANY)) is ANY
    assert repr(ANY) == "ANY"


def test_modes_have_distinct_names() -> None:
    """Two modes of one name could not be told apart in a trace or a file."""
    with pytest.raises(ModelError, match=r"mode has labels \['A', 'A'\]; they must be distinct\.$"):
        modes("A", "A")


def test_a_model_names_its_modes() -> None:
    """`in_mode` holds in the modes that are named, and in no other; a name that the machine lacks is refused with the nearest."""
    table = modes("IDLE", "ONE", "SEVERAL")
    rows = [Transition("goes on", table[0], table[1]), Transition("parts", table[1], table[2])]
    model = Model(Machine("tracks", table, [], {}, {}, rows), None)
    found = [holds(model.in_mode("ONE", "SEVERAL"), {model.machine.mode: number}) for number in range(3)]
    assert found == [False, True, True]
    with pytest.raises(
        UnknownNameError, match=r"tracks has no mode 'SEVERALS'; it has \['IDLE', 'ONE', 'SEVERAL'\].*SEVERAL"
    ):
        model.in_mode("IDLE", "SEVERALS")
