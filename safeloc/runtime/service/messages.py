"""The meaning of a line: a record, the end of a cycle, or the inputs of a step, each for one vehicle.

    {"vehicle": "12", "number": 5, "kind": "distance", "time_ms": 100, ...}   a record as in docs/records.md
    {"vehicle": "12", "number": 6, "kind": "cycle", "time_ms": 100}           all records up to this time were sent
    {"vehicle": "12", "cycle": 17, "front_wheel_mm": 1200, ...}               the inputs of a step

`vehicle` and `number` (the sender's count of the vehicle's lines, from 1) may be left out if a single vehicle sends over a
lossless connection.
"""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

from pydantic_core import from_json

from safeloc.errors import InputError
from safeloc.language.renamed import renamed
from safeloc.runtime.embedding import Program
from safeloc.runtime.outside import quoted, refusal
from safeloc.runtime.service.lines import Line
from safeloc.runtime.streams.record_files import record_or_fault
from safeloc.runtime.streams.records import Record, Unusable
from safeloc.runtime.streams.steps import SCHEMA

ALONE = "1"
"""The vehicle of lines without a vehicle's name."""

TRUTH = "truth_mm"
"""Field of a step with the true position: a remark, not an input."""

LONGEST_REASON = 300
"""Most characters of a reason: a reply should not be much longer than the line."""

_MOST_NAMES = 1_000
"""Most names in one line; the largest machine has some hundred inputs."""

_MOST_RECORD_NAMES = 32
"""Most names that are read in a record; a valid one has at most nine."""

VEHICLE = re.compile(r"[A-Za-z0-9_.:-]{1,64}")


class Envelope(NamedTuple):
    """The sending vehicle, and its line number (None: lines are not numbered)."""

    vehicle: str
    number: int | None = None


class RecordLine(NamedTuple):
    """One record of a vehicle."""

    envelope: Envelope
    record: Record | Unusable


class CycleEnd(NamedTuple):
    """The end of all cycles up to this time: all of their records have been sent."""

    envelope: Envelope
    time_ms: int


class Step(NamedTuple):
    """The inputs of a step; `cycle` is its number from 1, None for the next one."""

    envelope: Envelope
    cycle: int | None
    inputs: Mapping[str, object]
    truth_mm: int | None = None


@dataclass(frozen=True)
class Header:
    """The first line of a step stream, for the vehicle without a name.

    kept   inputs that a step contains only if they changed since the step before
    """

    kept: tuple[str, ...] = ()


class Refused(NamedTuple):
    """A refused line; `vehicle` is None if even the name cannot be read."""

    reason: str
    vehicle: str | None = None
    number: int | None = None


Message = RecordLine | CycleEnd | Step | Header | Refused


class Reader:
    """A reader of the lines of one process.

    own       vehicle -> its program, if that is not the common one
    inputs    lines are inputs of steps instead of records
    numbered  every line needs a number, since lines may be lost unnoticed
    """

    def __init__(
        self,
        program: Program,
        by_vehicle: Mapping[str, Program],
        *,
        inputs: bool,
        numbered: bool,
        first: Mapping[str, object],
    ) -> None:
        self._program, self._inputs, self._numbered, self._first = program, inputs, numbered, first
        self._by_vehicle = by_vehicle
        self._ghosts = {var.name for var in program.target.system.ghosts}

    def read(self, line: Line) -> Message:
        """Return the message of a line. It never raises: an unreadable line is Refused, with the reason."""
        if line.flaw:
            return Refused(line.flaw)
        vehicle: str | None = None
        try:
            fields = json_object(line.text)
            vehicle = _vehicle(fields)
            number = _count(fields, "number")
            if self._numbered and number is None:
                raise InputError("no number: lines may be lost on the way; count them from 1 for each vehicle")
            envelope = Envelope(vehicle, number)
            return self._step(envelope, fields) if self._inputs else _record(envelope, fields)
        except Exception as error:  # the rule of every border (safeloc.runtime.outside)
            return Refused(shortened(refusal(error)), vehicle)

    def _step(self, envelope: Envelope, fields: dict[str, Any]) -> Message:
        if "schema" in fields:
            return self._header(fields)
        named = "vehicle" in fields
        cycle = _count(fields, "cycle")
        if cycle is None and named:
            raise InputError("no cycle: a step with a vehicle needs its cycle number, so that lost lines are noticed")
        truth_mm = fields.pop(TRUTH, None)
        if truth_mm is not None and type(truth_mm) is not int:
            raise InputError(f"truth_mm is {quoted(truth_mm)}; give whole mm, or leave it out")
        envelope_names = ("vehicle", "number", "cycle")
        inputs = {k: v for k, v in fields.items() if k not in self._ghosts and k not in envelope_names}
        _require_known(self._by_vehicle.get(envelope.vehicle, self._program), inputs)
        return Step(envelope, cycle, inputs, truth_mm)

    def _header(self, fields: Mapping[str, Any]) -> Header:
        if fields["schema"] != SCHEMA:
            raise InputError(f"schema is {quoted(fields['schema'])}; this version reads {SCHEMA!r}")
        machine = fields.get("machine", "")
        if machine not in ("", self._program.name):
            raise InputError(f"a stream of machine {quoted(machine)}; this process runs {self._program.name!r}")
        first = fields.get("first", {})
        if not isinstance(first, dict):
            raise InputError("`first` must be an object of initial values")
        board = {name: value for name, value in first.items() if name not in self._ghosts}
        if board != self._first:
            raise InputError(
                f"the stream begins with {quoted(board)}, this machine with {dict(self._first)}; give --first"
            )
        return Header(self._kept(fields.get("kept", [])))

    def _kept(self, names: object) -> tuple[str, ...]:
        if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
            raise InputError("`kept` must be a list of inputs that are in every step")
        kept = [name for name in names if name not in self._ghosts]
        _require_known(self._program, [name for name in kept if name != TRUTH])
        return tuple(kept)


