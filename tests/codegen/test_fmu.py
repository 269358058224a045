"""Co-simulation units: found without a problem by fmpy, and equal to the interpreter step by step."""

from __future__ import annotations

import ctypes
import io
import random
import zipfile
from pathlib import Path

import pytest

from safeloc.codegen.c99_build import SUFFIX
from safeloc.codegen.fmu import platform_tuple, to_fmu
from safeloc.language.interpret import run
from safeloc.language.system import TransitionSystem, without_ghosts
from safeloc.proof.drawn_runs.lawful import first_state
from safeloc.proof.drawn_runs.sampled import drawn_run
from safeloc.shipped_machines import ENTRIES
from tests.codegen.c_folder import needs_compiler
from tests.codegen.fmi_unit import loaded
from tests.examples import EXAMPLES

pytestmark = needs_compiler
SYSTEMS = {example.name: example.system for example in EXAMPLES}
SOME_SHIPPED = ("odometry", "sections", "delocalized")


def system_of(name: str) -> TransitionSystem:
    """Return the on-board system of an example or of a shipped machine."""
    return without_ghosts(SYSTEMS[name] if name in SYSTEMS else ENTRIES[name].make(ENTRIES[name].config()).system)


def written(folder: Path, name: str, period_ms: int | None = 100) -> Path:
    """The unit in a file."""
    system, path = system_of(name), folder / f"{name}.fmu"
    path.write_bytes(to_fmu(system, period_ms=period_ms, first=first_state(system, random.Random(0)), doc="A unit."))
    return path


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize("name", [*SYSTEMS, *SOME_SHIPPED])
def test_nothing_is_found_wrong(name: str, tmp_path: Path) -> None:
    """fmpy finds no problem: schema, names, structure, start values, combinations."""
    validation = pytest.importorskip("fmpy.validation", reason="needs fmpy (extra fmi)")
    assert validation.validate_fmu(str(written(tmp_path, name))) == []


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize("name", [*SYSTEMS, *SOME_SHIPPED])
def test_runs_as_interpreted(name: str, tmp_path: Path) -> None:
    """Outputs, fired transitions and state of every communication step are those of the interpreter."""
    system = system_of(name)
    drawn = drawn_run(system, 1, 60, lawful=False)
    trace = run(system, drawn.steps, first=drawn.first)
    fired = {var.name: var.unit.members for var in system.fired}  # type: ignore[union-attr]
    with loaded(written(tmp_path, name)) as unit:
        unit.begin(dict(drawn.first or {}))
        for number, step in enumerate(trace.steps):
            for key, value in step.inputs.items():
                unit.set(key, value)
            unit.slave.doStep(number * 0.1, 0.1)
            assert list(step.outputs.values()) == unit.get(list(step.outputs))
            assert list(step.state.values()) == unit.get([f"state.{key}" for key in step.state])
            assert list(step.fired.values()) == [
                fired[key][value] for key, value in zip(fired, unit.get(list(fired)), strict=True)
            ]


def test_simulated_by_a_master(tmp_path: Path) -> None:
    """fmpy's own master runs a unit with the step size the unit declares, and records its outputs."""
    fmpy = pytest.importorskip("fmpy", reason="needs fmpy (extra fmi)")
    numpy = pytest.importorskip("numpy")
    columns = [("time", "f8"), ("movement", "i8"), ("reference.present", "?"), ("reference", "i8")]
    given = numpy.array([(n / 10, 10, n == 0, 500) for n in range(20)], dtype=columns)
    path = written(tmp_path, "odometer")
    result = fmpy.simulate_fmu(str(path), input=given, stop_time=1.0, output=["position_mm", "valid"])
    assert list(result["position_mm"])[:4] == [0, 500, 510, 520]
    assert all(result["valid"])


def test_refused_inputs_are_told_and_nothing_moves(tmp_path: Path) -> None:
    """A step with an input out of its range is discarded with its reason; with the input mended it can be taken."""
    logged: list[str] = []
    with loaded(written(tmp_path, "odometer"), logged) as unit:
        unit.begin({})
        unit.set("movement", 5001)
        with pytest.raises(Exception, match="status 2"):
            unit.slave.doStep(0.0, 0.1)
        assert logged == ["input movement is not in -5000 .. 5000 mm"]
        assert [0, True] == unit.get(["position_mm", "valid"])
        unit.set("movement", 5000)
        unit.slave.doStep(0.0, 0.1)
        assert [5000] == unit.get(["position_mm"])


@pytest.mark.parametrize(
    ("start", "size", "said"),
    [
        (0.0, 0.2, "one communication step is one cycle of 100 ms"),
        (0.3, 0.1, "a step begins where the last one ended, and takes time"),
    ],
)
def test_steps_of_another_kind_are_refused(start: float, size: float, said: str, tmp_path: Path) -> None:
    """Steps have the machine's period and follow each other."""
    logged: list[str] = []
    with loaded(written(tmp_path, "odometer"), logged) as unit:
        unit.begin({})
        with pytest.raises(Exception, match="status 3"):
            unit.slave.doStep(start, size)
        assert logged == [said]


