"""The cache of the findings of targets. The key is a digest of engine, target and request.

Findings with an undecided result are not cached: the next run tries again, perhaps on a less busy computer.
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
from safeloc.proof.verification.plain import Plain, pack_findings, unpack_findings
from safeloc.target import Target

_KIND = "findings"
_QUICKLY = 3  # of gzip's levels: a third more than the smallest, in a fifth of the time


@dataclass(frozen=True)
class Asked:
    """A request for the findings of a target, with its key."""

    target: Target
    key: str


def asked(target: Target, *question: object) -> Asked:
    """Return the request for the findings of a target; `question`, such as the plan, enters the key by its repr."""
    request = "\0".join([engine_digest(), target_digest(target), *map(repr, question)])
    return Asked(target, hashlib.sha256(request.encode()).hexdigest())


def found_before(store: Store | None, one: Asked) -> list[Finding] | None:
    """Return the cached findings, each with the time at which it was cached, and as what; None if there are none."""
    entry = None if store is None else store.get(_KIND, one.key)
    if entry is None:
        return None
    findings = unpack_findings(json.loads(gzip.decompress(entry.data)), one.target.system)
    digest = _digest(entry.data)
    return [replace(finding, kept_since=entry.since, kept_as=digest) for finding in findings]


def keep(store: Store | None, one: Asked, findings: Sequence[Finding], packed: Plain | None = None) -> list[Finding]:
    """Cache the findings, if all are decided and no file of the package was written since the process started.

    packed  the findings as `pack_findings` gave them, if that was done before

    Return them, each with what it is in the cache as, if they are.
    """
    if store is None or any(isinstance(finding.result, Unknown) for finding in findings) or not undisturbed():
        return list(findings)
    plain = pack_findings(findings, one.target.system) if packed is None else packed
    data = gzip.compress(json.dumps(plain).encode(), _QUICKLY, mtime=0)
    store.put(_KIND, one.key, data)
    digest = _digest(data)
    return [replace(finding, kept_as=digest) for finding in findings]


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()
