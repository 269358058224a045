"""Traces: what is recorded can be replayed, and reads as a table."""

from __future__ import annotations

from safeloc.language.expr import boolean, choice, enumeration, members, number, optional
from safeloc.language.html_views import trace_html
from safeloc.language.interpret import run
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.system import lower
from safeloc.language.trace import shown
from safeloc.language.units import MM

IDLE, SEEN = modes("IDLE", "SEEN")
COLOURS = members("colour", "red", "green")
SIGNAL = choice("signal", enumeration(COLOURS))
DISTANCE, LAST = optional("distance", MM, 3, 90), number("last", MM, 0, 90)
MACHINE = Machine(
    name="eye",
    modes=(IDLE, SEEN),
    inputs=[SIGNAL, DISTANCE],
    state={LAST: 0},
    outputs={},
    transitions=[Transition("see", (IDLE, SEEN), SEEN, DISTANCE.present, {LAST: DISTANCE.value})],
)
SYSTEM = lower(MACHINE)
STREAM = [{"signal": "green"}, {"signal": "red", "distance": 40}]


def test_a_trace_reads_as_a_table() -> None:
    """Labels instead of numbers; what was absent is not shown."""
    assert run(SYSTEM, STREAM).table() == (
        "   0  start  mode=IDLE last=0\n"
        "   1  (stay)  [signal=green]\n"
        "   2  see  [distance=40 signal=red]  mode=SEEN last=40"
    )


def test_a_table_shows_what_changed_and_the_last_step_in_full() -> None:
    """An optional input that does not come any more is named."""
    seen = {"signal": "red", "distance": 40}
    assert run(SYSTEM, [seen, seen, {"signal": "red"}, {"signal": "red"}, seen]).table().splitlines()[1:] == [
        "   1  see  [distance=40 signal=red]  mode=SEEN last=40",
        "   2  see  []",
        "   3  (stay)  [no distance]",
        "   4  (stay)  []",
        "   5  see  [distance=40 signal=red]  mode=SEEN last=40",
    ]


def test_an_input_that_is_absent_in_the_last_step_is_named_if_it_came_before() -> None:
    """Its absence is often the cause of what the run shows; one that never came is left out."""
    seen, silent = {"signal": "red", "distance": 40}, {"signal": "red"}
    assert (
        run(SYSTEM, [seen, silent, silent])
        .table()
        .splitlines()[-1]
        .startswith("   3  (stay)  [signal=red no distance]  ")
    )
    assert "no distance" not in run(SYSTEM, [silent, silent]).table()
    assert "signal=red  no distance" in trace_html(run(SYSTEM, [seen, silent]))


def test_a_long_table_says_what_it_leaves_out() -> None:
    """The first steps, those that fire something else, and the last ones; between them the number of the others."""
    still, seen = {"signal": "green"}, {"signal": "red", "distance": 40}
    lines = run(SYSTEM, [*[still] * 40, seen, *[still] * 59]).table(limit=10).splitlines()
    assert [line.split("  [")[0].strip() for line in lines] == [
        "0  start  mode=IDLE last=0", "1  (stay)", "... 39 more steps: (stay)", "41  see", "42  (stay)",
        "... 56 more steps: (stay)", "99  (stay)", "100  (stay)",
    ]  # fmt: skip


def test_a_long_table_stays_within_its_limit() -> None:
    """Where every step fires something else than the one before, the latest of them are shown."""
    lines = run(SYSTEM, STREAM * 50).table(limit=10).splitlines()
    assert [line.split()[0] for line in lines] == ["0", "1", "...", *map(str, range(92, 101))]
    assert "... 90 more steps" == lines[2].strip()
    assert ["0", "1", "...", "100"] == [
        line.split()[0] for line in run(SYSTEM, STREAM * 50).table(limit=1).splitlines()
    ]


def test_a_trace_is_a_stream_again() -> None:
    """The stream of a trace, run again, gives the same trace."""
    trace = run(SYSTEM, STREAM)
    assert trace.stream() == [{"signal": 1}, {"signal": 0, "distance": 40}]
    again = run(SYSTEM, trace.stream())
    assert again.steps == trace.steps
    assert again.initial == trace.initial


def test_values_as_a_person_reads_them() -> None:
    """Members by label, truth values in lower case, numbers as they are."""
    assert [shown(SIGNAL, 0), shown(boolean("p"), True), shown(LAST, 7)] == ["red", "true", "7"]
