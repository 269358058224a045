"""Named scenarios of a line area, replayed from simulated backscatter: each has the outcome that it announces."""

from __future__ import annotations

from functools import cache
from itertools import groupby
from pathlib import Path

import pytest

from safeloc.language.interpret import run
from safeloc.language.system import lower, without_ghosts
from safeloc.language.trace import Trace
from safeloc.language.units import Enumeration
from safeloc.models import fibre_area
from safeloc.models.fibre.picture import loud
from safeloc.models.fibre.scenes.figures import END_SCENES
from safeloc.models.fibre.scenes.recordings import Recording, recorded_order, recorded_stay
from safeloc.models.fibre.scenes.scenarios import AREA_SCENES, ENDS, ORDER_SCENES, SCENARIOS, SPLIT_S, VERIFIED_20_KM
from safeloc.models.train_order import machine as order_machine
from safeloc.railway.pictures import LoudFibre
from safeloc.runtime.streams.steps import Cell, read_steps
from tests.shipped_recordings import shipped

NAMES = [one.name for one in SCENARIOS]
LOST_FROM_S, LOST_TO_S = 95.5, 108.0


@cache
def run_of(name: str) -> tuple[Trace, list[dict[str, Cell]], LoudFibre]:
    """A shipped recording through the whole, its steps, and what is kept of its picture."""
    system = without_ghosts(fibre_area.compose_machines().composition.system)
    stream = read_steps(shipped(f"fibre_area-{name}"))
    known = {var.name for var in system.inputs} | {option.value.name for option in system.optionals}
    steps = [dict(step) for step in stream.steps]
    rows = [{key: cell for key, cell in step.items() if key in known} for step in steps]
    first = {key: value for key, value in stream.first.items() if key in {var.name for var in system.state}}
    heard = loud(f"fibre_area-{name}")
    assert heard is not None
    return run(system, rows, first=first), steps, heard


def said(name: str, signal: str) -> list[str]:
    """What a state or an output says after every step."""
    trace, _, _ = run_of(name)
    term = trace.system.outputs[signal] if signal in trace.system.outputs else trace.system.variable(signal)
    unit = term.unit  # type: ignore[union-attr]
    assert isinstance(unit, Enumeration)
    return [unit.members[{**step.state, **step.outputs}[signal]] for step in trace.steps]


def course(name: str, signal: str) -> list[str]:
    """The same, each once."""
    return [word for word, _ in groupby(said(name, signal))]


def at_s(name: str, second: float) -> int:
    """The step at a second of the scene."""
    _, _, heard = run_of(name)
    return round((second * 1_000 - heard.first_ms) / heard.step_ms)


def virtual(name: str) -> list[tuple[int, int, list[str]]]:
    """Bounds and states after every step of all virtual sections."""
    trace, _, heard = run_of(name)
    made = []
    for one in heard.virtual:
        begins = [*(step for step, _ in one.states), len(trace.steps)]
        states = [
            state
            for begin, end, (_, state) in zip(begins, begins[1:], one.states, strict=False)
            for _ in range(end - begin)
        ]
        made.append((one.low_mm, one.high_mm, states))
    return made


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("name", [one.name for one in AREA_SCENES])
def test_no_section_is_free_with_a_train_in_it(name: str) -> None:
    """Between the counters, in every step, by the true ends: whatever goes wrong, and a lost part too."""
    _, steps, heard = run_of(name)
    ends = next(one.stay.ends for one in AREA_SCENES if one.name == name)
    parts = heard.trains if name == "split-train" else heard.trains[:1]
    checked = 0
    for low, high, states in virtual(name):
        for number, state in enumerate(states):
            column = number // heard.steps_per_column
            exact = (number + 1) % heard.steps_per_column == 0
            spans = [(max(one.low_mm[column], ends.low_mm), min(one.high_mm[column], ends.high_mm)) for one in parts]
            if exact and any(rear < front and rear <= high and front >= low for rear, front in spans):
                assert state != "FREE", (name, number, low)
                checked += 1
    assert checked > len(steps) / 4 / heard.steps_per_column


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize("name", [one.name for one in AREA_SCENES])
def test_the_picture_shows_what_the_machine_tells(name: str) -> None:
    """The section that the machine as it ships has, is one of those kept for the picture, state by state."""
    trace, _, _ = run_of(name)
    first = dict(trace.initial)
    (states,) = [
        states
        for low, high, states in virtual(name)
        if (low, high) == (first["section_1.from_mm"], first["section_1.to_mm"])
    ]
    assert states == said(name, "section_1.mode")


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize("name", [one.name for one in AREA_SCENES])
def test_what_is_given_out_holds_the_front(name: str) -> None:
    """In every step of every scenario in which a position is given out."""
    trace, steps, _ = run_of(name)
    for step, row in zip(trace.steps, steps, strict=True):
        told = {key.removeprefix("verification."): value for key, value in step.outputs.items()}
        if told["trusted"]:
            assert (
                told["position_mm"] - told["margin_below_mm"]
                <= int(row["truth_mm"])
                <= told["position_mm"] + told["margin_above_mm"]
            )


