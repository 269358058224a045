"""What earlier runs found and is kept: the options that say where, and `safeloc cache`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from safeloc.cli.console import out
from safeloc.proof.cache.store import Store, usual_folder
from safeloc.proof.results import Finding

CacheOption = Annotated[
    Path | None,
    typer.Option(
        "--cache", envvar="SAFELOC_CACHE", help="folder of what earlier runs found; the user's own without it"
    ),
]
FreshOption = Annotated[bool, typer.Option("--fresh", help="ignore what earlier runs found")]


def store_in(folder: Path | None) -> Store:
    """The store in this folder, or in the user's own."""
    return Store(usual_folder() if folder is None else folder)


def told(findings: Sequence[Finding]) -> str:
    """How many of the findings an earlier run made, and since when they are kept; "" where all were made now."""
    since = [finding.kept_since for finding in findings if finding.kept_since]
    if not since:
        return ""
    return f"{len(findings) - len(since)} results computed now, {len(since)} kept, the oldest since {min(since)}"


def cache(
    folder: CacheOption = None,
    clean: Annotated[bool, typer.Option("--clean", help="take away all that is kept")] = False,
    size: Annotated[bool, typer.Option("--size", help="say how much is kept (what it does without an option)")] = False,
) -> None:
    """Say how much earlier runs left behind, and take it away."""
    store = store_in(folder)
    if size or not clean:
        out.print(f"{store.folder}: {len(list(store.entries()))} files, {store.bytes / 1e6:.1f} MB", markup=False)
    if clean:
        store.clean()
        out.print(f"{store.folder}: nothing is kept any more", markup=False)
