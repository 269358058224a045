"""A shard is the same wherever it is run; what is finished is not run again, and what is damaged is."""

from __future__ import annotations

import io
import os
import re
import signal
import subprocess
import sys
import time
from collections import Counter
from dataclasses import fields
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from pyarrow import parquet

from safeloc.campaign.declaration import Campaign, parse_campaign
from safeloc.campaign.judged import Outcome, judge_of
from safeloc.campaign.scenes import drawn_runs
from safeloc.campaign.schedule import (
    ASKED,
    Progress,
    Revival,
    Where,
    local_cluster,
    numbered,
    refuse_others,
    run_missing,
)
from safeloc.campaign.shards import digests, made_by, run_shard, shard_files, write_shard
from safeloc.errors import EngineError, InputError
from safeloc.language.interpret import Program, read_inputs, start, step
from safeloc.language.system import lower
from safeloc.own_module import load_module
from safeloc.simulation.vehicle_seed import VehicleSeed
from tests.campaign.declared import SKIDDING, SMALL

HERE = Where(in_process=True)


def rows(data: bytes, kind: str) -> list[dict[str, int]]:
    """The rows of a kind in a shard's table, without empty cells."""
    table = parquet.read_table(io.BytesIO(data)).to_pylist()
    return [{key: cell for key, cell in row.items() if cell is not None} for row in table if row["row"] == kind]


def small(**changes: str) -> Campaign:
    """The small campaign, with lines of its text replaced."""
    text = SMALL
    for old, new in changes.items():
        assert f"{old} = " in text
        text = text.replace(next(line for line in text.splitlines() if line.startswith(f"{old} = ")), f"{old} = {new}")
    return parse_campaign(text, "small.toml")


def test_a_shard_counts_what_the_interpreter_sees() -> None:
    """Cycles by law and interval, the first wrong one, margins and times, of every vehicle, recomputed step by step."""
    campaign = small()
    found = [row for number in range(3) for row in rows(run_shard(campaign.text, campaign.name, number), "vehicle")]
    expected = [by_interpreter(seed) for number in range(3) for seed in seeds(campaign, number)]
    assert 10 == len(found)
    assert 0 < sum("first_wrong" in one for one in expected) < 10
    for row, one in zip(found, expected, strict=True):
        assert {name: row.get(name) for name in one} == one
    assert list(range(10)) == [row["vehicle"] for row in found]


def seeds(campaign: Campaign, number: int) -> list[int]:
    """The seeds of a shard's vehicles, drawn as a campaign draws them for a machine that takes nothing else."""
    shard, seed = campaign.shards[number], campaign.declared.seed
    rngs = [VehicleSeed(seed, (number, vehicle)).rng("simulation") for vehicle in range(shard.end - shard.first)]
    return [int(rng.integers(0, 2**31)) for rng in rngs]


def by_interpreter(seed: int) -> dict[str, int]:
    """What a row has to say of a vehicle; figures that it has not are left out."""
    module = load_module(SKIDDING.rpartition(":")[0])
    system = lower(module.machine)
    clauses, reported = Program(list(module.machine.world.terms.values())), Program(list(system.outputs.values()))
    counts: Counter[str] = Counter()
    state, law, margins, told, first = start(system, None), "kept", list[int](), list[bool](), dict[str, int]()
    for cycle, record in enumerate(module.simulate(seed)[:150]):
        inputs = read_inputs(system, {name: value for name, value in record.items() if name != "truth_mm"})
        if not all(clauses({**state, **inputs})):
            law = "broken"
            first.setdefault("first_broken", cycle)
        state, _ = step(system, state, inputs)
        outputs = dict(zip(system.outputs, reported(state), strict=True))
        told.append(bool(outputs["valid"]))
        if told[-1]:
            error_nm = abs(state[system.variable("truth_nm")] - outputs["position_mm"] * 10**6)
            margins.append(outputs["margin_above_mm"] * 10**6 - error_nm)
        what = "silent" if not told[-1] else "wrong" if margins[-1] < 0 else "contained"
        counts[f"{law}_{what}"] += 1
        if what == "wrong":
            first.setdefault("first_wrong", cycle)
    begun = first.get("first_broken")
    if begun is not None and told[begun - 1]:
        first["reaction"] = told[begun:].index(False) if False in told[begun:] else -1
    every = [f"{one}_{what}" for one in ("kept", "broken") for what in ("contained", "silent", "wrong")]
    return {**{name: counts[name] for name in every}, **first, "least_margin_nm": min(margins), "told": sum(told)}


