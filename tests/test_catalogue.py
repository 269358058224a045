"""Machines by name and by address: what is found, and what a person is told who asked for something else."""

from __future__ import annotations

import gc
import json
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from safeloc.catalogue import ENTRIES, Target, load_target, read_config, with_defaults
from safeloc.errors import InputError, ModelError
from safeloc.models.localizer import LocalizerConfig
from safeloc.models.odometry.variables import OdometryConfig
from tests.shipped import shipped

OWN = """
from safeloc.language.composition import compose
from safeloc.language.expr import boolean, number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import always
from safeloc.language.units import MM

def lamp(name, high=10):
    dark, lit = modes("DARK", "LIT")
    press, level = boolean(name + "_press"), number(name + "_level", MM, 0, high)
    table = [Transition("on", dark, lit, press, {level: high})]
    return Machine(name, (dark, lit), [press], {level: 0}, {}, table, doc="a lamp")

machine = lamp("lamp")
def build(config=None):
    return lamp("built", high=(config or {"high": 5})["high"])
pair = compose("pair", [lamp("left"), lamp("right")], {})
number_of_lamps = 3
def nothing():
    return None
"""
DECLARED = """
properties = [always("lit is full", machine.mode.eq(machine.modes[0]) | (next(iter(machine.state)) >= 10))]
"""
OF_THE_MACHINE = """
def properties(found):
    return [always("of " + getattr(found, "name", "whole"), press.iff(press))]
press = boolean("never_read")
"""
WRONG_PROPERTIES = """
properties = ["light"]
"""
INTERVAL = """
from safeloc.reported import Reported
reported = Reported(position="somewhere")
"""


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A user's folder, with what is imported from it forgotten afterwards."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", list(sys.path))
    monkeypatch.setattr(sys, "modules", dict(sys.modules))
    return tmp_path


def own(place: Path, more: str = DECLARED, name: str = "my_lamps.py") -> Path:
    """The user's file."""
    path = place / name
    path.parent.mkdir(exist_ok=True)
    path.write_text(OWN + more, encoding="utf-8")
    return path


def refused(spec: str, config: Path | None = None) -> str:
    """What a person reads."""
    with pytest.raises(InputError) as error:
        load_target(spec, config)
    return str(error.value)


# ------------------------------------------------------------------ shipped machines


@pytest.mark.parametrize("name", list(ENTRIES))
def test_shipped(name: str) -> None:
    """A shipped machine comes with its properties, its default configuration and its documentation."""
    found = shipped(name)
    assert (found.name, found.system.name) == (name, name)
    assert found.properties
    assert found.doc
    assert isinstance(found.config, ENTRIES[name].config)
    assert ENTRIES[name].simulates is (found.simulate is not None)


def test_shipped_streams_exist() -> None:
    """Odometry ships with recordings, and each is a file."""
    streams = load_target("odometry").streams
    assert {path.name for path in streams} >= {"odometry-service.jsonl.gz", "odometry-wheel-slide.jsonl.gz"}
    assert all(path.is_file() for path in streams)


@pytest.mark.parametrize(("typed", "meant"), [("odometri", "odometry"), ("supervised", "supervised_odometry")])
def test_a_misspelt_name(typed: str, meant: str) -> None:
    """A name that is nearly right gets a suggestion beside the list of all names."""
    message = refused(typed)
    assert f"no machine {typed!r}" in message
    assert f"Did you mean {meant!r}?" in message
    assert all(name in message for name in ENTRIES)


def test_an_unknown_name() -> None:
    """A name like no other gets the list alone, and how to name a machine of one's own."""
    message = refused("xyz")
    assert "Did you mean" not in message
    assert "package.module:name" in message


# ------------------------------------------------------------------ configurations


@pytest.mark.parametrize("kind", ["toml", "json"])
def test_a_configuration_file_is_used(kind: str, tmp_path: Path) -> None:
    """A field of the file replaces its default, in the machine too."""
    path = tmp_path / f"vehicle.{kind}"
    path.write_text("tolerance_mm = 20000\n" if kind == "toml" else '{"tolerance_mm": 20000}', encoding="utf-8")
    found = load_target("delocalized", path)
    assert found.config is not None
    assert found.config.model_dump()["tolerance_mm"] == 20_000
    high = {var.name: var.high for var in found.system.state if hasattr(var, "high")}
    assert high["passed_margin_above_mm"] == 20_000


