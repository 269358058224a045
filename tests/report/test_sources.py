"""Sources over time: a band for each, where nothing is stated, who leads, and a table of what was rejected."""

from __future__ import annotations

from functools import cache

from safeloc.language.expr import Bool, Lit, Num, Var, boolean, choice, enumeration, members, number
from safeloc.language.interpret import run
from safeloc.language.machine import Any_, Machine, Transition, modes
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.units import MM
from safeloc.railway.pictures import NamedInterval, Refusals, Sources, unreadable
from safeloc.report.recorded_run import RecordedRun
from safeloc.report.refusals import refusals_table
from safeloc.report.sources import sources_picture
from safeloc.reported import Reported
from tests.report.drawing_reader import drawing, kinds, words

VERDICT = members("verdict", "NONE", "TOO_LATE", "CONTRADICTION")
WHO = members("who", "NONE", "RADAR", "BALISE")
ONLY_INTERVAL = Reported(position="place_mm", below="margin_mm", above="margin_mm", valid="valid", truth="")
PICTURE = Sources(
    "Sources", 100, ONLY_INTERVAL, "lead", (NamedInterval("radar", ONLY_INTERVAL),),
    refusals=(Refusals("radar", "verdict", ("NONE",), ("lead",)),),
)  # fmt: skip


@cache
def system() -> TransitionSystem:
    """A machine that says what it is told."""
    said = [number("place_mm", MM, 0, 99_000), number("margin_mm", MM, 0, 9_000)]
    said += [choice("verdict", enumeration(VERDICT)), choice("lead", enumeration(WHO))]
    told = [number("given_place", MM, 0, 99_000), number("given_margin", MM, 0, 9_000)]
    verdict, lead, valid = choice("v", enumeration(VERDICT)), choice("l", enumeration(WHO)), boolean("ok")
    state = boolean("valid")
    (only,) = modes("ONLY")
    copied: dict[Var, Num | Bool | int | bool] = dict(zip((*said, state), (*told, verdict, lead, valid), strict=True))
    first: dict[Var, int | bool | Lit | Any_] = {
        said[0]: 0,
        said[1]: 0,
        said[2]: VERDICT[0],
        said[3]: WHO[0],
        state: False,
    }
    return lower(
        Machine(
            "copy", modes=(only,), inputs=[*told, verdict, lead, valid], state=first, outputs={"valid": state, "place_mm": said[0], "margin_mm": said[1]},
            transitions=[Transition("told", only, only, set=copied, rank=0)],
        )
    )  # fmt: skip


def told(verdicts: str) -> RecordedRun:
    """A step of 0.1 s for each letter: . nothing refused, L too late, C contradiction, and then nothing is stated."""
    names = {".": "NONE", "L": "TOO_LATE", "C": "CONTRADICTION"}
    steps = [
        {"given_place": 1_000 * n, "given_margin": 3_000, "v": names[one], "l": "RADAR" if one == "C" else "NONE", "ok": one != "C"}
        for n, one in enumerate(verdicts)
    ]  # fmt: skip
    return RecordedRun("drive", run(system(), steps), tuple(1_000 * n for n in range(len(verdicts))))


def test_every_rejection_is_a_row() -> None:
    """From when to when, where, of what, and why; who else is named stands with it."""
    rows = refusals_table(PICTURE, told("..LL..C..L"))["rows"]
    assert [
        ["0.2", "0.4", "2", "radar", "verdict", "TOO_LATE"],
        ["0.6", "0.7", "6", "radar", "verdict", "CONTRADICTION: RADAR"],
        ["0.9", "1", "9", "radar", "verdict", "TOO_LATE"],
    ] == rows


def test_intervals_are_bands_and_silence_is_a_box() -> None:
    """An interruption is a box in each of the rows; each refusal has its mark."""
    of = drawing(sources_picture(PICTURE, told("..LL..C..L")))
    assert (2, 3) == (len(kinds(of, "silent")), len(kinds(of, "refused")))
    assert "+3 m" in words(of)


def test_a_run_without_any_place_has_no_picture() -> None:
    """Nothing stated and no truth: nothing is drawn."""
    silent = told("CCC")
    assert not sources_picture(PICTURE, RecordedRun("drive", silent.trace, (None,) * 3))


def test_it_reads_what_the_machine_has() -> None:
    """Names that the machine does not have are found."""
    assert not unreadable(PICTURE, system())
    wrong = Sources("x", 100, ONLY_INTERVAL, "leads", ())
    assert ["no output or state 'leads'"] == unreadable(wrong, system())
