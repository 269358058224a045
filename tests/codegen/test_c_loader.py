"""Generated C in Python: inputs checked as everywhere, snapshots that fit or are refused, a cache of libraries."""

from __future__ import annotations

import ctypes
import struct
from collections.abc import Sequence
from pathlib import Path

import pytest

from safeloc.codegen import c99_build
from safeloc.codegen.c99 import library_texts
from safeloc.codegen.c99_build import build, compiler
from safeloc.codegen.c99_layout import layout_of
from safeloc.codegen.c_loader import load_c
from safeloc.errors import EngineError, InputError
from safeloc.language.system import TransitionSystem, lower, without_ghosts
from tests.codegen.c_folder import needs_compiler
from tests.examples import EXAMPLES, build_odometer

pytestmark = needs_compiler


def on_board(name: str) -> TransitionSystem:
    """Return the on-board system of an example."""
    return without_ghosts(next(one for one in EXAMPLES if one.name == name).system)


def test_a_step_by_name(tmp_path: Path) -> None:
    """Inputs, outputs, state and transitions have the names of the declaration."""
    machine = load_c(on_board("odometer"), folder=tmp_path)
    assert machine.step({"movement": 100}) == {"position_mm": 100, "margin_mm": 5, "valid": True}
    assert machine.fired == {"fired": "run on"}
    assert machine.state == {"mode": 0, "position": 100, "margin": 5_000_000}
    assert machine.step({"movement": 0, "reference": 7}) == {"position_mm": 7, "margin_mm": 0, "valid": True}
    machine.reset()
    assert machine.state == {"mode": 0, "position": 0, "margin": 0}


def test_inputs_are_refused_as_by_the_interpreter(tmp_path: Path) -> None:
    """After an input that is out of range, unknown or no number, the state is unchanged."""
    machine = load_c(on_board("odometer"), folder=tmp_path)
    machine.step({"movement": 100})
    with pytest.raises(InputError, match=r"^movement: 5001 mm is outside -5000\.\.5000\.$"):
        machine.step({"movement": 5001})
    with pytest.raises(InputError, match=r"^movement: expected a whole number of mm, got nan\.$"):
        machine.step({"movement": float("nan")})
    with pytest.raises(InputError, match=r"^odometer: input 'movement' is missing"):
        machine.rows([{"movement": 1}, {}])
    assert machine.state["position"] == 100


def test_columns_are_checked_by_c(tmp_path: Path) -> None:
    """Columns from elsewhere stop before the first refused row, which is named; rows before it were taken."""
    machine = load_c(on_board("odometer"), folder=tmp_path)
    movements, present, places = (ctypes.c_int64 * 3)(1, 2, 6000), (ctypes.c_uint8 * 3)(), (ctypes.c_int64 * 3)()
    with pytest.raises(InputError, match=r"^odometer: row 2: input movement is not in -5000 \.\. 5000 mm\.$"):
        machine.run_columns(machine.columns([movements, present, places]))
    assert machine.state["position"] == 3


def test_columns_of_other_kinds_are_refused(tmp_path: Path) -> None:
    """Arrays of another kind, number or length would be read beyond their end."""
    machine = load_c(on_board("odometer"), folder=tmp_path)
    movements, present, places = (ctypes.c_int64 * 3)(), (ctypes.c_uint8 * 3)(), (ctypes.c_int64 * 2)()
    told = r"^odometer: give columns as arrays of equal length, movement: int64_t, reference_present: uint8_t, reference: int64_t\.$"
    for wrong in ([movements, present, places], [movements, present], [movements, places, present]):
        with pytest.raises(InputError, match=told):
            machine.columns(wrong)


def test_an_absent_value_is_not_looked_at(tmp_path: Path) -> None:
    """The value of an absent input is neither refused nor used."""
    machine = load_c(on_board("odometer"), folder=tmp_path)
    rows = machine.rows([{"movement": 5}])
    rows[0].reference = -(2**63)
    machine.run(rows)
    assert machine.state["position"] == 5


def test_a_flag_is_0_or_1(tmp_path: Path) -> None:
    """A presence flag that is neither is refused, not taken for true."""
    machine = load_c(on_board("odometer"), folder=tmp_path)
    rows = machine.rows([{"movement": 5}])
    rows[0].reference_present = 2
    with pytest.raises(InputError, match=r"input reference\.present is not 0 or 1\.$"):
        machine.run(rows)


def test_first_values_are_chosen_and_judged(tmp_path: Path) -> None:
    """Open first values are taken where `initially` allows them, also by C alone."""
    machine = load_c(on_board("timer"), folder=tmp_path, first={"left": 4})
    assert machine.step({"restart": False}) == {"left": 3}
    with pytest.raises(InputError, match="breaks `initially`"):
        machine.reset({"left": 1})
    first = (ctypes.c_int64 * 1)(1)
    initialize = machine._library.timer_init  # the interpreter would refuse it before C is asked
    assert initialize(ctypes.byref(machine._state), first) == 3
    first[0] = 6
    assert initialize(ctypes.byref(machine._state), first) == 3
    assert initialize(None, first) == 1


