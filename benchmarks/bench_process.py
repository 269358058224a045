"""Latency of the stand-alone process: python -m benchmarks.bench_process [seconds [vehicles [hertz]]]

So many vehicles, each over a TCP connection of its own, send the records of a cycle (four distances, now and then a
marker) and its end; latency is from before the lines are sent until the report has been read. In `spread` the vehicles'
cycles end one after the other, as those of vehicles that know nothing of each other; in `together` all at one moment.
Snapshots are on. Target: p99 < 5 ms for 50 vehicles at 100 Hz. Sender and process share the machine; on one that has other
work to do, `chrt -r 10` in front of the command keeps that out of the figures.
"""

from __future__ import annotations

import gc
import json
import resource
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

TARGET_P99_MS = 5.0
SECONDS, VEHICLES, HERTZ = 20, 50, 100
STEP_MM = 120
UNITS = (("front", "wheel"), ("front", "radar"), ("rear", "wheel"), ("rear", "radar"))


@dataclass
class Client:
    """One vehicle's computer: what it has sent and not yet heard of, and the latencies, in seconds."""

    name: str
    sock: socket.socket
    period_ms: int
    cycle: int = 0
    number: int = 0
    sent_at: list[float] = field(default_factory=list)
    latencies: list[float] = field(default_factory=list)
    heard: bytes = b""

    def say(self) -> None:
        """The lines of its next cycle."""
        self.cycle += 1
        text = "".join(json.dumps(self._line(one)) + "\n" for one in self._said()).encode()
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

    def _said(self) -> Iterator[dict[str, object]]:
        time_ms = self.cycle * self.period_ms
        for end, unit in UNITS:
            yield {"kind": "distance", "time_ms": time_ms, "end": end, "unit": unit, "step_mm": STEP_MM}
        if self.cycle % 200 == 1:
            place = {"position_mm": self.cycle * STEP_MM, "accuracy_mm": 500, "since_mm": 0}
            yield {"kind": "marker", "time_ms": time_ms, "end": "front", "marker": 1 + self.cycle // 200, **place}
        yield {"kind": "cycle", "time_ms": time_ms}

    def _line(self, said: dict[str, object]) -> dict[str, object]:
        self.number += 1
        return {"vehicle": self.name, "number": self.number, **said}


@contextmanager
def process(folder: Path, period_ms: int) -> Iterator[int]:
    """The process, and the port it listens on."""
    config = folder / "config.toml"
    config.write_text(f"trust_first_marker = true\nperiod_ms = {period_ms}\nreader_latency_ms = 5\n", encoding="utf-8")
    code = "from safeloc.cli import main; main()"
    where = ["--from", "tcp:0", "--snapshot", str(folder / "snapshot.json"), "--config", str(config)]
    with subprocess.Popen([sys.executable, "-c", code, "run", "odometry", *where], stderr=subprocess.PIPE) as running:
        assert running.stderr is not None
        told = json.loads(running.stderr.readline())
        try:
            yield int(told["port"])
        finally:
            running.terminate()


def drive(clients: Sequence[Client], cycles: int, period_s: float, *, together: bool) -> None:
    """Each client says its cycles in time; reports are read as they come."""
    selector = selectors.DefaultSelector()
    for client in clients:
        selector.register(client.sock, selectors.EVENT_READ, client)
    gap_s = 0.0 if together else period_s / len(clients)
    begin = time.perf_counter() + 0.1
    for due, client in sorted(
        (
            (begin + cycle * period_s + place * gap_s, client)
            for cycle in range(cycles)
            for place, client in enumerate(clients)
        ),
        key=lambda one: one[0],
    ):
        while (left := due - time.perf_counter()) > 0:
            _hear(selector, left)
        client.say()
        _hear(selector, 0)
    while any(client.sent_at for client in clients):
        _hear(selector, 1.0)
    selector.close()


def _hear(selector: selectors.BaseSelector, timeout_s: float) -> None:
    for key, _ in selector.select(timeout_s):
        key.data.hear()


def measure(seconds: float, vehicles: int, hertz: int, *, together: bool) -> list[float]:
    """Latencies in ms, sorted."""
    period_ms = 1_000 // hertz
    with tempfile.TemporaryDirectory() as folder, process(Path(folder), period_ms) as port:
        clients = [
            Client(f"v{number}", socket.create_connection(("127.0.0.1", port)), period_ms) for number in range(vehicles)
        ]
        drive(clients, int(seconds * hertz), period_ms / 1_000, together=together)
        for client in clients:
            client.sock.close()
    return sorted(latency * 1_000 for client in clients for latency in client.latencies)


def _processor_s() -> float:
    """Processor time of processes that have ended, start included."""
    spent = resource.getrusage(resource.RUSAGE_CHILDREN)
    return spent.ru_utime + spent.ru_stime


def at(latencies: Sequence[float], share: float) -> float:
    """The latency that this share of reports keeps within."""
    return latencies[min(len(latencies) - 1, int(share * len(latencies)))]


def main() -> None:
    """Measures both ways and prints."""
    gc.disable()  # the sender is not what is measured
    seconds, vehicles, hertz = (*map(int, sys.argv[1:]), *(SECONDS, VEHICLES, HERTZ)[len(sys.argv) - 1 :])
    print(f"{vehicles} vehicles at {hertz} Hz for {seconds} s, ms from lines sent to report read")
    print("cycles end     reports     p50     p90     p99   p99.9   worst   processor us a report")
    for together in (False, True):
        before = _processor_s()
        found = measure(seconds, vehicles, hertz, together=together)
        spent = (_processor_s() - before) / len(found) * 1_000_000
        shown = "".join(f"{at(found, share):8.2f}" for share in (0.5, 0.9, 0.99, 0.999, 1.0))
        print(f"{'together' if together else 'spread':10}  {len(found):10}{shown}{spent:10.0f}")
        if not together:
            print(f"target p99 < {TARGET_P99_MS} ms: {'met' if at(found, 0.99) < TARGET_P99_MS else 'MISSED'}")


if __name__ == "__main__":
    main()
