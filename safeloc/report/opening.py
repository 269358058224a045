"""Finds what a word stands for that a user wants to see, and makes the page that shows it.

An existing path comes first: a report folder, a file of runs of one, or a stream. Then a machine, or a recording that ships.
"""

from __future__ import annotations

import difflib
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from safeloc.catalogue import ENTRIES, load_target
from safeloc.errors import InputError
from safeloc.report import stored
from safeloc.report.digests import origin
from safeloc.report.folder import PAGE, unfit
from safeloc.report.recordings_page import recordings_page
from safeloc.report.run_page import RUN_PAGE
from safeloc.runtime.streams.steps import read_steps
from safeloc.target import MODELS, Target, find_recording, recording_name

_MOST_NAMED = 5


@dataclass(frozen=True)
class Found:
    """The page that a word stands for: one that is there, or one that is to be written.

    page   the page that is there; None if there is none yet
    text   the text of the page that is to be written
    unfit  what in a report folder does not fit; `text` then says so, and no verdict is shown
    origin what the digests of a report that fits them show, and what is known of who made it
    """

    page: Path | None = None
    text: str = ""
    unfit: Sequence[str] = ()
    origin: Sequence[str] = ()


def find(word: str, machine: str | None = None) -> Found:
    """Return the page for a word; `machine` runs a stream that does not name its machine.

    InputError for a word that stands for nothing, with the names that are near.
    """
    path = Path(word)
    if path.is_dir():
        return _folder(path)
    if path.is_file():
        return _run_file(path) if path.suffix == stored.RUNS else _stream(path, machine)
    if word in ENTRIES or ":" in word:
        return _machine(load_target(word))
    recording = next(iter(_recordings(word)), None)
    if recording is not None:
        return _stream(recording, machine)
    raise InputError(f"{word}: no such file or folder, and no machine or recording of that name.{_near(word)}")


def _folder(folder: Path) -> Found:
    if not (folder / stored.DATA).is_file():
        raise InputError(f"{folder}: no report; `safeloc verify --out {folder}` writes one.")
    found = unfit(folder)
    return Found(text=_unfit_page(folder, found), unfit=found) if found else Found(folder / PAGE, origin=origin(folder))


def _unfit_page(folder: Path, found: Sequence[str]) -> str:
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent), autoescape=True, undefined=StrictUndefined
    )
    given = {"folder": str(folder), "found": found, "data": {"made": "unknown time"}}
    return environment.get_template("unfit.html.jinja").render(**given)


def _run_file(path: Path) -> Found:
    """Return the page of runs of the report to which a file of runs belongs."""
    folder = path.absolute().parent.parent
    if not (folder / RUN_PAGE).is_file():
        raise InputError(f"{path}: a file of runs is shown by {RUN_PAGE} of its report, and {folder} has none.")
    found = _folder(folder)
    return found if found.unfit else Found(folder / RUN_PAGE)


def _stream(path: Path, machine: str | None) -> Found:
    name = machine or read_steps(path).machine
    if not name:
        raise InputError(f"{path}: does not name its machine; say which with --machine.")
    target = load_target(name)
    return Found(text=_page(target, [find_recording(target, path)]))


def _machine(target: Target) -> Found:
    if not target.streams:
        raise InputError(
            f"{target.name}: no recording of it ships; `safeloc simulate {target.name}` or `safeloc step {target.name}` makes one."
        )
    return Found(text=_page(target, target.streams))


def _page(target: Target, streams: Sequence[Path]) -> str:
    return recordings_page(target, streams, made=time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()))


def _recordings(name: str = "*") -> list[Path]:
    """Return the recordings of this name that ship."""
    return [path for path in sorted(MODELS.glob("*/recordings/*.jsonl.gz")) if name in ("*", recording_name(path))]


def _near(word: str) -> str:
    """Return the names that are near, or how to list all of them."""
    names = [*ENTRIES, *map(recording_name, _recordings())]
    near = difflib.get_close_matches(word, names, n=_MOST_NAMED) or [name for name in names if word and word in name]
    return f" Did you mean {', '.join(near[:_MOST_NAMED])}?" if near else " `safeloc list` names what there is."
