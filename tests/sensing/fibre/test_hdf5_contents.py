"""HDF5 files that promise too much, point elsewhere or carry code: refused before an array is read."""

from __future__ import annotations

import os
import pickle
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from safeloc.errors import EngineError, SafelocError, StreamError
from safeloc.sensing.fibre.hdf5_contents import MOST_ATTRIBUTES, MOST_OBJECTS, require_harmless
from safeloc.sensing.fibre.recordings import LARGEST_RECORDING, read_das

h5py = pytest.importorskip("h5py")

Make = Callable[[Any], object]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """Where a file is made."""
    return tmp_path / "a.h5"


def made(path: Path, make: Make) -> Path:
    """A file with this in it."""
    with h5py.File(path, "w") as file:
        make(file)
    return path


def judged(path: Path) -> None:
    """As before a recording is read."""
    require_harmless(path, LARGEST_RECORDING)


def sound(file: Any) -> None:
    """Arrays of numbers, packed as measured light packs; texts of both kinds, times, an empty attribute, a soft link."""
    frames = np.random.default_rng(1).integers(-100, 100, (500, 200), np.int16)
    array = file.create_dataset("Acquisition/Raw[0]/RawData", data=frames, chunks=(100, 200), compression="gzip")
    array.attrs["Dimensions"] = ["time", "locus"]
    array.attrs["units"] = np.bytes_(b"rad per frame.\nGauge length 10 m.\n")
    array.attrs["title"] = h5py.Empty("S1")
    array.attrs["_range"] = np.bytes_(pickle.dumps({"min": np.datetime64("2026-01-01"), "max": np.float64(1)}, 0))
    file["name"] = "Example"
    file["nothing"] = h5py.Empty("f4")
    file["same"] = h5py.SoftLink("/Acquisition/Raw[0]/RawData")


def test_a_sound_file_is_let_pass(path: Path) -> None:
    """Whatever stands in files of instruments."""
    judged(made(path, sound))


def zeros(file: Any) -> None:
    """Written, and packed to a thousandth."""
    array = file.create_dataset("data", (2_000, 100_000), "f4", chunks=(2_000, 1_000), compression="gzip")
    array[:, :1_000] = 0  # a hundredth of it is enough to be known


def declared(*shape: int, **told: Any) -> Make:
    """An array that nobody ever wrote."""
    return lambda file: file.create_dataset("data", shape, "f8", chunks=told.pop("chunks", True), **told)


def many_together(file: Any) -> None:
    """Each of them small enough."""
    for number in range(50):
        file.create_dataset(f"part{number}", (1_000, 20_000), "f8", chunks=True)


def same_text(file: Any) -> None:
    """Many references to one long text: each is read again."""
    array = file.create_dataset("data", (1_000_000,), h5py.string_dtype(), chunks=True)
    array[0] = "x" * 1_000


def long_texts(file: Any) -> None:
    """In attributes, each within bounds."""
    for number in range(20):
        file.create_group(f"g{number}").attrs["text"] = "x" * 1_000_000


def lists(file: Any) -> None:
    """As PyTables keeps Python objects, which it makes again by pickle."""
    file.create_dataset("data", (2,), h5py.vlen_dtype(np.uint8))


def elsewhere(file: Any) -> None:
    """A link into another file."""
    file["data"] = h5py.ExternalLink("/etc/passwd", "/")


def raw_elsewhere(file: Any) -> None:
    """An array whose bytes are another file's."""
    file.create_dataset("data", (10, 10), "u1", external=[("/dev/zero", 0, 100)])


def put_together(file: Any) -> None:
    """An array of parts of other files."""
    layout = h5py.VirtualLayout((10, 10), "f4")
    layout[:] = h5py.VirtualSource("other.h5", "data", (10, 10))
    file.create_virtual_dataset("data", layout)


def many_groups(file: Any) -> None:
    """More than any recording has."""
    for number in range(MOST_OBJECTS + 1):
        file.create_group(str(number))


def many_attributes(file: Any) -> None:
    """The same."""
    for number in range(MOST_ATTRIBUTES + 1):
        file.attrs[str(number)] = 0


