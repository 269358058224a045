"""Packages and data files of the distribution, read from the tree, so that a new folder needs no line; all else is in pyproject.toml.

models/ and properties/ stand at the top of the repository and are packaged inside safeloc. The links safeloc/models and
safeloc/properties are for an uninstalled checkout; they are not followed. docs/ is packaged as data, for `safeloc docs`.

The description of the package is README.md, in which links that lead nowhere outside of a checkout are commands instead.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path

from setuptools import setup

ROOT = Path(__file__).parent
TREES = {"safeloc": "safeloc", "safeloc.models": "models", "safeloc.properties": "properties"}
"""Package -> its folder in the repository."""
DOCS = {"safeloc.docs": "docs"}
"""The same for files that are read, also those that are Python: examples are no modules of the package."""


def folders(tree: str) -> Iterator[Path]:
    """Yield a tree's folder and all folders in it."""
    for at, inside, _ in os.walk(ROOT / tree):
        inside[:] = sorted(name for name in inside if name != "__pycache__")
        yield Path(at)


def is_package(folder: Path) -> bool:
    """Return whether a folder holds Python files; without an __init__.py a test refuses it."""
    return any(folder.glob("*.py"))


def packages() -> dict[str, Path]:
    """Return every package with its folder."""
    return {
        ".".join([package, *folder.relative_to(ROOT / tree).parts]): folder
        for package, tree in TREES.items()
        for folder in folders(tree)
        if is_package(folder)
    }


def data_files(package: Path) -> list[str]:
    """List the other files of a package, also in its folders without Python files, by their paths in it."""
    found = []
    for at, inside, names in os.walk(package):
        inside[:] = [name for name in inside if name != "__pycache__" and not is_package(Path(at) / name)]
        found += [(Path(at) / name).relative_to(package).as_posix() for name in names if not name.endswith(".py")]
    return sorted(found)


def pages(folder: Path) -> list[str]:
    """List every file of the documentation by its path in it."""
    return sorted(
        path.relative_to(folder).as_posix()
        for path in folder.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    )


FENCE = re.compile(r"(^```.*?^```$)", re.DOTALL | re.MULTILINE)
LINK = re.compile(r"(!?)\[([^\]]*)\]\((?!https?://)([^)\s]*)\)")
IMAGE = re.compile(r"<img\b[^>]*>")
ATTRIBUTE = re.compile(r'\b(src|alt)="([^"]*)"')


def description(readme: str) -> str:
    """Return the text of README.md without links to files: they are named as commands; blocks of code stay as they are."""
    parts = FENCE.split(readme)
    return "".join(part if part.startswith("```") else without_links(part) for part in parts)


def without_links(text: str) -> str:
    """Return the text with `safeloc docs NAME` in place of each link to a page or picture."""
    return LINK.sub(lambda found: in_words(found[1], found[2], found[3]), IMAGE.sub(of_html, text))


def of_html(image: re.Match[str]) -> str:
    """Return an image of HTML as one of Markdown."""
    has = dict(ATTRIBUTE.findall(image[0]))
    return f"![{has.get('alt', 'picture')}]({has.get('src', '')})"


def in_words(picture: str, words: str, target: str) -> str:
    """Return a link in words; of a file that is not installed, and of a place on the same page, only the words."""
    path = target.partition("#")[0]
    if not path.startswith("docs/"):
        return words
    name = re.sub(r"(/README)?(\.md|/)$", "", path.removeprefix("docs/"))
    command = f"`safeloc docs {name}`"
    return command if words.startswith("docs/") else f"{words} ({'picture: ' if picture else ''}{command})"


if __name__ == "__main__":
    setup(
        long_description=description((ROOT / "README.md").read_text(encoding="utf-8")),
        long_description_content_type="text/markdown",
        packages=[*packages(), *DOCS],
        package_dir={**TREES, **DOCS},
        package_data={
            **{package: data_files(folder) for package, folder in packages().items()},
            **{package: pages(ROOT / folder) for package, folder in DOCS.items()},
        },
        include_package_data=False,
    )
