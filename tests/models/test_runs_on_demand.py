"""Named runs that do not ship: made when they are needed, and the same as when they were looked at."""

from __future__ import annotations

import gzip
import hashlib
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

import pytest

from safeloc.catalogue import ENTRIES, load_target
from safeloc.language.verdict import word
from safeloc.models.axle_counter import AxleCounterConfig
from safeloc.models.axle_counter import simulate as axle_counter_runs
from safeloc.models.axle_section import AxleSectionConfig
from safeloc.models.axle_section import simulate as axle_section_runs
from safeloc.models.emitter import EmitterConfig
from safeloc.models.emitter import simulate as emitter_runs
from safeloc.models.fibre_area import recorded_runs as fibre_area_runs
from safeloc.models.route import recorded_runs as route_runs
from safeloc.models.train_order import TrainOrderConfig
from safeloc.models.train_order import simulate as train_order_runs
from safeloc.models.verification import VerificationConfig
from safeloc.models.verification import recorded_runs as verification_runs
from safeloc.proof.drawn_runs.worked import WorkedRun, write_named, write_runs
from safeloc.proof.verification.replay import replay_stream
from safeloc.target import recorded

WRITE: Mapping[str, Callable[[Path], list[Path]]] = {
    "axle_counter": partial(write_runs, runs=axle_counter_runs.ON_DEMAND, config=AxleCounterConfig()),
    "axle_section": partial(write_runs, runs=axle_section_runs.ON_DEMAND, config=AxleSectionConfig()),
    "emitter": partial(write_runs, runs=emitter_runs.ON_DEMAND, config=EmitterConfig()),
    "fibre_area": partial(fibre_area_runs.write, journeys=fibre_area_runs.ON_DEMAND),
    "route": partial(route_runs.write, runs=route_runs.ON_DEMAND),
    "train_order": partial(write_runs, runs=train_order_runs.ON_DEMAND, config=TrainOrderConfig()),
    "verification": partial(write_runs, runs=verification_runs.ON_DEMAND, config=VerificationConfig()),
}
DIGESTS = {
    "axle_counter-braking.jsonl.gz": "d358b1e713611505",
    "axle_counter-miscount.jsonl.gz": "d47efaf1194e654d",
    "axle_counter-power-up.jsonl.gz": "7218576285aff685",
    "axle_section-miscount.jsonl.gz": "33110548ca24526f",
    "emitter-unanswered.jsonl.gz": "a0aff0e8afe7b741",
    "fibre_area-turned-back.jsonl.gz": "deccb6d61b0ed8b2",
    "route-adab-every-reflector.jsonl.gz": "ae8dfb9a4bd77c64",
    "route-adad-every-reflector.jsonl.gz": "a15aacf699efec8d",
    "route-adcd-every-reflector.jsonl.gz": "eb02e297ea719c88",
    "route-dcd-every-reflector.jsonl.gz": "a7375378e228e23e",
    "train_order-close-together.jsonl.gz": "d27cc61483e8a676",
    "train_order-ghost-pattern.jsonl.gz": "27a540fa2c540b9d",
    "train_order-lost-pattern.jsonl.gz": "25ab9a7acd44fcee",
    "verification-miscount.jsonl.gz": "fe24f17a47c8e8a1",
}
"""Of the unpacked file, since another version of zlib may pack it otherwise."""


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("machine", WRITE)
def test_it_comes_out_the_same(machine: str, tmp_path: Path) -> None:
    """None of them ships, and replayed as `verify` does whatever can be judged on it holds."""
    made = WRITE[machine](tmp_path)
    digests = {path.name: hashlib.sha256(gzip.decompress(path.read_bytes())).hexdigest()[:16] for path in made}
    assert {name: digest for name, digest in DIGESTS.items() if name.startswith(f"{machine}-")} == digests
    assert not {path.name for path in recorded(machine)} & set(digests)
    target = load_target(machine)
    for path in made:
        assert {"held"} == {word(one.result) for one in replay_stream(target, path)[1]}


def test_each_is_asked_for() -> None:
    """The table names machines that ship, and each has a run."""
    assert set(WRITE) == {name.partition("-")[0] for name in DIGESTS}
    assert set(WRITE) <= set(ENTRIES)


STILL: Mapping[str, WorkedRun[None]] = {"axle_head-still": WorkedRun("Nothing.", lambda _: [{"a": False}])}


def test_a_folder_gets_what_is_made_on_demand(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a folder the runs that ship are written beside the file that makes them."""
    (tmp_path / "recordings").mkdir()
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.setattr("sys.argv", ["simulate.py"])
    write_named(str(tmp_path / "simulate.py"), STILL, {}, None)
    assert (tmp_path / "recordings" / "axle_head-still.jsonl.gz").is_file()
    monkeypatch.setattr("sys.argv", ["simulate.py", str(tmp_path / "elsewhere")])
    write_named(str(tmp_path / "simulate.py"), {}, STILL, None)
    assert (tmp_path / "elsewhere" / "axle_head-still.jsonl.gz").is_file()


def test_a_folder_for_nothing_is_refused(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Where every run ships there is nothing to write into a folder."""
    monkeypatch.setattr("sys.argv", ["simulate.py", str(tmp_path)])
    with pytest.raises(SystemExit, match="All named runs of this machine ship"):
        write_named(str(tmp_path / "simulate.py"), STILL, {}, None)
