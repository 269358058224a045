"""Latency of the stand-alone process: python -m benchmarks.bench_process [seconds [vehicles [hertz [machine]]]]

So many vehicles, each over a TCP connection of its own, send what belongs to a cycle: for `odometry` records (four
distances, now and then a marker) and its end, for `localizer` the inputs of a step of the shipped journeys. Latency is
from before the lines are sent until the report has been read. In `spread` the vehicles' cycles end one after the other, as
those of vehicles that know nothing of each other; in `together` all at one moment. Snapshots are on. Target: p99 < 5 ms for
50 vehicles at 100 Hz. Sender and process share the machine; on one that has other work to do latency says little, and the
processor time for a report says more. `chrt -r 10` in front of the command keeps other work out of the latencies.
"""

from __future__ import annotations

import gc
import json
import os
import selectors
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from benchmarks.vehicle_lines import TRAFFIC, Traffic

TARGET_P99_MS = 5.0
SECONDS, VEHICLES, HERTZ, MACHINE = "20", "50", "100", "odometry"


@dataclass
class Client:
    """One vehicle's computer: what it has sent and not yet heard of, and the latencies, in seconds."""

    lines: Iterator[bytes]
    sock: socket.socket
    sent_at: list[float] = field(default_factory=list)
    latencies: list[float] = field(default_factory=list)
    heard: bytes = b""

    def say(self) -> None:
        """The lines of its next cycle."""
        text = next(self.lines)
        self.sent_at.append(time.perf_counter())
        self.sock.sendall(text)

    def hear(self) -> None:
        """Reports that have come."""
        whole = self.heard + self.sock.recv(1 << 16)
        now = time.perf_counter()
        *lines, self.heard = whole.split(b"\n")
        for line in lines:
            if b'"mode"' not in line:
                raise RuntimeError(f"an event instead of a report: {line!r}")
            self.latencies.append(now - self.sent_at.pop(0))


@contextmanager
def process(folder: Path, traffic: Traffic, period_ms: int) -> Iterator[tuple[int, int]]:
    """The process: its id, and the port it listens on."""
    config = folder / "config.toml"
    config.write_text(traffic.config(period_ms), encoding="utf-8")
    code = "from safeloc.cli import main; main()"
    where = ["--from", "tcp:0", "--snapshot", str(folder / "snapshot.json"), "--config", str(config)]
    command = [sys.executable, "-c", code, "run", traffic.machine, *traffic.arguments, *where]
    with subprocess.Popen(command, stderr=subprocess.PIPE) as running:
        assert running.stderr is not None
        told = [json.loads(running.stderr.readline()) for _ in range(2)]
        try:
            yield running.pid, int(told[0]["port"])
        finally:
            running.terminate()


def drive(clients: Sequence[Client], cycles: int, period_s: float, *, together: bool) -> None:
    """Each client says its cycles in time; reports are read as they come."""
    selector = selectors.DefaultSelector()
    for client in clients:
        selector.register(client.sock, selectors.EVENT_READ, client)
    gap_s = 0.0 if together else period_s / len(clients)
    begin = time.perf_counter() + 0.1
    for cycle in range(cycles):
        for place, client in enumerate(clients):
            while (left := begin + cycle * period_s + place * gap_s - time.perf_counter()) > 0:
                _hear(selector, left)
            client.say()
    while any(client.sent_at for client in clients):
        _hear(selector, 1.0)
    selector.close()


def _hear(selector: selectors.BaseSelector, timeout_s: float) -> None:
    for key, _ in selector.select(timeout_s):
        key.data.hear()


@dataclass(frozen=True)
class Measured:
    """Latencies in ms, sorted, and processor time of the process for each report, in us."""

    latencies: Sequence[float]
    processor_us: float

    def at(self, share: float) -> float:
        """The latency that this share of reports keeps within."""
        return self.latencies[min(len(self.latencies) - 1, int(share * len(self.latencies)))]


def measure(traffic: Traffic, seconds: float, vehicles: int, hertz: int, *, together: bool) -> Measured:
    """Drives a process of its own; starting it is not counted."""
    period_ms = 1_000 // hertz
    with tempfile.TemporaryDirectory() as folder, process(Path(folder), traffic, period_ms) as (pid, port):
        clients = [
            Client(traffic.lines(f"v{number}", period_ms), socket.create_connection(("127.0.0.1", port)))
            for number in range(vehicles)
        ]
        before = _processor_s(pid)
        drive(clients, int(seconds * hertz), period_ms / 1_000, together=together)
        spent_s = _processor_s(pid) - before
        for client in clients:
            client.sock.close()
    latencies = sorted(latency * 1_000 for client in clients for latency in client.latencies)
    return Measured(latencies, spent_s / len(latencies) * 1_000_000)


def _processor_s(pid: int) -> float:
    """Processor time that a process has had so far."""
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def main() -> None:
    """Measures both ways and prints."""
    given = (*sys.argv[1:], *(SECONDS, VEHICLES, HERTZ, MACHINE)[len(sys.argv) - 1 :])
    seconds, vehicles, hertz = map(int, given[:3])
    traffic = TRAFFIC[given[3]]
    next(traffic.lines("first", 1_000 // hertz))
    gc.disable()  # the sender is not what is measured
    print(f"{vehicles} vehicles ({traffic.machine}) at {hertz} Hz for {seconds} s, ms from lines sent to report read")
    print("cycles end     reports     p50     p90     p99   p99.9   worst   processor us a report")
    for together in (False, True):
        found = measure(traffic, seconds, vehicles, hertz, together=together)
        shown = "".join(f"{found.at(share):8.2f}" for share in (0.5, 0.9, 0.99, 0.999, 1.0))
        kept = "met" if found.at(0.99) < TARGET_P99_MS else "MISSED"
        name = "together" if together else "spread"
        print(
            f"{name:10}  {len(found.latencies):10}{shown}{found.processor_us:10.0f}   p99 < {TARGET_P99_MS} ms {kept}"
        )


if __name__ == "__main__":
    main()
