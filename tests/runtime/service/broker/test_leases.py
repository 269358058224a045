"""Who owns what: the division of a fleet, leases and their time, epochs of snapshots."""

from __future__ import annotations

from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.errors import InputError, SnapshotError
from safeloc.runtime.embedding.snapshot import sealed
from safeloc.runtime.service.broker.epochs import Epochs, require_layout
from safeloc.runtime.service.broker.leases import BACK_S, STOP_SHARE, Lease, Leases, divided, lease_text, read_lease
from safeloc.runtime.service.broker.topics import Topics, partition_of
from safeloc.runtime.service.saving import KIND, VERSION

NAMES = st.sampled_from("abcdef")


@given(st.dictionaries(st.integers(0, 15), st.sampled_from(["", *"abcdef"]), min_size=1), st.sets(NAMES, min_size=1))
def test_the_division(owners: dict[int, str], processes: set[str]) -> None:
    """Each process comes to the same; nothing moves that need not; nobody takes what another one has; and when all has
    moved, shares differ by one at most."""
    found = divided(owners, processes)
    assert found == divided(dict(reversed(owners.items())), sorted(processes, reverse=True))
    for one, owner in found.items():
        assert owner == "" or owner in processes or owner == owners[one]
        if owners[one]:
            assert owner in ("", owners[one])
    after = divided(found, processes)
    counts = Counter(dict.fromkeys(processes, 0)) + Counter(owner for owner in after.values() if owner in processes)
    strangers = sum(owner not in processes for owner in after.values())
    assert "" not in after.values()
    if not strangers:
        assert max(counts[name] for name in processes) - min(counts[name] for name in processes) <= 1
    assert divided(after, processes) == after


@given(st.integers(1, 64), st.sets(NAMES, min_size=2), NAMES)
def test_only_what_has_to_move_moves(partitions: int, processes: set[str], gone: str) -> None:
    """Of a process that went, its partitions; and no other one loses any."""
    before = divided(dict.fromkeys(range(partitions), ""), processes)
    left = processes - {gone} or processes
    after = divided({one: "" if owner not in left else owner for one, owner in before.items()}, left)
    assert {one for one in before if before[one] != after[one]} == {one for one in before if before[one] not in left}


@given(st.floats(0, 5), st.floats(0.95, 1.05), st.floats(0.95, 1.05), st.integers(0, 9))
def test_the_owner_stops_first(other: float, rate: float, other_rate: float, renewals: int) -> None:
    """Whatever two clocks show, if their rates differ by a tenth at most: when another process may take a partition, its
    owner has stopped. Renewals take any time up to a lease, and the last one is confirmed at once."""
    length_s = 10.0
    leases = Leases("b", 1, length_s)
    sent = arrived = 0.0
    for number in range(renewals + 1):
        sent = number * 2.0
        arrived = sent + (number * 7 % 10) / 10 * 2.0
        leases.heard_lease(0, Lease("a"), other + arrived * other_rate)
    stops = sent + STOP_SHARE * length_s / rate
    assert leases.owner(0, other + stops * other_rate) == "a"
    assert leases.owner(0, other + (arrived + length_s / other_rate) * other_rate + 1e-6) == ""


def test_leases_in_time() -> None:
    """A lease that was given up is free at once; one of which nothing is heard, after its length; time in which this process
    heard nothing does not count."""
    leases = Leases("me", 4, 5.0)
    for partition in range(4):
        leases.heard_lease(partition, Lease("other"), 0.0)
    leases.heard_process("other", Lease("other"), 0.0)
    assert leases.mine(4.0, ()) == set()
    leases.heard_lease(2, Lease(""), 4.0)
    assert leases.mine(4.0, ()) == {2}
    leases.pass_over(5.0)
    assert leases.mine(9.9, {2}) == {2}
    assert leases.mine(10.1, {2}) == {0, 1, 2, 3}
    leases.heard_process("other", Lease("other"), 11.0)
    assert leases.processes(11.0) == ["me", "other"]
    leases.heard_process("other", Lease(""), 11.0)
    assert leases.processes(11.0) == ["me"]


@pytest.mark.parametrize(
    "text", [b"x", b"[]", b"[" * 100_000, b'{"owner": 1}', b'{"owner": "%s"}' % (b"x" * 65), b"\xff"]
)
def test_what_is_no_lease(text: bytes) -> None:
    """None, whatever it is."""
    assert read_lease(text) is None


def test_what_is_one() -> None:
    """Its owner; an empty message is a free one; and for how long it is waited for an owner that ended."""
    assert read_lease(lease_text("a", 3)) == Lease("a")
    assert read_lease(lease_text("")) == read_lease(b"") == Lease("")
    assert read_lease(lease_text("a", back_s=1.5)) == Lease("a", 1.5)


