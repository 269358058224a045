"""Recorded arrays: read with numpy always, with dascore where it is installed; refused with the reason otherwise."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from safeloc.errors import EngineError, InputError, StreamError
from safeloc.sensing.fibre.figures import FibreConfig, Interrogator
from safeloc.sensing.fibre.recordings import Recording, blocks, read_array, read_das
from tests.data_sources import data_file

CONFIG = FibreConfig(interrogator=Interrogator(fibre_mm=200_000))
CHANNELS = CONFIG.interrogator.channels


def test_npy_is_read_as_it_is(tmp_path: Path) -> None:
    """Rate and spacing are not in it."""
    np.save(tmp_path / "a.npy", np.arange(6.0).reshape(3, 2))
    made = read_array(tmp_path / "a.npy")
    assert ([[0, 1], [2, 3], [4, 5]], None, None) == (made.frames.tolist(), made.frame_hz, made.channel_mm)
    assert [[0, 2, 4], [1, 3, 5]] == read_array(tmp_path / "a.npy", channels_first=True).frames.tolist()


def test_npz_tells_scale_rate_and_spacing(tmp_path: Path) -> None:
    """Whole numbers times their scale."""
    np.savez(tmp_path / "a.npz", strain=np.array([[2, 4]], np.int16), scale=0.5, fs_hz=100.0, dx_m=1.5)
    made = read_array(tmp_path / "a.npz", name="strain")
    assert ([[1, 2]], 100, 1_500) == (made.frames.tolist(), made.frame_hz, made.channel_mm)


@pytest.mark.parametrize(
    ("saved", "message"),
    [
        ({"other": np.zeros((2, 2))}, "holds other, no array 'data'"),
        ({"data": np.zeros(3)}, "two axes of real numbers"),
        ({"data": np.zeros((2, 2), complex)}, "two axes of real numbers"),
        ({"data": np.zeros((2, 2), np.int16)}, "whole numbers need their scale"),
        ({"data": np.array([[object()]])}, "without pickles"),
    ],
)
def test_what_is_no_recording_is_refused(tmp_path: Path, saved: dict[str, Any], message: str) -> None:
    """With the file's name and the reason."""
    np.savez(tmp_path / "a.npz", **saved)
    with pytest.raises(StreamError, match=rf"a\.npz: .*{message}"):
        read_array(tmp_path / "a.npz")


@pytest.mark.parametrize("content", [b"", b"no array", b"PK\x03\x04broken"])
def test_broken_files_are_refused(tmp_path: Path, content: bytes) -> None:
    """As a stream error, whatever numpy says."""
    (tmp_path / "a.npz").write_bytes(content)
    with pytest.raises(StreamError, match="not an array"):
        read_array(tmp_path / "a.npz")
    with pytest.raises(StreamError, match="cannot be read: No such file"):
        read_array(tmp_path / "absent.npy")


def test_a_recording_is_cut_into_blocks() -> None:
    """What is left over makes none; times are those of the last frames."""
    frames = np.arange(1_200 * CHANNELS, dtype=np.float32).reshape(1_200, CHANNELS)
    made = list(blocks(Recording(frames, 1_000.0, 10_000.0), CONFIG, first_ms=100))
    assert [(600, 0), (1_100, 1)] == [(block.time_ms, block.sequence) for block in made]
    assert np.array_equal(frames[500:1_000], np.asarray(made[1].phase_rate))


@pytest.mark.parametrize(
    ("recording", "message"),
    [
        (Recording(np.zeros((500, CHANNELS), np.float32), 500.0, None), "500 frames a second, the configuration 1000"),
        (Recording(np.zeros((500, CHANNELS), np.float32), None, 5_000.0), "5000 mm between channels"),
        (Recording(np.zeros((500, 3), np.float32), None, None), "3 channels"),
    ],
)
def test_a_recording_fits_its_configuration(recording: Recording, message: str) -> None:
    """Or is refused before a block is made."""
    with pytest.raises(InputError, match=message):
        list(blocks(recording, CONFIG))


def test_without_dascore_the_remedy_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """And what needs no dascore."""
    monkeypatch.setitem(sys.modules, "dascore", None)
    with pytest.raises(
        EngineError, match=r"^x\.h5 is read with dascore: pip install 'safeloc\[das\]'; \.npy and \.npz"
    ):
        read_das(Path("x.h5"))


