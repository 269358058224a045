"""Virtual sections: proved for all cuts and streams, and told in scenes: swept, lost, split, ghost, disturbed."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from safeloc.catalogue import ENTRIES
from safeloc.errors import InputError
from safeloc.language.expr import TRUE
from safeloc.language.interpret import run
from safeloc.language.machine import Machine
from safeloc.language.monitor import check_all
from safeloc.language.trace import Trace
from safeloc.language.verdict import Held, Proved
from safeloc.models import sections
from safeloc.models.area import AreaConfig
from safeloc.models.area import build as build_area
from safeloc.models.area import parts as area_parts
from safeloc.models.sections import Sections, SectionsConfig, compose_machines
from safeloc.models.sections.simulate import Scene, TrainRun, first_state, simulate
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
from safeloc.properties.sections import properties
from tests.models.spoilt import rebuilt

CONFIG = SectionsConfig(area=AreaConfig(trains=2), sections=4)
MODEL = compose_machines(CONFIG)
CUTS = ((0, 2_500_000), (2_500_001, 5_000_000), (5_000_001, 7_500_000), (7_500_001, 10_000_000))
FAST = ((0, 40_000),)
TRAIN = TrainRun(1, 5, 200_000, FAST)


def scene(*trains: TrainRun, seconds: int = 280, **more: object) -> Scene:
    """10 km in four sections."""
    return Scene((0, 10_000_000), CUTS, trains, seconds, **more)  # type: ignore[arg-type]


def seen(what: Scene, seed: int = 1) -> Trace:
    """The run of a scene, in which every property holds and the assumption is kept."""
    trace = run(MODEL.composition.system, simulate(CONFIG, what, seed=seed), first=first_state(what))
    verdicts = check_all(trace, properties(MODEL))
    assert all(isinstance(verdict, Held) for verdict in verdicts), [v for v in verdicts if not isinstance(v, Held)]
    return trace


def states(trace: Trace, second: int) -> str:
    """The four sections after a second: U, F, O or A each."""
    table = MODEL.sections[0].machine.modes
    return "".join(table[int(trace.steps[second].state[f"section_{n}.mode"])].label[0] for n in range(1, 5))


def test_a_train_sweeps_the_area() -> None:
    """Unknown at the start; behind a whole train that came in at the end, section after section becomes clear."""
    trace = seen(scene(TRAIN))
    assert "UUUU" == states(trace, 4)
    assert "AUUU" == states(trace, 30)
    assert "FAUU" == states(trace, 100)
    assert "FFFA" == states(trace, 230)
    assert "FFFF" == states(trace, 279)
    assert trace.steps[279].outputs["area.swept"]


def test_after_the_sweep_trains_occupy() -> None:
    """Once nothing is loose, a followed and whole train makes its sections OCCUPIED, and only these."""
    trace = seen(scene(TRAIN, replace(TRAIN, slot=2, enters_s=300), seconds=420))
    assert "OFFF" == states(trace, 320)
    assert "FOFF" == states(trace, 400)
    rules = {int(step.outputs["section_1.rule"]) for step in trace.steps[300:]}
    assert {0, 2, 6} >= rules - {9}


def test_two_trains_follow_each_other() -> None:
    """Both have their sections; between them it is clear, and behind both."""
    trace = seen(scene(TRAIN, replace(TRAIN, slot=2, enters_s=155), seconds=300))
    assert "OFAU" == states(trace, 180)
    assert "FFOF" == states(trace, 299)


def test_a_lost_train_blocks_what_it_may_have_reached() -> None:
    """Without reports its sections become UNKNOWN after the mute timer, then more of them; a report brings it back."""
    lost = replace(TRAIN, slot=2, enters_s=300, withheld=((320, 400),))
    trace = seen(scene(TRAIN, lost, seconds=430))
    assert "OFFF" == states(trace, 322)
    assert "UFFF" == states(trace, 330)
    assert "UUFF" == states(trace, 390)
    assert "O" in states(trace, 420)
    assert "U" not in states(trace, 420)


def test_a_train_that_splits_leaves_its_sections_blocked() -> None:
    """A part that stands behind is not seen by vibration: without integrity nothing behind the train becomes clear."""
    split = TrainRun(2, 300, 200_000, FAST, splits_s=330, left_behind_mm=100_000)
    trace = seen(scene(TRAIN, split, seconds=540))
    assert "O" == states(trace, 329)[0]
    assert all(states(trace, second)[0] != "F" for second in range(330, 540))
    assert "A" in states(trace, 420)


SWEPT = compose_machines(
    SectionsConfig(area=CONFIG.area.model_copy(update={"integrity_is_trusted": False}), sections=4)
)


def seen_by(model: Sections, what: Scene, *, word: bool) -> Trace:
    """The run of a scene through a model, with trains that report themselves whole whatever they lost where `word` is given."""
    steps = simulate(CONFIG, what, seed=1)
    told = {f"area.train_{number}_integer": True for number in (1, 2)} if word else {}
    return run(model.composition.system, [{**step, **told} for step in steps], first=first_state(what))


def test_a_word_of_integrity_that_is_not_true() -> None:
    """A train loses its rear part and says that it is whole: where that is trusted its law is broken and the section is FREE over the
    part; where it is not, every law is kept and it is never FREE."""
    split = scene(TRAIN, TrainRun(2, 300, 200_000, FAST, splits_s=330, left_behind_mm=100_000), seconds=540)
    trusting, swept = seen_by(MODEL, split, word=True), seen_by(SWEPT, split, word=True)
    assert "FREE" == MODEL.sections[0].machine.modes[int(trusting.steps[420].state["section_1.mode"])].label
    assert all(isinstance(one, Held) for one in check_all(swept, properties(SWEPT)))
    assert all(states(swept, second)[0] != "F" for second in range(305, 540))


def test_a_train_whose_word_is_not_trusted_clears_when_it_has_left() -> None:
    """What lies behind it is not FREE before it was counted out, and then all at once."""
    trace = seen_by(SWEPT, scene(TRAIN, replace(TRAIN, slot=2, enters_s=300), seconds=570), word=False)
    assert all(isinstance(one, Held) for one in check_all(trace, properties(SWEPT)))
    assert "FFFF" == states(trace, 299)
    assert [states(trace, second)[0] for second in (310, 400, 550)] == ["O", "A", "A"]
    assert "FFFF" == states(trace, 569)


def test_an_uncounted_vehicle_is_never_overlooked() -> None:
    """A vehicle that stood in the area keeps what lies ahead of the sweeping train blocked, and is pushed out or stays."""
    trace = seen(scene(TRAIN, loose=(9_000_000, 9_100_000), loose_speed_mm_s=5_000))
    assert "FFFA" == states(trace, 230)
    stays = TrainRun(1, 5, 200_000, ((0, 40_000), (150, 0)))
    blocked = seen(scene(stays, loose=(9_000_000, 9_100_000)))
    assert states(blocked, 279)[3] != "F"
    assert "F" == states(blocked, 279)[0]


def test_a_train_that_turns_back_unsweeps() -> None:
    """When the sweeping train leaves again at the low end, what it had cleared is not clear any more."""
    back = TrainRun(1, 5, 200_000, ((0, 40_000), (150, -40_000)))
    trace = seen(scene(back, seconds=420, loose=(9_000_000, 9_100_000), loose_speed_mm_s=-10_000))
    assert "F" == states(trace, 150)[0]
    assert "UUUU" == states(trace, 400)


def test_a_disturbed_counter_makes_everything_unknown() -> None:
    """What is not occupied by a train becomes UNKNOWN in the same cycle, and stays so after the disturbance."""
    trace = seen(scene(TRAIN, seconds=400, disturbed=((300, 302),)))
    assert "FFFF" == states(trace, 299)
    assert "UUUU" == states(trace, 300)
    assert "UUUU" == states(trace, 399)


def test_clear_counters_free_everything() -> None:
    """An area that the undisturbed counters report empty is clear."""
    trace = seen(scene(TRAIN, seconds=400, disturbed=((300, 302),), clear=(350,)))
    assert "UUUU" == states(trace, 349)
    assert "FFFF" == states(trace, 350)


def test_a_report_that_contradicts_is_rejected() -> None:
    """A trusted report far from where the train can be narrows nothing, and says so."""
    steps = simulate(CONFIG, scene(TRAIN, seconds=60), seed=1)
    steps[40] = {**steps[40], "area.train_1_rear_mm": 8_000_000, "area.train_1_front_mm": 8_200_000}
    trace = run(MODEL.composition.system, steps, first=first_state(scene(TRAIN)))
    verdict = MODEL.area.own.slots[0].last_verdict.unit
    labels = verdict.members  # type: ignore[union-attr]
    assert "CONTRADICTED" == labels[int(trace.steps[40].state["area.train_1_last_verdict"])]
    assert trace.steps[40].state["area.train_1_high_mm"] > trace.steps[39].state["area.train_1_high_mm"]


def test_scenes_that_do_not_fit_are_refused() -> None:
    """More sections than the configuration has."""
    with pytest.raises(
        InputError, match=r"^the scene has 1 sections and slots up to 1; the configuration has 4 and 2\.$"
    ):
        simulate(CONFIG, Scene((0, 10), ((0, 5),), (TRAIN,), 3), seed=0)


@pytest.mark.parametrize(
    "area", [{"trains": 2}, {"borders": "occupancy"}, {"inner_detection": 1}], ids=["trains", "borders", "inner"]
)
def test_recordings_are_replayed_only_where_they_fit(area: dict[str, Any]) -> None:
    """A configuration with other inputs has none; one with other figures only has those that ship."""
    entry = ENTRIES["sections"]
    assert () == entry.make(SectionsConfig(area=AreaConfig(**area))).streams
    assert 3 == len(entry.make(SectionsConfig(area=AreaConfig(integrity_is_trusted=False))).streams)


NOT_COUNTED: dict[str, Any] = {"trains": 1, "borders": "occupancy"}


@pytest.mark.thorough
@pytest.mark.parametrize(
    "area",
    [
        {"trains": 1},
        {"trains": 1, "integrity_is_trusted": False},
        NOT_COUNTED,
        {**NOT_COUNTED, "integrity_is_trusted": False},
        {**NOT_COUNTED, "inner_detection": 1},
        {"trains": 1, "inner_detection": 1},
        pytest.param({"trains": 4}, marks=pytest.mark.slow),
        pytest.param({**NOT_COUNTED, "trains": 4, "inner_detection": 2}, marks=pytest.mark.slow),
    ],
    ids=str,
)
def test_everything_is_proved(area: dict[str, Any]) -> None:
    """For one section anywhere in the area and any number of trains: every property, without a bound."""
    model = compose_machines(SectionsConfig(area=AreaConfig(**area)))
    findings = prove(model.composition.system, properties(model), Limits(seconds=60), jobs=2)
    assert [] == [finding.id for finding in findings if not isinstance(finding.result, Proved)]


def _spoilt(fault: str) -> Sections:
    """Area and one section with a fault in one table."""
    config = SectionsConfig(area=AreaConfig(trains=1))
    area, one = build_area(area_parts(config.area)), sections.section(config, "section_1")
    if fault == "believes a split train's rear":
        area = replace(area, machine=_believing(area.machine))
    else:
        table = [
            replace(t, when=TRUE) if t.name == "#7 occupied to unknown" and fault == "wrong rule" else t
            for t in one.machine.transitions
            if not (fault == "forgets the loose" and t.name == "#1 free to unknown")
        ]
        one = replace(one, machine=rebuilt(one.machine, table))
    return sections.joined(area, (one,))


def _believing(machine: Machine) -> Machine:
    """Bounds one millimetre tighter on the rear in every cycle."""
    table = []
    for t in machine.transitions:
        low = next((var for var in t.set if var.name == "train_1_low_mm"), None)
        follows = low is not None and t.name.startswith("follow")
        table.append(replace(t, set={**t.set, low: t.set[low] + 1}) if follows and low is not None else t)
    return rebuilt(machine, table)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("fault", "noticed"),
    [
        ("believes a split train's rear", "train 1 containment"),
        ("forgets the loose", "section_1 is never clear with a vehicle that was not counted"),
    ],
)
def test_a_wrong_table_is_noticed(fault: str, noticed: str) -> None:
    """A machine with one fault does not have the property that the fault concerns."""
    model = _spoilt(fault)
    asked = [prop for prop in properties(model) if prop.name == noticed]
    assert not isinstance(prove(model.composition.system, asked, Limits(seconds=5))[-1].result, Proved)
    sound = compose_machines(SectionsConfig(area=AreaConfig(trains=1)))
    right = [prop for prop in properties(sound) if prop.name == noticed]
    assert isinstance(prove(sound.composition.system, right, Limits(seconds=30))[-1].result, Proved)
