"""Properties of the distance beyond the reference: it holds the true one, and what each cycle does to it."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import all_of, as_num, between, exact_to, ite, minimum
from safeloc.language.spec import Property, always, earlier_bool, earlier_num
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM
from safeloc.models.unlinked_group import UnlinkedGroup
from safeloc.models.vocabulary.measured import JUMP, MISSING, TOO_FAST
from safeloc.properties.unlinked_group.step import LAW, Step

for_all_inputs = partial(always, requirements=("RFL-9", "RFL-D4"), unconditional=True)


def distance_properties(model: UnlinkedGroup) -> Iterator[Property]:
    """Return every property of the distance."""
    yield from _safety(model)
    yield from _rounded(model)
    yield from _reading(model)
    yield from _running(model)
    yield from _measuring(model)
    yield from _remembered(model)


def _safety(model: UnlinkedGroup) -> Iterator[Property]:
    machine, config, step = model.machine, model.own.config, Step(model)
    distance, above, below = (machine.output(name) for name in ("distance_mm", "margin_above_mm", "margin_below_mm"))
    least, most = exact_to(distance - below, NM), exact_to(distance + above, NM)
    yield always(
        "containment",
        step.valid.implies(between(least, model.own.world.distance, most)),
        statement="the reported interval contains the true distance of the front end beyond balise 1 of the reference",
        requirements=("RFL-9", "RFL-D4"),
        assumption=LAW,
    )
    tolerable = [above <= config.tolerance_mm, below <= config.tolerance_mm]
    yield for_all_inputs(
        "tolerance and reach",
        step.valid.implies(all_of([*tolerable, between(-config.reach_mm, distance, config.reach_mm)])),
        statement="a reported interval is never wider than the tolerable error, on either side, and its distance is one that a packet can tell",
    )


def _rounded(model: UnlinkedGroup) -> Iterator[Property]:
    """Claim that margins are rounded up."""
    machine, step = model.machine, Step(model)
    distance, above, below = (machine.output(name) for name in ("distance_mm", "margin_above_mm", "margin_below_mm"))
    held = model.own.held
    pairs = ((above, held.above), (below, held.below))
    rounded = (between(as_num(0, NM), exact_to(told, NM) - kept, as_num(NM_PER_MM - 1, NM)) for told, kept in pairs)
    yield for_all_inputs(
        "margins are rounded up",
        step.valid.implies(all_of([distance.eq(held.position), *rounded])),
        statement="the reported distance is the stored one; the reported margins are the stored ones, rounded up to whole mm",
    )


def _reading(model: UnlinkedGroup) -> Iterator[Property]:
    own, step = model.own, Step(model)
    ahead = own.held.position.eq(own.config.antenna_mm + step.since)
    under = own.held.above.eq(step.first_margin(step.unmeasured(step.distance <= 0)))
    over = own.held.below.eq(step.first_margin(step.unmeasured(step.distance >= 0)))
    yield for_all_inputs(
        "the distance begins at the antenna",
        step.serves.implies(ahead),
        statement="when a group is taken, the front end is beyond it by the distance from the antenna to the front end and the counted "
        "run since the reading",
    )
    yield for_all_inputs(
        "the first margins are those of the reading",
        step.serves.implies(under & over),
        statement="when a group is taken, the under-reading and the over-reading are the detection accuracy, the odometer's one-off "
        "constant and the error of the run since the reading: by the odometer's rate, or, without a counter, the farthest run on "
        "that side; what was before is forgotten, and no location accuracy is in them",
    )


def _running(model: UnlinkedGroup) -> Iterator[Property]:
    own, step = model.own, Step(model)
    place, above, below = step.run_on
    as_measured = [own.held.position.eq(place), own.held.above.eq(above), own.held.below.eq(below)]
    yield for_all_inputs(
        "the distance runs on with the odometer",
        (step.valid & ~step.serves).implies(all_of(as_measured)),
        statement="between readings the distance grows by what the odometer measures, and both margins by its error, or by the farthest "
        "travel where it measures nothing; no telegram that is not taken changes them",
    )


def _measuring(model: UnlinkedGroup) -> Iterator[Property]:
    own, step = model.own, Step(model)
    odometer = own.odometer
    yield for_all_inputs(
        "odometer gate",
        step.admitted.iff(step.can_be_run),
        statement="a distance is admitted exactly if a vehicle can have run it: no faster than the top speed, and within the greatest "
        "change of speed since the last one",
        requirements=("RFL-D4",),
    )
    told, there = model.machine.output("odometer"), odometer.measured.present
    flaws = [told.eq(MISSING).iff(~there), told.eq(TOO_FAST).iff(there & ~step.not_too_fast)]
    yield for_all_inputs(
        "the odometer's flaw is named",
        all_of([*flaws, told.eq(JUMP).iff(step.not_too_fast & ~step.can_be_run)]),
        statement="a distance that is not admitted is missing, faster than the top speed, or another jump than a vehicle can make",
        requirements=("RFL-D4",),
    )


def _remembered(model: UnlinkedGroup) -> Iterator[Property]:
    """Claim what is remembered of the odometer, and the turn of the vehicle."""
    own, step = model.own, Step(model)
    odometer, longest = own.odometer, own.config.gap_limit_cycles + 1
    counted = minimum(earlier_num(odometer.gap) + 1, longest)
    heard = [
        odometer.gap.eq(ite(step.admitted, as_num(0, COUNT), counted)),
        odometer.last.eq(ite(step.admitted, odometer.measured.value, earlier_num(odometer.last))),
    ]
    yield for_all_inputs(
        "the odometer is remembered",
        all_of(heard),
        statement="the machine remembers the last admitted distance, and counts the cycles since then",
        requirements=("RFL-D4",),
    )
    heading, most = own.heading, own.config.reversal_mm
    ran = ite(earlier_bool(heading.backwards), step.distance, as_num(0, MM) - step.distance)
    against = earlier_num(heading.rolled) + ran
    turns = against > most
    kept = ite(turns | (against < 0), as_num(0, MM), against)
    turned = heading.backwards.iff(earlier_bool(heading.backwards).iff(~turns))
    yield for_all_inputs(
        "the vehicle turns beyond D_NVROLL",
        turned & heading.rolled.eq(kept),
        statement="the vehicle counts as turned once it ran farther than D_NVROLL against its direction without a break, as measured",
        requirements=("RFL-D4",),
    )