@pytest.mark.parametrize("kind", ["toml", "json"])
def test_an_array_of_a_configuration_file(kind: str, tmp_path: Path) -> None:
    """Sources of the localizer are left out in a file as in Python; what stands there is told where it is wrong."""
    path = tmp_path / f"vehicle.{kind}"
    sources = 'sources = ["odometry", "balise"]' if kind == "toml" else '{"sources": ["odometry", "balise"]}'
    path.write_text(sources, encoding="utf-8")
    assert read_config(LocalizerConfig, path) == LocalizerConfig(sources=("odometry", "balise"))
    path.write_text(sources.replace("balise", "radio"), encoding="utf-8")
    with pytest.raises(InputError, match=r"sources\.1: .*'reflector'.* \(got 'radio'\)"):
        read_config(LocalizerConfig, path)
    path.write_text(sources.replace('"odometry", "balise"', ""), encoding="utf-8")
    with pytest.raises(InputError, match="must be at least one of"):
        read_config(LocalizerConfig, path)


@pytest.mark.parametrize(
    ("content", "wrong"),
    [
        ({"tolerance_mm": 0}, ["tolerance_mm: "]),
        ({"tolerance_m": 30}, ["tolerance_m: "]),
        ({"tolerance_mm": "wide", "devices": 3}, ["tolerance_mm: ", "devices: "]),
        ({"first_unit": {"kind": "steam"}}, ["first_unit."]),
        ({"lone_limit_cycles": 1}, ["lone_limit_cycles must not be below gap_limit_cycles"]),
    ],
)
def test_wrong_fields_are_named(content: dict[str, object], wrong: list[str], tmp_path: Path) -> None:
    """The file and every wrong field are named, one a line."""
    path = tmp_path / "vehicle.json"
    path.write_text(json.dumps(content), encoding="utf-8")
    with pytest.raises(InputError) as error:
        read_config(OdometryConfig, path)
    lines = str(error.value).splitlines()
    assert str(path) in lines[0]
    assert all(any(line.startswith(f"  - {name}") for line in lines[1:]) for name in wrong), lines


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ("vehicle_lenght_mm = 75400", "vehicle_lenght_mm: there is no such figure (got 75400). Did you mean 'vehicle_length_mm'?"),
        ('vehicle_length_mm = "75 m"', "vehicle_length_mm: has to be a whole number (got '75 m')"),
        ("tolerance_mm = 20000.5", "tolerance_mm: has to be a whole number (got 20000.5)"),
        ("devices = 3", "devices: has to be 1 or 2 (got 3)"),
        ("trust_first_marker = 1", "trust_first_marker: has to be true or false (got 1)"),
        ("first_unit = 3", "first_unit: has to be a table of figures (got 3)"),
        ("[first_unit]\nrate_ppm = 3", "first_unit.kind: has to be given, since a table of the file replaces the default table as a whole"),
        ("tolerance_mm = 4000", "tolerance_mm 4000 is not above the units' one-off constant 5000 mm: no distance can be run within it"),
        ("max_speed_mm_s = 0", "max_speed_mm_s: has to be at least 1 (got 0)"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_told_in_plain_words(content: str, told: str, tmp_path: Path) -> None:
    """Each line begins with the figure, or with the sentence that names the figures that contradict each other."""
    (tmp_path / "vehicle.toml").write_text(content, encoding="utf-8")
    assert f"\n  - {told}" in refused("odometry", tmp_path / "vehicle.toml")


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("broken.toml", "tolerance_mm = = 3", "cannot be read as TOML"),
        ("broken.json", "{", "cannot be read as JSON"),
        ("list.json", "[1]", "expected a table of fields"),
    ],
)
def test_files_that_are_no_configuration(name: str, content: str, message: str, tmp_path: Path) -> None:
    """Text that does not parse, and a document that is no table, are refused with the file's name."""
    (tmp_path / name).write_text(content, encoding="utf-8")
    assert message in refused("odometry", tmp_path / name)
    assert name in refused("odometry", tmp_path / name)


def test_a_missing_configuration_file(tmp_path: Path) -> None:
    """A file that does not exist is an input error, not a crash."""
    assert refused("odometry", tmp_path / "none.toml") == f"{tmp_path / 'none.toml'}: no such file."
    assert refused("odometry", tmp_path) == f"{tmp_path}: a folder, not a configuration file."


@pytest.mark.parametrize(("name", "left"), [("deep.json", '{"a": '), ("deep.toml", "a = ")])
def test_a_deeply_nested_configuration(name: str, left: str, tmp_path: Path) -> None:
    """Deeper than Python recurses: refused, not a crash."""
    (tmp_path / name).write_text(left + "[" * 100_000, encoding="utf-8")
    assert "nested too deeply" in refused("odometry", tmp_path / name)


