"""Snapshots: one of this very build stays as it is, any other is refused, for nobody has shown what its numbers mean here."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

from safeloc.catalogue import load_target
from safeloc.errors import InputError, SnapshotError
from safeloc.runtime.embedding import Controller, Program
from safeloc.runtime.embedding.snapshot import sealed
from safeloc.runtime.migration import Migrated, migrate
from safeloc.runtime.service.saving import KIND, VERSION


@cache
def program() -> Program:
    """The restrictive state behind any source."""
    return Program(load_target("delocalized"))


def snapshot() -> bytes:
    """Of a controller that has stepped once."""
    controller = Controller(program(), period_ms=100)
    controller.step([])
    return controller.snapshot()


def process(**vehicles: bytes | None) -> bytes:
    """Of a process with these vehicles."""
    held = {name: {"controller": None if data is None else data.decode()} for name, data in vehicles.items()}
    return sealed({"vehicles": held}, KIND, VERSION)


def looked_at(path: Path, data: bytes, digest: str | None) -> Migrated:
    """What becomes of it where the machine of today has that digest."""
    path.write_bytes(data)
    return migrate(path, ships=(), fingerprint=lambda _machine, _config: digest)


@pytest.mark.parametrize("name", ["a.json", "a.snapshot"])
@pytest.mark.parametrize("made", [snapshot, lambda: process(one=snapshot(), two=None)], ids=["controller", "process"])
def test_one_of_this_build_is_left_alone(tmp_path: Path, made: Callable[[], bytes], name: str) -> None:
    """Whatever its file is called."""
    assert () == looked_at(tmp_path / name, made(), program().fingerprint).changes


@pytest.mark.parametrize(
    ("made", "of"),
    [(snapshot, ""), (lambda: process(one=snapshot()), "vehicle 'one': ")],
    ids=["controller", "process"],
)
def test_one_of_another_build_is_refused(tmp_path: Path, made: Callable[[], bytes], of: str) -> None:
    """With both digests. The file stays as it is."""
    path, data = tmp_path / "a.json", made()
    message = (
        f"{path}: {of}the state of another build of 'delocalized' (digest '{program().fingerprint}', now 'another'). "
        "Its numbers may mean something else here, so it cannot be converted: start without it, or end the run with the "
        "version that wrote it."
    )
    with pytest.raises(SnapshotError, match=rf"^{re.escape(message)}$"):
        looked_at(path, data, "another")
    assert data == path.read_bytes()


def test_one_of_a_machine_that_does_not_ship_is_refused(tmp_path: Path) -> None:
    """Nobody here knows its build of today."""
    path = tmp_path / "a.json"
    with pytest.raises(
        SnapshotError,
        match=rf"^{re.escape(str(path))}: the state of 'delocalized', which is no shipped machine, so it cannot be checked here",
    ):
        looked_at(path, snapshot(), None)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (snapshot().replace(b'"done":1', b'"done":2'), "the snapshot is damaged (wrong checksum)"),
        (
            sealed({"vehicles": {}}, KIND, VERSION + 1),
            "the snapshot has version 2, but this safeloc reads versions up to 1",
        ),
        (sealed({"program": "x"}), "holds no machine and configuration; start without the snapshot."),
    ],
    ids=["damaged", "newer", "empty"],
)
def test_one_that_cannot_be_read_is_refused(tmp_path: Path, data: bytes, message: str) -> None:
    """By name."""
    path = tmp_path / "a.json"
    with pytest.raises(SnapshotError, match=rf"^{re.escape(f'{path}: {message}')}"):
        looked_at(path, data, program().fingerprint)


def test_a_configuration_that_is_none_of_today_is_told(tmp_path: Path) -> None:
    """The machine cannot be made then, so the snapshot cannot be of its build."""
    path = tmp_path / "a.json"
    path.write_bytes(snapshot())

    def refused(_machine: str, _config: object) -> str:
        raise InputError("tolerance_mm: wrong")

    with pytest.raises(
        SnapshotError, match=r": its configuration is not valid now \(tolerance_mm: wrong\); start without"
    ):
        migrate(path, ships=(), fingerprint=refused)
