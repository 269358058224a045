"""Properties of the whole localizer (RFL-13, RFL-14, MRK-2, MRK-3), whatever its sources are.

The assumptions of arbitration, of the links and of the restrictive state are proved from the machines before them, with the
lemmas; so the whole assumes only the laws of each source's own sensors. The choice of the leading source and the advance of the
min safe front end are proved of arbitration by itself for all inputs in range, and so of the whole.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from safeloc.language.expr import Bool, Num, NumVar, all_of, between, exact_to
from safeloc.language.spec import Property, always, earlier_bool, within
from safeloc.language.units import NM
from safeloc.models.balise import Balise
from safeloc.models.localizer import Localizer
from safeloc.models.reflector import ReflectorMachine
from safeloc.models.reflector_anchor.line import Line
from safeloc.models.vocabulary.reasons import LOCATED
from safeloc.properties import reflector_anchor
from safeloc.properties.arbitration import kept_in_compositions
from safeloc.properties.behind_a_source import behind_a_source
from safeloc.properties.localizer_heard import heard
from safeloc.properties.reflector_anchor import Anchoring

LAW = "each source's own law: odometer, readings, telegrams, echoes, satellites, fibre; top speed"
REQUIREMENTS = ("RFL-13", "RFL-14", "MRK-2", "MRK-3")
for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)
under_assumption = partial(always, requirements=REQUIREMENTS, assumption=LAW)


def properties(model: Localizer) -> list[Property]:
    """Return the properties of the position for host and trackside, and of the steps in which it changes."""
    makers = (_host, _handed_on, _arbitrated, _responses, _trackside, heard, _anchored)
    return [prop for maker in makers for prop in maker(model)]


def _host(model: Localizer) -> Iterator[Property]:
    (_, below, above), tolerance = _passed(model), model.config.tolerance_mm
    yield _of_the_guard(model)
    yield for_all_inputs(
        "tolerance",
        _restrictive(model) | ((below <= tolerance) & (above <= tolerance)),
        statement="the position that the host gets is never wider than the tolerable error",
    )
    yield _of_the_front(model)


def _handed_on(model: Localizer) -> Iterator[Property]:
    """The host gets what arbitration reports."""
    yield from behind_a_source(model.composition, model.guard, model.arbitration.machine, "arbitration")


def _of_the_guard(model: Localizer) -> Property:
    """The interval that the host gets contains the true position. It is proved of the restrictive state alone, given that arbitration's interval does."""
    guard, truth = model.guard, next(iter(model.guard.world.choices))  # the vehicle's, after the step
    assert isinstance(truth, NumVar)
    position, below, above = (guard.output(f"{name}_mm") for name in ("position", "margin_below", "margin_above"))
    own = under_assumption(
        "containment",
        guard.flag("restrictive") | between(exact_to(position - below, NM), truth, exact_to(position + above, NM)),
        statement="the interval that the host gets contains the true position of the front end",
    )
    return replace(model.composition.inherited(guard, own), name=own.name)


def _of_the_front(model: Localizer) -> Property:
    """The min safe front end is behind the front end: proved of arbitration, given that its sources hold the truth."""
    counts, truth = model.arbitration.machine, model.arbitration.own.next_truth
    own = under_assumption(
        "min safe front end",
        counts.flag("valid").implies(exact_to(counts.output("min_safe_front_mm"), NM) <= truth),
        statement="the front end is never behind the min safe front end",
    )
    return replace(model.composition.inherited(counts, own), name=own.name)


def _arbitrated(model: Localizer) -> Iterator[Property]:
    """The properties that arbitration has for all inputs in range, and so in the whole."""
    for prop in kept_in_compositions(model.arbitration):
        yield model.composition.inherited(model.arbitration.machine, prop)


