"""Findings of targets, kept under the digests of engine and target, and what was asked for.

A target of which anything was not decided is not kept: it is asked again, when the machine may be less busy.
"""

from __future__ import annotations

import gzip
import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass, replace

from safeloc.language.verdict import Unknown
from safeloc.proof.cache.contents import target_digest
from safeloc.proof.cache.engine import engine_digest, undisturbed
from safeloc.proof.cache.store import Store
from safeloc.proof.results import Finding
from safeloc.proof.verification.plain import pack_findings, unpack_findings
from safeloc.target import Target

KIND = "findings"
QUICKLY = 3  # of gzip's levels: a third more than the smallest, in a fifth of the time


@dataclass(frozen=True)
class Asked:
    """A request about a target, with its key."""

    target: Target
    key: str


def asked(target: Target, *question: object) -> Asked:
    """Return a question to a target, such as the plan of its verification; `question` is told by its repr."""
    told = "\0".join([engine_digest(), target_digest(target), *map(repr, question)])
    return Asked(target, hashlib.sha256(told.encode()).hexdigest())


def found_before(store: Store | None, one: Asked) -> list[Finding] | None:
    """Return the findings, each with the time since when it is kept; None where the question has to be asked."""
    entry = None if store is None else store.get(KIND, one.key)
    if entry is None:
        return None
    findings = unpack_findings(json.loads(gzip.decompress(entry.data)), one.target.system)
    return [replace(finding, kept_since=entry.since) for finding in findings]


def keep(store: Store | None, one: Asked, findings: Sequence[Finding]) -> None:
    """Keep the findings, if all was decided, and by the engine whose files are there."""
    if store is None or any(isinstance(finding.result, Unknown) for finding in findings) or not undisturbed():
        return
    plain = pack_findings(findings, one.target.system)
    store.put(KIND, one.key, gzip.compress(json.dumps(plain).encode(), QUICKLY, mtime=0))
