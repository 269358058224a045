"""The catalogue of requirements: complete, and carried both ways by what ships."""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path

import pytest

from safeloc.assurance import requirements as module
from safeloc.assurance.requirements import Requirement, requirement, requirements, traceability
from safeloc.catalogue import ENTRIES, Target
from safeloc.errors import ModelError
from safeloc.language.expr import boolean
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import always
from safeloc.language.system import lower
from tests.shipped import shipped

ROOT = Path(__file__).parents[2]
GIVEN = ROOT.parent / "shared" / "requirements.toml"
CLAIMS = {"MRK": 5, "RFL": 15, "FWG": 15, "FVA": 18, "SAT": 6}
"""Of each publication that the project was given, how many claims it has. A machine with a source of its own adds ids of its own."""
DONE = [one for one in requirements() if one.status == "done"]


def published() -> list[Requirement]:
    """The entries of the publications that the project was given."""
    return [one for one in requirements() if one.id.partition("-")[0] in CLAIMS]


@cache
def targets() -> tuple[Target, ...]:
    """Every shipped machine with its default configuration."""
    return tuple(shipped(name) for name in ENTRIES)


def test_no_id_is_missing() -> None:
    """Ids, kinds and machines are those of the list that the project was given."""
    if not GIVEN.is_file():
        pytest.skip("the list that the project was given is not beside this checkout")
    rows = tomllib.loads(GIVEN.read_text(encoding="utf-8"))["requirement"]
    given = {row["id"]: (row["kind"], row["machine"]) for row in rows}
    assert {one.id: (one.kind, one.machine) for one in published()} == given


def test_every_claim_is_there() -> None:
    """74 entries of the given publications; the claims of each are numbered without a gap."""
    assert len(published()) == 74
    claims = {one.id for one in published() if one.kind == "claim"}
    assert claims == {f"{family}-{number}" for family, count in CLAIMS.items() for number in range(1, count + 1)}


def test_sources_are_named() -> None:
    """Each entry names the publication of its family, and no two families name the same."""
    sources = {one.id.partition("-")[0]: one.source for one in requirements()}
    assert sources["MRK"] == "ES 2 745 492 T3 / EP 3 237 266"
    assert set(CLAIMS) <= set(sources)
    assert len(set(sources.values())) == len(sources)


@pytest.mark.parametrize("one", [o for o in requirements() if o.carried_by], ids=lambda one: str(one.id))
def test_named_tests_exist(one: Requirement) -> None:
    """`carried_by` begins with the path of a test file that exists."""
    path = ROOT / one.carried_by.partition(" (")[0]
    assert path.is_file()
    assert path.name.startswith("test_")


# ------------------------------------------------------------------ both ways


def test_nothing_is_untraced() -> None:
    """What is done is carried by a transition and shown by a property, or by a named test; what ships says why."""
    assert traceability(targets()).gaps == ()


def test_the_two_ways_agree() -> None:
    """A requirement lists exactly the transitions and properties that name it."""
    found = traceability(targets())
    there = {(link.requirement.id, label) for link in found.links for label in (*link.transitions, *link.properties)}
    back = {(name, item.label) for item in found.items for name in item.requirements}
    assert there == back
    assert ("MRK-D1", "odometry: tolerance exceeded") in there


def test_a_machine_in_two_targets_is_traced_once() -> None:
    """The odometry machine alone and with its guard behind it is one machine; properties belong to each target."""
    items = traceability(targets()).items
    assert len(items) == len(set(items))
    labels = [item.label for item in items if item.name in ("tolerance exceeded", "containment")]
    assert labels.count("odometry: tolerance exceeded") == 1
    assert {"odometry: containment", "supervised_odometry: containment"} <= set(labels)


ON, OFF = modes("ON", "OFF")
GO = boolean("go")


def lamp(carries: tuple[str, ...], shows: tuple[str, ...]) -> Target:
    """A machine of one transition and one property with these ids."""
    machine = Machine("lamp", (ON, OFF), [GO], {}, {}, [Transition("go", ON, OFF, GO, requirements=carries)])
    return Target("lamp", (machine,), lower(machine), (always("off", machine.mode.eq(OFF), requirements=shows),))


@pytest.mark.parametrize(
    ("carries", "shows", "gaps"),
    [
        (("A-1",), ("A-1",), ()),
        ((), ("A-1",), ("A-1: no transition implements it", "transition lamp: go: names no requirement")),
        (("A-1",), (), ("A-1: no property verifies it", "property lamp: off: names no requirement")),
        (("A-1", "A-2"), ("A-1",), ("transition lamp: go: A-2 is planned",)),
        (("A-1",), ("A-1", "A-9"), ("property lamp: off: A-9 is no requirement",)),
    ],
)
def test_every_gap_is_told(
    carries: tuple[str, ...], shows: tuple[str, ...], gaps: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A-1 is done, A-2 planned, A-3 done and answered by a named test."""
    catalogue = (
        Requirement("A-1", "claim", "lamp", "done", "t", "s"),
        Requirement("A-2", "claim", "lamp", "planned", "t", "s"),
        Requirement("A-3", "claim", "lamp", "done", "t", "s", "tests/test_lamp.py"),
    )
    monkeypatch.setattr(module, "requirements", lambda: catalogue)
    assert traceability([lamp(carries, shows)]).gaps == gaps


def test_done_machines_ship() -> None:
    """A requirement is done only of a machine that ships; the line, which is no machine, is answered by named tests."""
    assert {one.machine for one in DONE if not one.carried_by} <= set(ENTRIES)
    assert {"line"} >= {one.machine for one in DONE} - set(ENTRIES)


def test_one_by_id() -> None:
    """An entry is found by its id; an unknown one is an error that names it."""
    assert requirement("MRK-D5").text.startswith("Worked figures")
    with pytest.raises(KeyError, match="MRK-99"):
        requirement("MRK-99")


HEAD = '[sources]\nMRK = { publication = "P" }\n'
ROW = '[[requirement]]\nid = "{id}"\nkind = "claim"\nmachine = "m"\nstatus = "{status}"\ntext = "{text}"\n'


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ([("XYZ-1", "done", "t")], "XYZ-1 has no source"),
        ([("MRK-1", "soon", "t")], "unknown status"),
        ([("MRK-1", "done", " ")], "no text"),
        ([("MRK-1", "done", "t"), ("MRK-1", "planned", "u")], "ids are not distinct"),
    ],
)
def test_a_wrong_file_is_refused(
    rows: list[tuple[str, str, str]], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No source, an unknown status, no text, an id given twice: the error says which."""
    path = tmp_path / "requirements.toml"
    path.write_text(HEAD + "".join(ROW.format(id=i, status=s, text=t) for i, s, t in rows), encoding="utf-8")
    monkeypatch.setattr(module, "FILE", path)
    with pytest.raises(ModelError, match=message):
        requirements.__wrapped__()
