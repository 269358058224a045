"""Claims on what is told of a train: the reason for which it is withheld, and the record for the neighbour (FVA-11, FVA-D1).

Neither decides about trust; a host reads the one, and a neighbouring area goes by the other.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, all_of, any_of
from safeloc.language.spec import Property, always
from safeloc.models.verification import Verification
from safeloc.models.verification import variables as v
from safeloc.properties.verification.requirements import COURSE, STAY

for_all_inputs = partial(always, unconditional=True)
_MISSING = (
    v.NOT_ASSOCIATED, v.NOT_LOCATED, v.PLACE_DOUBTFUL, v.CONTROL_DATA_MISSING, v.CHAIN_UNTESTED, v.NOT_VERIFIED,
)  # fmt: skip


def properties(model: Verification) -> list[Property]:
    """Return the claims."""
    return [*_reasons(model), *_record(model)]


def _reasons(model: Verification) -> Iterator[Property]:
    own, mode = model.own, model.machine.mode
    _, withheld, _, _ = model.machine.modes
    open_mm, tested = own.possible_high - own.possible_low, own.chain_tested
    doubtful = open_mm > own.config.place_doubt_limit_mm
    yield for_all_inputs(
        "withheld for what is missing",
        mode.eq(withheld).implies(own.why.one_of(*_MISSING)),
        statement="a train that is withheld without a mismatch is told that data are missing, or that nothing verifies it now",
        requirements=COURSE,
    )
    yield for_all_inputs(
        "an untested chain is the reason only where it is one",
        own.why.eq(v.CHAIN_UNTESTED).implies(all_of([mode.eq(withheld), own.associated, ~doubtful, ~tested])),
        statement="that the fibre chain was not tested is told only in a cycle in which it was not, of a train whose pattern is known and whose "
        "record leaves no more places open than permitted",
        requirements=COURSE,
    )
    yield for_all_inputs(
        "a doubtful place is the reason only where it is one",
        own.why.eq(v.PLACE_DOUBTFUL).implies(all_of([mode.eq(withheld), own.associated, doubtful])),
        statement="that its place is doubtful is told only of a train whose record leaves more places open than permitted",
        requirements=COURSE,
    )
    complete = [own.associated, ~doubtful, *([tested] if own.config.needs_emitter else [])]
    yield for_all_inputs(
        "nothing is missing where nothing verifies",
        (mode.eq(withheld) & own.why.eq(v.NOT_VERIFIED)).implies(all_of(complete)),
        statement="that no comparison verifies a train is told only where the data for one are there",
        requirements=COURSE,
    )


def _record(model: Verification) -> Iterator[Property]:
    own, machine = model.own, model.machine
    none, withheld, trusted, untrusted = machine.modes
    axles = machine.output("handover_axles")
    length, place = (
        [machine.output(f"handover_{what}_{end}_mm") for end in ("low", "high")] for what in ("length", "place")
    )
    stored = [axles.eq(own.stored_axles), length[0].eq(own.stored_length_low), length[1].eq(own.stored_length_high)]
    low, high = own.record_place_low.low, own.record_place_high.high
    yield for_all_inputs(
        "what is stored is handed over",
        machine.mode.one_of(withheld, trusted).implies(
            all_of([
                *stored,
                place[0] >= own.possible_low, any_of([place[0].eq(own.possible_low), place[0].eq(low)]),
                place[1] <= own.possible_high, any_of([place[1].eq(own.possible_high), place[1].eq(high)]),
            ])
        ),
        statement="while there is a reference the record for the neighbour has its count and length, and the places that it leaves open, as far as "
        "a record can tell them",
        requirements=("FVA-D1", *STAY),
    )  # fmt: skip
    numbers: list[Bool] = [number.eq(0) for number in (axles, *length, *place)]
    yield for_all_inputs(
        "nothing is handed over without a reference",
        machine.mode.one_of(none, untrusted).implies(all_of(numbers)),
        statement="without a reference, and after a mismatch, all numbers of the record for the neighbour are zero",
        requirements=("FVA-D1", *STAY),
    )
