"""Snapshots: those of this very build stay as they are, all others are refused.

A snapshot holds the state of one build of a machine. Its digest says which; that the same numbers mean the same in
another build nobody has shown, so a snapshot with new names would be a claim about the world that nobody made.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from safeloc.errors import InputError, SnapshotError
from safeloc.runtime.embedding import snapshot as controllers
from safeloc.runtime.outside import quoted
from safeloc.runtime.service import saving as processes

Fingerprint = Callable[[str, Mapping[str, Any]], str | None]
"""Machine and configuration -> digest of that machine as it is today; None for a machine that does not ship."""


def is_snapshot(content: object) -> bool:
    """Whether it says that it is one, of a controller or of a process."""
    return isinstance(content, dict) and content.get("kind") in (controllers.KIND, processes.KIND)


def require_current(path: Path, content: Mapping[str, Any], fingerprint: Fingerprint) -> None:
    """SnapshotError where it is damaged, newer than this version, or of another build of its machine."""
    for of, body in _controllers(path, content):
        machine, program, config = body.get("machine"), body.get("program"), body.get("config")
        if not isinstance(machine, str) or not isinstance(config, dict):
            raise SnapshotError(f"{path}: {of}holds no machine and configuration; begin anew without it.")
        own = _of_today(path, machine, config, fingerprint)
        if own is None:
            raise SnapshotError(
                f"{path}: {of}the state of {quoted(machine)}, which does not ship; only that machine itself can say whether it "
                "still fits. Begin with it, or anew without it."
            )
        if own != program:
            raise SnapshotError(
                f"{path}: {of}the state of another build of {quoted(machine)} (digest {quoted(program)}, of today "
                f"{quoted(own)}). That its numbers mean the same here is not shown, so it is not carried over: begin anew "
                "without it, or end the run with the version that wrote it."
            )


def _of_today(path: Path, machine: str, config: Mapping[str, Any], fingerprint: Fingerprint) -> str | None:
    try:
        return fingerprint(machine, config)
    except InputError as error:
        raise SnapshotError(f"{path}: its configuration is none of today ({error}); begin anew without it.") from error


def _controllers(path: Path, content: Mapping[str, Any]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Every controller's snapshot in it, each with what messages call it."""
    kind = content["kind"]
    version = controllers.VERSION if kind == controllers.KIND else processes.VERSION
    whole = _opened(path, json.dumps(content).encode(), str(kind), version)
    if kind == controllers.KIND:
        yield "", whole
        return
    for name, vehicle in whole.get("vehicles", {}).items():
        if vehicle.get("controller") is not None:
            data = vehicle["controller"].encode()
            yield f"vehicle {quoted(name)}: ", _opened(path, data, controllers.KIND, controllers.VERSION)


def _opened(path: Path, data: bytes, kind: str, version: int) -> dict[str, Any]:
    try:
        return controllers.opened(data, kind, version)
    except SnapshotError as error:
        raise SnapshotError(f"{path}: {error}") from error
