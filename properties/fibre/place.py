"""Properties of an end's interval: it contains the truth, grows with every run, and is tied to the map at every edge (FWG-1, FWG-8)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, all_of, as_num, before, between, exact_to, ite, minimum, was
from safeloc.language.spec import Property, always
from safeloc.language.units import NM, NM_PER_MM
from safeloc.models.fibre import CODE, COUNTS, SEEN, Fibre
from safeloc.models.fibre import variables as v
from safeloc.properties.fibre.seen import Seen, followed

LAW = "the detector's bounds, true references, and a code in which near sections differ"
for_all_inputs = partial(always, requirements=("FWG-1", "FWG-11"), unconditional=True)


def properties(model: Fibre) -> Iterator[Property]:
    """Yield the properties of the reported interval and of its parts."""
    yield from _interval(model)
    yield from _narrower(model)
    yield from _added_error(model)
    yield from _summed_runs(model)
    yield from _tied(model)
    yield from _entered(model)
    yield from _referred(model)
    yield from _kept(model)


def _interval(model: Fibre) -> Iterator[Property]:
    """Claim that the reported interval contains the end, and is no wider than tolerable."""
    machine, own = model.machine, model.own
    valid, position, above = machine.flag("valid"), machine.output("position_mm"), machine.output("margin_above_mm")
    off = own.ghosts.truth - exact_to(position, NM)
    yield always(
        "containment",
        valid.implies(between(-exact_to(above, NM), off, exact_to(above, NM))),
        statement="a reported interval contains the end of the train",
        requirements=("FWG-1", "FWG-11"),
        assumption=LAW,
    )
    yield for_all_inputs(
        "tolerance",
        valid.implies(above <= own.config.tolerance_mm + own.config.max_cycle_distance_mm * 4),
        statement="a reported interval is never wider than the tolerable error and the run of the cycle of an edge",
    )


def _narrower(model: Fibre) -> Iterator[Property]:
    """Claim the only events that make the interval narrower, or known again."""
    machine, own = model.machine, model.own
    valid = machine.flag("valid")
    no_event = own.event.one_of(v.NO_SIGNAL) & was(model.own.counted)
    stays = before(machine.mode).eq(machine.modes[2]) & valid & no_event & ~own.reference_accepted
    yield for_all_inputs(
        "only edges narrow",
        stays.implies(own.drift >= before(own.drift)),
        statement="without an edge of a section, or a reference, the interval never becomes narrower",
        requirements=SEEN,
    )
    yield for_all_inputs(
        "no resurrection",
        (valid & before(machine.mode).ne(machine.modes[2])).implies(_gives_place(model)),
        statement="a place is known again only from an accepted reference, or from a complete code word",
        requirements=CODE,
    )


def _gives_place(model: Fibre) -> Bool:
    """Return the condition that an accepted reference, or the map's answer to a whole word, gives the place."""
    own, seen, counting = model.own, Seen(model.own), model.machine.modes[1]
    word = own.word_found & before(own.read).eq(own.config.window) & before(own.band).eq(v.NORMAL)
    return seen.normal & (own.reference_accepted | (before(model.machine.mode).eq(counting) & word))


def _added_error(model: Fibre) -> Iterator[Property]:
    """Claim the error that is added for each run."""
    own, seen = model.own, Seen(model.own)
    none, follows = own.event.eq(v.NO_SIGNAL), followed(model.machine) & ~own.reference_accepted
    yield for_all_inputs(
        "every run adds its error",
        (follows & none).implies(
            (own.drift - seen.added_error_nm).eq(before(own.drift)) & own.run_since_edge.eq(seen.run)
        ),
        statement="in a cycle without an edge the interval grows by rate and floor of the run, or by the farthest run if none was measured",
    )
    edge = follows & ~none
    yield for_all_inputs(
        "an edge adds the run of its cycle to the error",
        edge.implies(own.drift.eq(seen.blind_nm) & own.run_since_edge.eq(0)),
        statement="an edge may have been passed anywhere within its cycle, and in the cycles without an amplitude before "
        "it: the whole run since the last amplitude is added to the error",
    )


