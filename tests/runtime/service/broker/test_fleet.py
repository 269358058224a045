"""Records over mosquitto, reports back: one process, several, and what may go wrong."""

from __future__ import annotations

import signal
from pathlib import Path

from tests.runtime.service.broker.mosquitto import (
    broker,
    broker_file,
    gateway,
    messages,
    needs_mosquitto,
    without_lines,
)
from tests.runtime.service.processes import numbered, ran, read, reports, running, wait_for

pytestmark = needs_mosquitto


def test_records_in_reports_out(tmp_path: Path) -> None:
    """The reports of a process that reads a pipe."""
    alone = reports(read(ran(tmp_path, said="".join(numbered(12, "7"))).stdout))
    file = broker_file(tmp_path)
    with (
        broker(tmp_path / "broker") as there,
        gateway(there.port) as speaker,
        running(tmp_path, "--from", there.url, "--broker", str(file), "--snapshot", str(tmp_path / "kept")) as run,
    ):
        run.logged("partition taken")
        for one in messages(numbered(12, "7")):
            speaker.send("7", one)
        wait_for(lambda: len(speaker.reports) >= 12, "reports")
        assert [without_lines(one) for one in speaker.reports] == [without_lines(one) for one in alone[:12]]
        code = run.end(signal.SIGTERM)
    assert code == 0
