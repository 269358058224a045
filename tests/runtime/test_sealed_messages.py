"""Sealed messages against each threat of EN 50159, tried one by one and by any change of a line."""

from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.errors import InputError
from safeloc.runtime.sealed_messages import Channel, Opened, Opener, Refusal, RefusedMessage, Sealer

KEY = bytes(range(32))
CHANNEL = Channel("train 12", "area west", KEY, age_limit_ms=1_000, clock_error_ms=50)
PLACE = {"position_mm": 1_000_000, "margin_above_mm": 5_000, "margin_below_mm": 4_000}


def refusal(opener: Opener, line: str, now_ms: int) -> Refusal | None:
    """Why the receiver refuses a line; None if it accepts it."""
    try:
        opener.open(line, now_ms)
    except RefusedMessage as refused:
        return refused.refusal
    return None


def test_a_message_arrives() -> None:
    """With its content, its number and its greatest age."""
    sealer, opener = Sealer(CHANNEL), Opener(CHANNEL)
    assert Opened(PLACE, 1, 150, None) == opener.open(sealer.seal(PLACE, 10_000), 10_100)
    assert Opened({}, 2, 50, 0) == opener.open(sealer.seal({}, 10_200), 10_200)


def test_repetition_and_re_sequencing() -> None:
    """A number that came already, or before one that came, is refused, however young."""
    sealer, opener = Sealer(CHANNEL), Opener(CHANNEL)
    first, second = (sealer.seal(PLACE, time_ms) for time_ms in (0, 100))
    assert [None, Refusal.REPEATED, Refusal.REPEATED] == [
        refusal(opener, line, 100) for line in (second, second, first)
    ]


def test_deletion() -> None:
    """The next message tells how many are missing."""
    sealer, opener = Sealer(CHANNEL), Opener(CHANNEL)
    lines = [sealer.seal(PLACE, 100 * number) for number in range(5)]
    opener.open(lines[0], 0)
    assert 3 == opener.open(lines[4], 400).missing


def test_insertion() -> None:
    """A message of another pair, though sealed with the same key, is refused."""
    opener = Opener(CHANNEL)
    other, back = Channel("train 13", "area west", KEY, 1_000), Channel("area west", "train 12", KEY, 1_000)
    assert [Refusal.FOREIGN] * 2 == [refusal(opener, Sealer(one).seal(PLACE, 0), 0) for one in (other, back)]


def test_delay() -> None:
    """The clocks' error counts as age; a message from the future is refused beyond it."""
    lines = [Sealer(CHANNEL).seal(PLACE, 10_000) for _ in range(4)]
    found = [
        refusal(Opener(CHANNEL), line, now) for line, now in zip(lines, (10_950, 10_951, 9_950, 9_949), strict=True)
    ]
    assert [None, Refusal.OLD, None, Refusal.AHEAD] == found


def test_clocks_may_begin_anywhere() -> None:
    """Times are those of the sender's clock, also before its zero."""
    sealer, opener = Sealer(CHANNEL), Opener(CHANNEL)
    assert [None, None] == [refusal(opener, sealer.seal({}, time_ms), time_ms) for time_ms in (-5_000, -4_000)]


def test_masquerade() -> None:
    """Without the key no message is accepted."""
    forged = Sealer(Channel("train 12", "area west", bytes(32), 1_000)).seal(PLACE, 0)
    assert Refusal.CHANGED == refusal(Opener(CHANNEL), forged, 0)


def test_a_session_that_comes_again() -> None:
    """A sender that starts anew is accepted with a later time; a recorded session is not, though its messages are young enough."""
    old, opener = Sealer(CHANNEL), Opener(CHANNEL)
    recorded = [old.seal(PLACE, time_ms) for time_ms in (0, 100)]
    assert [None, None] == [refusal(opener, line, 100) for line in recorded]
    assert opener.open(Sealer(CHANNEL).seal(PLACE, 200), 200).missing is None
    assert [Refusal.ANOTHER_SESSION] * 2 == [refusal(opener, line, 300) for line in recorded]


@given(st.data())
def test_corruption(data: st.DataObject) -> None:
    """Any character changed, left out or added: refused as changed, or the same message; and nothing is remembered of it."""
    sealer, opener = Sealer(CHANNEL), Opener(CHANNEL)
    line = sealer.seal(PLACE, 0)
    at = data.draw(st.integers(0, len(line) - 1))
    text = data.draw(st.text(st.characters(), max_size=2))
    spoilt = line[:at] + text + line[at + data.draw(st.integers(0, 1)) :]
    same = _loads(spoilt) == json.loads(line)
    assert (None if same else Refusal.CHANGED) == refusal(opener, spoilt, 0)
    assert (Refusal.REPEATED if same else None) == refusal(opener, line, 0)


def _loads(text: str) -> Any:
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return None


@given(
    st.text()
    | st.recursive(st.none() | st.text(), lambda inner: st.dictionaries(st.sampled_from(["body", "code"]), inner)).map(
        json.dumps
    )
)
def test_any_line_is_refused(line: str) -> None:
    """Whatever comes, the reason is a refusal and no other error."""
    assert Refusal.CHANGED == refusal(Opener(CHANNEL), line, 0)


def test_a_line_without_end_is_refused() -> None:
    """Before it is parsed."""
    assert Refusal.CHANGED == refusal(Opener(CHANNEL), "[" * 2_000_000, 0)


def test_an_authentic_message_of_another_form_is_an_error_of_the_sender() -> None:
    """Whoever has the key and does not use `Sealer` is told what is missing."""
    number = '{"source": "a", "destination": "b", "session": "c", "number": true}'
    bodies = {"[]": "source", "[" * 5_000: "source", f'{{"source": {"9" * 5_000}}}': "source", number: "number"}
    for body, name in bodies.items():
        line = json.dumps({"body": body, "code": CHANNEL.code(body)})
        with pytest.raises(InputError, match=f"an authentic message without {name}"):
            Opener(CHANNEL).open(line, 0)


def test_what_is_no_channel_and_no_content_is_refused() -> None:
    """A key that can be guessed, limits that cannot be kept, and NaN."""
    with pytest.raises(InputError, match="a key of 16 bytes can be guessed; give 32 random bytes"):
        Channel("a", "b", bytes(16), 1_000)
    for limits in ((50, 50), (50, -1)):
        with pytest.raises(InputError, match="above the error of the clocks"):
            Channel("a", "b", KEY, *limits)
    with pytest.raises(InputError, match="cannot be sent as JSON"):
        Sealer(CHANNEL).seal({"position_mm": float("nan")}, 0)
    assert "key" not in repr(CHANNEL)
