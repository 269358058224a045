"""Properties of signal and section as they are reported, by the inputs and by the world (FWG-1, FWG-2, FWG-3).

The world derives the amplitude's band once more, from the inputs alone, and knows the edge that the end has passed.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, Num, abs_, as_num, before, between, exact_to, ite
from safeloc.language.spec import Property, always
from safeloc.language.units import MM, NM, NM_PER_MM
from safeloc.models.fibre import SEEN, Fibre
from safeloc.models.fibre import variables as v
from safeloc.properties.fibre.counting import tells_changes
from safeloc.properties.fibre.place import LAW
from safeloc.properties.fibre.seen import Seen, followed

for_all_inputs = partial(always, requirements=SEEN, unconditional=True)
under_assumption = partial(always, requirements=SEEN, assumption=LAW)


def properties(model: Fibre) -> Iterator[Property]:
    """Yield the properties of the outputs `position_signal` and `in_section`."""
    yield from _by_inputs(model)
    yield from _section(model)
    yield from _signal(model)


def _by_inputs(model: Fibre) -> Iterator[Property]:
    machine, seen = model.machine, Seen(model.own)
    yield for_all_inputs(
        "a position signal is reported as one",
        machine.flag("position_signal").iff(machine.output("section_event").eq(v.POSITION_SIGNAL)),
        statement="a position signal is reported in the cycle of its event, and in no other",
    )
    yield for_all_inputs(
        "an end in a section is reported",
        followed(machine).implies(machine.flag("in_section").iff(~seen.normal)),
        statement="while sections are followed, the end is reported in a section exactly while its amplitude is not normal",
    )


def _section(model: Fibre) -> Iterator[Property]:
    """Claim when the end is reported in a section, both ways."""
    yield under_assumption(
        "a section is reported from its first edge to its last",
        model.machine.flag("in_section").iff(_within(model)),
        statement="in every mode the end is reported in a section from the cycle in which an edge changes the amplitude until the cycle in which one "
        "brings it back to normal, and in no other cycle",
    )


def _signal(model: Fibre) -> Iterator[Property]:
    """Claim when a position signal is reported, both ways, and where the end is then."""
    signal, seen = model.machine.flag("position_signal"), model.own.ghosts
    enters = before(seen.band).eq(v.NORMAL) & _within(model)
    yield under_assumption(
        "an edge that begins a section is reported as a signal",
        (tells_changes(model) & enters).implies(signal),
        statement="whenever the end passes an edge that changes the amplitude, a position signal is reported in that cycle; while the machine follows the "
        "pattern, the amplitude was not absent for too long, and no reference comes",
    )
    off = seen.truth - seen.edge
    most = _unheard_nm(model) + model.own.config.edge_tolerance_mm * NM_PER_MM
    yield under_assumption(
        "a signal is reported at an edge alone",
        signal.implies(enters & between(-most, off, most)),
        statement="a position signal is reported only in a cycle in which the end passes an edge that changes the amplitude, and the end is then no farther "
        "from that edge than its tolerance and the run since the last amplitude",
    )


def _within(model: Fibre) -> Bool:
    """By the world, the last amplitude is changed."""
    return model.own.ghosts.band.ne(v.NORMAL)


def _unheard_nm(model: Fibre) -> Num:
    """Greatest run of the end since the last amplitude before this cycle, by the world, nm."""
    own, run = model.own, model.own.run
    measured = exact_to(ite(run.present, abs_(run.value), as_num(0, MM)), NM)
    return before(own.ghosts.possible_run_since_amplitude) + measured + Seen(own).added_error_nm
