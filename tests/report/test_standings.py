"""Strips of several like parts: what each was, where, and whose it was."""

from __future__ import annotations

from functools import cache

import pytest

from safeloc.language.expr import TRUE, choice, enumeration, members, number
from safeloc.language.interpret import run
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.units import COUNT
from safeloc.railway.pictures import Standing, Standings, unreadable
from safeloc.report.recorded_run import Broken, RecordedRun
from safeloc.report.standings import standings_picture
from safeloc.reported import Reported
from tests.report.drawing_reader import across, begin, drawing, end, kinds, words

STATE = members("seat", "FREE", "TAKEN", "BROKEN")
PICTURE = Standings(
    "Seats", Reported(position="place", below="place", above="place", valid="always", truth=""),
    tuple(Standing(f"seat_{n}", f"whose_{n}") for n in (1, 2)), lambda number: f"P{number}",
)  # fmt: skip


@cache
def system() -> TransitionSystem:
    """Two seats that are what they are told to be."""
    seats = [choice(f"seat_{n}", enumeration(STATE)) for n in (1, 2)]
    whose = [number(f"whose_{n}", COUNT, 0, 99) for n in (1, 2)]
    given = [choice(f"given_seat_{n}", enumeration(STATE)) for n in (1, 2)]
    persons = [number(f"given_whose_{n}", COUNT, 0, 99) for n in (1, 2)]
    (only,) = modes("ONLY")
    return lower(
        Machine(
            "seats",
            modes=(only,),
            inputs=[*given, *persons],
            state={**dict.fromkeys(seats, STATE[0]), **dict.fromkeys(whose, 0)},
            outputs={"always": TRUE, "place": whose[0]},
            transitions=[
                Transition("told", only, only, TRUE, {**dict(zip(seats, given, strict=True)), **dict(zip(whose, persons, strict=True))}, rank=0)
            ],
        )
    )  # fmt: skip


def told(first: str, second: str, persons: tuple[int, ...] = (3,) * 10) -> RecordedRun:
    """A run over ten metres: letters F, T, B say what each seat is, metre by metre."""
    names = {"F": "FREE", "T": "TAKEN", "B": "BROKEN"}
    steps = [
        {"given_seat_1": names[a], "given_seat_2": names[b], "given_whose_1": who, "given_whose_2": 0}
        for a, b, who in zip(first, second, persons, strict=True)
    ]
    return RecordedRun("drive", run(system(), steps), tuple(1_000 * n for n in range(10)))


def test_each_part_has_its_strip() -> None:
    """Taken from 3 m to 7 m on the first seat, broken to the end on the second; in two rows."""
    of = drawing(standings_picture(PICTURE, told("FFFTTTTFFF", "FFFFFBBBBB")))
    place = across(of)
    (taken,), (broken,) = kinds(of, "TAKEN"), kinds(of, "BROKEN")
    assert (3, 7) == (round(place(begin(taken))), round(place(end(taken))))
    assert (5, 9) == (round(place(begin(broken))), round(place(end(broken))))
    assert float(str(taken.get("y"))) < float(str(broken.get("y")))


def test_whose_it_was_stands_beside_it() -> None:
    """Up to two names; of more the first and how many more; nobody has none."""
    everyone = drawing(standings_picture(PICTURE, told("T" * 10, "F" * 10, (3, 3, 0, 5, 5, 7, 7, 7, 7, 7))))
    assert "P3 and 2 more" in words(everyone)
    two = drawing(standings_picture(PICTURE, told("T" * 10, "F" * 10, (3,) * 5 + (5,) * 5)))
    assert "P3, P5" in words(two)


def test_what_occurs_is_in_the_legend() -> None:
    """With its number, once."""
    of = drawing(standings_picture(PICTURE, told("FFFTTTTFFF", "F" * 10)))
    assert [text for text in words(of) if text.endswith(("FREE", "TAKEN", "BROKEN")) and text[0].isdigit()] == [
        "1 FREE",
        "2 TAKEN",
    ]


def test_a_violated_statement_is_marked() -> None:
    """By name, at its place."""
    run_ = told("F" * 10, "F" * 10)
    of = drawing(
        standings_picture(PICTURE, RecordedRun(run_.name, run_.trace, run_.truth_mm, (Broken("nobody stands", 4),)))
    )
    assert any("violated at step 4: nobody stands" in text for text in words(of))


@pytest.mark.parametrize("gone", ["seat_1", "whose_2"])
def test_it_reads_what_the_machine_has(gone: str) -> None:
    """Names that the machine does not have are found."""
    assert not unreadable(PICTURE, system())
    rows = tuple(
        Standing(*(f"{name}x" if name == gone else name for name in (row.signal, row.called))) for row in PICTURE.rows
    )
    assert [f"no output or state '{gone}x'"] == unreadable(Standings("x", PICTURE.reported, rows), system())
