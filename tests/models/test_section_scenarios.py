"""Known situations of virtual sections, step by step, with borders that count and with borders that report occupancy alone.

Area of 10 km with four sections; U, F, O, A: UNKNOWN, FREE, OCCUPIED, AMBIGUOUS. At the start the area is clear. The table in
docs/sections.md says where these states differ from the published rules for virtual sub-sections, and why.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from safeloc.errors import InputError
from safeloc.language.interpret import run
from safeloc.language.monitor import check_all
from safeloc.language.trace import Trace
from safeloc.language.verdict import Held
from safeloc.models.area import AreaConfig
from safeloc.models.sections import Sections, SectionsConfig, compose_machines
from safeloc.models.sections.simulate import FollowerRun, Scene, TrainRun, first_state, simulate
from safeloc.properties.sections import properties

CUTS = ((0, 2_500_000), (2_500_001, 5_000_000), (5_000_001, 7_500_000), (7_500_001, 10_000_000))
TRAIN = TrainRun(1, 20, 200_000, ((0, 40_000),))
"A train that is in the four sections at 20, 83, 145 and 208 s, and out at 276 s."
SECOND = replace(TRAIN, slot=2)
NEVER = ((0, 10_000),)
"A train that is counted in, and never reports."


@dataclass(frozen=True)
class Situation:
    """Trains, and the states of the four sections at each of the times, s, in each of the four settings.

    not_counted  a vehicle that tells nothing: without counting it comes in unseen, and is counted into slot 2 otherwise
    """

    at: tuple[int, ...]
    states: tuple[str, str, str, str]
    trains: tuple[TrainRun, ...] = ()
    not_counted: FollowerRun | None = None
    disturbed: tuple[tuple[int, int], ...] = field(default=())


SITUATIONS: dict[str, Situation] = {
    "one whole train": Situation(
        (10, 30, 100, 160, 230, 290),
        (
            "FFFF OFFF FOFF FFOF FFFO FFFF",
            "FFFF OFFF AAFF AAAF AAAA FFFF",
            "FFFF AFFF UAFF UUAF UUUA FFFF",
            "FFFF AFFF AAFF AAAF AAAA FFFF",
        ),
        (TRAIN,),
    ),
    "a train that splits": Situation(
        (30, 60, 100, 160, 230, 290),
        (
            "OFFF OFFF AAFF AAAF AAAA AAAA",
            "OFFF AFFF AAFF AAAF AAAA AAAA",
            "AFFF AFFF AAFF AAAF AAAA AAAA",
            "AFFF AFFF AAFF AAAF AAAA AAAA",
        ),
        (replace(TRAIN, splits_s=50, left_behind_mm=100_000),),
    ),
    "a shadow train": Situation(
        (30, 60, 100, 160, 230, 290),
        (
            "OFFF AFFF UAFF UUAF UUUA UUUU",
            "OFFF AFFF AAFF AAAF AAAA UUUU",
            "AFFF AFFF UAFF UUAF UUUA UUUU",
            "AFFF AFFF AAFF AAAF AAAA UUUU",
        ),
        (TRAIN,),
        FollowerRun(28, 20_000, ((0, 40_000), (60, 0))),
    ),
    "a ghost train": Situation(
        (10, 30, 100, 160, 230),
        (
            "FFFF UFFF UUFF UUUF UUUU",
            "FFFF UFFF UUFF UUUF UUUU",
            "FFFF UFFF UUFF UUUF UUUU",
            "FFFF UFFF UUFF UUUF UUUU",
        ),
        (),
        FollowerRun(20, 20_000, ((0, 10_000), (50, 0))),
    ),
    "a train that is silent and comes back": Situation(
        (30, 45, 60, 100, 130, 290),
        (
            "OFFF UFFF UFFF UUFF FOFF FFFF",
            "OFFF UFFF UFFF UUFF AAFF FFFF",
            "AFFF UFFF UFFF UUFF UAFF FFFF",
            "AFFF UFFF UFFF UUFF AAFF FFFF",
        ),
        (replace(TRAIN, withheld=((40, 110),)),),
    ),
    "two trains close behind one another": Situation(
        (30, 60, 100, 160, 230, 290, 340),
        (
            "OFFF OFFF OOFF FOOF FFOO FFFO FFFF",
            "OFFF AFFF AAFF AAAF AAAA AAAA FFFF",
            "AFFF AFFF AAFF UAAF UUAA UUUA FFFF",
            "AFFF AFFF AAFF AAAF AAAA AAAA FFFF",
        ),
        (TRAIN, replace(SECOND, enters_s=40)),
    ),
    "a sweep": Situation(
        (10, 30, 100, 160, 230, 290),
        (
            "UUUU AUUU FAUU FFAU FFFA FFFF",
            "UUUU AUUU AAUU AAAU AAAA FFFF",
            "UUUU AUUU UAUU UUAU UUUA FFFF",
            "UUUU AUUU AAUU AAAU AAAA FFFF",
        ),
        (TRAIN,),
        None,
        ((5, 20),),
    ),
}


INNER = ((0, 5_000_000), (5_000_001, 10_000_000))
"Detection inside the area, in two halves: an inner border between the second and the third section."
SETTINGS = (("counted", True), ("counted", False), ("occupancy", True), ("occupancy", False))
"Borders, and whether a report of integrity is trusted."


BY_HALVES: dict[str, tuple[str, str, str, str]] = {
    "one whole train": (
        "FFFF OFFF FOFF FFOF FFFO FFFF",
        "FFFF OFFF AAFF FFAF FFAA FFFF",
        "FFFF AFFF UAFF FFAF FFUA FFFF",
        "FFFF AFFF AAFF FFAF FFAA FFFF",
    ),
    "a train that splits": (
        "OFFF OFFF AAFF AAAF AAAA AAFF",
        "OFFF AFFF AAFF AAAF AAAA AAFF",
        "AFFF AFFF AAFF AAAF AAAA AAFF",
        "AFFF AFFF AAFF AAAF AAAA AAFF",
    ),
    "a shadow train": (
        "OFFF AFFF UAFF UUAF UUUA UUFF",
        "OFFF AFFF AAFF AAAF AAAA UUFF",
        "AFFF AFFF UAFF UUAF UUUA UUFF",
        "AFFF AFFF AAFF AAAF AAAA UUFF",
    ),
    "a ghost train": (
        "FFFF UFFF UUFF UUFF UUFF",
        "FFFF UFFF UUFF UUFF UUFF",
        "FFFF UFFF UUFF UUFF UUFF",
        "FFFF UFFF UUFF UUFF UUFF",
    ),
    "a train that is silent and comes back": (
        "OFFF UFFF UFFF UUFF FOFF FFFF",
        "OFFF UFFF UFFF UUFF AAFF FFFF",
        "AFFF UFFF UFFF UUFF UAFF FFFF",
        "AFFF UFFF UFFF UUFF AAFF FFFF",
    ),
    "two trains close behind one another": (
        "OFFF OFFF OOFF FOOF FFOO FFFO FFFF",
        "OFFF AFFF AAFF AAAF FFAA FFAA FFFF",
        "AFFF AFFF AAFF UAAF FFAA FFUA FFFF",
        "AFFF AFFF AAFF AAAF FFAA FFAA FFFF",
    ),
    "a sweep": (
        "UUFF AUFF FAFF FFAU FFFA FFFF",
        "UUFF AUFF AAFF FFAU FFAA FFFF",
        "FFFF AUFF UAFF FFAU FFUA FFFF",
        "FFFF AUFF AAFF FFAU FFAA FFFF",
    ),
}
"The states of the same situations with detection in both halves."


@cache
def model(borders: str, *, trusted: bool, inner: int = 0) -> Sections:
    """Area and four sections; `inner=2` detects in both halves of the area."""
    kind: Any = borders
    area = AreaConfig(trains=2, borders=kind, integrity_is_trusted=trusted, inner_detection=inner)
    return compose_machines(SectionsConfig(area=area, sections=4))


def scene(what: Situation, borders: str) -> Scene:
    """The situation, its vehicle that tells nothing counted or not."""
    trains, follower = what.trains, what.not_counted
    if borders == "counted" and follower is not None:
        trains = (*trains, TrainRun(2, follower.comes_s, follower.length_mm, follower.speeds, NEVER))
    return Scene(
        (0, 10_000_000),
        CUTS,
        trains,
        max(what.at) + 1,
        disturbed=what.disturbed,
        clear=(3,) if borders == "counted" else (),
        follower=follower if borders == "occupancy" else None,
    )


def seen(what: Situation, setting: tuple[str, bool]) -> Trace:
    """The run, in which every claim holds and every law is kept."""
    return _ran(model(setting[0], trusted=setting[1]), scene(what, setting[0]))


def seen_by_halves(what: Situation, setting: tuple[str, bool]) -> Trace:
    """The same, with detection in both halves of the area."""
    return _ran(model(setting[0], trusted=setting[1], inner=2), replace(scene(what, setting[0]), inner_mm=INNER))


def _ran(one: Sections, place: Scene) -> Trace:
    steps = simulate(SectionsConfig(area=one.area.own.config, sections=4), place, seed=3)
    trace = run(one.composition.system, steps, first=first_state(place))
    assert [] == [verdict for verdict in check_all(trace, properties(one)) if not isinstance(verdict, Held)]
    return trace


def states(trace: Trace, second: int) -> str:
    """The four sections after a second."""
    table = model(SETTINGS[0][0], trusted=SETTINGS[0][1]).sections[0].machine.modes
    return "".join(table[int(trace.steps[second].state[f"section_{n}.mode"])].label[0] for n in range(1, 5))


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("number", range(4), ids=[f"{borders}, {trusted}" for borders, trusted in SETTINGS])
@pytest.mark.parametrize("name", SITUATIONS)
def test_a_known_situation(name: str, number: int) -> None:
    """State after state is as the table says."""
    what = SITUATIONS[name]
    trace = seen(what, SETTINGS[number])
    assert what.states[number] == " ".join(states(trace, second) for second in what.at)


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("number", range(4), ids=[f"{borders}, {trusted}" for borders, trusted in SETTINGS])
@pytest.mark.parametrize("name", BY_HALVES)
def test_a_known_situation_with_detection_inside(name: str, number: int) -> None:
    """A half that is clear is FREE, and what comes in uncounted does not spread into it."""
    what = SITUATIONS[name]
    trace = seen_by_halves(what, SETTINGS[number])
    assert BY_HALVES[name][number] == " ".join(states(trace, second) for second in what.at)


def test_a_follower_spreads_across_an_inner_border_that_is_not_clear() -> None:
    """The first half is FREE once it is clear; the second is blocked only after the vehicle came in there."""
    what = Situation((100, 190, 240, 420), ("",) * 4, (), FollowerRun(20, 20_000, ((0, 25_000), (300, 0))))
    trace = seen_by_halves(what, ("occupancy", True))
    assert ["UUFF", "UUFF", "FFUF", "FFUU"] == [states(trace, second) for second in what.at]


@pytest.mark.parametrize(
    ("borders", "loose"), [("counted", None), ("occupancy", (5_000_000, 5_020_000))], ids=["counted", "two vehicles"]
)
def test_a_follower_that_does_not_fit_is_refused(borders: str, loose: tuple[int, int] | None) -> None:
    """Counters count it; and it is the only vehicle that was never counted."""
    place = replace(scene(SITUATIONS["a ghost train"], "occupancy"), trains=(TRAIN,), loose=loose)
    config = SectionsConfig(area=model(borders, trusted=True).area.own.config, sections=4)
    with pytest.raises(
        InputError, match=r"^the scene has a follower: it comes in where borders report occupancy alone"
    ):
        simulate(config, place, seed=0)


def test_a_scene_without_trains_that_does_not_fit_is_refused() -> None:
    """Its sections are counted although there is no train."""
    place = replace(scene(SITUATIONS["a ghost train"], "occupancy"), sections_mm=CUTS[:2])
    config = SectionsConfig(area=model("occupancy", trusted=True).area.own.config, sections=4)
    message = r"^the scene has 2 sections and slots up to 0; the configuration has 4 and 2\.$"
    with pytest.raises(InputError, match=message):
        simulate(config, place, seed=0)


def test_inner_detection_that_does_not_fit_is_refused() -> None:
    """The scene names the places of the sections that the configuration has."""
    place = replace(scene(SITUATIONS["a sweep"], "counted"), inner_mm=INNER)
    config = SectionsConfig(area=model("counted", trusted=True).area.own.config, sections=4)
    with pytest.raises(
        InputError, match=r"^the scene has 2 detection sections inside the area; the configuration has 0 "
    ):
        simulate(config, place, seed=0)


def test_the_page_tells_these_states() -> None:
    """Each row of the table in docs/sections.md names states that its situation runs through, in their order."""
    page = (Path(__file__).parents[2] / "docs" / "sections.md").read_text(encoding="utf-8")
    rows = [[cell.strip() for cell in line.split("|")] for line in page.splitlines()]
    told = {name: row for name in SITUATIONS for row in rows if len(row) == 6 and row[1].startswith(name)}
    assert set(SITUATIONS) == set(told)
    for name, what in SITUATIONS.items():
        for cell, states_ in ((told[name][2], what.states[0]), (told[name][3], what.states[2])):
            assert cell.split(), name
            assert is_run_through(cell.split(), states_.split()), (name, cell, states_)


def is_run_through(told: list[str], states_: list[str]) -> bool:
    """Whether the states occur one after another."""
    rest = iter(states_)
    return all(state in rest for state in told)
