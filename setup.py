"""Packages and data files of the distribution, read from the tree, so that a new folder needs no line; all else is in pyproject.toml.

models/ and properties/ stand at the top of the repository and are packaged inside safeloc. The links safeloc/models and
safeloc/properties are for an uninstalled checkout; they are not followed.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from setuptools import setup

ROOT = Path(__file__).parent
TREES = {"safeloc": "safeloc", "safeloc.models": "models", "safeloc.properties": "properties"}
"""Package -> its folder in the repository."""


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


if __name__ == "__main__":
    setup(
        packages=list(packages()),
        package_dir=TREES,
        package_data={package: data_files(folder) for package, folder in packages().items()},
        include_package_data=False,
    )
