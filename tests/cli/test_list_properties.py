"""`safeloc list properties`: all, or those of some machines, of a requirement, or with a text."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from safeloc.assurance import property_choice
from safeloc.catalogue import ENTRIES, Target, load_target
from tests.cli.calling import DOOR, Call

Rows = list[dict[str, str]]


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Which machines were made, in order."""
    names: list[str] = []

    def load(name: str, config: Path | None = None) -> Target:
        names.append(name)
        return load_target(name, config)

    monkeypatch.setattr(property_choice, "load_target", load)
    return names


def rows(call: Call, *arguments: str) -> Rows:
    """What is listed, as data."""
    found: Rows = json.loads(call("list", "properties", *arguments, "--json").out)
    return found


def test_of_a_machine(call: Call, made: list[str]) -> None:
    """All its properties in their order; no other machine is made for it."""
    wanted = [prop.name for prop in load_target("delocalized").properties]
    assert [("delocalized", name) for name in wanted] == [
        (row["machine"], row["name"]) for row in rows(call, "--machine", "delocalized")
    ]
    assert made == ["delocalized"]


def test_of_several_machines(call: Call, made: list[str]) -> None:
    """In the order that was asked for, each once; one's own is among them."""
    found = rows(call, "--machine", "emitter", "--machine", DOOR, "--machine", "emitter")
    assert list(dict.fromkeys(row["machine"] for row in found)) == ["emitter", "door"]
    assert made == ["emitter", DOOR]


def test_those_of_all_are_kept(call: Call, made: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """A second list makes no machine, whatever it chooses; one of other source files makes all."""
    few = {name: ENTRIES[name] for name in ("emitter", "turn_off")}
    monkeypatch.setattr(property_choice, "ENTRIES", few)
    first = rows(call)
    assert made == ["emitter", "turn_off"]
    assert rows(call) == first == rows(call, "--machine", "emitter") + rows(call, "--machine", "turn_off")
    answers = rows(call, "--id", first[0]["requirements"].split()[0])
    assert 0 < len(answers) < len(first)
    assert made == ["emitter", "turn_off"] * 2
    monkeypatch.setattr(property_choice, "source_digest", lambda: "other")
    assert rows(call) == first
    assert made == ["emitter", "turn_off"] * 3
    monkeypatch.setattr(property_choice, "ENTRIES", {"emitter": few["emitter"]})
    assert {row["machine"] for row in rows(call)} == {"emitter"}


def test_that_answer_for_a_requirement(call: Call) -> None:
    """Exactly those that trace to it, however it is written; not those of a longer name that begins so."""
    machine = ("--machine", "odometry")
    every = rows(call, *machine)
    answers = [row for row in every if "MRK-1" in row["requirements"].split()]
    assert (
        0
        < len(answers)
        < len([row for row in every if "MRK-1" in row["requirements"] or "MRK-D1" in row["requirements"]])
    )
    assert answers == rows(call, *machine, "--id", "MRK-1") == rows(call, *machine, "--id", "mrk-1")


@pytest.mark.parametrize("text", ["true position", "TOLERANCE", "never wider"])
def test_that_say_a_text(call: Call, text: str) -> None:
    """In the name or in the statement, capital or small."""
    machine = ("--machine", "delocalized", "--machine", "supervised_odometry")
    every = rows(call, *machine)
    wanted = [row for row in every if text.lower() in row["name"].lower() or text.lower() in row["statement"].lower()]
    assert 0 < len(wanted) < len(every)
    assert wanted == rows(call, *machine, "--text", text)


def test_filters_are_joined(call: Call) -> None:
    """A property is listed if it passes all of them; as a line it stands as without filters."""
    called = call("list", "properties", "--machine", "odometry", "--id", "MRK-D1", "--text", "never wider")
    assert called.out.startswith("odometry  tolerance  MRK-D1  a reported interval is never wider")
    assert (0, 1) == (called.code, len(called.out.splitlines()))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["properties", "--machine", "emitter", "--text", "quark"],
            "safeloc: no property of emitter has 'quark' in its name or statement; `safeloc list properties` lists all.",
        ),
        (
            ["properties", "--machine", "emitter", "--machine", "delocalized", "--id", "XY-1", "--text", "quark"],
            "safeloc: no property of emitter, delocalized verifies requirement 'XY-1' and has 'quark' in its name",
        ),
        (["properties", "--machine", "odometri"], "no machine 'odometri'; there are odometry, "),
        (
            ["machines", "--text", "odometry"],
            "--id and --text filter properties and requirements, not machines",
        ),
        (
            ["lines", "--machine", "odometry"],
            "--machine chooses machines of which something is listed, and lines are not of a machine",
        ),
        (
            ["requirements", "--id", "FVA-44", "--text", "quark"],
            "safeloc: no requirement has the id 'FVA-44' and the text 'quark'. Did you mean",
        ),
    ],
)
def test_nothing_found_is_no_result(
    call: Call, monkeypatch: pytest.MonkeyPatch, arguments: list[str], message: str
) -> None:
    """What was asked for is told on standard error, and the exit code is that of no result, with --json as well."""
    monkeypatch.setenv("COLUMNS", "300")
    for more in ([], ["--json"]):
        called = call("list", *arguments, *more)
        assert (2, "") == (called.code, called.out)
        assert message in called.err


def test_a_machine_without_properties(call: Call, tmp_path: Path) -> None:
    """That it has none is told."""
    bare = tmp_path / "bare.py"
    bare.write_text(
        "from safeloc import Machine, Transition, boolean, modes\n"
        "A, B = modes('A', 'B')\ngo = boolean('go')\n"
        "machine = Machine('bare', (A, B), [go], {}, {}, [Transition('go', A, B, go)])\n",
        encoding="utf-8",
    )
    called = call("list", "properties", "--machine", f"{bare}:machine")
    assert (2, "") == (called.code, called.out)
    assert f"safeloc: no property of {bare}:machine is declared;" in called.err
