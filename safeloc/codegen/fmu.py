"""A machine as an FMI 3.0 co-simulation unit: description, sources, and the library for this platform, in one zip file.

FMI 3.0 has 64-bit integers, so every value is exact; FMI 2.0 has only 32-bit integers and floating point.
"""

from __future__ import annotations

import io
import platform
import sys
import tempfile
import zipfile
from collections.abc import Mapping
from pathlib import Path

from safeloc.codegen.c99 import library_texts
from safeloc.codegen.c99_build import SUFFIX, build
from safeloc.codegen.c99_layout import layout_of
from safeloc.codegen.c99_origin import NO_ORIGIN, Origin
from safeloc.codegen.fmi3_description import build_description, description
from safeloc.codegen.fmi3_source import unit_source
from safeloc.codegen.fmi3_variables import variables_of
from safeloc.language.expr import Bool
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem

_EPOCH = (1980, 1, 1, 0, 0, 0)  # a fixed time, so that the same machine always gives the same file


def to_fmu(
    system: TransitionSystem,
    *,
    period_ms: int | None = None,
    first: Mapping[str, Value] | None = None,
    doc: str = "",
    kept: Mapping[str, Bool] | None = None,
    cc: str | None = None,
    origin: Origin = NO_ORIGIN,
) -> bytes:
    """Return the bytes of the unit's .fmu file. `system` is the on-board system, without ghosts.

    period_ms  cycle of the machine: the unit refuses communication steps of another length; None: one step is one cycle,
               whatever its length
    first      start values of the parameters, which choose values of variables declared ANY
    kept       invariants, proved by `safeloc.proof.provers.lasting`, that a restored state has to satisfy besides the ranges
    cc         the C compiler; the default is $CC, cc, gcc or clang
    origin     what the unit is made of, for the header among its sources

    EngineError if there is no compiler; InputError if the system cannot run in C.
    """
    layout = layout_of(system, kept)
    variables = variables_of(layout, first or {})
    texts = {**library_texts(layout, doc, origin), "fmi3.c": unit_source(layout, variables, period_ms)}
    sources = sorted(name for name in texts if name.endswith(".c"))
    files: dict[str, bytes] = {
        "modelDescription.xml": description(layout, variables, period_ms, doc).encode(),
        "sources/buildDescription.xml": build_description(layout, sources).encode(),
        **{f"sources/{name}": text.encode() for name, text in texts.items()},
        f"binaries/{platform_tuple()}/{layout.names.prefix}{SUFFIX}": _library(texts, layout.names.prefix, cc),
    }
    return _zipped(files)


def platform_tuple() -> str:
    """Return the name of this platform in FMI 3.0, such as x86_64-linux."""
    machine = platform.machine().lower()
    architecture = {"amd64": "x86_64", "arm64": "aarch64", "i386": "x86", "i686": "x86"}.get(machine, machine)
    system = {"win32": "windows", "darwin": "darwin"}.get(sys.platform, "linux")
    return f"{architecture}-{system}"


def _library(texts: Mapping[str, str], name: str, cc: str | None) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        return build(texts, Path(folder), name, cc=cc, flags=["-fvisibility=hidden"]).read_bytes()


def _zipped(files: Mapping[str, bytes]) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name, _EPOCH), content, zipfile.ZIP_DEFLATED)
    return packed.getvalue()
