"""The machines that ship, by name: each with its configuration, properties, recorded streams and simulation."""

from __future__ import annotations

from collections.abc import Mapping

from safeloc.shipped import fibre, localizer, markers, odometry, receiver, satellite
from safeloc.target import Entry

ENTRIES: Mapping[str, Entry] = {
    entry.name: entry
    for entry in (
        *odometry.ENTRIES,
        *markers.ENTRIES,
        *fibre.ENTRIES,
        *satellite.ENTRIES,
        *receiver.ENTRIES,
        *localizer.ENTRIES,
    )
}
