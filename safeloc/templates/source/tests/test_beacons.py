"""The source of beacons.py keeps the localizer's contract, locates a train by itself, and wrong sources are refused."""

from __future__ import annotations

from pathlib import Path

from safeloc.catalogue import load_target
from safeloc.language.interpret import run
from safeloc.language.nodes import Value
from safeloc.language.system import without_ghosts
from safeloc.language.verdict import word
from safeloc.proof.provers.limits import Limits
from safeloc.proof.testing import state_machine_test
from safeloc.proof.verification.calls import prove_target

FILE = Path(__file__).parents[1] / "beacons.py"
TARGET = load_target(f"contract+{FILE}:source")

# Property tests: runs along plausible and faulty ranges, drawn by Hypothesis. pytest collects this class.
TestDrawnRuns = state_machine_test(TARGET.system, TARGET.properties, steps=20)


def test_the_contract_is_proved() -> None:
    """Its four claims, and what safeloc checks by itself: ranges, overflow, dead transitions, dead ends and more."""
    assert {"proved"} == {word(one.result) for one in prove_target(TARGET)}


def test_a_train_is_located_and_withdrawn() -> None:
    """The localizer with this source alone: a range leads at once, and is withdrawn when the train can have run too far."""
    system = without_ghosts(load_target(f"alone+{FILE}:source").system)
    near: dict[str, Value | None] = {"beacons.beacon_mm": 120_000, "beacons.range_mm": 20_000}
    silent: dict[str, Value | None] = {"beacons.beacon_mm": None, "beacons.range_mm": None}
    others: dict[str, Value | None] = {
        "motion.odometer_mm": None,
        "motion.check_mm": None,
        "uplink.sent": True,
        "uplink.arrived": False,
    }
    steps = run(system, [{**others, **one} for one in (near, *[silent] * 7)]).steps
    assert [True] * 6 + [False] * 2 == [step.outputs["arbitration.valid"] for step in steps]
    assert {100_000} == {step.outputs["delocalized.position_mm"] for step in steps[:6]}


WRONG = {
    "the cycle's run left out": ("RANGING_MM + run", "RANGING_MM"),
    "a millimetre less right after a range": ("{position: place, margin: fresh}", "{position: place, margin: fresh - 1}"),
    "no growth": ("{margin: wider}", "{margin: margin}"),
    "a reference without an interval": ('"reference_accepted": valid & margin.eq(fresh)', '"reference_accepted": ~valid'),
    "a reason beside a position": ("ite(valid, LOCATED, SENSOR_FAILURE)", "SENSOR_FAILURE"),
}  # fmt: skip
"""Wrong edits of the source: what stands there -> what would be wrong."""


def test_wrong_edits_are_refused(tmp_path: Path) -> None:
    """A proof that cannot fail would say nothing: each wrong source violates something that the right one keeps."""
    text = FILE.read_text(encoding="utf-8")
    for name, (right, wrong) in WRONG.items():
        assert 1 == text.count(right), f"the edit {name!r} no longer fits the file"
        path = tmp_path / "wrong.py"
        path.write_text(text.replace(right, wrong), encoding="utf-8")
        found = prove_target(load_target(f"contract+{path}:source"), limits=Limits(seconds=2))
        assert "violated" in {word(one.result) for one in found}, name
