"""The digests of a report's files, in the folder itself: `sha256sum -c SHA256SUMS` checks them as well.

They tell a damaged or mixed folder from the one that was written. They are no signature: whoever changes a file on purpose can
change its digest too. That every proof is one is checked by `safeloc recheck`.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from pathlib import Path

from safeloc.errors import InputError
from safeloc.runtime.outside import read_bytes

SUMS = "SHA256SUMS"


_SIGNATURES: Mapping[str, str] = {
    f"{SUMS}.asc": f"gpg --verify {SUMS}.asc {SUMS}",
    f"{SUMS}.sig": f"ssh-keygen -Y verify -f ALLOWED_SIGNERS -I WHO -n safeloc-report -s {SUMS}.sig < {SUMS}",
}
"""File of a signature beside the digests -> the command that checks it; a report never has one by itself."""
_SSH = b"-----BEGIN SSH SIGNATURE-----"


def origin(folder: Path) -> list[str]:
    """Return what the digests of a folder that fits them show, and what is known of who made it."""
    shown = f"the files fit {SUMS}: nothing was changed by accident since the report was written; who made it, that does not show"
    found = [name for name in _SIGNATURES if (folder / name).is_file()]
    if not found:
        return [f"{shown} ({SUMS} is not signed; sign it: gpg --armor --detach-sign {SUMS})"]
    told = [f"{name} is there, and not checked by safeloc; this checks it: {_checks(folder, name)}" for name in found]
    return [shown, *told]


def _checks(folder: Path, name: str) -> str:
    """Return the command that checks a signature; one that ends in .sig may be of either program."""
    if name.endswith(".sig") and not read_bytes(folder / name).startswith(_SSH):
        return f"gpg --verify {name} {SUMS}"
    return _SIGNATURES[name]


def write_digests(folder: Path, files: Iterable[str]) -> None:
    """Write the digests of these files, which lie in the folder."""
    lines = [f"{_digest(folder / name)}  {name}\n" for name in files]
    (folder / SUMS).write_text("".join(lines), encoding="utf-8")


def renew_digests(folder: Path, files: Iterable[str]) -> None:
    """Write the digests of these files in place of those of pages; what the report says of its data stays."""
    own = {name: digest for name, digest in _read(folder).items() if not _is_page(name)} if _has(folder) else None
    if own is None:
        return
    own |= {name: _digest(folder / name) for name in files if _is_page(name)}
    lines = [f"{digest}  {name}\n" for name, digest in own.items()]
    (folder / SUMS).write_text("".join(lines), encoding="utf-8")


def misfits(folder: Path, files: Iterable[str]) -> list[str]:
    """Return what does not fit, each with its file: changed, missing, or not of this report. `files` are those that are there."""
    if not _has(folder):
        return [f"{SUMS} is missing: whether the files are those of one report cannot be told"]
    known, there = _read(folder), set(files)
    found = [f"{name} is missing" for name in known if name not in there]
    found += [f"{name} is not of this report" for name in sorted(there - known.keys())]
    return found + [
        f"{name} is not the file that was written"
        for name, digest in known.items()
        if name in there and _digest(folder / name) != digest
    ]


def _has(folder: Path) -> bool:
    return (folder / SUMS).is_file()


def _is_page(name: str) -> bool:
    return name.endswith(".html") or name.startswith("page/")


def _digest(path: Path) -> str:
    return hashlib.sha256(read_bytes(path)).hexdigest()


def _read(folder: Path) -> dict[str, str]:
    """Return file -> digest. InputError for lines that are none of `sha256sum`."""
    found = {}
    for number, line in enumerate(read_bytes(folder / SUMS).decode("utf-8", errors="replace").splitlines(), 1):
        digest, blank, name = line.partition("  ")
        if not blank or len(digest) != 64 or not name:
            raise InputError(f"{folder / SUMS}:{number}: no digest and name of a file. Write the report again.")
        found[name] = digest
    return found
