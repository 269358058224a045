"""Latency of a fleet over a broker: python -m benchmarks.bench_fleet [seconds [vehicles [machine [killed every s]]]]

So many vehicles send a message in each cycle of 100 ms, one after the other over the period, to mosquitto; two workers of
one parent divide them (`--processes 2`), with snapshots each second. Every so many seconds one of the two is killed
(kill -9), and the parent starts it again. Latency is from before a message is sent until its report has been read, over
the whole time, kills included; a report that came twice counts once. `odometry_steps` sends inputs of whole steps, one
line instead of six, which costs the workers half. Sender, broker and workers share the machine; the sender speaks MQTT by
bytes that are made beforehand, so that it takes little. Target: p99 < 100 ms with 1000 vehicles of `odometry`, and with
200 of `localizer`, on two free cores.
"""

from __future__ import annotations

import gc
import json
import os
import re
import select
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.vehicle_lines import TRAFFIC, Traffic
from safeloc.runtime.service.broker.topics import Topics, partition_of

TARGET_P99_MS = 100.0
SECONDS, VEHICLES, MACHINE, KILL_S = "130", "1000", "odometry", "60"
TICKS = 100
"""Moments of a period at which vehicles send: each ms some of them, in one call of the system."""

PERIOD_MS, PARTITIONS, WORKERS, PREFIX = 100, 8, 2, "fleet"
BROKER = """
user root
listener {port} 127.0.0.1
allow_anonymous true
max_inflight_messages 20000
max_queued_messages 0
set_tcp_nodelay true
persistence true
persistence_location {folder}/
autosave_interval 10
"""
_REPORT = re.compile(rb'"cycle": ?([0-9]+), ?"time_ms"')


class Wire:
    """The computer of all vehicles: PUBLISH of QoS 1 out, reports of QoS 0 in (MQTT 3.1.1)."""

    def __init__(self, port: int) -> None:
        self._sock = socket.create_connection(("127.0.0.1", port))
        self._sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._rest = b""
        self._mid = 0
        name = b"vehicles"
        self._sock.sendall(_packet(0x10, b"\0\4MQTT\4\2\0\0" + struct.pack(">H", len(name)) + name))
        topic = f"{PREFIX}/reports/#".encode()
        self._sock.sendall(_packet(0x82, b"\0\1" + struct.pack(">H", len(topic)) + topic + b"\0"))

    def publish(self, messages: Iterable[tuple[bytes, bytes]]) -> None:
        """Records of topic and payload, each at least once, at the same moment."""
        self._sock.sendall(b"".join(self._record(topic, payload) for topic, payload in messages))

    def _record(self, topic: bytes, payload: bytes) -> bytes:
        self._mid = self._mid % 65_535 + 1
        return _packet(0x32, topic + struct.pack(">H", self._mid) + payload)

    def reports(self, seconds: float) -> Iterator[tuple[bytes, int]]:
        """Vehicle and cycle of each report that comes in this time."""
        if not select.select([self._sock], [], [], max(0.0, seconds))[0]:
            return
        data = self._rest + self._sock.recv(1 << 20)
        at = 0
        while (found := _next(data, at)) is not None:
            kind, begin, end = found
            if kind & 0xF0 == 0x30:
                size = int.from_bytes(data[begin : begin + 2], "big")
                topic = data[begin + 2 : begin + 2 + size]
                cycle = _REPORT.search(data, begin + 2 + size, end)
                if cycle is not None:
                    yield topic.rpartition(b"/")[2], int(cycle[1])
            at = end
        self._rest = data[at:]


def _packet(kind: int, body: bytes) -> bytes:
    size, left = bytearray(), len(body)
    while True:
        left, low = divmod(left, 128)
        size.append(low | (0x80 if left else 0))
        if not left:
            return bytes((kind,)) + bytes(size) + body


def _next(data: bytes, at: int) -> tuple[int, int, int] | None:
    """The packet there: its kind, and where its body begins and ends; None if it is not complete."""
    size = shift = 0
    place = at + 1
    while True:
        if place >= len(data):
            return None
        size |= (data[place] & 0x7F) << shift
        shift += 7
        place += 1
        if not data[place - 1] & 0x80:
            return (data[at], place, place + size) if place + size <= len(data) else None


