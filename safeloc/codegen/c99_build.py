"""Compilation of generated C into a shared library for this computer, in a folder that the caller names."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from safeloc.codegen.c99 import STRICT
from safeloc.errors import EngineError

SUFFIX = {"darwin": ".dylib", "win32": ".dll"}.get(sys.platform, ".so")


def compiler(name: str | None = None) -> str:
    """Return the path of the C compiler: `name`, else $CC, else cc, gcc or clang.

    EngineError if there is none, or not the one that is named: another one might build for another target.
    """
    named = os.environ.get("CC")
    wanted = [name] if name else [named] if named else ["cc", "gcc", "clang"]
    for one in wanted:
        found = shutil.which(one)
        if found:
            return found
    if named and not name:
        raise EngineError(
            f"no C compiler: the variable CC names {named!r}, which is no program that runs. Name one without options, or "
            "unset CC for cc, gcc or clang."
        )
    raise EngineError(
        f"no C compiler: {', '.join(wanted)} not found. Install one (gcc or clang), or name it in the variable CC."
    )


def build(
    texts: Mapping[str, str], folder: Path, name: str, *, cc: str | None = None, flags: Sequence[str] = ()
) -> Path:
    """Compile the shared library of these sources, `folder/NAME-DIGEST.so`, unless it exists already.

    The digest covers texts, compiler and flags, so that a folder can be stored and shared. EngineError with the compiler's
    message if it fails.
    """
    command = [compiler(cc), *STRICT, "-O2", "-fPIC", "-shared", *flags]
    content = "\0".join([*command, *(part for item in sorted(texts.items()) for part in item)])
    library = folder / f"{name}-{hashlib.sha256(content.encode('utf-8')).hexdigest()[:24]}{SUFFIX}"
    if not library.is_file():
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder) as place:
            os.replace(
                _compiled(command, texts, Path(place)), library
            )  # in one operation: other processes may look for it
    return library


def _compiled(command: Sequence[str], texts: Mapping[str, str], place: Path) -> Path:
    for file, text in texts.items():
        (place / file).write_text(text, encoding="utf-8")
    sources = sorted(file for file in texts if file.endswith(".c"))
    library = place / f"library{SUFFIX}"
    done = subprocess.run(
        [*command, "-o", str(library), *sources], cwd=place, capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        raise EngineError(f"{command[0]} refuses the generated C: {done.stderr.strip() or done.returncode}")
    return library