def _summed_runs(model: Fibre) -> Iterator[Property]:
    """Claim that runs without an amplitude are summed."""
    own, seen = model.own, Seen(model.own)
    most = own.config.tolerance_mm * NM_PER_MM
    yield for_all_inputs(
        "runs without an amplitude are summed",
        own.run_since_amplitude.eq(ite(own.amplitude.present, as_num(0, NM), minimum(seen.blind_nm, most))),
        statement="in each cycle without an amplitude the run and its greatest error are added to the run without an amplitude, up to the tolerance",
    )


def _tied(model: Fibre) -> Iterator[Property]:
    """Claim the place of the map to which the interval is tied."""
    machine, own, seen = model.machine, model.own, Seen(model.own)
    located = machine.modes[2]
    stays = before(machine.mode).eq(located) & machine.mode.eq(located) & ~own.reference_accepted
    edges = {v.POSITION_SIGNAL: seen.near, v.PASSED: before(own.far_edge)}
    at = [own.event.eq(event).implies(own.edge.eq(edge)) for event, edge in edges.items()]
    others = own.event.one_of(v.NO_SIGNAL, v.TURNED_BACK).implies(own.edge.eq(before(own.edge)))
    yield for_all_inputs(
        "an edge is the map's",
        stays.implies(all_of(at) & others),
        statement="at the entry of a section the place is its near edge on the map, at its end the far edge; nothing else "
        "moves it",
        requirements=(*SEEN, *COUNTS),
    )


def _entered(model: Fibre) -> Iterator[Property]:
    machine, own, seen = model.machine, model.own, Seen(model.own)
    located = machine.modes[2]
    stays = before(machine.mode).eq(located) & machine.mode.eq(located) & ~own.reference_accepted
    far, long = ite(seen.forwards, own.ahead.far, own.behind.far), ite(seen.forwards, own.ahead.long, own.behind.long)
    entered = own.far_edge.eq(far) & own.long_by_map.iff(long) & own.upwards.iff(seen.forwards)
    yield for_all_inputs(
        "the section entered is the map's",
        (stays & own.event.eq(v.POSITION_SIGNAL)).implies(entered),
        statement="far edge, length and direction of entry of the section are kept until the end leaves it",
        requirements=(*SEEN, *CODE),
    )


def _referred(model: Fibre) -> Iterator[Property]:
    machine, own, seen = model.machine, model.own, Seen(model.own)
    at_place = (
        own.edge.eq(own.reference_position)
        & own.run_since_edge.eq(0)
        & own.drift.eq(0)
        & own.sections_counted.eq(own.reference_count)
    )
    yield for_all_inputs(
        "an accepted reference locates the end",
        (own.reference_accepted & seen.normal).implies(machine.flag("valid") & at_place),
        statement="an accepted reference, with the amplitude normal, locates the end at its place and with its count",
        requirements=COUNTS,
    )


def _kept(model: Fibre) -> Iterator[Property]:
    """Claim the loss and the keeping of a place."""
    machine, own, seen = model.machine, model.own, Seen(model.own)
    waiting, counting, located, faulted = machine.modes
    mode, referred = machine.mode, own.reference_accepted & seen.normal
    was_followed = before(mode).ne(waiting) & before(mode).ne(faulted)
    yield for_all_inputs(
        "a pattern that is lost has no place",
        (was_followed & ~referred & seen.lost).implies(mode.eq(waiting)),
        statement="after too long a silence, or with an interval wider than tolerable, there is neither place nor count",
        requirements=SEEN,
    )
    calm = ~_any_flaw(seen) & ~seen.lost
    yield for_all_inputs(
        "a located end stays located",
        (before(mode).eq(located) & calm).implies(mode.eq(located)),
        statement="if nothing disagrees and the pattern is followed, the end stays located",
        requirements=SEEN,
    )
    ended = seen.flaws[v.NO_END_OF_SECTION] | (seen.changes & seen.full)
    yield for_all_inputs(
        "an end that counts goes on",
        (before(mode).eq(counting) & ~seen.lost & ~ended).implies(mode.one_of(counting, located)),
        statement="an end that counts sections, or reads a code word, goes on with that until it is located; unless the pattern is lost, no section is "
        "so long, or the range of section numbers is exhausted",
        requirements=(*SEEN, *CODE),
    )


def _any_flaw(seen: Seen) -> Bool:
    """Return the condition that some input disagrees."""
    return ~all_of(~flaw for flaw in seen.flaws.values())