def test_a_verified_run_is_trusted_from_the_record_to_the_exit() -> None:
    """By count, length, place and speed; every section is free after the sweep, occupied once, and free behind."""
    assert ["NO_REFERENCE", "TRUSTED", "NO_REFERENCE"] == course("verified-run", "verification.mode")
    trace, _, _ = run_of("verified-run")
    told = trace.steps[said("verified-run", "verification.mode").index("TRUSTED")].outputs
    names = ("count", "length", "place_at_entry", "speed_at_entry")
    assert all(told[f"verification.verified_{name}"] for name in names)
    for _, _, states in virtual("verified-run"):
        assert ("UNKNOWN", "FREE", "FREE") == (states[0], states[20], states[-1])
        assert "OCCUPIED" in states
        assert "AMBIGUOUS" not in states


def test_a_ghost_train_makes_patterns_belong_to_nobody() -> None:
    """Trusted, then withheld as soon as there are two patterns; never untrusted, never given out again."""
    assert ["NO_REFERENCE", "TRUSTED", "WITHHELD", "NO_REFERENCE"] == course("ghost-train", "verification.mode")
    modes, why = said("ghost-train", "verification.mode"), said("ghost-train", "verification.reason")
    assert "NOT_ASSOCIATED" == why[modes.index("WITHHELD")]


def test_a_lost_train_is_withheld_at_once_and_needs_a_reference() -> None:
    """The cycle in which nothing comes; both ends silent, the emitter's pattern overdue; nothing given out afterwards."""
    modes = said("lost-train", "verification.mode")
    assert "WITHHELD" == modes[at_s("lost-train", LOST_FROM_S)]
    assert ["NO_REFERENCE", "TRUSTED", "WITHHELD", "UNTRUSTED", "NO_REFERENCE"] == course(
        "lost-train", "verification.mode"
    )
    assert "CHAIN_FAILED" in said("lost-train", "verification.reason")
    inside = slice(at_s("lost-train", LOST_TO_S), said("lost-train", "entry.mode").index("OUTSIDE", 50))
    assert "TRUSTED" not in modes[inside]
    assert {"WAITING", "COUNTING"} >= set(said("lost-train", "front.mode")[inside])


def test_a_split_train_is_longer_than_its_record() -> None:
    """LENGTH within 20 s; the section with the lost part is not free at the end, though the rest has left the area."""
    modes = said("split-train", "verification.mode")
    begin = at_s("split-train", SPLIT_S)
    found = modes.index("UNTRUSTED")
    assert begin < found < begin + 40
    assert "LENGTH" == said("split-train", "verification.reason")[found]
    _, steps, heard = run_of("split-train")
    assert int(steps[-1]["truth_mm"]) > ENDS.high_mm
    lost = heard.trains[1]
    assert ["UNKNOWN"] == [states[-1] for low, high, states in virtual("split-train") if low <= lost.low_mm[-1] <= high]


