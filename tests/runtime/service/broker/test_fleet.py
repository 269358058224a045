"""A fleet over mosquitto: records in, reports out, and what may go wrong on the way. Processes are turned by hand."""

from __future__ import annotations

import json
import signal
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from safeloc.runtime.service.broker.tenure import Tenure
from safeloc.runtime.service.broker.topics import partition_of
from tests.runtime.service.broker.mosquitto import (
    PREFIX,
    Broker,
    Gateway,
    broker,
    gateway,
    messages,
    needs_mosquitto,
    without_lines,
)
from tests.runtime.service.broker.workers import Worker, alone, turn_for, turn_until
from tests.runtime.service.processes import Data, numbered, ran, read, reports, running, wait_for

pytestmark = needs_mosquitto
VEHICLES = ("a", "b", "c", "d", "e", "f")


@pytest.fixture
def there(tmp_path: Path) -> Iterator[Broker]:
    """A broker."""
    with broker(tmp_path / "broker") as made:
        yield made


@pytest.fixture
def speaker(there: Broker) -> Iterator[Gateway]:
    """The computer of all vehicles."""
    with gateway(there.port) as made:
        yield made


def owned(*workers: Worker) -> bool:
    """Each partition has its owner."""
    return sorted(one for worker in workers for one in worker.running) == [0, 1, 2, 3]