def _responses(model: Localizer) -> Iterator[Property]:
    restrictive = _restrictive(model)
    counts = model.composition.of(model.arbitration.machine)
    valid = counts.bool(model.arbitration.machine.flag("valid"))
    yield for_all_inputs(
        "same-step entry",
        (~valid).implies(restrictive),
        statement="the step in which arbitration withholds is the step in which the vehicle is restrictive",
    )
    stated = _stated(model)
    yield for_all_inputs(
        "every source withdrawn",
        all_of(~one for one in stated.values()).implies(restrictive),
        statement="the step in which the last source withdraws is the step in which the vehicle is restrictive",
    )
    referred = counts.bool(model.arbitration.machine.flag("reference_accepted"))
    yield for_all_inputs(
        "no resurrection",
        (earlier_bool(restrictive) & ~restrictive).implies(referred & valid),
        statement="the restrictive state is left only in a step in which a source accepted an absolute reference and all "
        "sources that state a position agree",
    )
    guard = model.composition.of(model.guard)
    yield for_all_inputs(
        "reason stated",
        guard.num(model.guard.output("reason")).eq(LOCATED).iff(~restrictive),
        statement="a reason is stated exactly while the vehicle is restrictive",
    )


def _trackside(model: Localizer) -> Iterator[Property]:
    seen, machine = model.composition.of(model.uplink.machine), model.uplink.machine
    valid = seen.bool(machine.flag("valid"))
    position, below, above = (
        seen.num(machine.output(f"{name}_mm")) for name in ("position", "margin_below", "margin_above")
    )
    yield under_assumption(
        "trackside containment",
        valid.implies(
            between(exact_to(position - below, NM), model.motion.own.ghosts.truth, exact_to(position + above, NM))
        ),
        statement="the interval that the trackside gets, widened by its age, holds the true position of the front end",
    )
    limit = model.config.uplink.age_limit_cycles
    arrives = machine.fired("report arrives")
    yield within(
        "trackside forgets",
        limit,
        earlier_bool(valid) & ~seen.bool(arrives),
        ~valid | seen.bool(arrives),
        statement="the trackside reports a vehicle that sends nothing any more for no longer than the age limit",
        requirements=REQUIREMENTS,
        unconditional=True,
        helper=lambda waited: (waited > 0).implies(~valid | (seen.num(model.uplink.own.held.age) >= waited)),
    )


def _anchored(model: Localizer) -> Iterator[Property]:
    """With balises and reflectors: what the groups do to the reflector machine."""
    if not {"balise", "reflector"} <= model.pieces.keys():
        return
    (groups,), (map_, source) = model.pieces["balise"].models, model.pieces["reflector"].models
    assert isinstance(groups, Balise) and isinstance(map_, Line) and isinstance(source, ReflectorMachine)
    whole = Anchoring(model.composition, groups, map_, source, model.motion.own.ghosts.truth, LAW)
    yield from reflector_anchor.properties(whole)
    contradicted = whole.of_source(source.own.contradicted)
    yield for_all_inputs(
        "groups that contradict withdraw what they anchored",
        contradicted.iff(whole.disproved) & whole.located.implies(~contradicted),
        statement="while the balise machine reports nothing because groups contradict its position, and in no other cycle, the reflector "
        "machine is told so; it reports a position only while they do not",
        requirements=("RFL-D4", "RFL-D3"),
    )


def _stated(model: Localizer) -> dict[str, Bool]:
    """Return the sources that state a position after the step, in terms of the whole; of the fibre, what has arrived on board."""
    found: dict[str, Bool] = {}
    for name, piece in model.pieces.items():
        machine = piece.machines[-1]
        if name == "fibre" and model.downlink is not None:
            machine = model.downlink.machine
            found[name] = model.composition.of(machine).bool(machine.flag("valid"))
        else:
            found[name] = model.composition.of(machine).bool(piece.stated.valid)
    return found


def _restrictive(model: Localizer) -> Bool:
    return model.composition.of(model.guard).bool(model.guard.flag("restrictive"))


def _passed(model: Localizer) -> tuple[Num, Num, Num]:
    guard = model.composition.of(model.guard)
    position, below, above = (
        guard.num(model.guard.output(f"{name}_mm")) for name in ("position", "margin_below", "margin_above")
    )
    return position, below, above
