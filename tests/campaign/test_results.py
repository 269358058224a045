"""What a campaign says of its shards, what it keeps, and the command."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from safeloc.campaign.declaration import parse_campaign
from safeloc.campaign.results_folder import write_results
from safeloc.campaign.schedule import Where, run_missing
from safeloc.campaign.shards import run_shard
from safeloc.campaign.statistics import proportion
from safeloc.catalogue import load_target
from safeloc.proof.verification.replay import read_recording, run_of
from tests.campaign.declared import SKIDDING, SMALL
from tests.campaign.test_shards import rows
from tests.cli.calling import Call


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the small campaign."""
    folder = tmp_path_factory.mktemp("campaign")
    campaign = parse_campaign(SMALL, "small.toml")
    run_missing(campaign, folder, Where(in_process=True), lambda _: None)
    write_results(campaign, folder)
    return folder


def test_results_are_counted_over_all_shards(finished: Path) -> None:
    """The sums are those of the vehicles' rows, and each comes with an interval, a method and the number of trials."""
    data = json.loads((finished / "results.json").read_text(encoding="utf-8"))
    every = [row for number in range(3) for row in rows(run_shard(SMALL, "small.toml", number), "vehicle")]
    assert 1_500 == data["vehicle_cycles"]
    words = {"law kept": "kept", "law broken": "broken", "contained": "contained", "nothing reported": "silent"}
    for one in data["laws"]:
        name = f"{words[one['law']]}_{words.get(one['interval'], 'wrong')}"
        assert sum(row[name] for row in every) == one["cycles"]
        assert sum(row[name] / 150 for row in every) / 10 == pytest.approx(one["whole"]["value"])
        assert one["whole"]["low"] <= one["whole"]["value"] <= one["whole"]["high"]
    kept, broken = data["answers"]["containment"]
    events = sum(row["broken_wrong"] > 0 for row in every)
    assert events > 0
    assert (0, events) == (kept["strata"][0]["events"], broken["strata"][0]["events"])
    assert "0 of 10: below 2.6/10 = 0.26 at 95 %" == kept["strata"][0]["says"]
    assert proportion(events, 10, 0.95).high == pytest.approx(broken["whole"]["high"])
    clauses = {one["name"]: one for one in data["clauses"]}
    assert events == clauses["the wheel keeps its error law"]["vehicles"]
    assert 0 == clauses["markers are read where they are"]["cycles"]


def test_what_was_found_is_kept_as_streams_that_replay(finished: Path) -> None:
    """Each stream ends soon after the cycle that it is kept for; there the machine reports an interval that misses the truth."""
    data = json.loads((finished / "results.json").read_text(encoding="utf-8"))
    kinds = [one["kind"] for one in data["streams"]]
    assert (3, 3, 0) == (kinds.count("broken-wrong"), kinds.count("near"), kinds.count("kept-wrong"))
    target = load_target(SKIDDING)
    for one in data["streams"]:
        stream, _ = read_recording(target, Path(one["file"]))
        step = run_of(target.system, Path(one["file"]), stream).steps[one["cycle"] - 1]
        error_nm = abs(step.state["truth_nm"] - step.outputs["position_mm"] * 10**6)
        misses = error_nm > step.outputs["margin_above_mm"] * 10**6
        assert step.outputs["valid"]
        assert misses == (one["kind"] == "broken-wrong")
        assert len(stream.steps) <= one["cycle"] + 20


def test_the_page_shows_every_figure_with_its_interval(finished: Path) -> None:
    """The words of the page; the pictures are beside it."""
    page = (finished / "index.html").read_text(encoding="utf-8")
    for words in (
        "0 of 10: below 2.6/10",
        "exact binomial (Clopper-Pearson)",
        "wrong interval",
        "Width along the line",
    ):
        assert words in page
    assert {"width.svg", "stanford.svg", "reaction.svg"} <= {path.name for path in finished.iterdir()}
    assert "misleading" in (finished / "stanford.svg").read_text(encoding="utf-8")


def test_the_command_goes_on_only_if_told_to(finished: Path, tmp_path: Path, call: Call) -> None:
    """Results, one shard alone, and refusals."""
    file = tmp_path / "small.toml"
    file.write_text(SMALL, encoding="utf-8")
    called = call("campaign", str(file), "--out", str(finished), "--in-process")
    assert (2, True) == (called.code, "holds shards already; go on with --resume" in called.err)
    called = call("campaign", str(file), "--out", str(finished), "--in-process", "--resume")
    assert 0 == called.code
    assert "3 of 3 shards" in called.err
    assert "0 of 10: below 2.6/10 = 0.26 at 95 % " in called.out.replace("\n", " \n")
    called = call("campaign", str(file), "--out", str(tmp_path / "one"), "--shard", "1")
    names = {path.name for path in (finished / "shards").iterdir()}
    assert names & {path.name for path in (tmp_path / "one" / "shards").iterdir()}
    assert 2 == call("campaign", str(file), "--out", str(tmp_path), "--in-process", "--workers", "2").code