def shared(*workers: Worker) -> bool:
    """Each process has its share."""
    return owned(*workers) and all(len(worker.running) == 4 // len(workers) for worker in workers)


def heard(speaker: Gateway, vehicle: str, cycles: int) -> list[Data]:
    """The reports of the first cycles, in order of cycles."""
    found = speaker.by_cycle(vehicle)
    return [without_lines(found[cycle]) for cycle in range(1, cycles + 1) if cycle in found]


def all_heard(speaker: Gateway, cycles: int) -> bool:
    """All reports of all vehicles came."""
    return all(len(speaker.by_cycle(name)) >= cycles for name in VEHICLES)


def test_records_in_reports_out(tmp_path: Path, there: Broker, speaker: Gateway) -> None:
    """The reports of a process that reads each line once, and the last one stays at the broker."""
    said = numbered(12, "7")
    worker = Worker(there, tmp_path / "one")
    turn_until(lambda: owned(worker), "owners", worker)
    for one in messages(said):
        speaker.send("7", one)
    turn_until(lambda: len(speaker.reports) == 12, "reports", worker)
    assert heard(speaker, "7", 12) == alone("7", said)
    worker.stop()
    with gateway(there.port, name="late") as late:
        wait_for(lambda: late.reports, "the last report")
        assert [one["cycle"] for one in late.reports] == [12]
    assert set(speaker.owners().values()) == {""}


def test_a_process_rests_when_it_has_its_partitions(tmp_path: Path, there: Broker) -> None:
    """While it waits for the broker's answers about them, no turn is put off."""
    worker = Worker(there, tmp_path, gather_ms=7)
    rests = set[float]()

    def turned() -> bool:
        worker.turn()
        if any(one.station is None for one in worker.division.tenures.values()):
            rests.add(worker.division.gather_s)
        return owned(worker)

    wait_for(turned, "owners")
    worker.turn()
    assert (rests, worker.division.gather_s) == ({0.0}, 0.007)
    worker.stop()


def test_a_killed_process_costs_nothing(tmp_path: Path, there: Broker, speaker: Gateway) -> None:
    """One of two is killed in the middle of a drive: each cycle has the report that it has where nobody is killed."""
    one, other = Worker(there, tmp_path / "one"), Worker(there, tmp_path / "one")
    turn_until(lambda: shared(one, other), "shares", one, other)
    said = {name: messages(numbered(40, name)) for name in VEHICLES}
    left = [one, other]
    for cycle in range(40):
        for name in VEHICLES:
            speaker.send(name, said[name][cycle])
        turn_for(0.01, *left)
        if cycle == 20:
            one.kill()
            left = [other]
    turn_until(lambda: all_heard(speaker, 40), "reports", other)
    assert owned(other)
    for name in VEHICLES:
        assert heard(speaker, name, 40) == alone(name, numbered(40, name))
    assert not speaker.events
    other.stop()


def test_partitions_wait_for_a_worker_that_starts_again(tmp_path: Path, there: Broker, speaker: Gateway) -> None:
    """The other worker takes none of them, and gives none back; each cycle has its report. Where nobody comes, it takes them."""
    one, other = Worker(there, tmp_path / "one", worker="of-a-parent-0"), Worker(there, tmp_path / "one")
    turn_until(lambda: shared(one, other), "shares", one, other)
    events = ("partition taken", "partition released", "partition lost")
    had, others, before = one.running, other.running, [len(other.logged(event)) for event in events]
    said = {name: messages(numbered(40, name)) for name in VEHICLES}
    for cycle in range(20):
        for name in VEHICLES:
            speaker.send(name, said[name][cycle])
        turn_for(0.01, one, other)
    one.kill()
    turn_for(0.1, other)
    again = Worker(there, tmp_path / "one", worker="of-a-parent-0")
    for cycle in range(20, 40):
        for name in VEHICLES:
            speaker.send(name, said[name][cycle])
        turn_for(0.01, again, other)
    turn_until(lambda: all_heard(speaker, 40), "reports", again, other)
    assert (again.running, other.running) == (had, others)
    assert [len(other.logged(event)) for event in events] == before
    for name in VEHICLES:
        assert heard(speaker, name, 40) == alone(name, numbered(40, name))
    again.kill()
    turn_until(lambda: owned(other), "taken", other)
    other.stop()


def test_a_process_that_hangs_says_nothing_more(tmp_path: Path, there: Broker, speaker: Gateway) -> None:
    """Its partitions are taken when its leases end. When it goes on, it finds its connections ended: nothing that it knows
    reaches anybody, and no snapshot of it is read again."""
    one = Worker(there, tmp_path / "one")
    turn_until(lambda: owned(one), "owners", one)
    said = messages(numbered(30, "7"))
    for each in said[:10]:
        speaker.send("7", each)
    turn_until(lambda: len(speaker.reports) == 10, "reports", one)
    other = Worker(there, tmp_path / "one")
    turn_until(lambda: owned(other), "taken", other)
    for each in said[10:20]:
        speaker.send("7", each)
    turn_until(lambda: len(speaker.by_cycle("7")) == 20, "reports", other)
    before = len(speaker.reports)
    one.turn()
    assert not one.running
    assert {each["why"] for each in one.logged("partition lost")} != set()
    turn_until(lambda: shared(one, other), "shares", one, other)
    for each in said[20:]:
        speaker.send("7", each)
    turn_until(lambda: len(speaker.by_cycle("7")) == 30, "reports", one, other)
    assert heard(speaker, "7", 30) == alone("7", numbered(30, "7"))
    assert len(speaker.reports) - before == 10
    one.stop()
    other.stop()


def test_an_owner_stops_before_its_lease_can_be_taken(tmp_path: Path, there: Broker) -> None:
    """A broker that answers no more: within seven tenths of the lease its owner is silent, and others wait for all of it."""
    worker = Worker(there, tmp_path / "one")
    turn_until(lambda: owned(worker), "owners", worker)
    assert there.process is not None
    there.process.send_signal(signal.SIGSTOP)
    began = time.monotonic()
    turn_until(lambda: not worker.running, "it goes on", worker)
    there.process.send_signal(signal.SIGCONT)
    assert time.monotonic() - began < 0.9
    assert "confirmed no lease" in worker.logged("partition lost")[0]["why"]
    turn_until(lambda: owned(worker), "owners again", worker)
    worker.stop()


def test_two_that_want_one_partition(tmp_path: Path, there: Broker, speaker: Gateway) -> None:
    """The broker ends the connection of the one that came first; what each vehicle is told fits into one drive."""
    one = Worker(there, tmp_path / "one")
    turn_until(lambda: owned(one), "owners", one)
    partition = partition_of("7", 4)
    said = messages(numbered(30, "7"))
    for each in said[:10]:
        speaker.send("7", each)
    turn_until(lambda: len(speaker.reports) == 10, "reports", one)
    division = Worker(there, tmp_path / "one").division
    rival = Tenure(
        division._broker, division._topics, "rival", partition, division._folder, division._make, division._journal, b""
    )  # fmt: skip
    worker = Worker(there, tmp_path / "one")
    rival.open(worker.selector)
    while rival.station is None:
        for key, mask in worker.selector.select(0.002):
            list(key.data(mask))
        rival.turn(float("inf"))
        one.turn()
    assert partition not in one.running
    assert one.logged("partition lost")[0]["epoch"] < rival._epoch
    rival.release()
    turn_until(lambda: owned(one), "owners", one)
    for each in said[10:]:
        speaker.send("7", each)
    turn_until(lambda: len(speaker.by_cycle("7")) == 30, "reports", one)
    assert heard(speaker, "7", 30) == alone("7", numbered(30, "7"))
    one.stop()


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_a_broker_that_restarts(tmp_path: Path, there: Broker, speaker: Gateway, number: int) -> None:
    """Ended by a signal that it can hear, it loses nothing. Killed, it loses what it had not written: the numbers show what
    is missing, and no interval is narrower for it."""
    worker = Worker(there, tmp_path / "one")
    turn_until(lambda: owned(worker), "owners", worker)
    said = messages(numbered(80, "7"))
    for each in said[:20]:
        speaker.send("7", each)
    turn_until(lambda: len(speaker.by_cycle("7")) == 20, "reports", worker)
    there.end(number)
    for each in said[20:40]:
        speaker.send("7", each)
    turn_for(0.5, worker)
    there.start()
    turn_until(lambda: owned(worker), "owners again", worker)
    for each in said[40:]:
        speaker.send("7", each)
    turn_until(lambda: 80 in speaker.by_cycle("7"), "reports", worker)
    whole = {one["cycle"]: one for one in alone("7", numbered(80, "7"))}
    found = speaker.by_cycle("7")
    if number == signal.SIGTERM:
        assert heard(speaker, "7", 80) == list(whole.values())
    for cycle, one in found.items():
        low, high = one["interval_mm"] or (-(10**9), 10**9)
        inner = whole[cycle]["interval_mm"]
        assert inner is None or (low <= inner[0] and inner[1] <= high)
    worker.stop()


def test_messages_that_come_twice(tmp_path: Path, there: Broker, speaker: Gateway) -> None:
    """A gateway that sends everything of the last cycles again, as after a connection that broke: nothing changes."""
    said = messages(numbered(300, "7"))
    worker = Worker(there, tmp_path / "one")
    turn_until(lambda: owned(worker), "owners", worker)
    for each in [*said[:280], *said[240:280], *said[280:]]:
        speaker.send("7", each)
    turn_until(lambda: len(speaker.by_cycle("7")) == 300, "reports", worker)
    assert heard(speaker, "7", 300) == alone("7", numbered(300, "7"))
    assert worker.division.sums()["repeated"] == sum(one.count(b"\n") for one in said[240:280])
    assert not speaker.events
    worker.stop()


def test_a_vehicle_that_restarts_is_no_repetition(tmp_path: Path, there: Broker, speaker: Gateway) -> None:
    """Count and clock begin anew, and it says what it said before: it may have been moved meanwhile, so its position is
    withdrawn."""
    said = messages(numbered(40, "7"))
    worker = Worker(there, tmp_path / "one")
    turn_until(lambda: owned(worker), "owners", worker)
    for each in [*said[:30], *said[:30]]:
        speaker.send("7", each)
    turn_until(lambda: any("anew" in one for one in speaker.reports), "withdrawn", worker)
    assert next(one for one in speaker.reports if "anew" in one)["interval_mm"] is None
    assert worker.division.sums()["repeated"] == 0
    worker.stop()


def test_what_is_no_record(tmp_path: Path, there: Broker, speaker: Gateway) -> None:
    """Topics that are no vehicle's, another vehicle's lines, huge and empty messages, retained ones, any bytes: refused, and
    the other vehicle's reports are as if they had not been."""
    own = partition_of("7", 4)
    foreign = next(name for name in map(str, range(100)) if partition_of(name, 4) == own and name != "7")
    said = messages(numbered(20, "7"))
    speaker.send(foreign, said[0].replace(b'"7"', b'"%s"' % foreign.encode()), retained=True).wait_for_publish(9)
    worker = Worker(there, tmp_path / "one")
    turn_until(lambda: owned(worker), "owners", worker)
    for each in said[:10]:
        speaker.send("7", each)
    turn_until(lambda: len(speaker.reports) == 10, "reports", worker)
    speaker.send(foreign, said[10])
    speaker.send(foreign, b"\xff\xfe{")
    speaker.send(foreign, b"")
    speaker.send(foreign, b"x" * 900_000)
    speaker.send(foreign, b"{}\n" * 300)
    speaker.say(f"{PREFIX}/records/{(own + 1) % 4}/7", said[10])
    speaker.say(f"{PREFIX}/records/{own}/{'n' * 200}", said[10])
    speaker.say(f"{PREFIX}/records/{own}/with space", said[10])
    speaker.say(f"{PREFIX}/leases/{own}", b"no lease")
    speaker.say(f"{PREFIX}/leases/77", b'{"owner": "x"}')
    speaker.say(f"{PREFIX}/processes/", b"{}")
    for each in said[10:]:
        speaker.send("7", each)
    turn_until(lambda: len(speaker.by_cycle("7")) == 20, "reports", worker)
    assert heard(speaker, "7", 20) == alone("7", numbered(20, "7"))
    assert {one["vehicle"] for one in speaker.reports} == {"7"}
    turn_until(lambda: len(worker.logged("message refused")) >= 4, "the log", worker)
    assert any("a line of vehicle 7" in json.dumps(one) for one in speaker.events)
    worker.stop()


@pytest.mark.thorough
def test_processes_as_a_user_starts_them(tmp_path: Path, there: Broker, speaker: Gateway) -> None:
    """Two, of which one is killed -9; the other ends by SIGTERM, and the exit code is that of every run."""
    alike = reports(read(ran(tmp_path, said="".join(numbered(40, "7"))).stdout))
    file = tmp_path / "broker.toml"
    file.write_text("partitions = 4\nlease_ms = 5000\n", encoding="utf-8")
    words = ("--from", there.url, "--broker", str(file), "--snapshot", str(tmp_path / "kept"))
    said = messages(numbered(40, "7"))
    with running(tmp_path, *words) as one, running(tmp_path, *words) as other:
        wait_for(lambda: len({*speaker.owners().values()} - {""}) == 2, "both own")
        for each in said[:20]:
            speaker.send("7", each)
        wait_for(lambda: len(speaker.by_cycle("7")) == 20, "reports")
        one.end(signal.SIGKILL)
        for each in said[20:]:
            speaker.send("7", each)
        wait_for(lambda: len(speaker.by_cycle("7")) == 40, "reports")
        assert heard(speaker, "7", 40) == [without_lines(report) for report in alike[:40]]
        wait_for(lambda: len({*speaker.owners().values()}) == 1, "the other one owns all")
        assert other.end(signal.SIGTERM) == 0
    wait_for(lambda: set(speaker.owners().values()) == {""}, "free leases")
