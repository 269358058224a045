"""The machines of supervised.py are proved, tested and replayed by calls of safeloc, and wrong machines are refused."""

from __future__ import annotations

from pathlib import Path

from safeloc.catalogue import load_target
from safeloc.language.verdict import word
from safeloc.proof.provers.limits import Limits
from safeloc.proof.testing import state_machine_test
from safeloc.proof.verification.calls import prove_target
from safeloc.proof.verification.replay import replay_stream

FILE = Path(__file__).parents[1] / "supervised.py"
WHOLE = load_target(f"{FILE}:whole")
RECORDING = WHOLE.streams[0]

# Property tests: runs along plausible and faulty sensors, drawn by Hypothesis. pytest collects this class.
TestDrawnRuns = state_machine_test(WHOLE.system, WHOLE.properties, steps=20)


def test_everything_is_proved() -> None:
    """Of the composition: claims, lemmas, the contract, and what safeloc checks by itself."""
    found = {one.id: word(one.result) for one in prove_target(WHOLE)}
    assert {"proved"} == set(found.values())
    assert "supervised_speed/lemma/contract of supervisor holds" in found


def test_each_machine_is_proved_alone() -> None:
    """The supervisor alone rests on an assumption, which the composition does not need."""
    for name in ("speedometer", "supervisor"):
        target = load_target(f"{FILE}:{name}")
        assert target.properties
        assert {"proved"} == {word(one.result) for one in prove_target(target)}


def test_the_recording_is_lawful_and_shows_every_transition() -> None:
    """Every property holds on it, and each transition fires in it."""
    rows, findings = replay_stream(WHOLE, RECORDING)
    assert {"held"} == {word(one.result) for one in findings}
    names = {transition.name for machine in WHOLE.machines for transition in machine.transitions}
    assert names <= {fired for row in rows for fired in row.fired.values()}


WRONG = {
    "free at the start": ('BRAKING, FREE = supervisor_modes = modes("BRAKING", "FREE")',
                          'FREE, BRAKING = supervisor_modes = modes("FREE", "BRAKING")'),
    "the bound does not age": ("minimum(bound + GAIN_MM_S, FASTEST_MM_S)", "bound"),
    "the sensor's error is forgotten": ("minimum(measured.value + MEASURED_WITHIN_MM_S, FASTEST_MM_S)", "measured.value"),
    "the limit is too high": ("speed_bound > LIMIT_MM_S)", "speed_bound > LIMIT_MM_S + 400)"),
    "released at any speed": ("released & (speed_bound <= RELEASE_MM_S)", "released"),
    "brakes too early": ("speed_bound > LIMIT_MM_S)", "speed_bound > RELEASE_MM_S)"),
}  # fmt: skip
"""Wrong edits of the machines: what stands there -> what would be wrong."""


def test_wrong_edits_are_refused(tmp_path: Path) -> None:
    """A proof that cannot fail would say nothing: each wrong machine violates something that the right one keeps."""
    for name, (right, wrong) in WRONG.items():
        path = tmp_path / f"{name.replace(' ', '_')}.py"
        text = FILE.read_text(encoding="utf-8").replace("recordings/run.jsonl", str(RECORDING))
        assert 1 == text.count(right), f"the edit {name!r} no longer fits the file"
        path.write_text(text.replace(right, wrong), encoding="utf-8")
        found = prove_target(load_target(f"{path}:whole"), limits=Limits(seconds=2))
        assert "violated" in {word(one.result) for one in found}, name
