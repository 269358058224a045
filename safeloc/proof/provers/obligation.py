"""One free obligation and what was found of it, before it becomes a Finding."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.verdict import Verdict


@dataclass(frozen=True, eq=False)
class Obligation:
    """`name` within its system; `method` for the reader."""

    name: str
    statement: str
    verdict: Verdict
    method: str
