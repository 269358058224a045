"""The command `safeloc cache`, and the options of other commands that choose the cache's folder."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from safeloc.cli.console import err, out
from safeloc.proof.cache.store import Store, usual_folder
from safeloc.proof.results import Finding

CacheOption = Annotated[
    Path | None,
    typer.Option(
        "--cache",
        envvar="SAFELOC_CACHE",
        help="folder of the cache of earlier results; by default in the user's cache folder",
    ),
]
FreshOption = Annotated[bool, typer.Option("--fresh", help="ignore cached results of earlier runs")]


def store_in(folder: Path | None) -> Store:
    """Return the store in this folder, or in the user's own."""
    return Store(usual_folder() if folder is None else folder)


def _cached_in_words(findings: Sequence[Finding]) -> str:
    """Return the number of findings from the cache and their oldest date, in words; "" if all were computed now."""
    since = [finding.kept_since for finding in findings if finding.kept_since]
    if not since:
        return ""
    return f"{len(findings) - len(since)} results computed now, {len(since)} from the cache, the oldest of {min(since)}"


def print_cached(findings: Sequence[Finding], *, quiet: bool) -> None:
    """Print how many findings come from the cache, if any does."""
    text = _cached_in_words(findings)
    if text and not quiet:
        err.print(text, markup=False)


def cache(
    folder: CacheOption = None,
    clean: Annotated[bool, typer.Option("--clean", help="delete all cached results")] = False,
    size: Annotated[
        bool, typer.Option("--size", help="show the number and size of cached files (the default)")
    ] = False,
) -> None:
    """Show the size of the cache of earlier results, or clear it."""
    store = store_in(folder)
    if size or not clean:
        out.print(f"{store.folder}: {len(list(store.entries()))} files, {store.bytes / 1e6:.1f} MB", markup=False)
    if clean:
        store.clean()
        out.print(f"{store.folder}: the cache is empty now", markup=False)
