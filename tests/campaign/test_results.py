"""What a campaign says of its shards, what it keeps, and the command."""

from __future__ import annotations

import json
import shutil
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

import safeloc
from safeloc.campaign.aggregate import Results
from safeloc.campaign.declaration import parse_campaign
from safeloc.campaign.regression import NAME, standing_at
from safeloc.campaign.results_folder import write_results
from safeloc.campaign.schedule import Where, run_missing
from safeloc.campaign.shards import run_shard
from safeloc.campaign.statistics import proportion
from safeloc.catalogue import load_target
from safeloc.codegen.batch import compile_batch, simulate
from safeloc.codegen.batch_lanes import compile_lanes
from safeloc.language.interpret import run
from safeloc.proof.verification.replay import read_recording, run_of
from safeloc.report.style_sheet import style_sheet
from safeloc.runtime.streams.steps import read_steps
from safeloc.simulation.many_runs import packed
from tests.campaign.declared import SKIDDING, SMALL
from tests.campaign.test_shards import rows
from tests.cli.calling import Call
from tests.codegen.c_folder import needs_compiler
from tests.started_pytest import run_pytest

ROOT = Path(safeloc.__file__).parents[1]


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


def test_files_are_read_once(finished: Path, tmp_path: Path) -> None:
    """Counts of a place and of a cell are those of all shards together; no question goes back to the files, of which there
    may be thousands."""
    campaign = parse_campaign(SMALL, "small.toml")
    shutil.copytree(finished / "shards", tmp_path / "shards")
    results = Results(campaign, tmp_path)
    shutil.rmtree(tmp_path / "shards")
    shards = [run_shard(SMALL, "small.toml", number) for number in range(3)]
    cells: Counter[tuple[int, int, str]] = Counter()
    for row in (row for shard in shards for row in rows(shard, "stanford")):
        cells[row["x"], row["y"], row["name"]] += row["cycles"]
    assert cells == {(x, y, name): cycles for x, y, name, cycles in results.stanford()}
    places: dict[int, list[dict[str, Any]]] = {}
    for row in (row for shard in shards for row in rows(shard, "place")):
        places.setdefault(row["x"], []).append(row)
    assert any(len(some) > 1 for some in places.values())
    found = results.along(campaign.strata[0], 60_000)
    assert [one.number for one in found] == sorted(places)
    for one, some in zip(found, (places[number] for number in sorted(places)), strict=True):
        total = {name: sum(row[name] for row in some) for name in ("vehicles", "share_sum", "reporting", "mean_sum")}
        assert (one.vehicles, one.reporting) == (total["vehicles"], total["reporting"])
        assert one.widest_mm == max(row["widest_mm"] for row in some)
        assert one.told.value == pytest.approx(total["share_sum"] / total["vehicles"] / 1e6)
        assert one.width_mm is None or one.width_mm.value == pytest.approx(total["mean_sum"] / total["reporting"])
    assert results.as_data()["vehicle_cycles"] == 1_500


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


def test_of_every_situation_the_worst_is_kept(tmp_path: Path) -> None:
    """Whichever situation has the longest wrong intervals; of near misses `kept` in all. How many there were is told."""
    again = SMALL[SMALL.index("[[situations]]") :].replace("every second one", "each second one")
    text = f"{SMALL}{again}".replace("weight = 1.0", "weight = 0.5").replace("seed = 3", "seed = 3\nkept = 1")
    campaign = parse_campaign(text, "two.toml")
    run_missing(campaign, tmp_path, Where(in_process=True), lambda _: None)
    data = write_results(campaign, tmp_path)
    wrong = [one for one in data["streams"] if one["kind"] == "broken-wrong"]
    assert {campaign.words_of(one) for one in campaign.strata} == {one["stratum"] for one in wrong} and 2 == len(wrong)
    found = {one["kind"]: (one["vehicles"], one["kept"]) for one in data["found"]}
    vehicles = [row for number in range(6) for row in rows(run_shard(text, "two.toml", number), "vehicle")]
    assert (sum(row["broken_wrong"] > 0 for row in vehicles), 2) == found["broken-wrong"]
    assert ((0, 0), 1) == (found["kept-wrong"], found["near"][1])
    for stratum, one in enumerate(sorted(wrong, key=lambda one: one["shard"])):
        own = [row for row in vehicles if row["stratum"] == stratum]
        [kept] = [row for row in own if (row["shard"], row["vehicle"]) == (one["shard"], one["vehicle"])]
        assert kept["longest_wrong"] == max(row["longest_wrong"] for row in own if "longest_wrong" in row)