def test_first_values_that_exclude_each_other_are_refused(tmp_path: Path) -> None:
    """What `initially` excludes cannot be begun with."""
    logged: list[str] = []
    with loaded(written(tmp_path, "timer"), logged) as unit:
        with pytest.raises(Exception, match="status 3"):
            unit.begin({"left": 1})
        assert logged == ["the chosen first values are out of range or exclude each other; nothing was done"]


def test_members_are_checked_when_set(tmp_path: Path) -> None:
    """A number that is no member of an enumeration is not taken, however large."""
    logged: list[str] = []
    with loaded(written(tmp_path, "doors"), logged) as unit:
        unit.begin({})
        with pytest.raises(Exception, match="status 2"):
            unit.set("command", 2**32 + 1)
        assert logged == ["command is no member of its enumeration"]


def test_a_saved_state_goes_on_as_before(tmp_path: Path) -> None:
    """A state that was saved, also as bytes, gives the same steps again; damaged bytes are refused."""
    logged: list[str] = []
    with loaded(written(tmp_path, "odometer"), logged) as unit:
        unit.begin({})
        unit.set("movement", 700)
        unit.slave.doStep(0.0, 0.1)
        saved = unit.slave.getFMUState()
        unit.slave.doStep(0.1, 0.1)
        assert [1400] == unit.get(["position_mm"])
        unit.slave.setFMUState(saved)
        assert [700] == unit.get(["position_mm"])
        kept = bytearray(unit.slave.serializeFMUState(saved))
        unit.slave.freeFMUState(saved)
        unit.slave.setFMUState(unit.slave.deserializeFMUState(bytes(kept)))
        unit.slave.doStep(0.1, 0.1)
        assert [1400] == unit.get(["position_mm"])
        kept[8] ^= 1
        with pytest.raises(Exception, match="status 3"):
            unit.slave.deserializeFMUState(bytes(kept))
        assert logged[-1:] == ["the snapshot's checksum is wrong; nothing was restored"]


def test_reset_begins_again(tmp_path: Path) -> None:
    """After a reset the unit is as when it was made."""
    with loaded(written(tmp_path, "odometer")) as unit:
        unit.begin({})
        unit.set("movement", 700)
        unit.slave.doStep(0.0, 0.1)
        unit.slave.terminate()
        unit.slave.reset()
        unit.begin({})
        assert [0, 0] == unit.get(["position_mm", "movement"])


def test_any_step_is_a_cycle_where_there_is_no_period(tmp_path: Path) -> None:
    """A machine without a period takes steps of any length."""
    with loaded(written(tmp_path, "odometer", period_ms=None)) as unit:
        unit.begin({})
        unit.set("movement", 5)
        unit.slave.doStep(0.0, 0.25)
        unit.slave.doStep(0.25, 3.0)
        assert [10] == unit.get(["position_mm"])


# ------------------------------------------------------------------ without fmpy


def test_what_is_in_the_file(tmp_path: Path) -> None:
    """Description, sources with their build description, and a library that every FMI function is found in."""
    content = to_fmu(system_of("odometer"), period_ms=100)
    assert content == to_fmu(system_of("odometer"), period_ms=100)
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        binary = f"binaries/{platform_tuple()}/odometer{SUFFIX}"
        expected = ["fmi3.c", "odometer.c", "odometer.h", "buildDescription.xml"]
        assert {"modelDescription.xml", binary, *(f"sources/{name}" for name in expected)} == set(archive.namelist())
        library = ctypes.CDLL(archive.extract(binary, tmp_path))
    version = library.fmi3GetVersion
    version.restype = ctypes.c_char_p
    assert version() == b"3.0"
    for name in ("fmi3DoStep", "fmi3GetBinary", "fmi3InstantiateModelExchange", "fmi3ActivateModelPartition"):
        assert hasattr(library, name)
    assert not hasattr(library, "odometer_step")  # two units in one process do not meet


def test_units_ranges_and_causality_are_described() -> None:
    """An importer sees what the declaration says."""
    with zipfile.ZipFile(io.BytesIO(to_fmu(system_of("odometer"), period_ms=100))) as archive:
        text = archive.read("modelDescription.xml").decode()
    assert '<Int64Type name="mm" description="whole numbers in mm" />' in text
    movement = '<Int64 name="movement" valueReference="1" causality="input" variability="discrete"'
    assert f'{movement} description="in mm" declaredType="mm" min="-5000" max="5000" start="0" />' in text
    assert 'description="in mm; read only where reference.present is true"' in text
    assert '<Item name="TRACKING" value="0" />' in text
    assert 'fixedInternalStepSize="0.1"' in text
