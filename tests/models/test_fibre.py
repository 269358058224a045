"""Place from localization sections: counting, the code, the error signal, and that nothing of it can be left out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import pytest
from pydantic import ValidationError

from safeloc.language.expr import FALSE, TRUE, Bool, Num, abs_, as_num, ite
from safeloc.language.monitor import check_all
from safeloc.language.spec import Property
from safeloc.language.system import lower
from safeloc.language.trace import Trace
from safeloc.language.units import COUNT, NM
from safeloc.language.verdict import Violated
from safeloc.models.fibre import Fibre, FibreConfig, build, parts
from safeloc.models.fibre import variables as v
from safeloc.models.fibre.code import Symbol
from safeloc.models.fibre.cycle import Cycle
from safeloc.models.fibre.simulate import Drive, Section, simulate, steady
from safeloc.properties.fibre import properties
from tests.models.everything_proved import unproved_of
from tests.models.fibre_family import labels, mode_labels, replayed
from tests.models.inductive import changed, inductive

CONFIG = FibreConfig()
RAISED = Section(1_000_000, 1_300_000, Symbol(rises=True, long=True))
LOWERED = Section(1_000_000, 1_300_000, Symbol(rises=False, long=True))


@cache
def made() -> Fibre:
    """The machine with its variables."""
    return build(parts(CONFIG))


def driven(drive: Drive, *sections: Section, seed: int = 1) -> Trace:
    """The machine on a simulated run; it holds its properties and, while located, the truth."""
    steps = simulate(CONFIG, seed=seed, drive=drive, sections=sections or None)
    trace = replayed(lower(made().machine), steps)
    assert not [one for one in check_all(trace, properties(made())) if isinstance(one, Violated)]
    for step, seen in zip(steps, trace.steps, strict=True):
        if seen.outputs["valid"]:
            off = int(step["truth_mm"]) - seen.outputs["position_mm"]
            assert -seen.outputs["margin_below_mm"] <= off <= seen.outputs["margin_above_mm"]
    return trace


@pytest.mark.parametrize("section", [RAISED, LOWERED], ids=["raised, figs. 2 to 4", "lowered, figs. 7 to 9"])
def test_one_section(section: Section) -> None:
    """One signal where the amplitude leaves normal; the return to normal is no second one."""
    events = labels(driven(Drive(steady(30_000, 110)), section), "section_event")
    assert [one for one in events if one != "NONE"] == ["POSITION_SIGNAL", "PASSED"]


def test_code_without_counting() -> None:
    """Fig. 5: started anywhere, the place is told after as many sections as a word has, and not before."""
    trace = driven(Drive(steady(40_000, 400), referred=False))
    found = mode_labels(made().machine, trace).index("LOCATED")
    assert labels(trace, "section_event")[:found].count("PASSED") == CONFIG.window
    assert trace.steps[found].outputs["count"] == CONFIG.window


def test_count_is_undefined_before_the_first_signal() -> None:
    """The count begins with the first signal, although the reference tells the place before."""
    trace = driven(Drive(steady(30_000, 110)), RAISED)
    known = [one.outputs["count_known"] for one in trace.steps]
    assert known.index(True) == labels(trace, "section_event").index("POSITION_SIGNAL")


def test_running_back_counts_down() -> None:
    """Out past two sections and back again: the count rises to two and falls to none."""
    trace = driven(Drive((*steady(30_000, 170), *steady(-30_000, 160))))
    counts = [one.outputs["count"] for one in trace.steps]
    assert (max(counts), counts[-1]) == (2, 0)
    assert mode_labels(made().machine, trace)[-1] == "LOCATED"


def test_turning_within_a_section() -> None:
    """A section left on the side it was entered is uncounted."""
    trace = driven(Drive((*steady(20_000, 105), *steady(-20_000, 40))), RAISED)
    events = [one for one in labels(trace, "section_event") if one != "NONE"]
    assert events == ["POSITION_SIGNAL", "TURNED_BACK"]
    assert trace.steps[-1].outputs["count"] == 0


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(
    ("drive", "reason"),
    [
        (Drive(steady(30_000, 200), missed=(2,)), "MISSED_SECTION"),
        (Drive(steady(30_000, 120), false_mm=(1_600_000,)), "FALSE_SECTION"),
        (Drive(steady(30_000, 120), flight_off_mm=90_000), "FLIGHT_DIFFERS"),
        (Drive(steady(30_000, 120), flight_off_mm=None, points_mm=(1_000_000,)), "LOCATED"),
    ],
    ids=["missed", "false", "time of flight drifts", "reflecting point agrees"],
)
def test_error_signal(drive: Drive, reason: str) -> None:
    """F comes with its reason, and stays; where all agrees there is none."""
    trace = driven(drive)
    assert labels(trace, "reason")[-1] == reason
    assert trace.steps[-1].outputs["error"] is (reason != "LOCATED")


def test_a_section_of_another_length() -> None:
    """Where the map has a short section and a long one is passed, F is out at its end."""
    steps = simulate(CONFIG, seed=1, drive=Drive(steady(30_000, 110)), sections=[RAISED])
    told = [{**step, "ahead_long": False} for step in steps]
    assert labels(replayed(lower(made().machine), told), "reason")[-1] == "WRONG_LENGTH"


def test_a_silent_pattern_is_lost() -> None:
    """Without a run for longer than permitted nothing is located."""
    steps = simulate(CONFIG, seed=1, drive=Drive(steady(30_000, 40)), sections=[RAISED])
    for step in steps[20:30]:
        del step["run_mm"]
    trace = replayed(lower(made().machine), steps)
    assert labels(trace, "reason")[20 + CONFIG.gap_limit_cycles - 1 : 20 + CONFIG.gap_limit_cycles + 1] == [
        "LOCATED",
        "SILENT",
    ]


@pytest.mark.thorough
def test_everything_is_proved() -> None:
    """All properties and lemmas, without bound."""
    assert unproved_of(made().machine, properties(made())) == {}


def _named(name: str, wrong: Fibre | None = None) -> Property:
    return next(prop for prop in properties(wrong or made()) if prop.name == name)


@pytest.mark.parametrize(
    ("row", "fields", "broken"),
    [
        ("error", {"when": FALSE}, "disagreement raises F"),
        ("error", {"when": FALSE}, "time of flight off the section raises F"),
        ("error", {"when": FALSE}, "missed section raises F at once"),
        ("section left again", {"set": {}}, "a section left again is uncounted"),
        ("section counted", {"set": {}}, "containment"),
        ("run on", {"set": {}}, "containment"),
        ("code word found", {"when": TRUE}, "a code word is complete"),
        ("error stays", {"target": "LOCATED"}, "F is latched"),
    ],
)
def test_a_broken_row_is_noticed(row: str, fields: dict[str, object], broken: str) -> None:
    """A row without its guard, its updates or its target loses a proof."""
    modes = {mode.label: mode for mode in made().machine.modes}
    given = {name: modes.get(value, value) if isinstance(value, str) else value for name, value in fields.items()}
    wrong = replace(made(), machine=changed(made().machine, row, **given))
    assert not inductive(wrong.machine, _named(broken, wrong))


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"return_cdb": 700}, "hysteresis"),
        ({"long_mm": 200_000}, "farther apart"),
        ({"short_mm": 100_000}, "farther apart"),
    ],
)
def test_configurations_that_cannot_tell_are_refused(fields: dict[str, int], message: str) -> None:
    """Lengths within each other's tolerance, or no hysteresis, are refused."""
    with pytest.raises(ValidationError, match=message):
        FibreConfig(**fields)


