"""Properties of position signals and of their count (FWG-1 to FWG-3, FWG-8, FWG-9)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, all_of, as_num, before, ite, minimum, was
from safeloc.language.spec import Property, always
from safeloc.language.units import COUNT
from safeloc.models.fibre import COUNTS, SEEN, Fibre
from safeloc.models.fibre import variables as v
from safeloc.properties.fibre.seen import Seen, followed

for_all_inputs = partial(always, requirements=SEEN, unconditional=True)


def properties(model: Fibre) -> Iterator[Property]:
    """Yield the properties of signals and of their count."""
    yield from _band(model)
    yield from _changes(model)
    yield from _direction(model)
    yield from _signals(model)
    yield from _known(model)
    yield from _known_and_reported(model)
    yield from _counted(model)
    yield from _uncounted(model)
    yield from _nothing_else_counts(model)


def _signals(model: Fibre) -> Iterator[Property]:
    own = model.own
    yield for_all_inputs(
        "a signal is a rise or a fall",
        own.event.eq(v.POSITION_SIGNAL).implies(before(own.band).eq(v.NORMAL) & own.band.ne(v.NORMAL)),
        statement="a position signal arises only where the amplitude leaves normal, upwards or downwards",
    )
    yield for_all_inputs(
        "normal again is no section",
        (before(own.band).ne(v.NORMAL) & own.band.eq(v.NORMAL)).implies(own.event.ne(v.POSITION_SIGNAL)),
        statement="the return to normal is not counted as a second section",
    )
    yield for_all_inputs(
        "one section at a time",
        before(own.band).ne(v.NORMAL).implies(own.event.ne(v.POSITION_SIGNAL)),
        statement="between two signals the amplitude is normal",
    )


def _known(model: Fibre) -> Iterator[Property]:
    """Claim the states with a known count."""
    machine, own = model.machine, model.own
    yield for_all_inputs(
        "count begins with the first signal",
        (machine.flag("count_known") & ~was(own.counted)).implies(own.event.eq(v.POSITION_SIGNAL)),
        statement="before the first signal the count is undefined, not zero",
        requirements=COUNTS,
    )


def _known_and_reported(model: Fibre) -> Iterator[Property]:
    """Claim that a count is reported exactly while it is known."""
    machine, own = model.machine, model.own
    waiting, _, located, _ = machine.modes
    mode = machine.mode
    yield for_all_inputs(
        "waiting has no count",
        mode.eq(waiting).implies(~machine.flag("count_known") & ~machine.flag("valid")),
        statement="without a signal there is neither count nor place",
        requirements=COUNTS,
    )
    follows = mode.ne(waiting) & ~machine.flag("error")
    yield for_all_inputs(
        "a known count is reported",
        machine.flag("count_known").iff(own.counted & follows)
        & machine.output("count").eq(
            ite(follows & (own.counted | mode.eq(located)), own.sections_counted, as_num(0, COUNT))
        ),
        statement="while sections are followed, the count is reported from the first signal on, and whenever the train is "
        "located; otherwise no count is reported",
        requirements=COUNTS,
    )


def _counted(model: Fibre) -> Iterator[Property]:
    """Claim the effect of each position signal on the count."""
    machine, own, seen = model.machine, model.own, Seen(model.own)
    counts = followed(machine) & ~own.reference_accepted
    change = own.sections_counted - before(own.sections_counted)
    back = own.run.present & (own.run.value < 0)
    yield for_all_inputs(
        "every signal counts by direction",
        (counts & own.event.eq(v.POSITION_SIGNAL)).implies(change.eq(seen.one)),
        statement="each signal counts one up if the train runs forwards, and one down if it runs back",
        requirements=COUNTS,
    )
    yield for_all_inputs(
        "running back decreases",
        (counts & back & own.event.eq(v.POSITION_SIGNAL)).implies(change.eq(-1)),
        statement="a section entered while running back decreases the count",
        requirements=COUNTS,
    )


def _uncounted(model: Fibre) -> Iterator[Property]:
    """Claim that only a section left again changes the count without a signal."""
    machine, own = model.machine, model.own
    counts = followed(machine) & ~own.reference_accepted
    change = own.sections_counted - before(own.sections_counted)
    yield for_all_inputs(
        "a section left again is uncounted",
        (counts & own.event.eq(v.TURNED_BACK)).implies(
            change.eq(ite(was(own.upwards), as_num(-1, COUNT), as_num(1, COUNT)))
        ),
        statement="a section that is left on the side of entry no longer counts",
        requirements=COUNTS,
    )


def _nothing_else_counts(model: Fibre) -> Iterator[Property]:
    """Claim that the count changes with nothing else."""
    machine, own = model.machine, model.own
    _, counting, located, _ = machine.modes
    mode = machine.mode
    counts = followed(machine) & ~own.reference_accepted
    change = own.sections_counted - before(own.sections_counted)
    found = before(mode).eq(counting) & mode.eq(located)
    quiet = own.event.one_of(v.NO_SIGNAL, v.PASSED) & ~found
    yield for_all_inputs(
        "nothing else counts",
        (counts & quiet).implies(change.eq(0)),
        statement="the count changes only with a signal, or with a section that is left again",
        requirements=COUNTS,
    )


def _band(model: Fibre) -> Iterator[Property]:
    """Claim the amplitude's band from the amplitude itself: a rise is a rise, and a fall is a fall."""
    machine, own, seen = model.machine, model.own, Seen(model.own)
    band_before, after = before(own.band), own.band
    raised = seen.rises | (band_before.eq(v.RAISED) & ~seen.returns)
    lowered = seen.falls | (band_before.eq(v.LOWERED) & ~seen.returns)
    step = machine.stayed() | ~machine.stayed()
    yield for_all_inputs(
        "the band follows the amplitude",
        step.implies(after.eq(v.RAISED).iff(raised) & after.eq(v.LOWERED).iff(lowered)),
        statement="the band is raised from a rise, and lowered from a fall, until the amplitude is normal again",
    )


