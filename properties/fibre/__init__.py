"""Properties of the position from localization sections (FWG-1 to FWG-15)."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.spec import Property, reachable
from safeloc.models.fibre import CHECKED, COUNTS, SEEN, Fibre
from safeloc.models.fibre import variables as v
from safeloc.properties.fibre import code, counting, error, place, told


def properties(model: Fibre) -> list[Property]:
    """Return the properties of containment, counting, the code, the error signal, and of what is reported of sections."""
    return [
        *place.properties(model),
        *counting.properties(model),
        *code.properties(model),
        *error.properties(model),
        *told.properties(model),
        *_reached(model),
    ]


def _reached(model: Fibre) -> Iterator[Property]:
    machine, own = model.machine, model.own
    valid = machine.flag("valid")
    yield reachable("located", valid & own.counted, statement="a train can be located by counting", requirements=COUNTS)
    yield reachable("error", machine.flag("error"), statement="F can come", requirements=CHECKED)
    yield reachable(
        "section passed", own.event.eq(v.PASSED) & valid, statement="a section can be passed", requirements=SEEN
    )