def test_a_miscount_is_found_with_the_record_and_at_the_exit() -> None:
    """COUNT in the cycle of the record; when other axles leave, nothing is free any more."""
    modes = said("counter-miscount", "verification.mode")
    assert "TRUSTED" not in modes
    _, steps, _ = run_of("counter-miscount")
    comes = [row["entry.reference_comes"] for row in steps].index("AXLE_COUNTER")
    assert "UNTRUSTED" == modes[comes]
    assert "COUNT" == said("counter-miscount", "verification.reason")[comes]
    assert {"UNKNOWN"} == {states[-1] for _, _, states in virtual("counter-miscount")}


def test_a_silent_emitter_revokes_what_was_given_out() -> None:
    """In the cycle in which its pattern is overdue, ten seconds and a cycle after the last one."""
    trace, _, _ = run_of("emitter-failure")
    modes = said("emitter-failure", "verification.mode")
    found = modes.index("UNTRUSTED")
    assert "CHAIN_FAILED" == said("emitter-failure", "verification.reason")[found]
    assert trace.steps[found].outputs["verification.revoked"]
    assert "FAILED" == said("emitter-failure", "emitter.mode")[found]
    assert "TESTED" == said("emitter-failure", "emitter.mode")[found - 1]


def test_a_run_through_20_km_is_verified_by_three_counters() -> None:
    """Two records that agree, trusted from the first to the exit, every one of the twenty sections occupied in its turn."""
    modes = said("verified-20-km", "verification.mode")
    _, steps, _ = run_of("verified-20-km")
    records = [number for number, row in enumerate(steps) if row["entry.reference_comes"] == "AXLE_COUNTER"]
    assert 2 == len(records)
    leaves = [row["entry.leaves_high"] for row in steps].index(True)
    assert {"TRUSTED"} == set(modes[records[0] + 4 : leaves])
    turns = [states.index("OCCUPIED") for _, _, states in virtual("verified-20-km")]
    assert 20 == len(turns)
    assert sorted(turns) == turns


def test_two_trains_close_together_are_nobodys() -> None:
    """Told apart by order, then one pattern for both, then two again with the same owners."""
    system = without_ghosts(lower(order_machine()))
    known = {var.name for var in system.inputs}
    steps = read_steps(shipped("train_order-two-trains-close")).steps
    trace = run(system, [{key: cell for key, cell in step.items() if key in known} for step in steps])
    owners = [tuple(step.outputs[f"train_of_pattern_{n}"] for n in (1, 2)) for step in trace.steps]
    assert [(0, 0), (1, 0), (2, 1), (0, 0), (2, 1)] == [pair for pair, _ in groupby(owners)]
    one_pattern = [number for number, step in enumerate(steps) if step["patterns"] == 1 and owners[number] == (0, 0)]
    assert len(one_pattern) > 20


def fresh_is_shipped(made: Recording) -> None:
    """Steps of a simulation made now are those that ship, but for rounding."""
    stored = read_steps(shipped(made.name))
    assert made.first.keys() == stored.first.keys()
    assert len(made.steps) == len(stored.steps)
    for now, then in zip(made.steps, stored.steps, strict=True):
        assert now.keys() == then.keys()
        far = {name: cell for name, cell in now.items() if isinstance(cell, int) and abs(cell - int(then[name])) > 2}
        assert far == {}


@pytest.mark.slow
@pytest.mark.parametrize("name", [*NAMES, VERIFIED_20_KM.name])
def test_shipped_stays_are_fresh_simulations(name: str) -> None:
    """As `python -m safeloc.models.fibre.scenes` makes them."""
    fresh_is_shipped(recorded_stay(next(one for one in AREA_SCENES if one.name == name)))


@pytest.mark.slow
def test_the_shipped_order_is_a_fresh_simulation() -> None:
    """As `python -m safeloc.models.fibre.scenes` makes it."""
    for one in ORDER_SCENES:
        fresh_is_shipped(recorded_order(one))


def test_every_scenario_is_described() -> None:
    """In words with the recording, and on its page."""
    page = (Path(__file__).parents[3] / "docs" / "fibre.md").read_text(encoding="utf-8")
    for one in (*END_SCENES, *AREA_SCENES, *ORDER_SCENES):
        assert f"`{one.name}`" in page, one.name
        assert one.says.endswith(".")
