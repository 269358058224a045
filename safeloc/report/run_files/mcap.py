"""Runs as MCAP, for Foxglove and other viewers of robot data, with the package mcap (extra `traces`).

A topic for inputs, transitions, state and outputs each; a message a step, as JSON with a schema. A step without a known time takes
a second.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from safeloc.errors import InputError
from safeloc.report.run_files.columns import GROUPS, Column, RunColumns

_TYPES = {"number": "integer", "truth": "boolean", "label": "string"}
_NS_PER_MS = 1_000_000
_STEP_MS = 1_000


def write_mcap(path: Path, run: RunColumns) -> None:
    """Write the run as MCAP; an absent value is left out of its message. InputError without the package."""
    period_ms = run.period_ms or _STEP_MS
    groups = [(name, [one for one in run.columns if one.group == name]) for name in GROUPS]
    with path.open("wb") as file:
        writer = _writer(path)(file)
        writer.start(profile="", library="safeloc")
        channels = [(_channel(writer, run.machine, name, columns), columns) for name, columns in groups if columns]
        for number in range(run.steps):
            time_ns = (number + 1) * period_ms * _NS_PER_MS
            for channel, columns in channels:
                data = json.dumps(_message(columns, number)).encode()
                writer.add_message(channel, log_time=time_ns, publish_time=time_ns, sequence=number + 1, data=data)
        writer.finish()


def _channel(writer: Any, machine: str, group: str, columns: Sequence[Column]) -> int:
    properties = {one.name: {"type": _TYPES[one.kind], "description": one.unit} for one in columns}
    schema = writer.register_schema(
        name=f"{machine}.{group}",
        encoding="jsonschema",
        data=json.dumps({"type": "object", "properties": properties}).encode(),
    )
    channel: int = writer.register_channel(topic=f"/{machine}/{group}", message_encoding="json", schema_id=schema)
    return channel


def _message(columns: Sequence[Column], number: int) -> dict[str, Any]:
    return {one.name: one.values[number] for one in columns if one.values[number] is not None}


def _writer(path: Path) -> Any:
    try:
        from mcap.writer import Writer
    except ImportError as error:
        raise InputError(f"{path}: MCAP needs the package mcap; install safeloc[traces], or write .csv.") from error
    return Writer