def test_numpy_and_c_give_the_same_numbers() -> None:
    """So a computer without a compiler makes the same shards."""
    campaign = small()
    scene, _, runs = drawn_runs(campaign, campaign.shards[0])
    numpy, compiled = (judge_of(scene.target, compiled=one).outcome(runs) for one in (False, True))
    for field in fields(Outcome):
        assert np.array_equal(getattr(numpy, field.name), getattr(compiled, field.name)), field.name


def test_shards_are_the_same_bytes_again_and_differ_from_each_other() -> None:
    """Without anything but text and number; another seed gives others."""
    campaign = small()
    first, second = (run_shard(campaign.text, "small.toml", number) for number in (0, 1))
    assert first == run_shard(campaign.text + "# a remark\n", "elsewhere.toml", 0)
    assert [row["least_margin_nm"] for row in rows(first, "vehicle")] != [
        row["least_margin_nm"] for row in rows(second, "vehicle")
    ]
    assert first != run_shard(small(seed="4").text, "small.toml", 0)
    with pytest.raises(InputError, match=r"^small\.toml: no shard 3; it has 3, from 0 on\.$"):
        run_shard(campaign.text, "small.toml", 3)


def test_counts_for_pictures_add_up() -> None:
    """Every cycle with a report is in a cell of the Stanford diagram, every cycle at a place; wrong ones are told apart."""
    data = run_shard(small().text, "small.toml", 0)
    vehicles, cells, places = (rows(data, kind) for kind in ("vehicle", "stanford", "place"))
    told = sum(row["told"] for row in vehicles)
    wrong = sum(row["kept_wrong"] + row["broken_wrong"] for row in vehicles)
    assert (told, wrong) == (
        sum(row["cycles"] for row in cells),
        sum(row["cycles"] for row in cells if row["name"] == "wrong"),
    )
    assert (4 * 150, told) == (sum(row["cycles"] for row in places), sum(row["told"] for row in places))
    assert sum(row["width_sum_mm"] for row in vehicles) == sum(row["width_sum_mm"] for row in places)
    assert max(row["widest_mm"] for row in vehicles) == max(row["widest_mm"] for row in places)


