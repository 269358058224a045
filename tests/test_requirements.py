"""The catalogue of requirements: complete, and carried both ways by what ships."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path

import pytest

from safeloc import requirements as module
from safeloc.catalogue import ENTRIES, Target, load_target
from safeloc.errors import ModelError
from safeloc.requirements import Requirement, requirement, requirements

ROOT = Path(__file__).parents[1]
GIVEN = ROOT.parent / "shared" / "requirements.toml"
CLAIMS = {"MRK": 5, "RFL": 15, "FWG": 15, "FVA": 18, "SAT": 6}
DONE = [one for one in requirements() if one.status == "done"]


@cache
def targets() -> tuple[Target, ...]:
    """Every shipped machine with its default configuration."""
    return tuple(load_target(name) for name in ENTRIES)


def carried() -> Mapping[str, list[str]]:
    """Requirement id -> transitions that name it."""
    return _by_id(
        (name, f"{machine.name}: {t.name}")
        for target in targets()
        for machine in target.machines
        for t in machine.transitions
        for name in t.trace
    )


def answered() -> Mapping[str, list[str]]:
    """Requirement id -> properties that name it."""
    return _by_id(
        (name, f"{one.name}: {prop.name}") for one in targets() for prop in one.properties for name in prop.trace
    )


def _by_id(pairs: Iterable[tuple[str, str]]) -> Mapping[str, list[str]]:
    found: dict[str, list[str]] = {}
    for name, what in pairs:
        found.setdefault(name, []).append(what)
    return found


def test_no_id_is_missing() -> None:
    """Ids, kinds and machines are those of the list that the project was given."""
    if not GIVEN.is_file():
        pytest.skip("the list that the project was given is not beside this checkout")
    rows = tomllib.loads(GIVEN.read_text(encoding="utf-8"))["requirement"]
    given = {row["id"]: (row["kind"], row["machine"]) for row in rows}
    assert {one.id: (one.kind, one.machine) for one in requirements()} == given


def test_every_claim_is_there() -> None:
    """74 entries; the claims of each publication are numbered without a gap."""
    assert len(requirements()) == 74
    claims = {one.id for one in requirements() if one.kind == "claim"}
    assert claims == {f"{family}-{number}" for family, count in CLAIMS.items() for number in range(1, count + 1)}


def test_sources_are_named() -> None:
    """Each entry names the publication of its family."""
    sources = {one.id.partition("-")[0]: one.source for one in requirements()}
    assert sources["MRK"] == "ES 2 745 492 T3 / EP 3 237 266"
    assert len(set(sources.values())) == len(CLAIMS)


@pytest.mark.parametrize("one", DONE, ids=[one.id for one in DONE])
def test_done_is_carried_and_answered(one: Requirement) -> None:
    """What is done is carried by a transition and answered by a property, or by a test that is named."""
    assert one.carried_by or carried().get(one.id), "no transition carries it"
    assert one.carried_by or answered().get(one.id), "no property answers for it"


@pytest.mark.parametrize("one", [o for o in requirements() if o.carried_by], ids=lambda one: str(one.id))
def test_named_tests_exist(one: Requirement) -> None:
    """`carried_by` begins with the path of a test file that exists."""
    path = ROOT / one.carried_by.partition(" (")[0]
    assert path.is_file()
    assert path.name.startswith("test_")


def test_traces_are_known() -> None:
    """Every id on a shipped transition or property is in the catalogue, and is not one that is only planned."""
    used = carried().keys() | answered().keys()
    assert used <= {one.id for one in DONE}
    assert {"MRK-1", "MRK-D1"} <= used


def test_everything_shipped_is_traced() -> None:
    """Every shipped transition and property says which requirement it is there for."""
    without = [f"{m.name}: {t.name}" for one in targets() for m in one.machines for t in m.transitions if not t.trace]
    without += [f"{one.name}: {prop.name}" for one in targets() for prop in one.properties if not prop.trace]
    assert without == []


def test_done_machines_ship() -> None:
    """A requirement is done only of a machine that ships."""
    assert {one.machine for one in DONE} <= set(ENTRIES)


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