WHEEL = 'kind = "wheel"\n'
FIGURES = [
    ("turn_off", "miss_limit_cycles = 0", "miss_limit_cycles: has to be at least 1 (got 0)"),
    ("reflector", "pause_limit_cycles = 0", "pause_limit_cycles: has to be at least 1"),
    ("reflector", "loss_limit_cycles = 0", "loss_limit_cycles: has to be at least 1"),
    ("reflector", "near_range_mm = 0", "near_range_mm: has to be at least 1"),
    ("reflector", "range_limit_mm = 1001", "range_limit_mm 1001 is not above near_range_mm 3000: no echo can be used."),
    ("reflector", f"[odometer]\n{WHEEL}rate_ppm = 1000000", "odometer.rate_ppm must not exceed 900000"),
    ("balise", "telegram_age_limit_ms = 1", "telegram_age_limit_ms 1 must be above a tenth of period_ms 100"),
    (
        "reflector",
        "radar_scale_ppm = 500000\nrange_limit_mm = 2000000\nreference_distance_mm = 299999",
        "these figures contradict each other in machine 'reflector' (radar_error_mm: has to be at most "
        "300000 (got 1022431)). Correct one of: range_limit_mm = 2000000, radar_scale_ppm = 500000, reference_distance_mm = ",
    ),
]


@pytest.mark.parametrize(("name", "content", "message"), FIGURES)
def test_figures_without_a_machine(name: str, content: str, message: str, tmp_path: Path) -> None:
    """Refused in the words of the configuration, never by a guard of the model or by a rule of another class."""
    path = tmp_path / "figures.toml"
    path.write_text(content, encoding="utf-8")
    assert message in refused(name, path)


def test_least_figures_make_a_machine(tmp_path: Path) -> None:
    """The documented minima of what counts cycles are enough."""
    path = tmp_path / "least.toml"
    for name, fields in (
        ("turn_off", ["miss_limit_cycles"]),
        ("reflector", ["pause_limit_cycles", "loss_limit_cycles"]),
    ):
        path.write_text("".join(f"{field} = 1\n" for field in fields), encoding="utf-8")
        assert load_target(name, path).name == name


def test_a_machine_without_a_meaning(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What only the whole shows is told as such, with the transitions and the figures; defaults are no one's figures."""

    def fails(_: object) -> Target:
        raise ModelError(
            "machine 'lamp' (x.py:1):\n  - transition 'on' (x.py:2): a comparison in its guard never changes."
        )

    entry = replace(ENTRIES["delocalized"], maker=fails)
    monkeypatch.setattr("safeloc.catalogue.ENTRIES", {"delocalized": entry})
    path = tmp_path / "own.toml"
    path.write_text("tolerance_mm = 7", encoding="utf-8")
    assert refused("delocalized", path) == (
        f"{path}: machine 'delocalized' cannot work with these figures (transitions that never, or always, fire: "
        "on). Correct one of: tolerance_mm = 7."
    )
    with pytest.raises(ModelError):
        load_target("delocalized")


# ------------------------------------------------------------------ a user's own


def checked(found: Target, name: str, properties: list[str]) -> None:
    """What a target of the user's file must be."""
    assert (found.name, [prop.name for prop in found.properties]) == (name, properties)
    assert found.config is None
    assert found.reported is None


def test_by_file(place: Path) -> None:
    """path/to/file.py:name, from any folder."""
    found = load_target(f"{own(place)}:machine")
    checked(found, "lamp", ["lit is full"])
    assert found.doc == "a lamp"


def test_by_module(place: Path) -> None:
    """module:name, of a module in the current folder."""
    own(place)
    checked(load_target("my_lamps:machine"), "lamp", ["lit is full"])


def test_by_package(place: Path) -> None:
    """package.module:name."""
    own(place, name="light/lamps.py")
    (place / "light" / "__init__.py").write_text("", encoding="utf-8")
    checked(load_target("light.lamps:machine"), "lamp", ["lit is full"])


def test_a_composition(place: Path) -> None:
    """A composition is a target with all its machines."""
    found = load_target(f"{own(place, more='')}:pair")
    checked(found, "pair", [])
    assert [machine.name for machine in found.machines] == ["left", "right"]


def test_a_function(place: Path) -> None:
    """A function is called without arguments, or with the content of the configuration file."""
    spec = f"{own(place, more='')}:build"
    (place / "own.toml").write_text("high = 7\n", encoding="utf-8")
    for config, high in ((None, 5), (place / "own.toml", 7)):
        found = load_target(spec, config)
        assert found.name == "built"
        assert {var.name: var.high for var in found.system.state if hasattr(var, "high")}["built_level"] == high


def test_a_configuration_nobody_reads(place: Path) -> None:
    """A machine that stands ready takes none, and it is not dropped in silence."""
    (place / "own.toml").write_text("high = 7\n", encoding="utf-8")
    assert "takes no configuration" in refused(f"{own(place)}:machine", place / "own.toml")


def test_properties_as_a_function_of_the_machine(place: Path) -> None:
    """`properties` may be a function: it gets the machine that was asked for."""
    path = own(place, OF_THE_MACHINE)
    assert [prop.name for prop in load_target(f"{path}:machine").properties] == ["of lamp"]
    assert [prop.name for prop in load_target(f"{path}:build").properties] == ["of built"]


@pytest.mark.parametrize(
    ("more", "name", "message"),
    [
        ("", "lamps", "has no 'lamps'; machines in it: ['machine', 'pair']"),
        ("", "Machine", "is a class; name a machine, a composition, or a function that returns one; machines in it: ["),
        ("", "number_of_lamps", "is of type int; expected a Machine, a Composition or a function returning one"),
        ("", "nothing", "is of type NoneType; expected a Machine"),
        (WRONG_PROPERTIES, "machine", "properties holds 'light' of type str at place 0 ("),
        ("properties = 5", "machine", "properties is 5 of type int ("),
        ("properties = 'lit'", "machine", "); expected a list, or a function of the machine that returns one."),
        ("def properties(found): return 5", "machine", "properties is 5 of type int ("),
        ("def properties(found): return 1 / 0", "machine", "my_lamps.properties fails: ZeroDivisionError: "),
        ("pictures = 5", "machine", "pictures is 5 of type int ("),
        (INTERVAL, "machine", "reported names 'somewhere'"),
    ],
)
def test_wrong_kinds(place: Path, more: str, name: str, message: str) -> None:
    """A missing name, something that is no machine, a wrong property, an unknown output: each is said."""
    assert message in refused(f"{own(place, more)}:{name}")


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        ("missing.py:machine", "missing.py: no such Python file"),
        ("no_such_module:machine", "cannot import 'no_such_module'"),
        ("no_such_package.lamps:machine", "Give a module on the path, or path/to/file.py:name"),
    ],
)
def test_nothing_there(place: Path, spec: str, message: str) -> None:
    """A file or module that does not exist is an input error that says what was looked for."""
    assert place == Path.cwd()
    assert message in refused(spec)