def test_places_count_each_vehicle_that_was_there() -> None:
    """Its share of cycles with a report there, in millionths, and the mean width of these reports; sums of both, and of their squares."""
    campaign = small()
    scene, _, runs = drawn_runs(campaign, campaign.shards[0])
    one, step_nm = judge_of(scene.target).outcome(runs), campaign.declared.place_step_mm * 1_000_000
    there: dict[int, dict[int, list[int]]] = {}
    for cycle, vehicle in np.ndindex(one.told.shape):
        counts = there.setdefault(int(one.truth_nm[cycle, vehicle]) // step_nm, {}).setdefault(vehicle, [0, 0, 0])
        told = int(one.told[cycle, vehicle])
        for place, more in enumerate((1, told, told * int(one.width_mm[cycle, vehicle]))):
            counts[place] += more
    assert len(there) > 1
    for row in rows(run_shard(campaign.text, "small.toml", 0), "place"):
        each = there.pop(row["x"]).values()
        shares = [reports * 1_000_000 // cycles for cycles, reports, _ in each]
        means = [widths // reports for _, reports, widths in each if reports]
        assert (len(shares), sum(shares), sum(share**2 for share in shares)) == (
            row["vehicles"], row["share_sum"], row["share_squares"],
        )  # fmt: skip
        assert (len(means), sum(means), sum(mean**2 for mean in means)) == (
            row["reporting"], row["mean_sum"], row["mean_squares"],
        )  # fmt: skip
    assert not there


def test_the_digest_covers_what_a_shard_depends_on() -> None:
    """Seed, cycles, limit and size change all shards; more vehicles only the last one and those behind it; kept and remarks none."""
    base = digests(small())
    for change in ({"seed": "4"}, {"cycles": "149"}, {"alert_limit_mm": "4_000"}):
        assert not set(base.values()) & set(digests(small(**change)).values())
    more = digests(small(vehicles="14"))
    assert [True, True, False] == [base[number] == more[number] for number in range(3)]
    assert base == digests(parse_campaign(SMALL + "# a remark\n", "elsewhere.toml"))


def test_only_what_is_missing_or_damaged_is_run(tmp_path: Path) -> None:
    """A shard of the same digest stays; a damaged one and one that is gone are run."""
    told = list[Progress]()
    run_missing(small(), tmp_path, HERE, told.append)
    before = {file.number: (file.path.name, file.path.stat().st_mtime_ns) for file in shard_files(tmp_path)}
    assert (3, 3, True) == (told[-1].ran, len(before), all(file.sound for file in shard_files(tmp_path)))

    damaged = next(file.path for file in shard_files(tmp_path) if file.number == 1)
    damaged.write_bytes(damaged.read_bytes()[:-1])
    next(file.path for file in shard_files(tmp_path) if file.number == 2).unlink()
    again = run_missing(small(), tmp_path, HERE, lambda _: None)
    after = {file.number: (file.path.name, file.path.stat().st_mtime_ns) for file in shard_files(tmp_path)}
    assert (2, 1) == (again.ran, again.damaged)
    assert before[0] == after[0]
    assert [name for name, _ in before.values()] == [name for name, _ in after.values()]
    assert 0 == run_missing(small(), tmp_path, HERE, lambda _: None).ran


def test_shards_of_another_campaign_are_not_deleted_unasked(tmp_path: Path) -> None:
    """Hours may be in them: the message says how many there are, and what to do; with `discard` they are gone, and all are run."""
    run_missing(small(), tmp_path, HERE, lambda _: None)
    before = {file.path for file in shard_files(tmp_path)}
    with pytest.raises(
        InputError, match=r": 3 shards are not of this campaign as it is: .* or delete these shards with --discard\.$"
    ):
        run_missing(small(seed="4"), tmp_path, HERE, lambda _: None)
    assert before == {file.path for file in shard_files(tmp_path)}
    again = run_missing(small(seed="4"), tmp_path, HERE, lambda _: None, discard=True)
    after = {file.path for file in shard_files(tmp_path)}
    assert (3, 0, 3) == (again.ran, again.damaged, len(after))
    assert not before & after


def test_the_time_left_follows_from_the_pace_of_shards(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not from the start of workers, nor from the first shard of each, with which its machine is compiled."""
    clock = [1_000.0]
    monkeypatch.setattr("safeloc.campaign.schedule.time.monotonic", lambda: clock[0])
    progress, left = Progress(100, 20, starting=2, began=0.0), []
    for seconds in (60.0, 1.0, 2.0, 2.0):
        clock[0] += seconds
        progress.one_more(10, 1, 0)
        left.append(progress.seconds_left)
    assert [None, None, 77 * 2.0, 76 * 2.0] == left
    assert (24, 4, 40, 4, 0) == (
        progress.done,
        progress.ran,
        progress.cycles,
        progress.kept_wrong,
        progress.broken_wrong,
    )


def test_a_worker_of_another_make_runs_nothing() -> None:
    """Its shards would be others: packages, kind of processor and code of safeloc are part of every digest."""
    with pytest.raises(
        EngineError, match=rf"^a worker has {re.escape(made_by())}, this process numpy 1\.0, mips; install the same"
    ):
        numbered(SMALL, "small.toml", 0, "numpy 1.0, mips")
    assert numbered(SMALL, "small.toml", 0, made_by()) == (0, run_shard(SMALL, "small.toml", 0))
    client = SimpleNamespace(run=lambda _: {"tcp://one": made_by(), "tcp://two": "numpy 1.0"})
    with pytest.raises(EngineError, match=r"^worker tcp://two has numpy 1\.0, this process numpy "):
        refuse_others(client)
    with pytest.raises(InputError, match=r"^the scheduler has no workers"):
        refuse_others(SimpleNamespace(run=lambda _: {}))
    refuse_others(SimpleNamespace(run=lambda _: {"tcp://one": made_by()}))


def test_shards_are_run_in_turn_of_their_strata(tmp_path: Path) -> None:
    """So that what an interrupted campaign has speaks of all situations: the first shard of each, then the second of each."""
    again = (
        SMALL[SMALL.index("[[situations]]") :]
        .replace("every second one", "each second one")
        .replace("weight = 1.0", "weight = 0.5")
    )
    campaign = parse_campaign(SMALL.replace("weight = 1.0", "weight = 0.5") + again, "c.toml")
    order = list[int]()

    def note(progress: Progress) -> None:
        order.extend(file.number for file in shard_files(tmp_path) if file.number not in order and progress.ran)

    run_missing(campaign, tmp_path, HERE, note)
    assert [0, 3, 1, 4, 2, 5] == order


def test_a_shard_is_written_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where writing fails in the middle, no file is left that a later run could take for a shard."""

    def fails(_: int) -> None:
        raise OSError("no space left")

    monkeypatch.setattr("safeloc.campaign.shards.os.fsync", fails)
    with pytest.raises(OSError, match="no space left"):
        write_shard(tmp_path, 0, "0" * 16, b"table")
    assert [] == list((tmp_path / "shards").iterdir())


def test_workers_that_are_gone_for_good_are_started_anew() -> None:
    """Not while there is one, and not at once, since a killed worker starts again by itself."""
    scaled = list[int]()
    there: dict[str, int] = {}
    revive = Revival(SimpleNamespace(nthreads=lambda: there), SimpleNamespace(scale=scaled.append), 3)
    for _ in range(ASKED - 1):
        revive()
    there["tcp://worker"] = 1
    revive()
    there.clear()
    for _ in range(ASKED - 1):
        revive()
    assert scaled == []
    revive()
    assert scaled == [0, 3]


def test_workers_that_are_killed_while_they_start_are_started_again() -> None:
    """As often as that may be chance; where they never start, the message says what to do."""
    left = [RuntimeError("Nanny failed to start."), RuntimeError("Nanny failed to start.")]

    def start(**_: object) -> str:
        if left:
            raise left.pop()
        return "cluster"

    assert local_cluster(SimpleNamespace(LocalCluster=start), 2) == "cluster"
    left.extend([RuntimeError("Nanny failed to start.")] * 100)
    with pytest.raises(
        EngineError, match=r"^2 local workers did not start in 5 attempts: Nanny failed to start\. Run with"
    ):
        local_cluster(SimpleNamespace(LocalCluster=start), 2)


@pytest.mark.slow
def test_workers_that_are_killed_change_no_shard(tmp_path: Path) -> None:
    """Every worker is killed while shards are under way; the files have the names, and so the bytes, of a run in one process."""
    from distributed import get_client  # takes a second to load, and only slow tests need it

    campaign = small(vehicles="200")
    killed = set[int]()

    def kill(progress: Progress) -> None:
        if progress.ran in (3, 9):
            for pid in get_client().run(os.getpid).values():
                killed.add(pid)
                os.kill(pid, signal.SIGKILL)

    run_missing(campaign, tmp_path / "killed", Where(workers=2), kill)
    run_missing(campaign, tmp_path / "here", HERE, lambda _: None)
    names = [[file.path.name for file in shard_files(tmp_path / where)] for where in ("killed", "here")]
    assert len(killed) >= 3
    assert names[0] == names[1]
    assert 50 == len(names[0])


@pytest.mark.slow
def test_a_cluster_makes_the_same_shards(tmp_path: Path) -> None:
    """By the address of its scheduler; where none answers, the message says so."""
    from distributed import LocalCluster

    with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster:
        run_missing(small(), tmp_path / "cluster", Where(scheduler=cluster.scheduler_address), lambda _: None)
        gone = cluster.scheduler_address
    run_missing(small(), tmp_path / "here", HERE, lambda _: None)
    names = [[file.path.name for file in shard_files(tmp_path / where)] for where in ("cluster", "here")]
    assert names[0] == names[1] != []
    with pytest.raises(InputError, match=f"^--scheduler {gone}: no scheduler answers there"):
        run_missing(small(), tmp_path / "gone", Where(scheduler=gone), lambda _: None)


@pytest.mark.slow
@pytest.mark.parametrize("where", [["--in-process"], ["--workers", "2"]], ids="-".join)
def test_an_interrupted_campaign_goes_on(tmp_path: Path, where: list[str]) -> None:
    """Ctrl-C, which reaches all processes of a terminal, loses the shards under way; those that are done stay as they are, and are not run again."""
    file, folder = tmp_path / "small.toml", tmp_path / "out"
    file.write_text(small(vehicles="400").text, encoding="utf-8")
    command = [sys.executable, "-m", "safeloc", "campaign", str(file), "--out", str(folder), *where]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, start_new_session=True) as process:
        while len(list(folder.glob("shards/*.parquet"))) < 3:
            assert process.poll() is None
            time.sleep(0.05)
        os.killpg(process.pid, signal.SIGINT)
        _, said = process.communicate(timeout=60)
    done = {path.name: path.stat().st_mtime_ns for path in folder.glob("shards/*.parquet")}
    assert 130 == process.returncode
    assert f"interrupted: {len(done)} shards are kept in {folder}; go on with --resume." in said
    assert "Traceback" not in said
    assert [] == list(folder.glob("shards/*.partial"))
    subprocess.run([*command, "--resume", "--json"], check=True, capture_output=True)
    after = {path.name: path.stat().st_mtime_ns for path in folder.glob("shards/*.parquet")}
    assert 3 <= len(done) < len(after) == 100
    assert done.items() <= after.items()