def test_dascore_reads_what_it_wrote(tmp_path: Path) -> None:
    """A patch in HDF5, with its rate and spacing; time goes down, distance across."""
    dascore = pytest.importorskip("dascore")
    data = np.arange(12, dtype=np.float64).reshape(3, 4)
    coords = {
        "distance": np.arange(3) * 10.0,
        "time": np.datetime64("2026-01-01") + np.arange(4) * np.timedelta64(2, "ms"),
    }
    patch = dascore.Patch(data=data, coords=coords, dims=("distance", "time"))
    patch.io.write(tmp_path / "a.h5", "dasdae")
    made = read_das(tmp_path / "a.h5")
    assert data.T.tolist() == made.frames.tolist()
    assert (500, 10_000) == (pytest.approx(made.frame_hz), pytest.approx(made.channel_mm))


def test_dascore_refuses_what_it_does_not_know(tmp_path: Path) -> None:
    """As a stream error with its reason."""
    pytest.importorskip("dascore")
    with pytest.importorskip("h5py").File(tmp_path / "a.h5", "w") as file:
        file["data"] = np.zeros((3, 4))
    with pytest.raises(StreamError, match=r"a\.h5: dascore cannot read it"):
        read_das(tmp_path / "a.h5")


@pytest.mark.parametrize(("frames", "step_ms", "why"), [(1, 2, "of two or more each"), (3, 0, "0 s apart")])
def test_dascore_tells_no_rate(tmp_path: Path, frames: int, step_ms: int, why: str) -> None:
    """One frame has none, nor have frames of one time."""
    dascore = pytest.importorskip("dascore")
    time = np.datetime64("2026-01-01") + np.arange(frames) * np.timedelta64(step_ms, "ms")
    coords = {"distance": np.arange(3) * 10.0, "time": time}
    patch = dascore.Patch(data=np.zeros((3, frames)), coords=coords, dims=("distance", "time"))
    patch.io.write(tmp_path / "a.h5", "dasdae")
    with pytest.raises(StreamError, match=rf"a\.h5: .*{why}"):
        read_das(tmp_path / "a.h5")


def stored(path: Path, *, seconds: Sequence[float], metres: Sequence[float], **attributes: str) -> Path:
    """A patch with these axes in HDF5."""
    dascore = pytest.importorskip("dascore")
    time = np.datetime64("2026-01-01") + (np.array(seconds) * 1e9).astype("timedelta64[ns]")
    coords = {"distance": np.array(metres), "time": time}
    data = np.zeros((len(metres), len(seconds)))
    made = dascore.Patch(data=data, coords=coords, dims=("distance", "time"), attrs=attributes)
    unit = attributes.get("distance_units")
    made = made.set_units(distance=unit) if unit else made
    made.io.write(path, "dasdae")
    return path


@pytest.mark.parametrize(
    ("axes", "why"),
    [
        ({"seconds": [0, 0.01, 0.02, 0.04, 0.05]}, r"frames are not evenly spaced: frame 3 lies 0\.02 s after"),
        ({"metres": [0, 10, 20, 30, 45]}, r"channels are not evenly spaced: channel 4 lies 15 m after"),
        ({"metres": [40, 30, 20, 10, 0]}, r"channels are -10 m apart on average; the axis has to increase"),
        ({"data_type": "strain"}, r"holds '?strain'?, not a rate; store its change over time"),
        ({"distance_units": "s"}, r"its distance is no length"),
    ],
)
def test_dascore_axes_are_even_lengths_of_a_rate(tmp_path: Path, axes: dict[str, Any], why: str) -> None:
    """A gap or a splice anywhere is told with its place; the first two frames and channels do not speak for all."""
    even: dict[str, Any] = {"seconds": [0, 0.01, 0.02, 0.03, 0.04], "metres": [0, 10, 20, 30, 40]}
    with pytest.raises(StreamError, match=rf"a\.h5: .*{why}"):
        read_das(stored(tmp_path / "a.h5", **{**even, **axes}))


def test_dascore_distances_may_be_in_any_unit_of_length(tmp_path: Path) -> None:
    """Feet become metres, and a rate of a third of a millisecond, whose times are rounded to ns, is even."""
    seconds = [frame / 3_000 for frame in range(9)]
    made = read_das(stored(tmp_path / "a.h5", seconds=seconds, metres=[0, 10, 20], distance_units="ft"))
    assert (3_000, 3_048) == (pytest.approx(made.frame_hz, rel=1e-5), pytest.approx(made.channel_mm))


def test_the_recorded_earthquake_is_read() -> None:
    """500 channels of 1 m, 50 s of 100 Hz."""
    made = read_array(data_file("das_negative/daspy_example_int16.npz"), channels_first=True)
    assert ((5_000, 500), 100, 1_000) == (made.frames.shape, made.frame_hz, made.channel_mm)
    assert np.isfinite(made.frames).all()