@pytest.mark.parametrize("body", ["machine = (", "machine = 1 / 0", "def machine():\n    raise ValueError('no')"])
def test_a_file_that_fails_is_wrong_input(tmp_path: Path, body: str) -> None:
    """A syntax error, an exception on import or in the function: an InputError that names file and cause."""
    path = tmp_path / "json.py"
    path.write_text(body, encoding="utf-8")
    with pytest.raises(InputError, match=r"json.py.* fails: \w+Error"):
        load_target(f"{path}:machine")
    assert "json.py" not in str(sys.modules["json"].__file__) or str(tmp_path) not in str(sys.modules["json"].__file__)


def test_a_file_that_ends_the_program_is_wrong_input(tmp_path: Path) -> None:
    """A user's module that calls sys.exit is not taken for a result."""
    module = tmp_path / "ends.py"
    module.write_text("import sys\nsys.exit(0)\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"fails: SystemExit: 0 \(.*ends\.py:2\)"):
        load_target(f"{module}:machine")


@pytest.mark.parametrize("looking", [True, False])
def test_making_a_machine_leaves_the_garbage_collector_as_it_was(
    monkeypatch: pytest.MonkeyPatch, looking: bool
) -> None:
    """It rests while nodes are made, and goes on after, also where making fails; a host that switched it off keeps it off."""
    asked: list[bool] = []

    def fails(_: object) -> Target:
        asked.append(gc.isenabled())
        raise RuntimeError("cannot be made")

    wrong = {"emitter": replace(ENTRIES["emitter"], maker=fails)}
    try:
        (gc.enable if looking else gc.disable)()
        load_target("emitter")
        assert gc.isenabled() is looking
        monkeypatch.setattr("safeloc.catalogue.ENTRIES", wrong)
        with pytest.raises(RuntimeError, match="cannot be made"):
            load_target("emitter")
        assert ([False], looking) == (asked, gc.isenabled())
    finally:
        gc.enable()


def test_a_machine_with_its_defaults_is_not_loaded_again_while_somebody_has_it(tmp_path: Path) -> None:
    """Neither one with other figures nor one that nobody has any more stands for it."""
    first = load_target("delocalized")
    path = tmp_path / "config.toml"
    path.write_text("", encoding="utf-8")
    assert load_target("delocalized", path) is not first
    assert with_defaults("delocalized") is first
    name = first.name
    del first
    gc.collect(1)  # the machine is young; to look through all objects of the tests takes a second
    again = with_defaults("delocalized")
    assert (name, None) == (again.name, again.config_file)
    assert with_defaults("delocalized") is again
