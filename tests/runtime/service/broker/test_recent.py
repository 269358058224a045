"""Messages that come again, and vehicles that begin anew."""

from __future__ import annotations

import json
from itertools import islice

import pytest

from safeloc.errors import SnapshotError
from safeloc.runtime.service.broker.recent import Recent
from tests.runtime.service.broker.mosquitto import messages
from tests.runtime.service.processes import numbered

SAID = messages(numbered(400, "7"))
EARLY, LATE = SAID[:50], SAID[300:350]


def test_a_message_is_known_among_the_last_ones() -> None:
    """By its content, for its own vehicle; the oldest of too many is forgotten."""
    recent = Recent()
    assert not any(recent.came_before("7", one, again=False) for one in LATE)
    assert all(recent.came_before("7", one, again=False) for one in LATE)
    assert not recent.came_before("8", LATE[0], again=True)
    assert not any(recent.came_before("7", b'{"number": %d}' % number, again=False) for number in range(5_000, 5_128))
    assert not recent.came_before("7", LATE[-1], again=True)


def test_the_first_messages_are_known_only_if_the_broker_says_so() -> None:
    """Of a vehicle that restarts count and clock, nothing is left out."""
    recent = Recent()
    assert not any(recent.came_before("7", one, again=False) for one in [*EARLY, *EARLY])
    assert all(recent.came_before("7", one, again=True) for one in EARLY)


def test_a_message_that_came_twice_is_known_until_both_are_forgotten() -> None:
    """Of two equal first messages among the last ones, the older is forgotten alone; a snapshot keeps both."""
    recent, later = Recent(), Recent()
    others = iter([b'{"number": %d}' % number for number in range(5_000, 5_300)])

    def hear(some: int, *memories: Recent) -> None:
        for one in islice(others, some):
            assert not any(memory.came_before("7", one, again=True) for memory in memories)

    assert not recent.came_before("7", EARLY[0], again=False)
    hear(100, recent)
    assert not recent.came_before("7", EARLY[0], again=False)
    later.resume({"recent": recent.position()})
    hear(27, recent, later)  # 128 and one: the first is forgotten
    assert recent.came_before("7", EARLY[0], again=True)
    assert later.came_before("7", EARLY[0], again=True)
    hear(100, recent, later)
    assert recent.came_before("7", EARLY[0], again=True)
    hear(1, recent, later)
    assert not recent.came_before("7", EARLY[0], again=True)
    assert not later.came_before("7", EARLY[0], again=True)


def test_it_goes_on_from_a_snapshot() -> None:
    """With the messages that the owner before had."""
    recent, later = Recent(), Recent()
    for one in LATE:
        recent.came_before("7", one, again=False)
    later.resume(json.loads(json.dumps({"recent": recent.position()})))
    assert all(later.came_before("7", one, again=False) for one in LATE)
    Recent().resume({})


@pytest.mark.parametrize("wrong", ["", [], {"7": 1}, {"7": "zz"}, {"7": "ab"}, {"7": "0" * 16 * 129}])
def test_a_memory_that_is_none(wrong: object) -> None:
    """It is refused, as every field of a snapshot."""
    with pytest.raises(SnapshotError):
        Recent().resume({"recent": wrong})
