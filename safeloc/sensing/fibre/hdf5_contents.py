"""Inspects an HDF5 file before it is read: sizes, links to other files, and pickled code.

A few kilobytes can declare terabytes: an array of zeros packs to a thousandth, and one that was never written takes no
space at all. Readers built on PyTables (such as dascore) execute attributes that are Python pickles. So a file is refused,
before any of its arrays is read, if it has more data than the limit, far more than is stored, links to other files, or a pickle
that names anything but numpy's own numbers.

This bounds the reading, not the HDF5 library itself, which opens damaged files as well as it can.
"""

from __future__ import annotations

import pickletools
from collections.abc import Iterator
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from safeloc.errors import EngineError, SafelocError, StreamError
from safeloc.runtime.outside import refuse_beyond, shortened, shown
from safeloc.runtime.streams.files import streaming

_SIGNATURE = b"\x89HDF\r\n\x1a\n"

MOST_OBJECTS = 10_000
"""Greatest number of groups and arrays; a recording has some tens."""

MOST_ATTRIBUTES = 1_000
"""Greatest number of attributes of one object; in recordings about a hundred."""

_LARGEST_TEXT = 10_000_000
"""Bytes of all attributes and texts together."""

_MOST_TEXTS = 16
"""Greatest number of variable-length texts in one place; many may point to the same bytes, which are read for each."""

_MOST_PACKED = 100
"""The arrays may be this many times larger than the file. Measured light compresses to a half or a fifth."""

_SMALL = 100_000_000
"""Arrays up to this many bytes are exempt from it."""

_NUMBERS = {
    ("numpy", "dtype"), ("numpy._core.multiarray", "scalar"), ("numpy.core.multiarray", "scalar"),
    ("_codecs", "encode"),
}  # fmt: skip
"""Names that a pickle may contain, since dascore stores the range of a time axis with them. None runs code."""

_NAMING = {"INST", "STACK_GLOBAL", "EXT1", "EXT2", "EXT4", "PERSID", "BINPERSID"}
"""Opcodes beside GLOBAL with which a pickle names an object; PyTables writes none of them."""


def require_harmless(path: Path, largest: int) -> None:
    """Refuse a file with content that must not be read. StreamError says what and where; EngineError without h5py.

    largest   bytes of all arrays, unpacked
    """
    try:
        import h5py  # pyright: ignore[reportMissingImports] # comes with dascore
    except ModuleNotFoundError as error:
        raise EngineError(f"{path} is HDF5, read with h5py: pip install 'safeloc[das]'.") from error
    with streaming(path):
        with path.open("rb") as begin:
            if begin.read(len(_SIGNATURE)) != _SIGNATURE:
                raise StreamError(f"{path}: not an HDF5 file; store other recordings as HDF5, or as .npy or .npz.")
        try:
            with h5py.File(path, "r") as file:
                _Looked(path, h5py, largest).through(file)
        except (SafelocError, MemoryError):
            raise
        except Exception as error:  # the library may raise anything on a damaged file
            raise StreamError(f"{path}: not readable as HDF5 ({shortened(error)}).") from error


@dataclass
class _Looked:
    """The state of the inspection of one file."""

    path: Path
    library: Any
    largest: int
    objects: int = 0
    array_bytes: int = 0
    text_bytes: int = 0

    def through(self, file: Any) -> None:
        """Inspect every object once, and the links of groups."""
        self._object("/", file)
        file.visititems(self._object)

    def _object(self, name: str, found: Any) -> None:
        self.objects += 1
        refuse_beyond(self.path, self.objects, MOST_OBJECTS, "groups and arrays")
        if isinstance(found, self.library.Group):
            self._links(name, found)
        elif isinstance(found, self.library.Dataset):
            self._array(name, found)
        self._attributes(name, found)

    def _links(self, name: str, group: Any) -> None:
        refuse_beyond(f"{self.path}: {shown(name)}", len(group), MOST_OBJECTS, "members")
        for member in group:
            if isinstance(group.get(member, getlink=True), self.library.ExternalLink):
                self._refuse(f"{name}/{member}", "is in another file; copy it into this one")

    def _array(self, name: str, array: Any) -> None:
        if array.is_virtual or array.external:
            self._refuse(name, "is in other files; copy it into this one")
        if array.shape is None:
            return
        if array.dtype.hasobject:
            self._texts(name, array)
        size = max(array.size, prod(array.chunks) if array.chunks else 0)  # a chunk is always unpacked completely
        self.array_bytes += size * array.dtype.itemsize
        where = f"{self.path}: {shown(name)}"
        refuse_beyond(where, self.array_bytes, self.largest, "bytes in arrays up to here")
        stored = self.path.stat().st_size
        if self.array_bytes > max(_SMALL, _MOST_PACKED * stored):
            self._refuse(
                name,
                f"makes {self.array_bytes} bytes of a file of {stored}; no measurement packs to less than 1 in {_MOST_PACKED}",
            )

    def _texts(self, name: str, array: Any) -> None:
        if self.library.check_string_dtype(array.dtype) is None:
            self._refuse(name, "holds lists or objects, not numbers; a recording has none")
        refuse_beyond(f"{self.path}: {shown(name)}", array.size, _MOST_TEXTS, "texts")
        self._count_text(name, array[()])

    def _attributes(self, name: str, found: Any) -> None:
        where = f"{self.path}: {shown(name)}"
        refuse_beyond(where, len(found.attrs), MOST_ATTRIBUTES, "attributes")
        for key in found.attrs:
            attribute = found.attrs.get_id(key)
            if attribute.shape is None:
                continue
            if attribute.dtype.hasobject:
                refuse_beyond(f"{where}: {shown(key)}", prod(attribute.shape), _MOST_TEXTS, "texts")
            else:
                refuse_beyond(
                    f"{where}: {shown(key)}", prod(attribute.shape) * attribute.dtype.itemsize, _LARGEST_TEXT, "bytes"
                )
            value = found.attrs[key]
            self._count_text(name, value)
            for text in _bytes_in(value):
                self._require_no_code(f"{name}: {key}", text)

    def _count_text(self, name: str, value: object) -> None:
        self.text_bytes += sum(map(len, _bytes_in(value)))
        refuse_beyond(f"{self.path}: {shown(name)}", self.text_bytes, _LARGEST_TEXT, "bytes of text up to here")

    def _require_no_code(self, name: str, text: bytes) -> None:
        for named in _names_of_pickle(text):
            self._refuse(name, f"is a pickle that names {shown(named)}; what reads it would run that. Leave it out")

    def _refuse(self, name: str, why: str) -> None:
        raise StreamError(f"{self.path}: {shown(name)} {why}.")


def _bytes_in(value: object) -> list[bytes]:
    """Return all texts of an attribute or an array as bytes."""
    if isinstance(value, np.ndarray):
        return [text for one in value.ravel().tolist() for text in _bytes_in(one)]
    if isinstance(value, str):
        return [value.encode("utf-8", "surrogateescape")]
    if isinstance(value, np.void):
        return [value.tobytes()]
    return [value] if isinstance(value, bytes) else []


def _names_of_pickle(text: bytes) -> Iterator[str]:
    """Yield the names that a pickle would import, except numbers, up to its first invalid opcode (it would run that far)."""
    try:
        for code, argument, _ in pickletools.genops(text):
            if code.name == "GLOBAL" and tuple(str(argument).split(" ", 1)) not in _NUMBERS:
                yield str(argument)
            elif code.name in _NAMING:
                yield code.name
    except Exception:  # whatever is wrong with it, unpickling would end here too
        return