@pytest.mark.parametrize("back_ms", ["-1", "10001", "1.5", "true", '"1500"', "null"])
def test_a_wait_that_is_not_believed(back_ms: str) -> None:
    """The lease then ends by its length, as any other."""
    assert read_lease(b'{"owner": "a", "back_ms": %s}' % back_ms.encode()) == Lease("a")


@pytest.mark.parametrize("length_s", [0.5, 5.0])
def test_partitions_wait_for_a_worker(length_s: float) -> None:
    """Nothing of a worker that ended is taken until it should be back; it has all of it when it is; else the others have it."""
    waits_s = min(BACK_S, length_s)
    leases = Leases("me", 4, length_s)
    for partition in range(4):
        leases.heard_lease(partition, Lease("me" if partition < 2 else "other"), 0.0)
    leases.heard_process("other", Lease("other"), 0.0)
    ended = Lease("other", BACK_S)
    leases.heard_process("other", ended, 0.0)
    for partition in (2, 3):
        leases.heard_lease(partition, ended, 0.0)
    assert leases.mine(0.99 * waits_s, {0, 1}) == {0, 1}
    assert leases.mine(1.01 * waits_s, {0, 1}) == {0, 1, 2, 3}
    again = Leases("other", 4, length_s)
    again.heard_process("me", Lease("me"), 0.0)
    for partition in range(4):
        again.heard_lease(partition, Lease("me") if partition < 2 else ended, 0.0)
    assert again.mine(0.1, ()) == {2, 3}


@given(st.text(max_size=80), st.integers(0, 7))
def test_a_topic_names_a_vehicle_of_its_partition(vehicle: str, partition: int) -> None:
    """Or none."""
    topics = Topics("fleet", 8)
    found = topics.vehicle(f"fleet/records/{partition}/{vehicle}", partition)
    assert found in (None, vehicle)
    if found is not None:
        assert partition_of(found, 8) == partition
    assert topics.vehicle(f"other/records/{partition}/{vehicle}", partition) is None


def test_partitions_are_those_of_the_page() -> None:
    """CRC-32 as everywhere: vehicles compute it too."""
    assert (partition_of("12", 16), partition_of("123456789", 2**32)) == (13, 0xCBF43926)


def test_a_later_owner_reads_what_the_ones_before_saved(tmp_path: Path) -> None:
    """Of the highest epoch that has a snapshot; what an earlier owner writes afterwards is not read."""
    require_layout(tmp_path, 4)
    first = Epochs(tmp_path, 0)
    one = first.claim()
    assert first.last(one) is None
    first.path(one).write_bytes(sealed({"state": 1}, KIND, VERSION))
    unused, two = Epochs(tmp_path, 0).claim(), Epochs(tmp_path, 0).claim()
    assert one < unused < two
    assert not first.alone_between(one, two) and first.alone_between(unused, two)
    assert (first.last(two) or {})["state"] == 1
    first.path(two).write_bytes(sealed({"state": 2}, KIND, VERSION))
    first.forget_before(two)
    first.path(one).write_bytes(sealed({"state": 3}, KIND, VERSION))
    three = first.claim()
    assert (first.last(three) or {})["state"] == 2
    assert three > two


def test_a_damaged_snapshot_is_not_passed_over(tmp_path: Path) -> None:
    """An older one would bring back what was withdrawn since."""
    epochs = Epochs(tmp_path, 0)
    epochs.path(epochs.claim()).write_bytes(sealed({"state": 1}, KIND, VERSION))
    epochs.path(epochs.claim()).write_bytes(b"damaged")
    with pytest.raises(SnapshotError):
        epochs.last(epochs.claim())


@pytest.mark.parametrize("numbers", [(4,) * 8, (4, 8) * 4])
def test_a_folder_for_several_that_begin_at_once(tmp_path: Path, numbers: tuple[int, ...]) -> None:
    """One makes it, all others find it, and those of another number are refused."""
    together = Barrier(len(numbers))

    def refused(partitions: int) -> str:
        together.wait(60)
        try:
            require_layout(tmp_path / "kept", partitions)
        except InputError as error:
            return str(error)
        return ""

    with ThreadPoolExecutor(len(numbers)) as pool:
        told = dict(zip(enumerate(numbers), pool.map(refused, numbers), strict=True))
    (one,) = {number for (_, number), why in told.items() if not why}
    for (_, number), why in told.items():
        assert why == "" if number == one else f"snapshots of {one} partitions, not {number}" in why


def test_a_folder_of_another_division(tmp_path: Path) -> None:
    """Its vehicles are in other partitions."""
    require_layout(tmp_path / "kept", 4)
    require_layout(tmp_path / "kept", 4)
    with pytest.raises(InputError, match="snapshots of 4 partitions, not 8"):
        require_layout(tmp_path / "kept", 8)
    (tmp_path / "file").write_text("", encoding="utf-8")
    with pytest.raises(InputError, match="no folder"):
        require_layout(tmp_path / "file", 4)
