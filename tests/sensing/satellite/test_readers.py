"""Readers refuse what they cannot read, with file and line."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import pytest

from safeloc.errors import InputError, StreamError
from safeloc.runtime.border import Reason
from safeloc.sensing.satellite import log_lines
from safeloc.sensing.satellite.android import read_android
from safeloc.sensing.satellite.epochs import Epoch, Measured, Row, in_order, received
from safeloc.sensing.satellite.navigation import read_navigation
from safeloc.sensing.satellite.observations import read_observations
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


COLUMNS = (
    "TimeNanos,FullBiasNanos,BiasNanos,Svid,TimeOffsetNanos,State,ReceivedSvTimeNanos,PseudorangeRateMetersPerSecond,"
    "CarrierFrequencyHz,ConstellationType"
)
MS_70 = 70_000_000


def _phone(tmp_path: Path, *rows: str, columns: str = COLUMNS) -> Path:
    """A log whose receiver time is 1 000 s into week 1, its rows given without the first three columns."""
    path = tmp_path / "log.txt"
    head = f"Raw,0,{-(604_800 + 1_000) * 10**9},0"
    path.write_text("\n".join([f"# Raw,{columns}", *(f"{head},{row}" for row in rows)]) + "\n")
    return path


def test_a_phone_of_two_bands_and_three_constellations(tmp_path: Path) -> None:
    """Only 1575.42 MHz counts; a receiver of one band leaves the frequency out; each constellation has its own code lock."""
    sent = 1_000 * 10**9 - MS_70
    path = _phone(
        tmp_path,
        f"5,0,9,{sent},1.5,1575420030,1",
        f"5,0,9,{sent},1.5,1176450000,1",
        f"193,0,9,{sent},2.5,,4",
        f"7,0,1032,{sent},3.5,1575420000,6",
        f"8,0,9,{sent},3.5,1575420000,6",
        f"9,0,1,{sent},3.5,1575420000,1",
        f"3,0,9,{sent},3.5,1602000000,3",
    )
    (epoch,) = read_android(path)
    assert {"G05", "J01", "E07"} == set(epoch.satellites)
    assert 605_800.0 == epoch.time_s
    assert pytest.approx(0.07 * 299_792_458.0) == epoch.satellites["G05"].code()
    assert [1.5, 2.5, 3.5] == [epoch.satellites[name].rate() for name in ("G05", "J01", "E07")]


def test_a_wrong_phone_log_is_refused(tmp_path: Path) -> None:
    """A satellite twice on one band, a row with text for a number, a log without a column it needs."""
    row = f"5,0,9,{1_000 * 10**9 - MS_70},1.5,,1"
    with pytest.raises(StreamError, match="G05 stands twice"):
        read_android(_phone(tmp_path, row, row))
    with pytest.raises(StreamError, match="mend or drop the row"):
        read_android(_phone(tmp_path, row.replace("1.5", "fast")))
    with pytest.raises(StreamError, match="'State'"):
        read_android(_phone(tmp_path, row, columns=COLUMNS.replace("State", "Stated")))


HEADER = (
    "     3.04           OBSERVATION DATA    M                   RINEX VERSION / TYPE\n"
    "G    2 C1C D1C                                              SYS / # / OBS TYPES\n"
    "E    4 C1X L1X D1X S1X                                      SYS / # / OBS TYPES\n"
    "R    2 C1C D1C                                              SYS / # / OBS TYPES\n"
    "                                                            END OF HEADER\n"
)
EPOCH = "> 2024 06 24 08 20  0.0000000  0  3\n"
LINES = (
    "G05  21000000.000       -1000.000\n"
    "E07  23000000.000       12345.000         100.000          40.000\n"
    "R01  20000000.000         500.000\n"
)


def _observed(tmp_path: Path, text: str) -> list[Epoch]:
    path = tmp_path / "rover.obs"
    path.write_text(text)
    return read_observations(path)


def test_observations_by_constellation(tmp_path: Path) -> None:
    """Columns of each constellation's own signal; GLONASS is passed over; Doppler becomes a rate of the other sign."""
    (epoch,) = _observed(tmp_path, HEADER + EPOCH + LINES)
    assert {"G05": 21e6, "E07": 23e6} == {name: one.code() for name, one in epoch.satellites.items()}
    assert [pytest.approx(190.29, abs=0.01), pytest.approx(-19.03, abs=0.01)] == [
        epoch.satellites[name].rate() for name in ("G05", "E07")
    ]


