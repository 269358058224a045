"""The machines that ship, by name: each with its configuration, properties, recorded streams and simulation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial

from pydantic import BaseModel

from safeloc.shipped import fibre, localizer, markers, odometry, receiver, satellite
from safeloc.shipped.hosting import for_hosts
from safeloc.target import Entry, Target


def _made(entry: Entry, config: BaseModel) -> Target:
    return for_hosts(entry.make(config))


ENTRIES: Mapping[str, Entry] = {
    entry.name: replace(entry, make=partial(_made, entry))
    for entry in (
        *odometry.ENTRIES,
        *markers.ENTRIES,
        *fibre.ENTRIES,
        *satellite.ENTRIES,
        *receiver.ENTRIES,
        *localizer.ENTRIES,
    )
}
