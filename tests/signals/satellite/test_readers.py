"""Readers refuse what they cannot read, with file and line."""

from __future__ import annotations

from pathlib import Path

import pytest

from safeloc.errors import InputError, StreamError
from safeloc.signals.satellite.android import read_android
from safeloc.signals.satellite.epochs import Epoch, Measured, in_order
from safeloc.signals.satellite.navigation import read_navigation
from safeloc.signals.satellite.observations import read_observations
from tests.data_sources import data_file

NMEA = "$GPGGA,082000.00,3508.08,N,13658.65,E,1,12,0.7,66.0,M,38.0,M,,*55\n"


def test_nmea_is_refused_with_the_reason(tmp_path: Path) -> None:
    """Positions alone hold neither pseudorange nor Doppler."""
    path = tmp_path / "log.nmea"
    path.write_text(NMEA)
    with pytest.raises(StreamError, match="no pseudorange and no Doppler"):
        read_observations(path)
    with pytest.raises(StreamError, match="NMEA"):
        read_navigation(path)
    with pytest.raises(StreamError, match="NMEA"):
        read_android(path)


def test_epochs_go_forward() -> None:
    """A repeated epoch, an earlier one and a time that is no number are faults."""
    for times in ((1.0, 1.0), (2.0, 1.0), (1.0, float("nan"))):
        with pytest.raises(InputError, match="does not come after"):
            list(in_order(Epoch(time, {}) for time in times))


def test_measured_values_are_finite() -> None:
    """NaN is not a measurement; None is the way to say nothing was measured."""
    with pytest.raises(InputError, match="nan"):
        Measured(float("nan"), None)
    with pytest.raises(InputError, match="no range rate"):
        Measured(2e7, None).rate()


def test_a_navigation_file_cut_short_is_refused(tmp_path: Path) -> None:
    """The last line of a record missing: the error names the line the record starts on."""
    for name, start in (("gnss_septentrio/base.nav", 11), ("gnss_android/hour1820.16n", 9)):
        lines = data_file(name).read_text().splitlines()[: start + 6]
        path = tmp_path / "cut.nav"
        path.write_text("\n".join(lines))
        with pytest.raises(StreamError, match=f"cut.nav:{start}: .*cut short"):
            read_navigation(path)
