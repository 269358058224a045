"""A controller's memory as bytes, with version and checksum; a snapshot that does not fit is refused.

The checksum detects damage, not manipulation. A snapshot holds everything that the controller remembers between cycles,
but no records of an open cycle: the host still has these, or reports them as lost.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

from safeloc.errors import SnapshotError

KIND, VERSION = "safeloc-controller", 1
_NOT_FIT = "it cannot be used here"

_CHECKSUM = re.compile(rb'"checksum":"([0-9a-f]{64})",')
"""The checksum as `sealed` writes it. Of a text within the content quotes are escaped, so it cannot look like this."""


def sealed(
    body: Mapping[str, Any], kind: str = KIND, version: int = VERSION, *, ready: Mapping[str, str] | None = None
) -> bytes:
    """Return the content with its kind, version and checksum, as one line of JSON.

    ready  further fields whose text (`text_of`) was made before, since it is the same in every snapshot
    """
    fields = {name: text_of(value) for name, value in {"kind": kind, "version": version, **body}.items()}
    fields.update(ready or {})
    checksum = hashlib.sha256(_joined(fields).encode()).hexdigest()
    return _joined({**fields, "checksum": text_of(checksum)}).encode()


def opened(data: bytes, kind: str = KIND, version: int = VERSION) -> dict[str, Any]:
    """Return the content; SnapshotError if it is damaged, of another kind, or of a newer version."""
    try:
        content = json.loads(data)
    except TypeError as error:
        raise SnapshotError(f"expected a snapshot as bytes, got {type(data).__name__}.") from error
    except (ValueError, RecursionError) as error:
        raise SnapshotError(f"the snapshot is damaged (no JSON: {error}); start without the snapshot.") from error
    if not isinstance(content, dict) or content.get("kind") != kind:
        raise SnapshotError(f"this is no snapshot of kind {kind!r}; give one that safeloc wrote for this purpose.")
    found = content.get("version")
    if type(found) is not int or found > version:
        raise SnapshotError(
            f"the snapshot has version {found!r}, but this safeloc reads versions up to {version}; use the safeloc that wrote "
            "it, or start without the snapshot."
        )
    checksum = content.pop("checksum", None)
    if not _as_sealed(data, checksum) and checksum != _checksum(content):
        raise SnapshotError("the snapshot is damaged (wrong checksum); start without the snapshot.")
    return content


def require_same(what: str, expected: object, found: object) -> None:
    """Raise SnapshotError if the snapshot's `what` differs from that of this program."""
    if expected != found:
        raise SnapshotError(f"the snapshot is of another {what} ({_differing(expected, found)}); {_NOT_FIT}.")


def _differing(expected: object, found: object) -> str:
    if not (isinstance(expected, Mapping) and isinstance(found, Mapping)):
        return f"{found!r}, here {expected!r}"
    names = [name for name in {**expected, **found} if expected.get(name) != found.get(name)]
    shown = [f"{name} {found.get(name)!r}, here {expected.get(name)!r}" for name in names[:3]]
    return "; ".join(shown) + (f" and {len(names) - 3} more" if len(names) > 3 else "")


_ENCODER = json.JSONEncoder(sort_keys=True, separators=(",", ":"))


def text_of(value: object) -> str:
    """Return a value as it stands in a snapshot."""
    return _ENCODER.encode(value)


_name = lru_cache(maxsize=256)(text_of)
"""The name of a field as it stands in a snapshot: the same few in all of them."""


def _joined(fields: Mapping[str, str]) -> str:
    """Return the object with these fields, as `text_of` would."""
    return "{" + ",".join([f"{_name(name)}:{fields[name]}" for name in sorted(fields)]) + "}"


def _as_sealed(data: bytes | str, checksum: object) -> bool:
    """Return whether the bytes are as `sealed` wrote them: without the checksum, they have this checksum. This makes no
    text of the content; another text of the same content, as with spaces, is left to `_checksum`."""
    if isinstance(data, str):
        return False
    found = _CHECKSUM.search(data)
    if found is None or found[1].decode() != checksum:
        return False
    rest = hashlib.sha256(memoryview(data)[: found.start()])
    rest.update(memoryview(data)[found.end() :])
    return rest.hexdigest() == checksum


def _checksum(content: Mapping[str, Any]) -> str:
    return hashlib.sha256(text_of(content).encode()).hexdigest()
