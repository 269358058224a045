"""NMEA 0183 sentences as deliveries. Needs the extra `nmea` (pynmeagps).

One kind of sentence makes the stream, the others are skipped. RMC has position, speed, date and a valid flag. GGA, GNS and
GLL have the time of day only; a fall by more than half a day counts as midnight.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from datetime import UTC, date, datetime, time, timedelta
from typing import Any

from safeloc.errors import EngineError, InputError
from safeloc.railway.guard.deliveries import Delivery
from safeloc.railway.guard.fields import milliseconds_of, speed_mm_s
from safeloc.runtime.outside import shortened

_SENTENCES = ("RMC", "GGA", "GNS", "GLL")
_LONGEST_SENTENCE = 1_000
"""Characters; NMEA 0183 allows 82."""
_HALF_A_DAY = timedelta(hours=12)


def nmea_deliveries(lines: Iterable[str], sentence: str = "RMC") -> Iterator[Delivery]:
    """Yield a delivery for every sentence of that kind, and for every line that is not a sentence. Skip proprietary sentences.

    Raises InputError for a kind without a position, EngineError without the extra.
    """
    if sentence not in _SENTENCES:
        raise InputError(f"sentence {sentence!r}: choose one of {', '.join(_SENTENCES)}.")
    parse = _parser()
    clock = _Clock()
    for number, line in enumerate(lines, 1):
        text = line.strip()
        if text and not text.startswith("$P") and (not _known(text) or text[3:6] == sentence):
            yield _delivery(number, text, parse, clock)


def _known(text: str) -> bool:
    """Return whether a line looks like an NMEA sentence."""
    return text.startswith("$") and len(text) > 6 and text[1:6].isalnum() and text.isascii()


def _delivery(number: int, text: str, parse: Callable[[str], Any], clock: _Clock) -> Delivery:
    try:
        if not text.isascii():
            raise InputError("not ASCII, as NMEA is")
        parsed = parse(text[:_LONGEST_SENTENCE])
        if parsed is None:
            raise InputError("no sentence")
        return _of(number, parsed, clock)
    except InputError as error:
        return Delivery(number, wrong=f"{error}".splitlines()[0] if f"{error}" else "no sentence")
    except Exception as error:  # a third-party parser may raise anything
        return Delivery(number, wrong=shortened(error))


def _of(number: int, parsed: Any, clock: _Clock) -> Delivery:
    if parsed.time in ("", None):
        return Delivery(number)
    when = clock.at(parsed.time, getattr(parsed, "date", None))
    flag = str(getattr(parsed, "status", getattr(parsed, "quality", getattr(parsed, "posMode", ""))))
    fixed = flag not in ("V", "0", "N", "NN", "") and parsed.lat != "" and parsed.lon != ""
    x, y = (float(parsed.lon), float(parsed.lat)) if fixed else (None, None)
    knots = getattr(parsed, "spd", "")
    speed = None if knots in ("", None) else speed_mm_s("speed", knots, "knots")
    return Delivery(number, milliseconds_of(when), x, y, speed, flag)


class _Clock:
    """Finds the day of sentences with a time of day only: a fall by more than half a day begins the next day."""

    def __init__(self) -> None:
        self._last: datetime | None = None

    def at(self, when: object, stated: object) -> datetime:
        """Return the time of a sentence; InputError without one."""
        if not isinstance(when, time):
            raise InputError("no time")
        dated = isinstance(stated, date)
        day = stated if isinstance(stated, date) else (self._last or datetime(1970, 1, 1)).date()
        found = datetime.combine(day, when.replace(tzinfo=None), UTC)
        if not dated and self._last is not None and self._last - found > _HALF_A_DAY:
            found += timedelta(days=1)
        self._last = found
        return found


def _parser() -> Callable[[str], Any]:
    try:
        from pynmeagps import NMEAReader
        from pynmeagps.exceptions import NMEAMessageError, NMEAParseError, NMEATypeError
    except ImportError as error:
        raise EngineError("reading NMEA sentences needs pynmeagps; install safeloc[nmea].") from error

    reader: Any = NMEAReader  # declared for bytes, but it takes both

    def parse(text: str) -> Any:
        try:
            return reader.parse(text)
        except (NMEAParseError, NMEAMessageError, NMEATypeError) as error:
            raise InputError(str(error)) from error

    return parse
