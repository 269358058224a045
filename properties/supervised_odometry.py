"""Properties of odometry and the delocalized machine together: no loss of position between them is hidden."""

from __future__ import annotations

from functools import partial

from safeloc.language.expr import Num, between, exact_to
from safeloc.language.spec import Property, always, earlier_bool
from safeloc.language.units import NM
from safeloc.models.supervised_odometry import Supervised
from safeloc.properties.behind_a_source import behind_a_source
from safeloc.properties.odometry import LAW

for_all_inputs = partial(always, requirements=("MRK-D1",), unconditional=True)


def properties(model: Supervised) -> list[Property]:
    """Return the properties of the composition: containment, tolerance, entry in the same step, no return without a
    reference, and that the host gets odometry's interval and reason.
    """
    source, guard = model.composition.of(model.source.machine), model.composition.of(model.guard)
    own, tolerance = model.source.own, model.source.own.config.tolerance_mm
    position, above, below = (
        guard.num(model.guard.output(f"{name}_mm")) for name in ("position", "margin_above", "margin_below")
    )
    restrictive = guard.bool(model.guard.flag("restrictive"))
    truth = source.num(own.ghosts.truth)
    valid = source.bool(model.source.machine.flag("valid"))
    checked = source.bool(model.source.machine.flag("reference_accepted"))
    return [
        always(
            "containment",
            restrictive | between(_nm(position) - _nm(below), truth, _nm(position) + _nm(above)),
            statement="the position that the host gets contains the true position of end A",
            requirements=("MRK-1", "MRK-D1"),
            assumption=LAW,
        ),
        for_all_inputs(
            "tolerance",
            restrictive | ((above <= tolerance) & (below <= tolerance)),
            statement="the position that the host gets is never wider than the tolerable error",
        ),
        for_all_inputs(
            "same-step entry",
            restrictive.iff(~valid),
            statement="the vehicle is restrictive in exactly the cycles in which odometry reports nothing",
            requirements=("MRK-D1", "MRK-D2"),
        ),
        for_all_inputs(
            "no resurrection",
            (earlier_bool(restrictive) & ~restrictive).implies(checked),
            statement="the restrictive state is left only in a cycle with a checked absolute reference",
        ),
        *behind_a_source(model.composition, model.guard, model.source.machine, "odometry"),
    ]


def _nm(term: Num) -> Num:
    return exact_to(term, NM)