def tells_changes(model: Fibre) -> Bool:
    """Return the condition that a change of the amplitude in this cycle is told: followed, within the tolerance, and no reference comes."""
    machine, own, seen = model.machine, model.own, Seen(model.own)
    waiting, _, _, faulted = machine.modes
    referred = own.reference_accepted & seen.normal
    kept = ~referred & ~seen.lost & ~seen.full
    hears = before(machine.mode).eq(waiting) | (before(machine.mode).ne(faulted) & kept)
    return hears & ~seen.late & ~referred


def _changes(model: Fibre) -> Iterator[Property]:
    """Claim the changes of the amplitude that are position signals."""
    machine, own, seen = model.machine, model.own, Seen(model.own)
    waiting, counting, *_ = machine.modes
    yield for_all_inputs(
        "a rise or a fall is a signal",
        (tells_changes(model) & seen.changes).implies(own.event.eq(v.POSITION_SIGNAL)),
        statement="whenever the amplitude leaves normal, upwards or downwards, a position signal arises in that cycle; "
        "unless the amplitude was absent for so long, or always, that the place of the change is unknown",
    )
    yield for_all_inputs(
        "a change of long ago is no signal",
        (before(machine.mode).one_of(waiting, counting) & seen.late).implies(own.event.ne(v.POSITION_SIGNAL)),
        statement="an amplitude that is changed when it comes back after too long a run, or comes for the first time, is "
        "not counted as a section entered in that cycle",
    )


def _direction(model: Fibre) -> Iterator[Property]:
    machine, own, seen = model.machine, model.own, Seen(model.own)
    step = machine.stayed() | ~machine.stayed()
    silent = minimum(before(own.silent_cycles) + 1, own.silent_cycles.high)
    ran = [own.forwards.iff(seen.forwards), own.silent_cycles.eq(ite(own.run.present, as_num(0, COUNT), silent))]
    yield for_all_inputs(
        "direction and silence are followed",
        step.implies(all_of(ran)),
        statement="the direction is that of the last measured run other than zero; silent cycles are counted",
        requirements=(*SEEN, *COUNTS),
    )
