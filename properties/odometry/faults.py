"""Properties of odometry while one unit, unknown which, breaks its error law at will (MRK-4, MRK-D1)."""

from __future__ import annotations

from safeloc.errors import PropertyError
from safeloc.language.expr import Bool, Num, all_of, as_num, between, exact_to
from safeloc.language.spec import Property, always
from safeloc.language.units import NM
from safeloc.models.odometry import Odometry

_ONE_FAULT = (
    "at most one unit, the same one all the time, breaks its error law; all other admitted distances obey theirs; "
    "accepted readings are true within accuracy; top speed"
)
CHECKED = f"{_ONE_FAULT}; a distance of the faulty unit is admitted only in cycles in which the other unit's is; no reading is stray"
SOURCES = ("MRK-4", "MRK-D1")


def properties(model: Odometry) -> list[Property]:
    """Return the properties of containment with one faulty unit: of the reported interval, or, without
    `single_fault_safe`, of a wider one.

    That of the wider one holds only where no reading is stray (`trust_first_marker`). PropertyError for a machine whose parts
    were made without the ghost of a faulty unit.
    """
    if model.own.ghosts.faulty_unit is None:
        name, src = model.machine.name, model.machine.src
        raise PropertyError(f"{src}: {name} has no ghost of a faulty unit; make its parts with with_fault=True.")
    if model.own.config.single_fault_safe:
        return [containment(model)]
    return [
        always(
            "containment within what a fault can hide",
            _contained(model, model.own.ghosts.unseen),
            statement="with one faulty unit, the reported interval contains the true position of end A once both its sides are "
            "widened: by twice the greater error law of the device's two units, over the cycles since the reference in "
            "which both measured, and by the difference of their one-off constants",
            requirements=SOURCES,
            assumption=CHECKED,
        )
    ]


def containment(model: Odometry) -> Property:
    """Claim that the reported interval contains the true position although one unit is faulty; with `single_fault_safe` only."""
    return always(
        "containment with one faulty unit",
        _contained(model, tuple(as_num(0, NM) for _ in model.own.devices)),
        statement="with one faulty unit, whichever, the reported interval holds the true position of end A",
        requirements=SOURCES,
        assumption=_ONE_FAULT,
    )


def _contained(model: Odometry, more: tuple[Num, ...]) -> Bool:
    """Whichever device gives the position, the reported interval and `more` of it on both sides hold the truth."""
    machine = model.machine
    position, above, below = (
        exact_to(machine.output(f"{name}_mm"), NM) for name in ("position", "margin_above", "margin_below")
    )
    return all_of(
        machine.mode.eq(mode).implies(
            between(position - below - wider, model.own.ghosts.truth, position + above + wider)
        )
        for mode, wider in zip(machine.modes[-len(more) :], more, strict=True)
    )
