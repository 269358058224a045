"""Reads recorded arrays: `.npy` and `.npz`, and with the extra `das` HDF5 in each form that dascore knows (such as PRODML).

A recording is phase rate or strain rate, [frames, channels], unchecked: the border checks it block by block. Its scale does
not matter, since levels are compared with each channel's quiet level.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from zipfile import ZipFile, is_zipfile

import numpy as np
from numpy.typing import NDArray

from safeloc.errors import EngineError, InputError, StreamError
from safeloc.language.units import MM_PER_M, MS_PER_S
from safeloc.runtime.outside import refuse_beyond, shortened, shown
from safeloc.runtime.streams.files import existing, streaming
from safeloc.sensing.fibre.blocks import FibreBlock
from safeloc.sensing.fibre.figures import FibreConfig
from safeloc.sensing.fibre.hdf5_contents import require_harmless

LARGEST_RECORDING = 4_000_000_000
"""Bytes: an hour of a thousand channels, 1000 times a second as 8-bit numbers. Cut longer recordings into pieces."""
_RATES = ("", "velocity", "strain_rate")
"""What dascore calls the measured quantity; "" where the file does not say."""
_UNEVEN = 0.01
"""Share of a step by which a frame or channel may lie beside its place: rounding of times and distances, not a gap."""


@dataclass(frozen=True, eq=False)
class Recording:
    """A recording, with its rate and spacing (None: unknown)."""

    frames: NDArray[np.float32]
    frame_hz: float | None
    channel_mm: float | None


def read_array(path: Path, *, name: str = "data", channels_first: bool = False) -> Recording:
    """Read an array from `.npy`, or `name` from `.npz` with `scale`, `fs_hz` and `dx_m` if present; no pickles.

    Whole numbers are multiplied by `scale`, which they need. StreamError for anything that is not two axes of numbers.
    """
    with streaming(path):
        data, figures = _loaded(path, name)
        return _recording(path, data, figures, channels_first)


def _refuse_large(path: Path) -> None:
    """Refuse a file whose arrays declare too much memory; a file of zeros compresses to a thousandth."""
    size = path.stat().st_size
    if is_zipfile(path):
        with ZipFile(path) as archive:
            size = sum(part.file_size for part in archive.infolist())
    refuse_beyond(path, size, LARGEST_RECORDING, "bytes in its arrays")


def _loaded(path: Path, name: str) -> tuple[object, dict[str, float]]:
    """Return the array and the figures stored beside it."""
    try:
        _refuse_large(path)
        loaded = np.load(path, allow_pickle=False)
        if isinstance(loaded, np.ndarray):
            return loaded, {}
        with loaded:
            if name not in loaded:
                raise StreamError(
                    f"{path}: holds {shown(', '.join(sorted(loaded)))}, no array {name!r}; give its name."
                )
            names = ("scale", "fs_hz", "dx_m")
            return loaded[name], {key: float(loaded[key]) for key in names if key in loaded and loaded[key].size == 1}
    except (InputError, FileNotFoundError, MemoryError):
        raise
    except Exception as error:  # numpy, zipfile and zlib may raise anything on a damaged file
        raise StreamError(f"{path}: not an array that numpy reads without pickles ({shortened(error)}).") from error


def _recording(path: Path, data: object, figures: dict[str, float], channels_first: bool) -> Recording:
    if not isinstance(data, np.ndarray) or data.ndim != 2 or data.dtype.kind not in "fiu":
        raise StreamError(f"{path}: needs two axes of real numbers, frames and channels.")
    if data.dtype.kind != "f" and "scale" not in figures:
        raise StreamError(f"{path}: whole numbers need their scale; store it beside them as `scale` in an .npz.")
    frames = (data.T if channels_first else data).astype(np.float32) * np.float32(figures.get("scale", 1.0))
    spacing = figures.get("dx_m")
    return Recording(frames, figures.get("fs_hz"), None if spacing is None else spacing * MM_PER_M)


def read_das(path: Path) -> Recording:
    """Read an HDF5 file in a form that dascore knows. EngineError without dascore; StreamError if it cannot read the file.

    Frames and channels must be evenly spaced over the whole axes, distances may be in any unit of length (metres if none is
    stated), and the quantity must be a rate.

    Only HDF5 is read: dascore finds the kind of a file by trying, and would also try to unpickle it, which runs code.
    """
    try:
        import dascore  # pyright: ignore[reportMissingImports] # an extra
    except ModuleNotFoundError as error:
        raise EngineError(
            f"{path} is read with dascore: pip install 'safeloc[das]'; .npy and .npz need nothing."
        ) from error
    with streaming(path):
        refuse_beyond(path, existing(path).stat().st_size, LARGEST_RECORDING, "bytes")
    require_harmless(path, LARGEST_RECORDING)
    try:
        library: Any = dascore
        patch = library.spool(path)[0].transpose("time", "distance")
    except Exception as error:
        raise StreamError(f"{path}: dascore cannot read it ({shortened(error)}).") from error
    with streaming(path):
        return _of_patch(path, patch)


def _of_patch(path: Path, patch: Any) -> Recording:
    data = np.asarray(patch.data)
    if data.ndim != 2 or data.dtype.kind not in "fiu" or min(data.shape) < 2:
        raise StreamError(f"{path}: needs two axes of real numbers, time and distance, of two or more each.")
    if patch.attrs.data_type not in _RATES:
        raise StreamError(
            f"{path}: holds {shown(patch.attrs.data_type)}, not a rate; store its change over time, "
            'for instance by dascore\'s patch.differentiate("time").'
        )
    if patch.get_coord("distance").units is not None:
        patch = _in_metres(path, patch)
    time, distance = (patch.get_array(name) for name in ("time", "distance"))
    frame_s = _step(path, (time - time[0]) / np.timedelta64(1, "s"), "frame", "s")
    channel_m = _step(path, np.asarray(distance, dtype=np.float64), "channel", "m")
    return Recording(data.astype(np.float32), 1 / frame_s, channel_m * MM_PER_M)


def _in_metres(path: Path, patch: Any) -> Any:
    try:
        return patch.convert_units(distance="m")
    except Exception as error:  # dascore's own errors of units have no common class
        raise StreamError(f"{path}: its distance is no length ({shortened(error)}).") from error


def _step(path: Path, places: NDArray[np.float64], what: str, unit: str) -> float:
    """Return the mean distance of neighbours on an axis. StreamError unless all are where even spacing puts them."""
    step = float(places[-1] - places[0]) / (len(places) - 1)
    if not step > 0:
        raise StreamError(f"{path}: its {what}s are {step:g} {unit} apart on average; the axis has to increase.")
    off = np.abs(places - places[0] - step * np.arange(len(places)))
    if not np.max(off) <= _UNEVEN * step:
        steps = np.diff(places)
        worst = int(np.argmax(np.where(np.isfinite(steps), np.abs(steps - np.median(steps)), np.inf)))
        raise StreamError(
            f"{path}: its {what}s are not evenly spaced: {what} {worst + 1} lies {steps[worst]:g} {unit} after the one before, "
            f"{step:g} {unit} on average; cut the recording there, or interpolate it."
        )
    return step


def blocks(recording: Recording, config: FibreConfig, first_ms: int = 0) -> Iterator[FibreBlock]:
    """Cut the recording into blocks; an incomplete block at the end is dropped.

    InputError where rate, spacing or number of channels are not those of the configuration.
    """
    inter = config.interrogator
    _same("frames a second", recording.frame_hz, inter.frame_hz)
    _same("mm between channels", recording.channel_mm, inter.channel_mm)
    _same("channels", recording.frames.shape[1], inter.channels)
    size = config.band.block_frames
    for number in range(len(recording.frames) // size):
        frames = np.ascontiguousarray(recording.frames[number * size : (number + 1) * size])
        last_ms = first_ms + round((number + 1) * size * MS_PER_S / inter.frame_hz)
        yield FibreBlock(frames, None, last_ms, number)


def _same(what: str, recorded: float | None, configured: float) -> None:
    if recorded is not None and abs(recorded - configured) > 1e-6 * configured:
        raise InputError(f"the recording has {recorded:g} {what}, the configuration {configured:g}; make them agree.")
