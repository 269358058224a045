"""A snapshot is all of a controller: it goes on as if nothing had been, or is refused with the reason."""

from __future__ import annotations

import hashlib
import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.errors import InputError, SnapshotError
from safeloc.language.system import lower
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.runtime.embedding import Controller, Program
from safeloc.runtime.embedding.snapshot import opened, sealed, text_of
from safeloc.runtime.streams.records import ValueRecord
from safeloc.shipped_machines import ENTRIES
from safeloc.target import Target
from tests.data.door_controller import machine as door
from tests.runtime.embedding.driving import distances, drive, shipped, trusting

ROOT = Path(__file__).parents[3]


def driven(cycles: int) -> Controller:
    """After so many cycles."""
    controller = Controller(trusting())
    for records in drive(cycles):
        controller.step(records)
    return controller


@given(st.integers(0, 120))
def test_going_on_is_as_if_nothing_had_been(cut: int) -> None:
    """Restored after any cycle, the rest of the run gives the very same reports."""
    whole = driven(cut)
    rest = Controller(trusting())
    assert rest.restore(whole.snapshot()).interval == whole.report.interval
    for records in drive(30, cut + 1):
        assert rest.step(records) == whole.step(records)
    assert rest.snapshot() == whole.snapshot()


def test_what_was_delivered_is_remembered() -> None:
    """A record that was used before the snapshot is late after it."""
    rest = Controller(trusting())
    rest.restore(driven(3).snapshot())
    assert {fault.reason.name for fault in rest.step(distances(300)).rejections} == {"DUPLICATE"}


def test_a_restored_follower_stands_where_the_machine_stands() -> None:
    """Nothing was entered, so nobody is told."""
    told: list[str] = []
    host = SimpleNamespace(on_enter_front=lambda event: told.append("entered"))
    rest = Controller(trusting())
    rest.follow(host)
    rest.listen(lambda report: told.append("report"))
    rest.restore(driven(3).snapshot())
    assert host.state == "FRONT"
    assert told == []


def test_a_halted_controller_stays_halted() -> None:
    """A snapshot is no way around it."""
    target = Target("door", (door,), lower(door), ())
    halted, rest = Controller(target, period_ms=500), Controller(target, period_ms=500)
    with pytest.raises(InputError):
        halted.step([ValueRecord(time_ms=1, name="speed", value=0)])
    rest.restore(halted.snapshot())
    with pytest.raises(InputError, match="has halted"):
        rest.step([])


def odometry(**figures: Any) -> Controller:
    """With other figures."""
    return Controller(ENTRIES["odometry"].make(OdometryConfig(**figures)))


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: Controller(shipped("balise")),
            r"of another machine \('odometry', here 'balise'\); it cannot be used here",
        ),
        (
            lambda: odometry(trust_first_marker=True, tolerance_mm=20_000),
            r"of another configuration \(tolerance_mm 30000, here 20000\)",
        ),
        (
            lambda: Controller(trusting(), expected={"front_wheel": 1}),
            r"of another setting \(expected \{\}, here \{'front_wheel'",
        ),
    ],
    ids=["machine", "configuration", "setting"],
)
def test_of_something_else(make: Callable[[], Controller], message: str) -> None:
    """Refused, saying what differs, and nothing has changed."""
    controller = make()
    before = controller.snapshot()
    with pytest.raises(SnapshotError, match=message):
        controller.restore(driven(3).snapshot())
    assert controller.snapshot() == before


def test_of_another_build_of_the_machine() -> None:
    """The same name and configuration, but another table: refused."""
    body = json.loads(driven(3).snapshot())
    body["program"] = "0" * 64
    with pytest.raises(SnapshotError, match="of another build of the machine"):
        Controller(trusting()).restore(resealed(body))


def resealed(body: dict[str, Any]) -> bytes:
    """With a checksum that fits."""
    kind, version = body.pop("kind"), body.pop("version")
    body.pop("checksum")
    return sealed(body, kind, version)


def test_newer_than_this_version() -> None:
    """Whatever else is in it, it is not read."""
    body = json.loads(driven(3).snapshot())
    with pytest.raises(
        SnapshotError, match=r"^the snapshot has version 2, but this safeloc reads versions up to 1; use the "
    ):
        Controller(trusting()).restore(resealed({**body, "version": 2}))


