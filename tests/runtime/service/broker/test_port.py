"""The port of a partition without a broker: what it takes for lines, for messages beside them, and what it adds to reports."""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Iterable
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from safeloc.runtime.service.broker.codes import Codes
from safeloc.runtime.service.broker.packets import Came
from safeloc.runtime.service.broker.port import Beside, PartitionPort
from safeloc.runtime.service.broker.topics import Topics, partition_of
from safeloc.runtime.service.feeds import Arrived, Told
from safeloc.runtime.service.journal import Journal
from tests.runtime.service.processes import nowhere

TOPICS = Topics("areas", 4)
OWN = partition_of("west", 4)


class Connection:
    """A connection that is there: what came, and what was published."""

    lost, waiting = "", False

    def __init__(self, came: Iterable[Came] = ()) -> None:
        self.came = deque(came)
        self.published: list[tuple[str, bytes, bool]] = []

    def publish(self, topic: str, payload: bytes, *, retained: bool = False) -> None:
        """Note it."""
        self.published.append((topic, payload, retained))

    def flush(self) -> None:
        """Nothing waits."""


class Reports(Beside):
    """The reports of one vehicle of another fleet."""

    def topics(self, partition: int) -> list[str]:
        """Its topic."""
        return ["fleet/reports/1/12"] if partition == OWN else []

    def about(self, topic: str) -> str | None:
        """The vehicle."""
        return "12" if topic == "fleet/reports/1/12" else None


def port(connection: Connection, **more: Any) -> PartitionPort:
    """The port of the partition of `west`."""
    made = PartitionPort(connection, TOPICS, OWN, Journal(nowhere()), **more)  # type: ignore[arg-type]
    made.running = True
    return made


def test_partitions_save_one_after_another() -> None:
    """Each has its own part of a period."""
    made = [PartitionPort(Connection([]), TOPICS, one, Journal(0)) for one in range(TOPICS.partitions)]  # type: ignore[arg-type]
    assert [one.save_turn for one in made] == [one / TOPICS.partitions for one in range(TOPICS.partitions)]


def test_messages_beside_the_records() -> None:
    """They come in their order, also retained, and need no acknowledgement; records are as before."""
    record = Came(f"areas/records/{OWN}/west", b"{}\n", 7, retained=False, again=False)
    told = Came("fleet/reports/1/12", b'{"vehicle": "12"}', 0, retained=True, again=False)
    other = Came("fleet/reports/1/13", b"{}", 0, retained=True, again=False)
    events = list(port(Connection([told, record, other, told]), beside=Reports()).look())
    assert [type(one) for one in events] == [Told, Arrived, Told]
    assert events[0] == Told("12", b'{"vehicle": "12"}')
    assert [type(one) for one in port(Connection([told, record])).look()] == [Arrived]


def test_codes_of_reports() -> None:
    """With a key each report has its code, events have none; without one nothing is added."""
    codes = Codes(bytes(32))
    for made in (None, codes):
        connection = Connection()
        one = port(connection, codes=made)
        one.put("west", b'{"vehicle": "west"}\n')
        one.put("west", b'{"event": "refused"}\n', event=True)
        one.flush()
        [(topic, report, retained), (_, event, _)] = connection.published
        assert (topic, retained, event) == (f"areas/reports/{OWN}/west", True, b'{"event": "refused"}')
        assert (codes.opened(topic, report) is not None) is (made is codes)
        assert report.startswith(b'{"vehicle": "west"')


PLAIN = st.none() | st.booleans() | st.integers() | st.text()


NESTED = st.recursive(
    PLAIN, lambda one: st.lists(one, max_size=4) | st.dictionaries(st.text(), one, max_size=4), max_leaves=8
)


@given(st.dictionaries(st.text(), NESTED, max_size=4))
def test_the_text_of_a_report(report: dict[str, Any]) -> None:
    """One line, without spaces outside of texts, and with the same content: whole numbers of any size, and any character."""
    text = port(Connection()).text(report)
    assert text.endswith(b"\n")
    assert text.count(b"\n") == 1
    assert json.loads(text) == report
    assert repr(json.loads(text)) == repr(report)


def test_a_report_with_half_a_character() -> None:
    """It is told all the same: a line can quote one."""
    report = {"event": "refused", "reason": "unit is '\ud800'"}
    assert json.loads(port(Connection()).text(report)) == report
    assert b" " not in port(Connection()).text({"vehicle": "west", "cycle": 7, "interval_mm": [1, 2]})
