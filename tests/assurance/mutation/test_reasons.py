"""Written reasons why no proof needs to notice a mutant: read, told apart from open questions, and refused when they are stale."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from safeloc.assurance.mutation.choosing import MADE, chosen
from safeloc.assurance.mutation.composed_work import parts
from safeloc.assurance.mutation.declared import declared_of
from safeloc.assurance.mutation.members import composed
from safeloc.assurance.mutation.places import noted
from safeloc.assurance.mutation.reasons import Reasons, read_reasons, shipped_reasons
from safeloc.assurance.mutation.results import Of, Outcome, as_data, from_data
from safeloc.assurance.mutation.table import lines
from safeloc.catalogue import ENTRIES, load_target
from safeloc.errors import InputError
from safeloc.target import MODELS
from tests.assurance.mutation.shop import outcome

WHY = "The number of brakings is for people; nothing safe rests on it."


def _file(folder: Path, text: str) -> Path:
    path = folder / "brake.toml"
    path.write_text(text, encoding="utf-8")
    return path


def _entry(*ids: str, part: str = "machine", reason: str = WHY) -> str:
    return f'[[{part}]]\nmutants = [{", ".join(map(repr, ids))}]\nreason = "{reason}"\n'


def test_reasons_of_the_parts_that_are_looked_at(tmp_path: Path) -> None:
    """By id, of each part; several mutants may share one reason."""
    read = read_reasons(_file(tmp_path, _entry("brake-1", "brake-2") + _entry("brake-3", part="world")))
    assert {"brake-1": WHY, "brake-2": WHY} == read.of({"machine": {"brake-1", "brake-2", "brake-9"}})
    assert {"brake-3": WHY} == read.of({"world": {"brake-3"}})
    assert {} == Reasons().of({"machine": {"brake-1"}})


def test_a_reason_does_not_outlive_its_mutant(tmp_path: Path) -> None:
    """A reason for a mutant that there is no more is refused, also where that mutant would not be judged."""
    read = read_reasons(_file(tmp_path, _entry("brake-1")))
    with pytest.raises(InputError, match=r"brake\.toml: there is no mutant 'brake-1' of the machine any more"):
        read.of({"machine": {"brake-2"}})


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (_entry("brake-1") + _entry("brake-1"), "'brake-1' has two reasons; leave one"),
        (_entry(), "field machine.0.mutants: List should have at least 1 item"),
        (_entry("brake-1", reason="fine"), "field machine.0.reason: String should have at least 30 characters"),
        (_entry("brake-1", part="lemmas"), "field lemmas: Extra inputs are not permitted"),
        ("[[machine]\n", "not TOML"),
    ],
)
def test_what_is_no_file_of_reasons(tmp_path: Path, text: str, message: str) -> None:
    """Refused, with the field."""
    with pytest.raises(InputError, match=message):
        read_reasons(_file(tmp_path, text))


def test_no_such_file(tmp_path: Path) -> None:
    """Of a path that was handed over; a machine without a file has no reasons."""
    with pytest.raises(InputError, match="cannot be read"):
        read_reasons(tmp_path / "none.toml")
    assert Reasons() == shipped_reasons("no such machine")


def test_told_apart() -> None:
    """A survivor with a reason is listed with it, behind those without; a mutant that a proof notices needs none."""
    survived = outcome("update skipped", "brakings keeps its value")
    killed = outcome("comparison turned", "< becomes >", "'brakes'")
    other = replace(survived, id="brake-other", everywhere=Outcome("survived"))
    told = [
        *lines(
            "brake",
            [survived, killed, other],
            of=3,
            machine_only=False,
            reasons=dict.fromkeys([survived.id, killed.id], WHY),
        )
    ]
    assert "  no proof notices 2: 1 with a written reason, 1 without" in told
    assert f"  a reason that is no longer needed: {killed.id} is refuted by a run" in told
    first, last = told[-2:]
    assert "brake-other" in first and "REASON" not in first
    assert survived.id in last and last.endswith(f"REASON: {WHY}")


def test_data() -> None:
    """JSON has the reason of each, and lists what is open; a result is read back without it."""
    survived = outcome("update skipped", "brakings keeps its value")
    data = as_data("brake", [survived], of=1, seed=0, seconds=1.0, reasons={survived.id: WHY})
    assert ([], [], WHY) == (data["without_reason"], data["needless_reasons"], data["results"][0]["reason"])
    assert [survived.id] == as_data("brake", [survived], of=1, seed=0, seconds=1.0)["without_reason"]
    assert survived.id == from_data(data["results"][0]).id


SHIPPED = {path.name.removesuffix(".mutants.toml"): path for path in sorted(MODELS.rglob("*.mutants.toml"))}


@pytest.mark.parametrize("name", SHIPPED)
def test_what_ships_speaks_of_what_there_is(name: str) -> None:
    """Each file that ships stands in the folder of its machine, and each of its reasons is of a mutant of it."""
    assert MODELS / ENTRIES[name].folder == SHIPPED[name].parent
    reasons = shipped_reasons(name)
    assert str(SHIPPED[name]) == reasons.file
    with noted() as places:
        target = load_target(name)
    if target.system.parts:
        existing: dict[Of, frozenset[str]] = {
            "machine": parts(composed(target, places), places, most=1, seed=0).existing
        }
        assert reasons.of(existing)
    else:
        some = chosen(declared_of(target), places, [part for part in MADE if part in reasons.by_part], most=1, seed=0)
        assert reasons.of(some.existing)
