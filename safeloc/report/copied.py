"""Copies of single files of a report, where a CI server or an editor looks for them."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path

from safeloc.errors import InputError


def copied_to(folder: Path, places: Mapping[str, Path | None]) -> Callable[[], None]:
    """Return a function that copies files of the finished report in a folder to their places; whatever stands there is replaced.

    places  name of a file of the report -> where its copy goes; None: nowhere

    InputError at once, before the proofs, if a place cannot be written, or lies within the report, whose files have digests.
    """
    wanted = {name: path for name, path in places.items() if path is not None}
    for path in wanted.values():
        _check(folder, path)
    if len({path.resolve() for path in wanted.values()}) < len(wanted):
        raise InputError(f"{next(iter(wanted.values()))}: two files cannot be written to one place.")

    def copy() -> None:
        for name, path in wanted.items():
            try:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes((folder / name).read_bytes())
            except OSError as error:
                raise InputError(f"{path}: cannot be written: {error.strerror or error}.") from error

    return copy


def _check(folder: Path, path: Path) -> None:
    if path.resolve().is_relative_to(folder.resolve()):
        raise InputError(
            f"{path}: lies within the report, whose files have digests. The report has junit.xml and results.sarif "
            "itself; name a place outside."
        )
    existing = next(place for place in (path, *path.absolute().parents) if place.exists())
    if path.is_dir() or not os.access(existing, os.W_OK) or (existing != path and not existing.is_dir()):
        raise InputError(f"{path}: cannot be written; name a file in a folder in which you may write.")
