"""The law on telegram and map of anchored reflectors: whom it binds, and that recordings use it up."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest

from safeloc.catalogue import load_target
from safeloc.errors import EngineError
from safeloc.language.trace import Trace
from safeloc.models.balise.variables import REPEATED
from safeloc.models.localizer import LocalizerConfig, compose_machines
from safeloc.models.reflector.world import ODOMETER, PRESCRIBED, READING
from safeloc.proof.provers.replayed_evidence import admissible_run
from safeloc.proof.verification.assumptions import judge_recording
from safeloc.proof.verification.replay import read_recording
from safeloc.runtime.streams.steps import Cell, StepStream
from safeloc.target import Target, find_recording

READ_AT = 307
"""The cycle of the metro's recording in which group 3 is read and accepted."""


def recorded(name: str) -> Path:
    """A recording of the localizer that ships."""
    return find_recording(load_target("localizer"), Path(name))


@pytest.fixture(name="metro", scope="module")
def _metro() -> StepStream:
    return read_recording(load_target("localizer"), recorded("localizer-metro"))[0]


@pytest.fixture(name="target", scope="module")
def _target() -> Target:
    return load_target("localizer")


def run(target: Target, stream: StepStream, changes: Mapping[int, Mapping[str, Cell]], cycles: int) -> Trace:
    """The first cycles of a stream with some inputs changed; EngineError if that is not lawful."""
    given = ({name: value for name, value in step.items() if name != "truth_mm"} for step in stream.steps[:cycles])
    steps = [{**step, **changes.get(number, {})} for number, step in enumerate(given, 1)]
    return admissible_run(target.system, stream.first, steps)


def read_again(target: Target, stream: StepStream) -> dict[str, Cell]:
    """The telegram of the group that was accepted, delivered once more in the cycle after: older, with the run since counted on."""
    before, after = (step.state for step in run(target, stream, {}, READ_AT + 1).steps[-2:])
    telegram = {name: value for name, value in stream.steps[READ_AT - 1].items() if name.startswith("balise.")}
    ran_nm = int(after["truth_nm"]) - int(before["truth_nm"])
    return telegram | {
        "balise.telegram_age_ms": int(telegram["balise.telegram_age_ms"]) + 100,
        "balise.telegram_since_mm": int(telegram["balise.telegram_since_mm"])
        + int(stream.steps[READ_AT]["motion.odometer_mm"]),
        "balise.true_since_nm": int(telegram["balise.true_since_nm"]) + ran_nm,
    }


def test_a_telegram_that_anchors_nothing_is_not_bound(target: Target, metro: StepStream) -> None:
    """A group that is read twice is repeated the second time; the map has moved on to the reflector behind the target by then, as it may."""
    again = read_again(target, metro)
    assert 400_000 == metro.steps[READ_AT - 1]["line.next_position_mm"]
    assert 640_000 == metro.steps[READ_AT]["line.next_position_mm"]
    last = run(target, metro, {READ_AT + 1: again}, READ_AT + 1).steps[-1]
    assert REPEATED.value == last.state["balise.telegram_last_verdict"]
    assert not last.outputs["balise.reference_accepted"]


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(
    ("name", "off"),
    [("line.next_position_mm", 100), ("balise.telegram_reflector_mm", 100), ("line.next_reference_mm", -100)],
)
def test_an_accepted_one_is(target: Target, metro: StepStream, name: str, off: int) -> None:
    """Telegram, map and the map's distance are of one survey, to 50 mm."""
    assert run(target, metro, {}, READ_AT).steps[-1].outputs["balise.reference_accepted"]
    changed = int(metro.steps[READ_AT - 1][name]) + off
    with pytest.raises(EngineError, match=f"breaks the assumption in step {READ_AT}"):
        run(target, metro, {READ_AT: {name: changed}}, READ_AT)


def test_the_recording_uses_the_survey_up_to_ten_millimetres(target: Target) -> None:
    """So a law that allows less is not kept by it."""
    judged = judge_recording(target, recorded("localizer-metro"))
    [law] = [one for one in judged.laws if [each.machine for each in one.laws] == ["line"]]
    assert (10, "mm") == (law.least, law.unit)


def test_a_corrupted_telegram_tells_a_wrong_distance(target: Target) -> None:
    """It is rejected, and no law says anything of it."""
    stream, _ = read_recording(target, recorded("localizer-metro-silent-odometer-corrupted-balise"))
    [read] = [step for step in stream.steps if step.get("balise.telegram_check") == "FAILED"]
    assert 80_040 != read["balise.telegram_reflector_mm"] and "line.next_position_mm" in read
    assert len(stream.steps) == len(run(target, stream, {}, len(stream.steps)).steps)


def test_what_the_reflector_machine_assumes_is_owed() -> None:
    """Its readings and their distance by the balise machine, its odometer by the check unit."""
    system = compose_machines(LocalizerConfig(sources=("balise", "reflector"))).composition.system
    [reflectors] = [part for part in system.parts if part.name == "reflector"]
    assert {READING, PRESCRIBED, ODOMETER} <= set(reflectors.guaranteed)
