"""Write a project of the user's own from a template: machine, recording, tests, README, Makefile, pyproject, CI.

    write_project(Path("my-train"), "machine")

Either the whole project is written, or nothing: a folder with files in it is refused, and after a failure what was written
is removed again.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

from safeloc.errors import InputError
from safeloc.language.renamed import hint

_HERE = Path(__file__).parent
_COMMON: Mapping[str, str] = {
    "Makefile.in": "Makefile",
    "pyproject.toml.in": "pyproject.toml",
    "gitignore.in": ".gitignore",
    "github.yml.in": ".github/workflows/verify.yml",
    "gitlab-ci.yml.in": ".gitlab-ci.yml",
}
"""File of the folder `common` -> its place in a project; a template may have one of the same name instead."""
_NAME = re.compile(r"[A-Za-z](?:[A-Za-z0-9_-]*[A-Za-z0-9])?")
_PARTS = ("*.py", "*.md", "recordings/*", "tests/test_*.py")
"""The files of a template that a project gets. Its __init__.py stay: a project's folders are no packages."""


@dataclass(frozen=True)
class Template:
    """A template: what it is about in a line, its Python file, the name of the machine in it, and what is verified of it.

    prefix  before the file, in the name that the commands take: "contract+" for a source of the localizer
    """

    summary: str
    module: str
    machine: str
    prefix: str = ""

    @property
    def target(self) -> str:
        """The machine as the commands of safeloc name it, seen from the project's folder."""
        return self.target_in(Path())

    def target_in(self, folder: Path) -> str:
        """The machine as the commands of safeloc name it, with its file in a folder."""
        return f"{self.prefix}{folder / self.module}.py:{self.machine}"


TEMPLATES: Mapping[str, Template] = {
    "machine": Template("one machine with the error law of a sensor", "odometer", "machine"),
    "composition": Template("a sensor's machine and a supervising one, with a contract", "supervised", "whole"),
    "source": Template("a source of your own for the localizer", "beacons", "source", prefix="contract+"),
}


def write_project(folder: Path, template: str) -> list[Path]:
    """Write a new project into a folder that is empty or not there yet; return its files.

    InputError for an unknown template, a name that is none for a project, a folder with files in it, and a place that cannot
    be written; then nothing of the project is left.
    """
    if template not in TEMPLATES:
        described = "; ".join(f"{name} ({one.summary})" for name, one in TEMPLATES.items())
        raise InputError(f"no template {template!r}; there are {described}.{hint(template, TEMPLATES)}")
    _refuse_name(folder)
    _refuse_place(folder)
    contents = {folder / name: content for name, content in _files(folder.resolve().name, template)}
    _write(folder, contents)
    return sorted(contents)


def _refuse_name(folder: Path) -> None:
    """Refuse a folder whose name is no name for a Python project."""
    name = folder.resolve().name
    if not _NAME.fullmatch(name):
        raise InputError(
            f"{folder}: {name!r} is no name for a project; use letters, digits, - and _, with a letter first, such as "
            "`safeloc init my-train`."
        )


def _refuse_place(folder: Path) -> None:
    """Refuse a place that holds something, and one whose parent folder does not exist."""
    if folder.is_symlink() and not folder.exists():
        raise InputError(f"{folder}: a link to something that does not exist; name another folder.")
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder}: a file, not a folder; name a folder that does not exist yet.")
    if not folder.absolute().parent.is_dir():
        raise InputError(f"{folder.parent}: no such folder; create it first, or name a folder in one that exists.")
    held = sorted(path.name for path in folder.iterdir()) if folder.is_dir() else []
    if held:
        shown = ", ".join(held[:3]) + (f" and {len(held) - 3} more" if len(held) > 3 else "")
        raise InputError(
            f"{folder}: not empty (it holds {shown}); nothing is overwritten. Name a new folder, or empty this one first."
        )


def _files(name: str, template: str) -> Iterator[tuple[str, bytes]]:
    """Yield every file of a project: its path in the folder, and its content."""
    chosen = TEMPLATES[template]
    values = {"NAME": name, "MODULE": chosen.module, "MACHINE": chosen.machine, "VERSION": _version()}
    root = _HERE / template
    for source, place in _COMMON.items():
        own = root / source
        yield place, _filled((own if own.is_file() else _HERE / "common" / source).read_bytes(), values)
    for path in sorted(path for part in _PARTS for path in root.glob(part) if path.name != "__init__.py"):
        content = path.read_bytes()
        yield path.relative_to(root).as_posix(), _filled(content, values) if path.suffix == ".md" else content


def _filled(content: bytes, values: Mapping[str, str]) -> bytes:
    for name, value in values.items():
        content = content.replace(f"@{name}@".encode(), value.encode())
    return content


def _version() -> str:
    try:
        return metadata.version("safeloc")
    except metadata.PackageNotFoundError:  # a checkout that is not installed
        return "0"


def _write(folder: Path, contents: Mapping[Path, bytes]) -> None:
    """Write the files; whatever ends it before the last one, remove what was written and raise that error."""
    made: list[Path] = []
    try:
        for path, content in contents.items():
            for parent in reversed([one for one in path.parents if one.is_relative_to(folder)]):
                if not parent.is_dir():
                    parent.mkdir()
                    made.append(parent)
            with path.open("xb") as file:
                made.append(path)
                file.write(content)
    except BaseException as error:
        _remove(made)
        if isinstance(error, OSError):
            raise InputError(f"{folder}: the project cannot be written here: {error}; nothing was left.") from error
        raise


def _remove(made: list[Path]) -> None:
    """Remove files and folders, the last one first."""
    for path in reversed(made):
        if path.is_dir():
            path.rmdir()
        else:
            path.unlink(missing_ok=True)