# ------------------------------------------------------------------ wrong edits of what several rows are made of


def _no_fall(cycle: Cycle) -> Num:
    """A fall of the amplitude is never noticed."""
    raised = cycle.own.amplitude.present & (cycle.own.amplitude.value >= CONFIG.change_cdb)
    return ite(raised, v.RAISED, v.NORMAL)


def _swapped(cycle: Cycle) -> Num:
    """Rise and fall taken for one another."""
    value = cycle.own.amplitude.value
    return ite(value >= CONFIG.change_cdb, v.LOWERED, ite(value <= -CONFIG.change_cdb, v.RAISED, v.NORMAL))


def _missed_ahead_only(cycle: Cycle) -> Bool:
    """A missed section is not noticed while running down."""
    reach = CONFIG.read_tolerance_mm + cycle.slack
    beyond = cycle.own.ahead.known & (cycle.place - reach > cycle.own.ahead.near)
    return cycle.own.band.eq(v.NORMAL) & ~cycle.enters & beyond


EDITS: list[tuple[str, Callable[[Cycle], object], str]] = [
    ("band", _no_fall, "the band follows the amplitude"),
    ("band", _no_fall, "a rise or a fall is a signal"),
    ("band", _swapped, "the band follows the amplitude"),
    ("overdue", _missed_ahead_only, "missed section raises F at once"),
    ("one", lambda cycle: ite(cycle.own.forwards, as_num(1, COUNT), as_num(1, COUNT)), "every signal counts by direction"),
    ("forwards", lambda cycle: cycle.own.forwards, "direction and silence are followed"),
    ("added_error", lambda cycle: as_num(0, NM), "every run adds its error"),
    ("fresh", lambda cycle: cycle.added_error, "an edge adds the run of its cycle to the error"),
    ("since", lambda cycle: cycle.own.run_since_edge, "every run adds its error"),
    ("silent", lambda cycle: ~cycle.own.run.present & (cycle.own.silent_cycles > 3) & cycle.own.counted, "a pattern that is lost has no place"),
    ("too_wide", lambda cycle: cycle.drift > 10**12, "a pattern that is lost has no place"),
    ("reads_long", lambda cycle: abs_(cycle.inside) > CONFIG.short_mm, "the code word consists of the sections read"),
    ("reads_short", lambda cycle: ~cycle.reads_long, "wrong length raises F"),
    ("turned_back", lambda cycle: cycle.inside < 0, "wrong length raises F"),
    ("endless", lambda cycle: abs_(cycle.own.run_since_edge) > CONFIG.long_mm * 3, "endless section raises F at once"),
    ("fits", lambda cycle: cycle.own.ahead.known & ~cycle.full, "false section raises F at once"),
    ("wrong_length", lambda cycle: cycle.leaves & ~cycle.turned_back & ~cycle.read, "wrong length raises F"),
    ("flight_differs", lambda cycle: cycle.own.flight_position.value > cycle.place + 400_000, "time of flight raises F at once"),
    ("reflection_differs", lambda cycle: cycle.own.reflecting_point.value > cycle.place, "reflecting point raises F at once"),
]  # fmt: skip


def lacking(claim: str) -> bool:
    """Whether the machine, as it is at present, does not keep a claim."""
    model = build(parts(CONFIG))
    return not inductive(model.machine, _named(claim, model))


@pytest.mark.thorough(ordinary=8)
@pytest.mark.parametrize(("name", "wrong", "broken"), EDITS, ids=[f"{name}: {broken}" for name, _, broken in EDITS])
def test_a_wrong_term_is_noticed(
    name: str, wrong: Callable[[Cycle], object], broken: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A fall that is never noticed, a section missed while running down, an added error that is forgotten: each loses a proof."""
    monkeypatch.setattr(Cycle, name, property(wrong))
    assert lacking(broken)


@pytest.mark.thorough(ordinary=6)
@pytest.mark.parametrize("claim", sorted({broken for *_, broken in EDITS}))
def test_the_right_machine_keeps_it(claim: str) -> None:
    """What wrong edits lose, the machine as it ships has."""
    assert not lacking(claim)