def test_blank_observations_are_not_measured(tmp_path: Path) -> None:
    """A blank cell is nothing measured, not zero."""
    (epoch,) = _observed(tmp_path, HEADER + EPOCH + LINES.replace("-1000.000", "         "))
    assert Measured(21e6, None) == epoch.satellites["G05"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (HEADER + EPOCH + LINES[:40], "it is cut"),
        (HEADER + LINES, "no epoch starts here"),
        (HEADER + EPOCH + LINES.replace("21000000.000", "21000000.0x0"), "mend or drop the epoch"),
        (HEADER + EPOCH + LINES.replace("21000000.000", "21_000_000.0"), "mend or drop the epoch"),
        (HEADER + EPOCH + LINES.replace("E07", "G05"), "G05 stands twice"),
        (HEADER.replace("C1C", "C2W").replace("C1X", "C5X") + EPOCH, "record both"),
        (HEADER.replace("     3.04", "     2.11") + EPOCH, "not a RINEX 3 observation file"),
        (HEADER.replace("END OF HEADER", "COMMENT") + EPOCH, "does not end"),
        ("", "not a RINEX 3 observation file"),
    ],
)
def test_wrong_observations_are_refused(tmp_path: Path, text: str, message: str) -> None:
    """Cut, without a header, with letters in a number, with a satellite twice: by file and line."""
    with pytest.raises(StreamError, match=f"rover.obs:[0-9]+: .*{message}"):
        _observed(tmp_path, text)


def test_what_a_receiver_delivers_is_judged_at_the_border() -> None:
    """Numbers pass; NaN, text and truth values are named and not measured; a time that is none gives no epoch."""
    rows = [Row("G01", 2e7, 1), Row("G02", math.inf, None), Row("G03", True, "1"), Row("G01", 2e7, 1)]
    epoch, faults = received(10, rows)
    assert epoch is not None and 10.0 == epoch.time_s
    assert {"G01": Measured(None, None), "G02": Measured(None, None), "G03": Measured(None, None)} == epoch.satellites
    told = [(fault.channel, fault.reason) for fault in faults]
    assert [
        ("G02", Reason.NOT_FINITE),
        ("G03", Reason.WRONG_TYPE),
        ("G03", Reason.WRONG_TYPE),
        ("G01", Reason.DUPLICATE),
    ] == told
    nothing, why = received(math.nan, rows)
    assert (None, Reason.NOT_FINITE) == (nothing, why[0].reason)


@pytest.mark.parametrize("read", [read_observations, read_navigation], ids=["observations", "navigation"])
def test_lines_without_end_are_counted(
    read: Callable[[Path], object], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Empty lines, the cheapest that there are: refused by their number, before a list of them is made."""
    monkeypatch.setattr(log_lines, "MOST_LINES", 1_000)
    path = tmp_path / "long.rnx"
    path.write_text(HEADER + "\n" * 1_000)
    with pytest.raises(InputError, match=r"long\.rnx: more than 1000 lines"):
        read(path)


@pytest.mark.parametrize("read", [read_observations, read_navigation], ids=["observations", "navigation"])
def test_a_log_that_is_too_large_is_not_read(
    read: Callable[[Path], object], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One line without an end."""
    monkeypatch.setattr(log_lines, "LARGEST_LOG", 10_000)
    path = tmp_path / "wide.rnx"
    path.write_text(HEADER + ">" * 10_000)
    with pytest.raises(InputError, match=r"wide\.rnx"):
        read(path)
