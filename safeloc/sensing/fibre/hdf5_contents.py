"""Inspection of an HDF5 file before it is read: sizes, links to other files, and pickled code.

A few kilobytes can declare terabytes: an array of zeros packs to a thousandth, and one that was never written takes no
space at all. Readers built on PyTables (such as dascore) execute attributes that are Python pickles. So a file is refused,
before any of its arrays is read, if it holds more than we read, far more than was stored, data of other files, or a pickle
that names anything but numpy's own numbers.

Reading is bounded so, not the HDF5 library itself: it opens what is damaged as well as it can.
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
"""Groups and arrays; a recording has some tens."""

MOST_ATTRIBUTES = 1_000
"""Of one object; a recording's largest has about a hundred."""

_LARGEST_TEXT = 10_000_000
"""Bytes of all attributes and texts together."""

_MOST_TEXTS = 16
"""Texts of any length in one place; many may point to the same bytes, which are read again for each."""

_MOST_PACKED = 100
"""How many times larger than the file its arrays may be. Measured light packs to a half or a fifth."""

_SMALL = 100_000_000
"""Bytes of arrays for which that is not asked."""

_NUMBERS = {
    ("numpy", "dtype"), ("numpy._core.multiarray", "scalar"), ("numpy.core.multiarray", "scalar"),
    ("_codecs", "encode"),
}  # fmt: skip
"""What a pickle may name: dascore writes the range of a time axis so. None of these runs anything."""

_NAMING = {"INST", "STACK_GLOBAL", "EXT1", "EXT2", "EXT4", "PERSID", "BINPERSID"}
"""Ways of a pickle to name something, beside GLOBAL; PyTables writes none of them."""


def require_harmless(path: Path, largest: int) -> None:
    """StreamError for a file that holds what must not be read, with what and where; EngineError without h5py.

    largest   bytes of all arrays, unpacked
    """
    try:
        import h5py  # pyright: ignore[reportMissingImports] # comes with dascore
    except ModuleNotFoundError as error:
        raise EngineError(f"{path} is HDF5, read with h5py: pip install 'safeloc[das]'.") from error
    with streaming(path):
        with path.open("rb") as begin:
            if begin.read(len(_SIGNATURE)) != _SIGNATURE:
                raise StreamError(f"{path}: no HDF5 file; store other recordings as HDF5, or as .npy or .npz.")
        try:
            with h5py.File(path, "r") as file:
                _Looked(path, h5py, largest).through(file)
        except (SafelocError, MemoryError):
            raise
        except Exception as error:  # the library fails on damage in its own ways
            raise StreamError(f"{path}: no HDF5 that can be read ({shortened(error)}).") from error


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
        """Every object once, the groups' links among them."""
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
        size = max(array.size, prod(array.chunks) if array.chunks else 0)  # a part is unpacked whole
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
            told = found.attrs.get_id(key)
            if told.shape is None:
                continue
            if told.dtype.hasobject:
                refuse_beyond(f"{where}: {shown(key)}", prod(told.shape), _MOST_TEXTS, "texts")
            else:
                refuse_beyond(f"{where}: {shown(key)}", prod(told.shape) * told.dtype.itemsize, _LARGEST_TEXT, "bytes")
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
    """All texts of an attribute or an array, as bytes."""
    if isinstance(value, np.ndarray):
        return [text for one in value.ravel().tolist() for text in _bytes_in(one)]
    if isinstance(value, str):
        return [value.encode("utf-8", "surrogateescape")]
    if isinstance(value, np.void):
        return [value.tobytes()]
    return [value] if isinstance(value, bytes) else []


def _names_of_pickle(text: bytes) -> Iterator[str]:
    """List the names that a pickle would import, except numbers, up to its first invalid code, since it would run that
    far."""
    try:
        for code, argument, _ in pickletools.genops(text):
            if code.name == "GLOBAL" and tuple(str(argument).split(" ", 1)) not in _NUMBERS:
                yield str(argument)
            elif code.name in _NAMING:
                yield code.name
    except Exception:  # whatever is wrong with it: here it ends, for who would run it too
        return
