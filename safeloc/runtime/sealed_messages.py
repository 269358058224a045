"""Messages between computers over a channel that may lose, repeat, delay, change or forge them (EN 50159, category 3).

A message carries source, destination, session, number and time, and a message authentication code over all of it (HMAC-SHA256).
The receiver refuses whatever is changed, forged, foreign, repeated, out of order or too old, and tells how many messages are
missing before the one that it accepts. What is refused or missing is for the receiver's machine to bear: its input is absent.

Both sides need one secret key for the channel, and clocks that agree within `clock_error_ms`. A sender that starts anew begins a
new session; the receiver accepts it only with a time after that of the last message, so that no old session comes again.
"""

from __future__ import annotations

import hashlib
import hmac
import json
import secrets
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

from safeloc.errors import InputError
from safeloc.runtime.outside import quoted

_LEAST_KEY_BYTES = 32
_MOST_CHARACTERS = 1_000_000
_BODY = {"source": str, "destination": str, "session": str, "number": int, "time_ms": int, "content": dict}


class Refusal(Enum):
    """The reason for refusing a message, with the threats of EN 50159 that the refusal counters."""

    CHANGED = "its code does not fit: it was changed on the way, or made without the key"  # corruption, masquerade
    FOREIGN = "it is of another source, or for another destination"  # insertion
    REPEATED = "its number came already, or a later one did"  # repetition, re-sequencing
    OLD = "it is older than the limit"  # delay
    AHEAD = "its time is later than now"  # a wrong clock
    ANOTHER_SESSION = "it is of a session that began before the last message"  # repetition of a session


class RefusedMessage(InputError):
    """A message that must not be used; `refusal` says why."""

    def __init__(self, refusal: Refusal) -> None:
        super().__init__(f"the message is refused: {refusal.value}.")
        self.refusal = refusal


@dataclass(frozen=True)
class Channel:
    """One direction between two computers.

    key             secret, of at least 32 random bytes, for this direction of this channel only
    age_limit_ms    the oldest message that is accepted, the clocks' error included
    clock_error_ms  the greatest difference of both clocks
    """

    source: str
    destination: str
    key: bytes = field(repr=False)
    age_limit_ms: int
    clock_error_ms: int = 0

    def __post_init__(self) -> None:
        if len(self.key) < _LEAST_KEY_BYTES:
            raise InputError(f"a key of {len(self.key)} bytes can be guessed; give {_LEAST_KEY_BYTES} random bytes.")
        if self.clock_error_ms < 0 or self.age_limit_ms <= self.clock_error_ms:
            raise InputError("the limit of age must be above the error of the clocks, and that not negative.")

    def code(self, body: str) -> str:
        """Return the message authentication code of a body, in hexadecimal digits."""
        return hmac.new(self.key, body.encode(), hashlib.sha256).hexdigest()


class Sealer:
    """The sender's side: numbers and seals messages. One for each channel and run of the sender."""

    def __init__(self, channel: Channel) -> None:
        self._channel, self._session, self._number = channel, secrets.token_hex(16), 0

    def seal(self, content: Mapping[str, Any], time_ms: int) -> str:
        """Return the message as one line. InputError for content that is no JSON (NaN among it)."""
        self._number += 1
        fields = {
            "source": self._channel.source,
            "destination": self._channel.destination,
            "session": self._session,
            "number": self._number,
            "time_ms": time_ms,
            "content": dict(content),
        }
        try:
            body = json.dumps(fields, allow_nan=False)
        except (TypeError, ValueError) as error:
            raise InputError(f"the content cannot be sent as JSON: {error}.") from error
        return json.dumps({"body": body, "code": self._channel.code(body)})


@dataclass(frozen=True)
class Opened:
    """An accepted message.

    age_ms   its greatest age, the clocks' error included
    missing  messages of its session before it that did not come; None for the first message of a session
    """

    content: dict[str, Any]
    number: int
    age_ms: int
    missing: int | None


class Opener:
    """The receiver's side. One for each channel; it remembers the last message that it accepted."""

    def __init__(self, channel: Channel) -> None:
        self._channel = channel
        self._session: str | None = None
        self._time_ms: int | None = None
        self._number = 0

    def open(self, line: str, now_ms: int) -> Opened:
        """Return the message of a line. RefusedMessage says why one is refused; a refused one changes nothing here."""
        body = self._authentic(line)
        fields = _fields(body)
        if (fields["source"], fields["destination"]) != (self._channel.source, self._channel.destination):
            raise RefusedMessage(Refusal.FOREIGN)
        age_ms = now_ms - fields["time_ms"] + self._channel.clock_error_ms
        if age_ms > self._channel.age_limit_ms:
            raise RefusedMessage(Refusal.OLD)
        if age_ms < 0:
            raise RefusedMessage(Refusal.AHEAD)
        missing = self._missing(fields)
        self._session, self._number, self._time_ms = fields["session"], fields["number"], fields["time_ms"]
        return Opened(fields["content"], fields["number"], age_ms, missing)

    def _authentic(self, line: str) -> str:
        try:
            sealed = json.loads(line) if len(line) <= _MOST_CHARACTERS else None
        except (ValueError, RecursionError):
            sealed = None
        if not isinstance(sealed, dict) or sealed.keys() != {"body", "code"}:
            raise RefusedMessage(Refusal.CHANGED)
        body, code = sealed["body"], sealed["code"]
        if not (isinstance(body, str) and isinstance(code, str) and code.isascii()):
            raise RefusedMessage(Refusal.CHANGED)
        try:
            right = hmac.compare_digest(self._channel.code(body), code)
        except UnicodeEncodeError:  # half of a surrogate pair
            right = False
        if not right:
            raise RefusedMessage(Refusal.CHANGED)
        return body

    def _missing(self, fields: Mapping[str, Any]) -> int | None:
        if fields["session"] != self._session:
            if self._time_ms is not None and fields["time_ms"] <= self._time_ms:
                raise RefusedMessage(Refusal.ANOTHER_SESSION)
            return None
        if fields["number"] <= self._number:
            raise RefusedMessage(Refusal.REPEATED)
        missing: int = fields["number"] - self._number - 1
        return missing


def _fields(body: str) -> dict[str, Any]:
    """Return the fields of an authentic body. InputError where the sender did not use `Sealer`."""
    try:
        found: object = json.loads(body)
    except (ValueError, RecursionError):
        found = None
    fields: dict[str, Any] = found if isinstance(found, dict) else {}
    for name, kind in _BODY.items():
        if not isinstance(fields.get(name), kind) or isinstance(fields[name], bool):
            raise InputError(f"an authentic message without {name}: {quoted(body)}; seal messages with `Sealer`.")
    return fields
