"""What must hold of the delocalized machine (MRK-D1, MRK-D2)."""

from __future__ import annotations

from safeloc.language.absence import while_there
from safeloc.language.expr import BoolVar, NumVar, all_of, before, between, exact_to
from safeloc.language.machine import Machine
from safeloc.language.spec import Property, always, reachable
from safeloc.language.units import NM
from safeloc.models.delocalized import DelocalizedConfig
from safeloc.models.vocabulary.reasons import LOCATED
from safeloc.properties.no_interval import no_interval

SOURCE_IS_TRUE = "a valid source interval holds the truth"


def properties(machine: Machine, config: DelocalizedConfig | None = None) -> list[Property]:
    """Containment, restrictive state, latched reason, and no resurrection without a checked reference."""
    config = config or DelocalizedConfig()
    delocalized, localized = machine.modes
    is_lost, mode = machine.mode.eq(delocalized), machine.mode
    inputs = {var.name: var for var in machine.inputs if isinstance(var, BoolVar)}
    reference, valid = inputs["reference_accepted"], inputs["source_valid"]
    position, above, below = (machine.output(f"{name}_mm") for name in ("position", "margin_above", "margin_below"))
    truth = next(iter(machine.world.ghosts))
    reason = machine.output("reason")
    assert isinstance(reason, NumVar) and isinstance(truth, NumVar)
    centre = exact_to(position, NM)
    was_lost = before(mode).eq(delocalized)
    return [
        always(
            "containment",
            mode.eq(localized).implies(between(centre - exact_to(below, NM), truth, centre + exact_to(above, NM))),
            statement="a position that is passed on holds the truth",
            requirements=("MRK-D1",),
            assumption=SOURCE_IS_TRUE,
        ),
        always(
            "tolerance",
            mode.eq(localized).implies((above <= config.tolerance_mm) & (below <= config.tolerance_mm)),
            statement="a position that is passed on is never wider than the tolerance",
            requirements=("MRK-D1",),
            unconditional=True,
        ),
        always(
            "nothing reported",
            is_lost.implies(no_interval(machine) & all_of(while_there(one).eq(0) for one in (position, above, below))),
            statement="a delocalized vehicle reports no position, and keeps none",
            requirements=("MRK-D1", "MRK-D2"),
            unconditional=True,
        ),
        always(
            "restrictive",
            machine.flag("restrictive").iff(is_lost),
            statement="the host is told to be restrictive exactly while delocalized",
            requirements=("MRK-D2",),
            unconditional=True,
        ),
        always(
            "same step",
            (~valid).implies(is_lost),
            statement="the step in which the source loses its position is the step in which the vehicle is delocalized",
            requirements=("MRK-D1",),
            unconditional=True,
        ),
        always(
            "no resurrection",
            (was_lost & mode.eq(localized)).implies(reference & valid),
            statement="the delocalized state is left only with a valid source and a checked absolute reference",
            requirements=("MRK-D1",),
            unconditional=True,
        ),
        always(
            "reason latched",
            (was_lost & is_lost).implies(reason.eq(before(reason))),
            statement="the first reason stays until the state is left",
            requirements=("MRK-D1",),
            unconditional=True,
        ),
        always(
            "reason stated",
            is_lost.implies(reason.ne(LOCATED)),
            statement="a delocalized vehicle always states a reason",
            requirements=("MRK-D1",),
            unconditional=True,
        ),
        reachable("localized", mode.eq(localized), statement="the vehicle can be localized", requirements=("MRK-D1",)),
    ]