# ------------------------------------------------------------------ snapshots


def test_a_snapshot_goes_on_as_before(tmp_path: Path) -> None:
    """Restored, a machine does what it would have done; in another instance as well."""
    machine, other = (load_c(on_board("odometer"), folder=tmp_path) for _ in range(2))
    machine.step({"movement": 100})
    saved = machine.save()
    after = machine.step({"movement": 50})
    machine.restore(saved)
    other.restore(saved)
    assert after == machine.step({"movement": 50}) == other.step({"movement": 50})


@pytest.mark.parametrize("place", range(8, 16 + 32))
def test_a_damaged_snapshot_is_refused(place: int, tmp_path_factory: pytest.TempPathFactory) -> None:
    """A changed bit anywhere but in padding is noticed, and the state stays as it is."""
    machine = load_c(on_board("odometer"), folder=tmp_path_factory.getbasetemp() / "snapshots")
    machine.step({"movement": 100})
    saved = bytearray(machine.save())
    saved[place] ^= 4
    if 28 <= place < 32:  # between mode and position nothing is kept
        machine.restore(bytes(saved))
    else:
        with pytest.raises(InputError, match=r"^odometer: the snapshot's checksum is wrong; nothing was restored\.$"):
            machine.restore(bytes(saved))
    assert machine.state["position"] == 100


def test_a_foreign_snapshot_is_refused(tmp_path: Path) -> None:
    """A snapshot of a declaration that differs in one constant is refused; so is one of another size."""
    machine = load_c(on_board("odometer"), folder=tmp_path)
    other = load_c(without_ghosts(lower(build_odometer(2000).machine)), folder=tmp_path)
    with pytest.raises(InputError, match="of another declaration; nothing was restored"):
        machine.restore(other.save())
    with pytest.raises(
        InputError, match=r"^odometer: the snapshot has 47 bytes, expected 48; it is damaged or of another machine\.$"
    ):
        machine.restore(machine.save()[:-1])


_SNAPSHOT = "<QQQi4xqq"
"""Of the odometer: declaration, checksum, and the state with its mark, mode, position and margin."""


def test_a_snapshot_out_of_range_is_refused(tmp_path: Path) -> None:
    """A value out of its range is refused even where the checksum fits."""
    machine = load_c(on_board("odometer"), folder=tmp_path)
    declaration, _, *state = struct.unpack(_SNAPSHOT, machine.save())
    state[2] = 10**7
    forged = struct.pack(_SNAPSHOT, declaration, _fnv_1a(state), *state)
    with pytest.raises(InputError, match=r"^odometer: a state variable is out of its range; nothing was done\.$"):
        machine.restore(forged)
    assert machine.state["position"] == 0


def _fnv_1a(numbers: Sequence[int]) -> int:
    """The checksum of a snapshot: over the bytes of each number, the least significant one first."""
    total = 14695981039346656037
    for byte in b"".join((number % 2**64).to_bytes(8, "little") for number in numbers):
        total = (total ^ byte) * 1099511628211 % 2**64
    return total


# ------------------------------------------------------------------ compiling


def test_without_a_compiler_the_message_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    """No compiler: an error that names what was looked for."""
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("CC", raising=False)
    with pytest.raises(EngineError, match=r"^no C compiler: cc, gcc, clang not found\. Install one"):
        load_c(on_board("odometer"))
    with pytest.raises(EngineError, match=r"^no C compiler: tcc not found\."):
        compiler("tcc")
    monkeypatch.setenv("CC", "mycc")
    with pytest.raises(
        EngineError, match=r"^no C compiler: the variable CC names 'mycc', which is no program that runs\."
    ):
        compiler()


def test_a_compiler_that_is_named_and_missing_is_not_replaced(monkeypatch: pytest.MonkeyPatch) -> None:
    """Another one, which is there, might build for another target."""
    monkeypatch.delenv("CC", raising=False)
    found = compiler()
    monkeypatch.setenv("CC", "/nonexistent/cc")
    with pytest.raises(EngineError, match="CC names '/nonexistent/cc'"):
        compiler()
    monkeypatch.setenv("CC", found)
    assert compiler() == found


def test_a_library_is_compiled_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same machine is found again in the folder; another one is not taken for it."""
    load_c(on_board("odometer"), folder=tmp_path)
    monkeypatch.setattr(c99_build, "_compiled", lambda *_: pytest.fail("compiled again"))
    load_c(on_board("odometer"), folder=tmp_path)
    assert len(list(tmp_path.iterdir())) == 1
    with pytest.raises(pytest.fail.Exception, match="compiled again"):
        load_c(on_board("doors"), folder=tmp_path)


def test_what_the_compiler_says_is_told(tmp_path: Path) -> None:
    """Sources that do not compile: the compiler's own words, and no library left behind."""
    texts = library_texts(layout_of(on_board("doors")))
    texts["doors.c"] = texts["doors.c"].replace("int64_t mode", "int64_t unused = 0, mode")
    with pytest.raises(EngineError, match=r"refuses the generated C: (?s:.*)unused"):
        build(texts, tmp_path, "doors")
    assert list(tmp_path.iterdir()) == []