@pytest.mark.parametrize(
    ("make", "why"),
    [
        (zeros, r"data makes 800000000 bytes of a file of \d+; no measurement packs to less than 1 in 100"),
        (declared(300_000, 200_000), "data: more than 4000000000 bytes in arrays up to here"),
        (declared(10_000, 100_000, compression="gzip"), "data: more than 4000000000 bytes in arrays"),
        (
            declared(2, 2, chunks=(8_000, 60_000), maxshape=(None, None)),
            r"data makes 3840000000 bytes of a file of \d+",
        ),
        (many_together, "more than 4000000000 bytes in arrays|makes 160000000 bytes"),
        (same_text, "data: more than 16 texts"),
        (long_texts, "more than 10000000 bytes of text"),
        (lists, "data holds lists or objects, not numbers"),
        (elsewhere, "/data is in another file; copy it into this one"),
        (raw_elsewhere, "data is in other files; copy it into this one"),
        (put_together, "data is in other files; copy it into this one"),
        (many_groups, "more than 10000 groups and arrays|more than 10000 members"),
        (many_attributes, "/: more than 1000 attributes"),
    ],
)
def test_bombs(path: Path, make: Make, why: str) -> None:
    """Refused with file, place and reason, in a small part of the memory that they ask for."""
    made(path, make)
    assert path.stat().st_size < 50_000_000
    tracemalloc.start()
    with pytest.raises(StreamError, match=rf"^{path}: .*({why})"):
        judged(path)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < 20_000_000


class Code:
    """Leaves a sign where it is run."""

    def __init__(self, sign: Path) -> None:
        self.sign = sign

    def __reduce__(self) -> tuple[Any, ...]:
        return os.mkdir, (str(self.sign),)


def code_in_attribute(sign: Path, protocol: int) -> Make:
    """As PyTables runs it when the attribute is read."""

    def make(file: Any) -> None:
        sound(file)
        file["Acquisition"].attrs["note"] = np.bytes_(pickle.dumps(Code(sign), protocol))

    return make


@pytest.mark.parametrize("protocol", range(pickle.HIGHEST_PROTOCOL + 1))
def test_code_is_not_run(path: Path, tmp_path: Path, protocol: int) -> None:
    """Neither here, nor by whoever would read the file next."""
    sign = tmp_path / "run"
    made(path, code_in_attribute(sign, protocol))
    with pytest.raises(StreamError, match=r"Acquisition: note is a pickle that names (posix mkdir|STACK_GLOBAL)"):
        judged(path)
    assert not sign.exists()


def test_a_broken_pickle_is_run_up_to_where_it_breaks(path: Path) -> None:
    """So what comes before counts."""
    text = np.bytes_(b"cos\nsystem\n(S'true'\ntR\xff.")
    with pytest.raises(StreamError, match="is a pickle that names os system"):
        judged(made(path, lambda file: file.attrs.__setitem__("note", text)))


@pytest.mark.parametrize("content", [b"", b"no HDF5", pickle.dumps([1]), b"\0" * 512 + b"\x89HDF\r\n\x1a\n"])
def test_other_files(path: Path, content: bytes) -> None:
    """Among them what a reader that tries all kinds would take for a pickle."""
    path.write_bytes(content)
    with pytest.raises(StreamError, match=rf"^{path}: not an HDF5 file; store other recordings as HDF5"):
        judged(path)


def test_damage(path: Path) -> None:
    """Is told in words, wherever it is."""
    whole = bytearray(made(path, sound).read_bytes())
    for place in range(8, len(whole), max(1, len(whole) // 150)):
        damaged = bytearray(whole)
        damaged[place] ^= 0xFF
        path.write_bytes(damaged)
        try:
            judged(path)
        except StreamError as error:
            assert str(error).startswith(f"{path}: ")  # noqa: PT017 # most damage is in numbers, and passes
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(StreamError, match="not readable as HDF5"):
        judged(path)


def test_the_reader_looks_first(path: Path, tmp_path: Path) -> None:
    """read_das refuses all of these; without its extra it says what to install."""
    sign = tmp_path / "run"
    for make in (zeros, elsewhere, code_in_attribute(sign, 0)):
        with pytest.raises((StreamError, EngineError)) as told:
            read_das(made(path, make))
        assert isinstance(told.value, SafelocError)
    assert not sign.exists()
    with pytest.raises((StreamError, EngineError), match=r"a folder, not a file|is read with dascore"):
        read_das(tmp_path)
