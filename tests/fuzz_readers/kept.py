"""Inputs that once did what no input may, by reader: they are tried first, for good."""

from __future__ import annotations

from collections.abc import Mapping

KEPT: Mapping[str, tuple[bytes, ...]] = {
    "lines of records": (
        b'{"kind":"distance","time_ms":100,"end":"front","unit":"wheel","distance_mm":1200,"marker":7}',
        b'{"kind":"distance","time_ms":100,"end":"front","unit":"wheel","distance_mm":1200,"marker":null}',
    ),
    "CSV": (b"kind,time_ms,position_nm,marker\ntruth,1,1,7\n",),
    "RINEX observations": (
        b"     3.04           OBSERVATION DATA    M                   RINEX VERSION / TYPE\n"
        b"G    2 C1C D1C                                              SYS / # / OBS TYPES\n"
        b"                                                            END OF HEADER\n"
        b"> 2022 03 15 09 27 26.2000000  0 -1\n",  # led back to itself for ever
    ),
}
