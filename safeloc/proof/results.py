"""Findings: statements with verdicts, in the form that command line, report and tests share."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from safeloc.language.html_views import html_table
from safeloc.language.trace import Trace
from safeloc.language.verdict import Result, told

Kind = Literal["property", "obligation", "lemma", "test", "replay"]


@dataclass(frozen=True, eq=False)
class Replayed:
    """A whole recorded run through a machine; findings of one replay share it.

    name      of the recording, without the extension of its file
    truth_mm  the recorded truth after each step, None where it is not known
    """

    name: str
    trace: Trace
    truth_mm: tuple[int | None, ...]


@dataclass(frozen=True, eq=False)
class Finding:
    """A statement about a machine, with its verdict.

    id            unique within a report: "machine/kind/name"
    method        engine and what it relied on, for the reader
    seconds       time it took
    requirements  ids of the requirements that it verifies
    assumption    the assumption that the verdict relies on, in words ("" for none)
    truth_mm      the truth after each step of the violated run, from a recording that holds it; None where it is not known
    replayed      the recorded run that the verdict is about
    notes         further information for the reader, such as the properties that were not checked
    kept_since    the date (UTC) of the earlier run whose cached result this is; "" for a new result
    kept_as       the digest of the results with which it is in the cache; "" if it is not
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
    kept_as: str = ""


class Findings(list[Finding]):
    """A list of findings, which a notebook shows as a table."""

    def _repr_html_(self) -> str:
        count = Counter(told(one.result) for one in self)
        rows = (
            (told(one.result), one.machine, one.kind, one.id.split("/", 2)[-1], one.statement, one.method)
            for one in self
        )
        total = ", ".join(f"{number} {verdict}" for verdict, number in count.items()) or "no findings"
        return f"<p>{total}</p>" + html_table(("verdict", "machine", "kind", "name", "statement", "method"), rows)
