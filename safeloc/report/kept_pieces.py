"""Pieces of a report that are kept from run to run: what belongs to a machine that did not change is not made again.

The key of a piece is a digest of all that it is made from: all code of safeloc but the declarations; every module of these to which the
declaration of the machine leads; its configuration; and of what shows results, the results themselves. So only machines that
ship have keys, with results that are in the cache.
"""

from __future__ import annotations

import base64
import gzip
import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from safeloc.assurance.margins.making_code import making_modules
from safeloc.catalogue import ENTRIES
from safeloc.proof.cache.contents import target_digest
from safeloc.proof.cache.engine import tools_digest, undisturbed
from safeloc.proof.cache.store import Store
from safeloc.proof.results import Finding
from safeloc.target import Target

_KIND, _BYTES = "pieces", "bytes"
_QUICKLY = 3


@dataclass(frozen=True)
class KeptPieces:
    """The store in which pieces are looked for and kept; without one, none is.

    fresh  they are made anew, and kept
    """

    store: Store | None = None
    fresh: bool = False

    def found(self, key: str) -> Any:
        """Return a kept piece; None if there is none."""
        entry = None if self.store is None or self.fresh or not key else self.store.get(_KIND, key)
        if entry is None:
            return None
        plain = json.loads(gzip.decompress(entry.data))
        return base64.b64decode(plain[_BYTES]) if _BYTES in plain else plain["data"]

    def keep(self, key: str, made: Any) -> None:
        """Keep a piece, which JSON can hold, or bytes; nothing without a key, or after a file of the package was written."""
        if self.store is None or not key or not undisturbed():
            return
        plain = {_BYTES: base64.b64encode(made).decode()} if isinstance(made, bytes) else {"data": made}
        self.store.put(_KIND, key, gzip.compress(json.dumps(plain).encode(), _QUICKLY, mtime=0))


NOTHING_KEPT = KeptPieces()


def of_target_key(target: Target, *more: str) -> str:
    """Return the key of what follows from a target alone; "" for one that does not ship, or has another configuration file."""
    if not (target.spec.isidentifier() and target.spec in ENTRIES) or target.config_file is not None or target.given:
        return ""
    config = "" if target.config is None else target.config.model_dump_json()
    made_by = _modules_digest(ENTRIES[target.spec].folder)
    return _digest(tools_digest(), made_by, target_digest(target), target.spec, target.configuration, config, *more)


def of_results_key(target: Target, findings: Sequence[Finding], *more: str) -> str:
    """Return the key of what follows from a target and its findings; "" unless all of these are in the cache together."""
    kept = {one.kept_as for one in findings}
    own = of_target_key(target)
    return _digest(own, *kept, *more) if own and len(kept) == 1 and "" not in kept else ""


def of_texts_key(texts: Mapping[str, str]) -> str:
    """Return the key of what follows from some texts, by name."""
    return _digest(tools_digest(), *(part for name, text in texts.items() for part in (name, text)))


@cache
def _modules_digest(folder: str) -> str:
    """Return the digest of every module of declarations that a machine leads to, with those of its simulation and pictures."""
    total = hashlib.sha256()
    for name, path in making_modules(folder, left_out=()).items():
        total.update(f"{name}\0".encode() + hashlib.sha256(path.read_bytes()).digest())
    return total.hexdigest()


def _digest(*parts: str) -> str:
    total = hashlib.sha256()
    for part in parts:
        total.update(hashlib.sha256(part.encode()).digest())
    return total.hexdigest()