def _require_known(program: Program, names: Collection[str]) -> None:
    """Raise InputError for a name that is no input. The message suggests no similar name: that would take longer than a step."""
    unknown = program.unknown(names)
    if unknown:
        new_name = renamed(unknown[:1], program.entries)
        raise InputError(f"{program.name} has no input {quoted(unknown[0])}{new_name}")


def _record(envelope: Envelope, fields: dict[str, Any]) -> Message:
    fields.pop("vehicle", None)
    fields.pop("number", None)
    if len(fields) > _MOST_RECORD_NAMES:
        raise InputError(f"{len(fields)} names in one record; none has more than {_MOST_RECORD_NAMES}")
    if "kind" not in fields:
        raise InputError("no kind: this is no record; to read lines with the inputs of steps, give --inputs")
    if fields["kind"] != "cycle":
        return RecordLine(envelope, record_or_fault(fields))
    time_ms = fields.get("time_ms")
    if type(time_ms) is not int or time_ms < 0 or len(fields) > 2:
        raise InputError(f"a line of kind cycle has only time_ms, in whole ms from 0; got {quoted(fields)}")
    return CycleEnd(envelope, time_ms)


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        raise InputError("a name is given twice")
    if len(found) > _MOST_NAMES:
        raise InputError(f"{len(found)} names in one line; at most {_MOST_NAMES} are read")
    return found


def _flat(text: bytes) -> dict[str, Any] | None:
    """Return the JSON object in a line in a third of the time; None if it has to be read with more care, or cannot be read.

    With as many colons as names in what was read, no name came twice, and no value has names of its own.
    """
    try:
        found = from_json(text, allow_inf_nan=False)
    except ValueError:
        return None
    return found if type(found) is dict and text.count(b":") == len(found) <= _MOST_NAMES else None


_DECODER = json.JSONDecoder(object_pairs_hook=_once)
"""Made once, since making it takes longer than reading a line."""


def json_object(text: bytes) -> dict[str, Any]:
    """Return the JSON object in a line; InputError for anything else, and for a name given twice."""
    flat = _flat(text)
    if flat is not None:
        return flat
    try:
        found = _decoded(text.decode())
    except InputError:
        raise
    except (ValueError, RecursionError) as error:
        raise InputError(f"not JSON ({error}); each line is one JSON object, docs/records.md") from error
    if not isinstance(found, dict):
        raise InputError(f"expected an object, got {type(found).__name__}")
    return found


def _decoded(text: str) -> object:
    """Decode JSON. The usual case, one object and nothing else, takes half the time."""
    if text.startswith("{"):
        found, end = _DECODER.raw_decode(text)
        if end == len(text):
            return found
    return _DECODER.decode(text)


def shortened(text: str) -> str:
    """Return the text, cut with a mark if it is longer than a reason may be."""
    return text if len(text) <= LONGEST_REASON else f"{text[:LONGEST_REASON]}... (shortened)"


def _vehicle(fields: Mapping[str, Any]) -> str:
    vehicle = fields.get("vehicle", ALONE)
    if type(vehicle) is not str or not _is_name(vehicle):
        raise InputError(f"vehicle is {quoted(vehicle)}; give up to 64 letters, digits and _ . : -")
    return vehicle


@lru_cache(maxsize=1_024)
def _is_name(vehicle: str) -> bool:
    return VEHICLE.fullmatch(vehicle) is not None


def _count(fields: Mapping[str, Any], name: str) -> int | None:
    value = fields.get(name)
    if value is not None and (type(value) is not int or not 1 <= value < 2**63):
        raise InputError(f"{name} is {quoted(value)}; count from 1, in whole numbers")
    return value
