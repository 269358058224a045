"""Properties of the delocalized machine (MRK-D1, MRK-D2)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.absence import value_while_present
from safeloc.language.expr import BoolVar, NumVar, all_of, any_of, before, between, exact_to
from safeloc.language.machine import Machine
from safeloc.language.spec import Property, always, reachable
from safeloc.language.units import NM
from safeloc.models.delocalized import DelocalizedConfig
from safeloc.models.vocabulary.reasons import LOCATED, NO_REFERENCE, TOLERANCE
from safeloc.properties.no_interval import no_interval

_SOURCE_IS_TRUE = "a valid source interval holds the truth"
for_all_inputs = partial(always, requirements=("MRK-D1",), unconditional=True)


def properties(machine: Machine, config: DelocalizedConfig | None = None) -> list[Property]:
    """Return the properties: containment, restrictive state, latched reason, no resurrection without a checked reference."""
    config = config or DelocalizedConfig()
    entry = _entry_and_exit(machine, config.tolerance_mm)
    return [*_interval(machine, config), *_restriction(machine), *entry, *_reason(machine)]


def _interval(machine: Machine, config: DelocalizedConfig) -> Iterator[Property]:
    """Properties of the reported interval: it is the source's, or there is none."""
    delocalized, localized = machine.modes
    mode = machine.mode
    position, above, below = (machine.output(f"{name}_mm") for name in ("position", "margin_above", "margin_below"))
    truth = next(iter(machine.world.ghosts))
    assert isinstance(truth, NumVar)
    centre = exact_to(position, NM)
    yield always(
        "containment",
        mode.eq(localized).implies(between(centre - exact_to(below, NM), truth, centre + exact_to(above, NM))),
        statement="a position that is passed on contains the true position",
        requirements=("MRK-D1",),
        assumption=_SOURCE_IS_TRUE,
    )
    yield for_all_inputs(
        "tolerance",
        mode.eq(localized).implies((above <= config.tolerance_mm) & (below <= config.tolerance_mm)),
        statement="a position that is passed on is never wider than the tolerance",
    )
    nothing = no_interval(machine) & all_of(value_while_present(one).eq(0) for one in (position, above, below))
    yield for_all_inputs(
        "nothing reported",
        mode.eq(delocalized).implies(nothing),
        statement="a delocalized vehicle neither reports nor stores a position",
        requirements=("MRK-D1", "MRK-D2"),
    )


def _restriction(machine: Machine) -> Iterator[Property]:
    """Properties of the restrictive output."""
    delocalized, localized = machine.modes
    yield for_all_inputs(
        "restrictive",
        machine.flag("restrictive").iff(machine.mode.eq(delocalized)),
        statement="the restrictive output is set exactly while the vehicle is delocalized",
        requirements=("MRK-D2",),
    )
    yield reachable(
        "localized", machine.mode.eq(localized), statement="the vehicle can be localized", requirements=("MRK-D1",)
    )


def _entry_and_exit(machine: Machine, most: int) -> Iterator[Property]:
    """Properties of the steps in which the delocalized state is entered and left."""
    delocalized, localized = machine.modes
    mode, is_lost, was_lost = machine.mode, machine.mode.eq(delocalized), before(machine.mode).eq(delocalized)
    inputs = {var.name: var for var in machine.inputs if isinstance(var, BoolVar)}
    reference, valid = inputs["reference_accepted"], inputs["source_valid"]
    yield for_all_inputs(
        "same step",
        (~valid).implies(is_lost),
        statement="the step in which the source loses its position is the step in which the vehicle is delocalized",
    )
    yield for_all_inputs(
        "no resurrection",
        (was_lost & mode.eq(localized)).implies(reference & valid),
        statement="the delocalized state is left only with a valid source and a checked absolute reference",
    )
    too_wide = any_of(
        var > most for var in machine.inputs if isinstance(var, NumVar) and var.name.startswith("source_margin_")
    )
    yield for_all_inputs(
        "a usable position is passed on",
        (is_lost & (~was_lost | reference) & valid).implies(too_wide),
        statement="a valid position within the tolerance does not delocalize, and with a checked reference it localizes again",
    )


def _first_reason(machine: Machine) -> Property:
    lost = machine.modes[0]
    enters = before(machine.mode).ne(lost) & machine.mode.eq(lost)
    valid = next(var for var in machine.inputs if isinstance(var, BoolVar) and var.name == "source_valid")
    cause = next(var for var in machine.inputs if isinstance(var, NumVar) and var.name == "source_reason")
    reason = machine.output("reason")
    return for_all_inputs(
        "the reason is the first one",
        (enters & valid).implies(reason.eq(TOLERANCE))
        & (enters & ~valid & cause.ne(LOCATED)).implies(reason.eq(cause))
        & (enters & ~valid & cause.eq(LOCATED)).implies(reason.eq(NO_REFERENCE)),
        statement="a delocalized vehicle gives the tolerance as its reason if the source is valid, else the "
        "source's own reason, and a missing reference if the source gives none",
        requirements=("MRK-D1", "MRK-D2"),
    )


def _reason(machine: Machine) -> Iterator[Property]:
    """Properties of the latched reason."""
    is_lost, was_lost = machine.mode.eq(machine.modes[0]), before(machine.mode).eq(machine.modes[0])
    reason = machine.output("reason")
    assert isinstance(reason, NumVar)
    yield _first_reason(machine)
    yield for_all_inputs(
        "no reason while localized",
        (~is_lost).implies(reason.eq(LOCATED)),
        statement="while a position is passed on the machine gives no reason",
    )
    yield for_all_inputs(
        "reason latched",
        (was_lost & is_lost).implies(reason.eq(before(reason))),
        statement="the first reason stays until the state is left",
    )
    yield for_all_inputs(
        "reason stated",
        is_lost.implies(reason.ne(LOCATED)),
        statement="a delocalized vehicle always gives a reason",
    )
