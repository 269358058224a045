"""The reported interval and how it stands to the truth: WRONG and INVALID are never the same."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from safeloc.assurance.evidence.top_event import hazard_claims
from safeloc.catalogue import ENTRIES, load_target
from safeloc.errors import InputError, StreamError
from safeloc.language.verdict import word
from safeloc.proof.verification.replay import replay_stream
from safeloc.reported import PossibleTrack, Reported, Tracks, usual_names
from tests.shipped import shipped

OUTPUTS = {"valid": True, "position_mm": 100, "margin_below_mm": 5, "margin_above_mm": 7}


@pytest.mark.parametrize(
    ("truth_mm", "standing"), [(94, "WRONG"), (95, "contained"), (107, "contained"), (108, "WRONG")]
)
def test_ends_belong_to_the_interval(truth_mm: int, standing: str) -> None:
    """Both ends are contained; one millimetre beyond either is wrong."""
    assert Reported().standing(OUTPUTS, truth_mm) == standing


def test_nothing_reported_is_never_wrong() -> None:
    """Without a valid report the values that stand in the outputs count for nothing, however far off they are."""
    assert Reported().standing({**OUTPUTS, "valid": False}, 10**9) == "INVALID"
    restrictive = Reported(valid="restrictive", valid_is=False)
    assert restrictive.standing({**OUTPUTS, "restrictive": True}, 10**9) == "INVALID"
    assert restrictive.standing({**OUTPUTS, "restrictive": False}, 10**9) == "WRONG"


def test_an_interval_along_an_edge_means_another_place() -> None:
    """The host is told from where the place counts, what the edges mean, and that a coordinate is no place on the map."""
    track = Tracks(
        "edge", "tracks", (PossibleTrack("track_1_edge", "track_1_low_mm", "track_1_high_mm"),), ("along_mm",)
    )
    meanings = Reported(tracks=track).meanings
    assert meanings["position_mm"].startswith(
        "estimate of the place of end A from the beginning of the edge that edge tells"
    )
    assert meanings["edge"].endswith("0: it is not known")
    assert meanings["along_mm"].endswith("no place on the map while edge is 0")
    assert {"tracks", "track_1_edge", "track_1_low_mm", "track_1_high_mm"} < set(meanings)
    assert Reported().meanings["position_mm"].startswith("estimate of the place of end A on the line")


def test_usual_names() -> None:
    """A machine with the four usual outputs has an interval; with one missing it has none."""
    assert usual_names("door", OUTPUTS) == Reported()
    assert usual_names("door", ["position_mm", "margin_below_mm", "margin_above_mm"]) is None


def test_usual_names_of_before_are_refused() -> None:
    """A machine that has the margins under their names of 0.1.0 would lose its interval in silence."""
    before = ["valid", "position_mm", "under_mm", "over_mm"]
    message = (
        r"^door: of its outputs 'over_mm' is now 'margin_above_mm'; 'under_mm' is now 'margin_below_mm'\. Rename them, or "
        r"declare reported = Reported\(below='under_mm', above='over_mm'\)\.$"
    )
    with pytest.raises(InputError, match=message):
        usual_names("door", before)
    assert usual_names("door", before[1:]) is None


def test_a_recording_with_an_old_name_is_refused(tmp_path: Path) -> None:
    """With file, line and the new name."""
    stream = tmp_path / "old.jsonl"
    stream.write_text('{"source_over_mm": 3}\n', encoding="utf-8")
    with pytest.raises(StreamError, match=r"old\.jsonl:1: .* 'source_over_mm' is now 'source_margin_above_mm'\.$"):
        replay_stream(load_target("delocalized"), stream)


@pytest.mark.parametrize("name", ENTRIES)
def test_shipped_machines_declare_their_interval(name: str) -> None:
    """Every shipped machine names outputs and a ghost that it has, or its entry states the reason why it reports no interval."""
    target, reason = shipped(name), ENTRIES[name].no_interval
    assert (target.reported is None) == bool(reason), f"{name}: declare `reported` in the target, or `no_interval`"
    if target.reported is None:
        assert reason.endswith(".")
        assert hazard_claims(target), (
            f"{name}: declare `hazard` in the entry; nothing else is the top event of its faults"
        )
        return
    assert set(target.reported.outputs) <= set(target.system.outputs)
    assert target.reported.truth in {var.name for var in target.system.ghosts}


def test_delocalized_is_invalid_not_wrong(tmp_path: Path) -> None:
    """The delocalized machine without a source reports nothing: INVALID beside any truth, and no violation."""
    stream = tmp_path / "lost.jsonl"
    target = load_target("delocalized")
    inputs = [var.name for var in target.machines[0].inputs if not hasattr(var, "present")]
    quiet = {name: _quiet(target.system.variable(name)) for name in inputs}
    stream.write_text(_line({**quiet, "truth_mm": 123_456}), encoding="utf-8")
    rows, findings = replay_stream(target, stream)
    assert [row.truth for row in rows] == ["INVALID"]
    truth = next(finding for finding in findings if finding.id.endswith(": truth"))
    assert word(truth.result) == "held"


def _quiet(var: object) -> int | bool:
    low, high = getattr(var, "low", None), getattr(var, "high", None)
    if low is None or high is None:
        return False
    return int(min(max(0, low), high))


def _line(step: dict[str, int | bool]) -> str:
    return json.dumps(step) + "\n"


@pytest.mark.parametrize("truth", ['"12.5"', "true"])
def test_truth_in_whole_millimetres(tmp_path: Path, truth: str) -> None:
    """A truth that cannot be compared is refused with its line, not passed over."""
    stream = tmp_path / "odd.jsonl"
    stream.write_text('{"truth_mm": ' + truth + "}\n", encoding="utf-8")
    with pytest.raises(StreamError, match=r"odd\.jsonl:1: truth_mm is .*; give whole mm, or leave it out\."):
        replay_stream(load_target("odometry"), stream)


def test_own_interval_must_exist(tmp_path: Path) -> None:
    """A declared interval that names a missing output is refused."""
    door = Path(__file__).parent / "data" / "door_controller.py"
    text = "from safeloc.reported import Reported\n" + door.read_text(encoding="utf-8") + "\nreported = Reported()\n"
    path = tmp_path / "door_with_interval.py"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match="reported names 'position_mm'; outputs are closing_for"):
        load_target(f"{path}:machine")
