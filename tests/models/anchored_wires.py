"""Wrong wires that devices with a reflector machine behind a balise machine have in common."""

from __future__ import annotations

from typing import Any

from safeloc.language.expr import TRUE
from safeloc.models.vocabulary.absent import wired_interval
from tests.models.composed_devices import input_of
from tests.models.owed_contracts import Wires


def always_a_reference(whole: Any, _: Wires) -> Wires:
    """Each cycle ends a loss."""
    return {input_of(whole.restrictive, "reference_accepted"): TRUE}


def balise_for_the_host(whole: Any, _: Wires) -> Wires:
    """The host gets the balise machine's whole interval, which neither direction nor route withdraws."""
    machine, (position, below, above) = whole.restrictive, wired_interval(whole.groups.machine)
    return {
        input_of(machine, "source_valid"): whole.groups.machine.flag("valid"),
        input_of(machine, "source_position_mm"): position,
        input_of(machine, "source_margin_below_mm"): below,
        input_of(machine, "source_margin_above_mm"): above,
    }


def whatever_is_reported(whole: Any, _: Wires) -> Wires:
    """The host gets each position of the reflector machine, whatever course or route say."""
    return {input_of(whole.restrictive, "source_valid"): whole.source.machine.flag("valid")}
