"""The code of a report or a line: it shows that it is unchanged since whoever made it, whatever the broker did with it.

It is one JSON object; its last field, `code`, is an HMAC-SHA256 over the topic and all that stands before it. The topic names
the vehicle, so what stands under another topic does not fit. The key is that of all processes of the fleet.
"""

from __future__ import annotations

import hmac
import re

_LEAST_KEY_BYTES = 32
_LAST_FIELD = re.compile(rb', "code": "([0-9a-f]{64})"\}\Z')


class Codes:
    """Codes by one secret key. ValueError for a key that can be guessed."""

    def __init__(self, key: bytes) -> None:
        if len(key) < _LEAST_KEY_BYTES:
            raise ValueError(f"a key of {len(key)} bytes can be guessed; give {_LEAST_KEY_BYTES} random bytes")
        self._key = key

    def added(self, topic: str, text: bytes) -> bytes:
        """Return a JSON object with its code as the last field."""
        return b'%b, "code": "%b"}' % (text[:-1], self._code(topic, text[:-1]))

    def opened(self, topic: str, payload: bytes) -> bytes | None:
        """Return the object without its code; None if the code does not fit: it was changed, or is of another topic."""
        found = _LAST_FIELD.search(payload)
        if found is None or not hmac.compare_digest(self._code(topic, payload[: found.start()]), found[1]):
            return None
        return payload[: found.start()] + b"}"

    def _code(self, topic: str, body: bytes) -> bytes:
        return hmac.digest(self._key, topic.encode() + b"\n" + body, "sha256").hex().encode()