def _numbered(vehicle: str, traffic: Traffic) -> Iterator[bytes]:
    """The message of each cycle; steps get line numbers."""
    for number, text in enumerate(traffic.lines(vehicle, PERIOD_MS), 1):
        yield text if b'"number"' in text else text.replace(b'{"vehicle"', b'{"number": %d, "vehicle"' % number, 1)


@contextmanager
def mosquitto(folder: Path) -> Iterator[tuple[int, int]]:
    """Its process and its port."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    conf = folder / "mosquitto.conf"
    conf.write_text(BROKER.format(port=port, folder=folder), encoding="utf-8")
    program = shutil.which("mosquitto", path=f"{os.environ['PATH']}:/usr/sbin")
    if program is None:
        raise SystemExit("this benchmark needs mosquitto")
    with subprocess.Popen([program, "-c", str(conf)], stderr=subprocess.DEVNULL) as running:
        time.sleep(1.0)
        try:
            yield running.pid, port
        finally:
            running.terminate()


class Processes:
    """A parent with two workers; processor time of workers that were killed counts too."""

    def __init__(self, folder: Path, traffic: Traffic, port: int) -> None:
        config = folder / "config.toml"
        config.write_text(traffic.config(PERIOD_MS), encoding="utf-8")
        (folder / "broker.toml").write_text(f"partitions = {PARTITIONS}\nlease_ms = 10000\n", encoding="utf-8")
        where = ["--from", f"mqtt://127.0.0.1:{port}/{PREFIX}", "--broker", str(folder / "broker.toml")]
        options = [*traffic.arguments, *where, "--snapshot", str(folder / "kept"), "--config", str(config)]
        command = [sys.executable, "-m", "safeloc", "run", traffic.machine, *options, "--processes", str(WORKERS)]
        self._path = folder / "log"
        self._log = self._path.open("ab")
        self.spent_s = 0.0
        self._parent = subprocess.Popen(command, stderr=self._log, stdout=subprocess.DEVNULL)

    def _events(self, name: str) -> list[dict[str, Any]]:
        """What the processes logged of an event."""
        lines = self._path.read_text(encoding="utf-8", errors="replace").splitlines()
        found = (json.loads(line) for line in lines if line.startswith("{") and line.endswith("}"))
        return [one for one in found if one["event"] == name]

    def _workers(self) -> dict[int, int]:
        """The process of each worker."""
        return {one["worker"]: one["pid"] for one in self._events("worker started")}

    def settle(self) -> None:
        """Until each partition has an owner, and both have their share."""
        while len(self._events("started")) < WORKERS or len(self._events("partition taken")) < PARTITIONS:
            if self._parent.poll() is not None:
                raise SystemExit(self._path.read_text(encoding="utf-8"))
            time.sleep(0.2)
        time.sleep(3.0)

    def kill(self, which: int) -> None:
        """As kill -9; the parent starts it again."""
        pid = self._workers()[which]
        self.spent_s += _processor_s(pid)
        os.kill(pid, signal.SIGKILL)

    def processor_s(self) -> float:
        """Of all of them so far."""
        return self.spent_s + sum(_processor_s(pid) for pid in (self._parent.pid, *self._workers().values()))

    def end(self) -> None:
        """By SIGTERM."""
        self._parent.terminate()
        self._parent.wait()
        self._log.close()


def _processor_s(pid: int) -> float:
    """Processor time that a process has had so far."""
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def drive(
    wire: Wire, said: dict[str, list[bytes]], kill_s: float, processes: Processes
) -> dict[tuple[bytes, int], float]:
    """All cycles in time; returns the latency of each vehicle's cycles, in s."""
    topics = Topics(PREFIX, PARTITIONS)
    named = [(name, topics.records(partition_of(name, PARTITIONS))[:-1] + name) for name in said]
    wired = [(name.encode(), struct.pack(">H", len(topic)) + topic.encode(), said[name]) for name, topic in named]
    cycles = len(wired[0][2])
    sent: dict[tuple[bytes, int], float] = {}
    found: dict[tuple[bytes, int], float] = {}

    def hear(seconds: float) -> None:
        for one in wire.reports(seconds):
            if one in sent and one not in found:
                found[one] = time.perf_counter() - sent[one]

    ticks = [wired[len(wired) * tick // TICKS : len(wired) * (tick + 1) // TICKS] for tick in range(TICKS)]
    begin, kills = time.perf_counter() + 0.1, 0
    for cycle in range(cycles):
        if kill_s and cycle * PERIOD_MS / 1_000 >= kill_s * (kills + 1):
            processes.kill(kills % 2)
            kills += 1
        for tick, some in enumerate(ticks):
            due = begin + (cycle + tick / TICKS) * PERIOD_MS / 1_000
            if (left := due - time.perf_counter()) > 0.0:
                time.sleep(left)
            hear(0.0)  # a report counts as read up to a tick late, which spares the cores a wakeup for each
            now = time.perf_counter()
            sent.update(((name, cycle + 1), now) for name, _, _ in some)
            wire.publish((topic, texts[cycle]) for _, topic, texts in some)
    until = time.perf_counter() + 30.0
    while len(found) < len(sent) and time.perf_counter() < until:
        hear(0.1)
    return found


@dataclass(frozen=True)
class Measured:
    """What a drive took.

    sent        messages
    latencies_ms  of each that was answered, sorted
    processes_us, broker_us, sender_us  processor time a message
    """

    sent: int
    latencies_ms: Sequence[float]
    processes_us: float
    broker_us: float
    sender_us: float

    def quantile_ms(self, share: float) -> float:
        """The latency that this share of the answered messages keeps."""
        return self.latencies_ms[min(len(self.latencies_ms) - 1, int(share * len(self.latencies_ms)))]


def measured(seconds: float, vehicles: int, traffic: Traffic, kill_s: float) -> Measured:
    """Drive a fleet for so long, with its own broker and processes."""
    cycles = int(seconds * 1_000 / PERIOD_MS)
    said = {}
    for number in range(vehicles):
        lines = _numbered(f"v{number}", traffic)
        said[f"v{number}"] = [next(lines) for _ in range(cycles)]
    gc.disable()  # the sender is not what is measured
    with tempfile.TemporaryDirectory() as name, mosquitto(Path(name)) as (pid, port):
        processes = Processes(Path(name), traffic, port)
        try:
            wire = Wire(port)
            processes.settle()
            before = (processes.processor_s(), _processor_s(pid), time.process_time())
            found = drive(wire, said, kill_s, processes)
            after = (processes.processor_s(), _processor_s(pid), time.process_time())
        finally:
            processes.end()
            gc.enable()
    sent = vehicles * cycles
    spent = [(b - a) / sent * 1_000_000 for a, b in zip(before, after, strict=True)]
    return Measured(sent, sorted(latency * 1_000 for latency in found.values()), *spent)


def main() -> None:
    """Measures and prints."""
    given = (*sys.argv[1:], *(SECONDS, VEHICLES, MACHINE, KILL_S)[len(sys.argv) - 1 :])
    seconds, vehicles, traffic, kill_s = float(given[0]), int(given[1]), TRAFFIC[given[2]], float(given[3])
    one = measured(seconds, vehicles, traffic, kill_s)
    shown = "".join(f"{one.quantile_ms(share):9.1f}" for share in _SHARES)
    spent = "".join(f"{us:10.0f}" for us in (one.processes_us, one.broker_us, one.sender_us))
    late = sum(latency >= TARGET_P99_MS for latency in one.latencies_ms)
    kept = "met" if one.quantile_ms(0.99) < TARGET_P99_MS else "MISSED"
    print(
        f"{vehicles} vehicles ({traffic.machine}) at 10 Hz for {seconds:g} s, one of two workers killed each {kill_s:g} s"
    )
    print(
        "messages  unreported      p50      p90      p99    p99.9    worst ms    processes    broker    sender us     late"
    )
    unreported = one.sent - len(one.latencies_ms)
    print(f"{one.sent:8}{unreported:12}{shown}{spent}{late:9}   p99 < {TARGET_P99_MS:g} ms {kept}")


_SHARES = (0.5, 0.9, 0.99, 0.999, 1.0)

if __name__ == "__main__":
    main()
