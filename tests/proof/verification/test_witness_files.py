"""Files of witnesses: what is written is read, other files are refused, and a run that shows nothing is no evidence."""

from __future__ import annotations

import json
import lzma
from pathlib import Path

import pytest

from safeloc.errors import StreamError
from safeloc.language.expr import boolean, number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.units import COUNT
from safeloc.language.verdict import require_proved
from safeloc.proof.provers import reachability
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.obligation import Obligation
from safeloc.proof.provers.reachability import reached
from safeloc.proof.provers.recorded_witnesses import Recording
from safeloc.proof.verification.witness_files import SCHEMA, read_witnesses, write_witnesses

RUNS = [("pair", {"n": 3}, [{"p": True}, {}]), ("pair left", {}, [{"x": -4}])]
ON, OFF = modes("ON", "OFF")
P, N = boolean("p"), number("n", COUNT, 0, 90)


def counter(ends: int = 6) -> TransitionSystem:
    """Counts up to a figure, and goes OFF there."""
    rows = [
        Transition("off", ON, OFF, N.eq(ends)),
        Transition("count", ON, ON, P & (N < ends), {N: N + 1}),
        Transition("begin anew", ON, ON, ~P, {N: 0}),
        Transition("stay", OFF, OFF),
    ]
    return lower(Machine("counter", (ON, OFF), [P], {N: 0}, {}, rows))


WITNESSES = {"counter": [Recording({}, [{"p": True}] * 8), Recording({}, [{"p": False}])]}


def test_what_is_written_is_read(tmp_path: Path) -> None:
    """By the name of the system; equal runs give equal bytes."""
    path, other = tmp_path / "a.jsonl.xz", tmp_path / "b.jsonl.xz"
    write_witnesses(path, RUNS)
    write_witnesses(other, RUNS)
    assert path.read_bytes() == other.read_bytes()
    assert read_witnesses(path) == {
        "pair": [Recording({"n": 3}, [{"p": True}, {}])],
        "pair left": [Recording({}, [{"x": -4}])],
    }
    assert read_witnesses(None) == {}


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"no xz",
        lzma.compress(b""),
        lzma.compress(b"{}"),
        lzma.compress(b'{"schema": "safeloc-witnesses/2"}'),
        lzma.compress(json.dumps({"schema": SCHEMA}).encode() + b'\n{"system": "pair"}'),
        lzma.compress(json.dumps({"schema": SCHEMA}).encode() + b"\n[1, 2]"),
        lzma.compress(json.dumps({"schema": SCHEMA}).encode() + b"\nnothing"),
        lzma.compress(json.dumps({"schema": SCHEMA}).encode())[:-9],
    ],
)
def test_another_file_is_refused(tmp_path: Path, content: bytes) -> None:
    """The message names file and form."""
    path = tmp_path / "bad.jsonl.xz"
    path.write_bytes(content)
    with pytest.raises(StreamError, match=r"bad\.jsonl\.xz: no file of witnesses \(safeloc-witnesses/1\)"):
        read_witnesses(path)


def test_a_file_that_is_gone_is_refused(tmp_path: Path) -> None:
    """As any other."""
    with pytest.raises(StreamError, match="no file of witnesses"):
        read_witnesses(tmp_path / "gone.jsonl.xz")


def _mode_off(found: list[Obligation]) -> Obligation:
    return next(one for one in found if one.name == "mode counter OFF")


def test_a_witness_shows_an_event_without_a_search(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its run is the evidence, and the interpreter has made it."""
    monkeypatch.setattr(reachability, "first_runs", lambda *_: pytest.fail("searched"))
    found = _mode_off(list(reached(counter(), Limits(), witnesses=WITNESSES)))
    proved = require_proved(found.verdict)
    assert found.method == "a shipped witness under the assumption"
    assert proved.engine == "witness"
    assert proved.rechecked == ("interpreter",)
    assert proved.witness is not None
    assert proved.witness.steps[-1].state["mode"] == 1
    assert len(proved.witness.steps) == 7


@pytest.mark.parametrize(
    "useless",
    [
        {},
        {"another": WITNESSES["counter"]},
        {"counter": []},
        {"counter": [Recording({}, [{"p": True}] * 6)]},
        {"counter": [Recording({"n": 7}, [{"p": True}] * 5 + [{"p": False}])]},
        {"counter": [Recording({}, [{"q": True}] * 8)]},
        {"counter": [Recording({}, [{"p": 5}] * 8)]},
    ],
)
def test_a_witness_that_shows_nothing_is_no_evidence(
    useless: dict[str, list[Recording]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The event is searched for as without it."""
    monkeypatch.setattr(reachability, "drawn", lambda *_: {})
    found = _mode_off(list(reached(counter(ends=7), Limits(), witnesses={**useless})))
    assert found.method == "witness under the assumption"
    assert require_proved(found.verdict).engine == "bmc"
