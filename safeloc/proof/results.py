"""One checked statement, whatever checked it: what command line, report and tests exchange."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from safeloc.language.trace import Trace
from safeloc.language.verdict import Result

Kind = Literal["property", "obligation", "lemma", "test", "replay"]


@dataclass(frozen=True, eq=False)
class Replayed:
    """A whole recorded run through a machine; findings of one replay share it.

    name      of the recording, without the ending of its file
    truth_mm  the recorded truth after each step, None where it is not known
    """

    name: str
    trace: Trace
    truth_mm: tuple[int | None, ...]


@dataclass(frozen=True, eq=False)
class Finding:
    """A statement about a machine and what was found.

    id            unique within a report: "machine/kind/name"
    method        engine and what it relied on, for the reader
    seconds       time it took
    requirements  requirement ids it answers for
    assumption    the assumption it was shown under, in words ("" for none)
    truth_mm      of a recording that holds it: the truth after each step of the violated run, None where it is not known
    replayed      the recorded run that it was found on
    notes         what a reader of it has to know besides, such as what was not checked
    kept_since    of what was found by an earlier run of the same: when that was (UTC); "" for what was found now
    """

    id: str
    machine: str
    kind: Kind
    statement: str
    result: Result
    method: str
    seconds: float
    requirements: tuple[str, ...] = ()
    assumption: str = ""
    truth_mm: tuple[int | None, ...] = ()
    replayed: Replayed | None = None
    notes: Mapping[str, str] = field(default_factory=dict)
    kept_since: str = ""
