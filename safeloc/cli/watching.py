"""`--watch`: run the command again whenever a file is saved, and print changed verdicts first.

Each run is a new process that loads the saved files; results that the edit does not affect come from the cache
(safeloc.proof.cache).
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from safeloc.catalogue import sources_of
from safeloc.cli.console import err, out
from safeloc.language.verdict import SHOWN, WORST_FIRST
from safeloc.report.verdict_words import told_of

WatchOption = Annotated[bool, typer.Option("--watch", help="run again whenever a file is saved, until Ctrl-C")]
PACKAGE = Path(__file__).parents[1]
_LOOKS_EVERY_S = 0.3
_SETTLES_S = 0.2
"""Seconds without a change before a run: an editor may write a file in several steps, or several files in a row."""
_SUFFIXES = (".py", ".toml", ".json", ".jsonl", ".jsonl.gz", ".csv")
_Seen = Mapping[Path, tuple[int, int]]


@dataclass(frozen=True)
class Row:
    """One result of a run: verdict, time, the verdict in the run before ("" if it is new), and whether one run is all its evidence."""

    id: str
    verdict: str
    seconds: float
    before: str
    by_run: bool = False

    @property
    def line(self) -> str:
        """Return the row as text."""
        before = "new" if not self.before else "as before" if self.before == self.verdict else f"was {self.before}"
        return f"{'shown' if self.by_run else self.verdict:9} {self.seconds:6.1f} s  {before:12} {self.id}"


def rows(data: Mapping[str, Any], before: Mapping[str, str]) -> list[Row]:
    """Return the results that were computed in this run: worst verdict first; of equal verdicts, changed ones first."""
    now = [row for row in data["results"] if row["machine"] not in data["kept"]]
    made = [
        Row(row["id"], row["verdict"], row["seconds"], before.get(row["id"], ""), told_of(row) == SHOWN) for row in now
    ]
    return sorted(made, key=lambda row: (WORST_FIRST.index(row.verdict), row.before == row.verdict, -row.seconds))


def watch(arguments: Sequence[str], beside: Sequence[Path]) -> int:
    """Run `safeloc ARGUMENTS` now and after every change, until Ctrl-C; return the exit code of the last run.

    beside   files to watch besides the package: the user's own Python files, and a configuration
    """
    command = [sys.executable, "-m", "safeloc", *(one for one in arguments if one != "--watch"), "--json"]
    # without byte code: Python takes a file of equal size and second of change for unchanged
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}
    before: dict[str, str] = {}
    code = 0
    try:
        for _ in changes([PACKAGE, *beside]):
            began = time.monotonic()
            ran = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
            code = ran.returncode
            before = _show(ran, before, time.monotonic() - began)
            err.print("waiting for a file to be saved (Ctrl-C ends)", markup=False)
    except KeyboardInterrupt:
        err.print("no longer watching", markup=False)
    return code


def _show(ran: subprocess.CompletedProcess[str], before: dict[str, str], seconds: float) -> dict[str, str]:
    """Print a run; return the verdicts of all its results. Of a failed run, print the reason; return the verdicts before."""
    try:
        data = json.loads(ran.stdout)
    except ValueError:
        err.print(ran.stderr.strip() or f"no result (exit code {ran.returncode})", markup=False)
        return before
    made = rows(data, before)
    for row in made:
        out.print(row.line, markup=False)
    gone = before.keys() - {row["id"] for row in data["results"]}
    for name in sorted(gone):
        out.print(f"{'gone':9} {'':8}  was {before[name]:8} {name}", markup=False)
    kept = len(data["results"]) - len(made)
    out.print(f"{data['verdict']}: {len(made)} results decided in {seconds:.1f} s, {kept} from the cache", markup=False)
    return {row["id"]: row["verdict"] for row in data["results"]}


def beside(machines: Sequence[str], config: Path | None) -> list[Path]:
    """Return the files to watch besides the package: Python files in the folders of the user's machines, and a configuration."""
    named = [one for name in machines for one in sources_of(name)]
    addresses = [name.rpartition(":")[0] for name in named if ":" in name]
    folders = dict.fromkeys(Path(name).parent if name.endswith(".py") else Path.cwd() for name in addresses)
    return [path for folder in folders for path in folder.glob("*.py")] + ([] if config is None else [config])


def changes(places: Sequence[Path]) -> Iterator[None]:
    """Yield once now, and once after every change to the files in these places."""
    seen = looked_at(places)
    yield
    while True:
        time.sleep(_LOOKS_EVERY_S)
        now = looked_at(places)
        while now != seen:
            seen = now
            time.sleep(_SETTLES_S)
            now = looked_at(places)
            if now == seen:
                yield
                now = looked_at(places)


def looked_at(places: Sequence[Path]) -> _Seen:
    """Return the files in these places, each with the time of its last change (ns) and its size (bytes)."""
    found: dict[Path, tuple[int, int]] = {}
    for path in (path for place in places for path in _files(place)):
        try:
            stat = path.stat()
        except OSError:  # deleted in the meantime, or between two steps of an editor
            continue
        found[path] = stat.st_mtime_ns, stat.st_size
    return found


def _files(place: Path) -> Iterator[Path]:
    if not place.is_dir():
        yield place
        return
    for folder, folders, names in os.walk(place, followlinks=True):
        folders[:] = [name for name in folders if not name.startswith((".", "__pycache__"))]
        yield from (Path(folder, name) for name in names if name.endswith(_SUFFIXES))
