"""The machine of odometer.py is proved, tested and replayed by calls of safeloc, and wrong machines are refused."""

from __future__ import annotations

from pathlib import Path

from safeloc.catalogue import load_target
from safeloc.language.verdict import word
from safeloc.proof.provers.limits import Limits
from safeloc.proof.testing import state_machine_test
from safeloc.proof.verification.calls import prove_target
from safeloc.proof.verification.replay import replay_stream

FILE = Path(__file__).parents[1] / "odometer.py"
TARGET = load_target(f"{FILE}:machine")
RECORDING = TARGET.streams[0]

# Property tests: runs along plausible and faulty sensors, drawn by Hypothesis. pytest collects this class.
TestDrawnRuns = state_machine_test(TARGET.system, TARGET.properties, steps=20)


def test_everything_is_proved() -> None:
    """Claims, lemmas and what safeloc checks by itself: ranges, overflow, dead transitions, dead ends and more."""
    assert {"proved"} == {word(one.result) for one in prove_target(TARGET)}


def test_the_recording_is_lawful_and_contained() -> None:
    """Every property holds on it, and no reported interval misses the true position beside it."""
    rows, findings = replay_stream(TARGET, RECORDING)
    assert {"held"} == {word(one.result) for one in findings}
    assert {"contained", "INVALID"} == {row.truth for row in rows}


def test_the_recording_shows_every_transition() -> None:
    """A recording in which nothing happens would say nothing."""
    rows, _ = replay_stream(TARGET, RECORDING)
    names = {transition.name for machine in TARGET.machines for transition in machine.transitions}
    assert names <= {fired for row in rows for fired in row.fired.values()}


WRONG = {
    "rounded to the wrong side": ("margin + ceil_div(", "margin + floor_div("),
    "a marker without error": ("margin: MARKER_UM}", "margin: 0}"),
    "pulses without error": (" + WHEEL_CONSTANT_UM\nfits", "\nfits"),
    "withdrawn too late": ("grown <= TOLERANCE_MM * 1_000)", "grown <= 2 * TOLERANCE_MM * 1_000)"),
    "found without a marker": ("table, LOCATED, marker.present,", "table, LOCATED, marker.present | wheel.present,"),
    "runs on without a reading": (
        "LOCATED, LOST, ~wheel.present,",
        "LOCATED, LOST, ~wheel.present & (margin > 500_000),",
    ),
}
"""Wrong edits of the machine: what stands there -> what would be wrong."""


def test_wrong_edits_are_refused(tmp_path: Path) -> None:
    """A proof that cannot fail would say nothing: each wrong machine violates something that the right one keeps."""
    for name, (right, wrong) in WRONG.items():
        path = tmp_path / f"{name.replace(' ', '_')}.py"
        text = FILE.read_text(encoding="utf-8").replace("recordings/run.jsonl", str(RECORDING))
        assert 1 == text.count(right), f"the edit {name!r} no longer fits the file"
        path.write_text(text.replace(right, wrong), encoding="utf-8")
        found = prove_target(load_target(f"{path}:machine"), limits=Limits(seconds=2))
        assert "violated" in {word(one.result) for one in found}, name
