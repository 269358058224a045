"""What a verification by count, length, place and speed cannot notice: a run of each, and its figure."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest

from safeloc.catalogue import load_target
from safeloc.language.interpret import run
from safeloc.language.monitor import check_all
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.trace import Trace
from safeloc.language.verdict import Violated
from safeloc.models.fibre.simulate import Stay, simulate_stay
from safeloc.models.verification import VerificationConfig, build_doubted, parts
from safeloc.models.verification.unnoticed import (
    CONFIG,
    ENTRY,
    FOLDER,
    RUNS,
    Steps,
    Unnoticed,
    first_of,
    steps_of,
    write,
)
from safeloc.proof.verification.assumptions import judge_recording
from safeloc.runtime.streams.steps import Cell
from tests.models.fibre_family import REMARK, labels

TARGET = load_target("verification_doubted")


def told(steps: Steps, system: TransitionSystem = TARGET.system) -> Trace:
    """The machine along the steps, its laws and its claims kept."""
    trace = run(
        system, [{name: cell for name, cell in one.items() if name != REMARK} for one in steps], first=first_of()
    )
    if system is TARGET.system:
        assert not [one for one in check_all(trace, TARGET.properties) if isinstance(one, Violated)]
    return trace


def beside_mm(trace: Trace, steps: Steps, cycle: int) -> int:
    """How far the interval that is given out lies beside the front; 0: it holds it."""
    out, front = trace.steps[cycle].outputs, steps[cycle][REMARK]
    assert isinstance(front, int)
    position, below, above = (int(out[name]) for name in ("position_mm", "margin_below_mm", "margin_above_mm"))
    return max(0, position - below - front, front - position - above)


@pytest.mark.parametrize("name", RUNS)
def test_it_is_not_noticed(name: str) -> None:
    """Trusted to the end, as far beside the front as is said, and no farther than the machine says that it can be."""
    steps = steps_of(RUNS[name])
    trace = told(steps)
    assert {label for label in labels(trace, "reason")[2:-1]} == {"VERIFIED"}
    assert beside_mm(trace, steps, -2) == RUNS[name].beside_mm
    assert all(
        beside_mm(trace, steps, n) <= one.outputs["place_doubt_mm"] for n, one in enumerate(trace.steps[2:-1], 2)
    )


@pytest.mark.parametrize("name", RUNS)
def test_the_laws_are_kept(name: str) -> None:
    """The counter's record is true, and the train moves as trains do: it is the fibre alone that is wrong."""
    judged = judge_recording(TARGET, FOLDER / f"verification_doubted-{name}.jsonl.gz")
    assert judged.laws
    assert [one for one in judged.laws if one.breaches] == []


def test_recordings_are_fresh(tmp_path: Path) -> None:
    """They come out the same."""
    write(tmp_path)
    for made in tmp_path.iterdir():
        assert made.read_bytes() == (FOLDER / made.name).read_bytes()


def stayed(changes: dict[int, dict[str, Cell]], stay: Stay | None = None) -> Trace:
    """A stay, with cells changed in single cycles."""
    steps = simulate_stay(CONFIG, seed=1, stay=stay or Stay())
    for cycle, one in enumerate(steps):
        front = Stay().speed_mm_s * 1_000
        steps[cycle] = one | {"next_true_speed_um_s": front, "next_true_axles": 40} | changes.get(cycle, {})
    return run(
        TARGET.system,
        [{name: cell for name, cell in one.items() if name != REMARK} for one in steps],
        first=first_of(),
    )


def test_a_miscount_that_the_fibre_repeats() -> None:
    """Counter and fibre count two axles too few: the record's law is broken, and nothing shows it."""
    wrong = stayed({cycle: {"fibre_axles": 38} for cycle in range(2, 59, 4)}, Stay(counted=38))
    assert set(labels(wrong, "reason")[2:-1]) == {"VERIFIED"}
    assert wrong.steps[-2].outputs["handover_axles"] == 38


def test_a_wagon_lost_of_which_the_fibre_does_not_tell() -> None:
    """A fibre that repeats the old count is believed until the next counter, whose record contradicts in its cycle."""
    front = 25_000 * 50 // 2
    record: dict[str, Cell] = {
        "reference_due": True, "record_axles": 36, "record_length_low_mm": 180_000, "record_length_high_mm": 188_000,
        "record_place_low_mm": front - 5_000, "record_place_high_mm": front + 5_000,
    }  # fmt: skip
    reasons = labels(stayed({50: record}), "reason")
    assert set(reasons[2:50]) == {"VERIFIED"}
    assert set(reasons[50:-1]) == {"REFERENCE_CONTRADICTS"}


def test_a_speed_that_wanders_after_the_counter() -> None:
    """The speed that the fibre tells may drift by 3 m/s a cycle, to 97 m/s where the train has 25; it is not given out."""
    drift = {cycle: {"fibre_speed_mm_s": 25_000 + min(cycle - 12, 40) * 3_000} for cycle in range(12, 37)}
    trace = stayed({cycle: dict(cells) for cycle, cells in drift.items()}, Stay(cycles=37))
    assert set(labels(trace, "reason")[2:-1]) == {"VERIFIED"}


def test_a_place_wanders_no_farther_than_its_limit() -> None:
    """As fast as no check forbids, a place gets 50 m a cycle ahead; it is withheld where the record leaves too much open."""
    config = VerificationConfig(place_doubt_limit_mm=2_000_000)
    entered, served = 25_000 * ENTRY // 2, (2_000_000 - 10_000) // 100_000

    def fastest(cycle: int, _: int, __: Mapping[str, Cell]) -> Mapping[str, Cell | None]:
        return {"fibre_position_mm": entered + 45_000 + 50_000 * (cycle - ENTRY), "fibre_speed_mm_s": None}

    steps = steps_of(Unnoticed("a place that runs away", 0, fastest, from_cycle=ENTRY), config, ENTRY + served + 3)
    target = lower(build_doubted(parts(config)).machine)
    trace = told(steps, target)
    assert labels(trace, "reason")[ENTRY:-1] == ["VERIFIED"] * (served + 1) + ["PLACE_DOUBTFUL"]
    assert beside_mm(trace, steps, ENTRY + served) == 35_000 + 37_500 * served