@pytest.mark.parametrize("data", [b"", b"{", b"[]", b'{"kind": "other"}', b"\xff", b"null"])
def test_what_is_no_snapshot(data: bytes) -> None:
    """Refused as damaged, or as no snapshot at all."""
    with pytest.raises(SnapshotError, match=r"damaged|no snapshot of kind 'safeloc-controller'"):
        Controller(trusting()).restore(data)


def test_what_are_no_bytes() -> None:
    """Such as that of a file that was not there."""
    with pytest.raises(SnapshotError, match="expected a snapshot as bytes, got NoneType"):
        Controller(trusting()).restore(None)  # type: ignore[arg-type] # that is the point


@given(st.integers(0, 10**6), st.integers(1, 255))
def test_damage_is_seen(place: int, change: int) -> None:
    """One changed byte anywhere: refused, or the very same content."""
    data = bytearray(driven(2).snapshot())
    data[place % len(data)] ^= change
    controller = Controller(trusting())
    with pytest.raises(SnapshotError):
        controller.restore(bytes(data))
    assert controller.report.cycle == 0


def test_another_text_of_the_same_content() -> None:
    """As with spaces, or in another order; and with fields below it that look like a checksum."""
    data = driven(2).snapshot()
    body = json.loads(data)
    for text in (json.dumps(body), json.dumps(body, indent=1), json.dumps(dict(reversed(body.items())))):
        controller = Controller(trusting())
        assert controller.restore(text.encode()) == Controller(trusting()).restore(data)
        assert controller.snapshot() == data
    inner = {"checksum": "0" * 64, "other": 1}
    for content in ({"a": inner}, {"z": inner}, {"text": json.dumps({"a": 1, **inner}, separators=(",", ":"))}):
        assert opened(sealed(content, "a", 1), "a", 1) == {**content, "kind": "a", "version": 1}
        spaced = sealed(content, "a", 1).replace(b'"version":1', b'"version": 1')
        assert opened(spaced, "a", 1) == {**content, "kind": "a", "version": 1}
        with pytest.raises(SnapshotError, match="wrong checksum"):
            opened(sealed(content, "a", 1).replace(b"0" * 64, b"0" * 63 + b"1"), "a", 1)


@pytest.mark.parametrize(
    "spoil",
    [lambda state: state.update(mode=99), lambda state: state.pop("mode"), lambda state: state.update(mode=True)],
    ids=["range", "variable", "kind"],
)
def test_a_state_that_is_none(spoil: Callable[[dict[str, Any]], object]) -> None:
    """Also under a checksum that fits, a state is only what the machine's variables can hold."""
    body = json.loads(driven(2).snapshot())
    spoil(body["state"])
    with pytest.raises(SnapshotError, match="start without the snapshot"):
        Controller(trusting()).restore(resealed(body))


def test_another_process_reads_it() -> None:
    """What identifies a build of a machine does not depend on the process that computes it."""
    code = (
        "import sys; from tests.runtime.embedding.driving import trusting; from safeloc.runtime.embedding import Controller; "
        "print(Controller(trusting()).restore(sys.stdin.buffer.read()).words())"
    )
    whole = driven(3)
    done = subprocess.run(
        [sys.executable, "-c", code], input=whole.snapshot(), capture_output=True, cwd=ROOT, check=False
    )
    assert done.stdout.decode().strip() == whole.report.words(), done.stderr.decode()


def test_a_program_is_shared() -> None:
    """Its fingerprint is one of content: made twice, it is the same."""
    assert trusting().fingerprint == trusting().fingerprint
    assert Program(trusting().target).fingerprint == trusting().fingerprint != shipped("balise").fingerprint


LEAVES = st.none() | st.integers() | st.text(max_size=5)


@given(st.dictionaries(st.text(max_size=8), st.recursive(LEAVES, st.lists, max_leaves=8)))
def test_a_snapshot_is_its_content_in_order(content: dict[str, Any]) -> None:
    """One object with sorted names and its checksum, whether a field's text was made before or not."""
    fields = {name: value for name, value in content.items() if name not in ("kind", "version", "checksum")}
    plain = {"kind": "k", "version": 1, **fields}
    body = json.dumps(plain, sort_keys=True, separators=(",", ":"))
    whole = {**plain, "checksum": hashlib.sha256(body.encode()).hexdigest()}
    text = json.dumps(whole, sort_keys=True, separators=(",", ":")).encode()
    assert sealed(fields, "k") == text
    assert sealed({}, "k", ready={name: text_of(value) for name, value in fields.items()}) == text
    assert opened(text, "k") == plain