def test_a_kept_stream_is_shortened_to_what_matters(finished: Path) -> None:
    """Readings that do not matter are left out, and what was kept is still shown (the tests around); distances that matter stay."""
    data = json.loads((finished / "results.json").read_text(encoding="utf-8"))
    assert all(one["messages_left"] < one["messages"] for one in data["streams"])
    broken = next(one for one in data["streams"] if one["kind"] == "broken-wrong")
    steps = read_steps(Path(broken["file"])).steps
    assert broken["messages_left"] == sum(len(step.keys() - {"run_nm"}) for step in steps)
    assert any("wheel_mm" in step for step in steps[-25:])


def test_the_regression_test_passes_and_fails_as_it_says(finished: Path) -> None:
    """Near misses stay contained, a wrong interval after a broken law is expected; a stream of another kind is noticed."""
    told = run_pytest("-q", str(finished / "streams" / NAME), folder=finished)
    assert (0, True) == (told.returncode, "3 passed, 3 xfailed" in told.stdout), told.stdout
    target = load_target(SKIDDING)
    data = json.loads((finished / "results.json").read_text(encoding="utf-8"))
    found = {one["kind"]: standing_at(target, Path(one["file"]), one["cycle"]) for one in data["streams"]}
    assert {"broken-wrong": "WRONG", "near": "contained"} == found


@needs_compiler
def test_a_kept_stream_replays_alike_in_every_back_end(finished: Path) -> None:
    """Interpreter, generated Python, numpy and C tell the same in every cycle of every stream."""
    data, target = json.loads((finished / "results.json").read_text(encoding="utf-8")), load_target(SKIDDING)
    names = list(target.system.outputs)
    for one in data["streams"]:
        stream, _ = read_recording(target, Path(one["file"]))
        expected = [dict(step.outputs) for step in run(target.system, stream.steps, first=stream.first).steps]
        quick = [dict(step.outputs) for step in run_of(target.system, Path(one["file"]), stream).steps]
        inputs = packed(target.system, [stream.steps], len(stream.steps))
        assert expected == quick
        for code in (compile_batch(target.system, names), compile_lanes(target.system, names)):
            kept = simulate(code, inputs, start_state=stream.first).kept
            assert expected == [{name: kept[name][cycle, 0].item() for name in names} for cycle in range(len(expected))]


def test_the_page_shows_every_figure_with_its_interval(finished: Path) -> None:
    """The words of the page, in the style of all pages; the pictures are beside it."""
    page = (finished / "index.html").read_text(encoding="utf-8")
    assert style_sheet() in page and "font:15px" in page and "{%" not in page and "{{" not in page
    for words in (
        "0 of 10: below 2.6/10",
        "exact binomial (Clopper-Pearson)",
        "wrong interval",
        "Width along the line",
        "streams/test_found.py",
    ):
        assert words in page
    assert {"width.svg", "availability.svg", "margins.svg", "stanford.svg", "reaction.svg"} <= {
        path.name for path in finished.iterdir()
    }
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
    called = call("campaign", str(file), "--out", str(tmp_path / "one"), "--shard", "3")
    assert (2, True) == (called.code, "has the shards 0 to 2." in " ".join(called.err.split()))
    assert 2 == call("campaign", str(file), "--out", str(tmp_path), "--in-process", "--workers", "2").code
