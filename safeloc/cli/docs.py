"""The command `safeloc docs`: the pages and examples that are installed with the package."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

import safeloc
from safeloc.cli.console import out, print_json, print_line
from safeloc.errors import InputError
from safeloc.language.renamed import hint

_PACKAGE = Path(safeloc.__file__).resolve().parent
_OF_A_FOLDER = "README.md"
"""The page of a folder has the folder's name."""


def docs(
    name: Annotated[
        str | None, typer.Argument(help="page, example or picture; without it, all pages and examples are listed")
    ] = None,
    printed: Annotated[bool, typer.Option("--print", help="print the text of the page, not its path")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="print JSON only")] = False,
) -> None:
    """List the documentation that is installed with safeloc, or print the path of one page, or its text."""
    if printed and (name is None or as_json):
        raise typer.BadParameter("--print is for the text of one page: give its name, without --json.")
    known = pages(folder())
    if name is not None:
        path = _find_page(known, name)
        if as_json:
            print_json({"name": name, "path": str(path)})
        elif printed:
            sys.stdout.write(path.read_text(encoding="utf-8"))
        else:
            out.print(str(path), markup=False)
        return
    rows = [{"name": page, "title": title(path)} for page, path in known.items() if path.suffix != ".svg"]
    if as_json:
        print_json(rows)
        return
    for row in rows:
        print_line(f"{row['name']}  {row['title']}")


def folder() -> Path:
    """Return the folder of the documentation: in the package, or beside it in a checkout."""
    for found in (_PACKAGE / "docs", _PACKAGE.parent / "docs"):
        if (found / "language.md").is_file():
            return found
    raise InputError(f"{_PACKAGE}: the documentation is missing; install safeloc again.")


def pages(of: Path) -> dict[str, Path]:
    """Return every file by its name: a page without its suffix, the page of a folder by the folder, others as they are."""
    paths = sorted(path for path in of.rglob("*") if path.is_file() and "__pycache__" not in path.parts)
    return {_name(path.relative_to(of)): path for path in paths}


def _name(path: Path) -> str:
    if path.name == _OF_A_FOLDER:
        return path.parent.as_posix()
    return (path.with_suffix("") if path.suffix == ".md" else path).as_posix()


def _find_page(known: Mapping[str, Path], name: str) -> Path:
    """Return the file with this name, which may also be written as in a link (docs/language.md). InputError if there is none."""
    asked = name.partition("#")[0].removeprefix("docs/").removesuffix("/").removesuffix(".md").removesuffix("/README")
    if asked not in known:
        begin = " Begin with the tutorial." if asked in ("README", ".", "..") else hint(asked, list(known))
        raise InputError(f"there is no page {name!r}; `safeloc docs` lists all.{begin}")
    return known[asked]


def title(path: Path) -> str:
    """Return the first heading of a page, or what an example says of itself in its first line."""
    text = path.read_text(encoding="utf-8")
    first = next((line for line in text.splitlines() if line.strip()), "")
    if path.suffix in (".md", ".toml"):
        return first.removeprefix("#").strip()
    return first.strip('"') if path.suffix == ".py" else ""
