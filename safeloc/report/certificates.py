"""The packed certificates of a report folder: certificates/MACHINE.texts.xz has those of all claims of a machine.

Each file has the lines of its SMT-LIB2 texts once (safeloc.report.shared_lines); `safeloc report FOLDER --extract DIR` writes each text to
a file. The name of a text ends in the digest of its content, and its header names the texts that it relies on. report.json lists the
texts of each file. Reports of earlier versions have archives (MACHINE.tar.xz) of all texts in full, or of those of one claim.
"""

from __future__ import annotations

import io
import tarfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from safeloc.errors import InputError
from safeloc.language.verdict import Proved
from safeloc.proof.results import Finding
from safeloc.report.file_names import file_names
from safeloc.report.shared_lines import shared_lines, texts_of
from safeloc.runtime.outside import LARGEST_FILE, shortened
from safeloc.runtime.packed import packed, read_packed

FOLDER, SUFFIX, FORMER = "certificates", ".texts.xz", ".tar.xz"
Archives = dict[str, dict[str, str]]
"""File -> name of each text in it -> the text."""


def archives(findings: Sequence[Finding]) -> Archives:
    """Return the texts of each file, those of one claim together; InputError if two different texts have the same name.

    A text that claims of several machines use is in the file of the first of them.
    """
    machines: dict[str, str] = {}
    texts: dict[str, str] = {}
    taken: dict[str, str] = {}
    for finding in findings:
        if isinstance(finding.result, Proved):
            for name, text in finding.result.certificates.items():
                if taken.setdefault(name.casefold(), text) != text:
                    raise InputError(f"{finding.id}: another certificate is called {name}; rename machine or property.")
                machines.setdefault(name, finding.machine)
                texts[name] = text
    files = file_names([finding.machine for finding in findings])
    found: Archives = {}
    for name in sorted(texts):
        found.setdefault(f"{files[machines[name]]}{SUFFIX}", {})[name] = texts[name]
    return found


def packed_texts(texts: Mapping[str, str]) -> bytes:
    """Return the content of a file with these texts."""
    return packed(shared_lines(texts).encode())


# ------------------------------------------------------------------ read


@dataclass
class Texts:
    """The texts in the files of a folder, by name, and the damaged files, each with its error."""

    texts: dict[str, str] = field(default_factory=dict)
    damaged: dict[str, str] = field(default_factory=dict)


def read_archives(folder: Path, expected: Mapping[str, Sequence[str]]) -> Texts:
    """Read every file in the folder of certificates.

    expected   file -> names of its texts, according to the report

    A file that is damaged, missing or has other texts is listed as damaged, and none of its texts is returned.
    """
    found = Texts()
    present = {path.name: path for suffix in (SUFFIX, FORMER) for path in sorted(folder.glob(f"*{suffix}"))}
    for file in [*present, *(file for file in expected if file not in present)]:
        try:
            texts = (_read_former if file.endswith(FORMER) else _read)(folder / file)
            if set(texts) != {*expected.get(file, ())}:
                raise InputError(f"{folder / file}: its certificates are not those listed in report.json.")
            found.texts |= texts
        except InputError as error:
            found.damaged[file] = str(error)
    return found


def _read(path: Path) -> dict[str, str]:
    """Return the texts of one file by name. InputError for any other file."""
    content = read_packed(path).decode("utf-8", errors="replace")
    try:
        return texts_of(content, LARGEST_FILE)
    except (ValueError, LookupError) as error:
        raise InputError(f"{path}: damaged, no certificates ({shortened(error)}). Write the report again.") from error


def _read_former(path: Path) -> dict[str, str]:
    """Return the texts of one archive by name. InputError for any other file, and for a name that occurs twice."""
    texts: dict[str, str] = {}
    try:
        with tarfile.open(fileobj=io.BytesIO(read_packed(path)), mode="r:") as archive:
            for member in archive:
                content = archive.extractfile(member) if member.isreg() else None
                if content is None or member.name in texts or Path(member.name).name != member.name:
                    raise InputError(f"{path}: damaged, {member.name!r} is no certificate, or is in it twice.")
                texts[member.name] = content.read().decode("utf-8", errors="replace")
    except (tarfile.TarError, EOFError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{path}: damaged, no archive of certificates ({error}). Write the report again.") from error
    return texts
