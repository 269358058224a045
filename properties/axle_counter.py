"""What must hold of a train's entry record (FVA-3, FVA-5)."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import Lit, before, between, exact_to
from safeloc.language.spec import Property, always, reachable
from safeloc.language.units import NM, UM, Unit
from safeloc.models.axle_counter import AxleCounter
from safeloc.models.axle_counter.passage import SOUND, UM_PER_MM
from safeloc.models.axle_head import NO_AXLE

TRACE = ("FVA-3", "FVA-5")
LAW = "heads without a fault tell every axle and true bounds of its speed; trains keep to their traction and brakes"


def properties(model: AxleCounter) -> list[Property]:
    """A sound record is true; a passage with any flaw gives none."""
    machine, own = model.machine, model.own
    spoilt, _, passing, done = machine.modes
    mode, sound = machine.mode, machine.flag("record_sound")
    nothing = [machine.output(f"record_{name}") for name in ("axles", "length_low_um", "length_high_um")]
    gap = Lit(own.config.axle_gap_mm * UM_PER_MM, UM)
    return [
        always(
            "count is true",
            sound.implies(own.count.eq(own.axles)),
            statement="a sound record holds the number of axles that passed",
            requirements=TRACE,
            assumption=LAW,
        ),
        *_within_bounds(model),
        always(
            "the whole train has passed",
            sound.implies(own.run - own.length > exact_to(gap, NM)),
            statement="a record is made only when the train has run farther since its last axle than two axles are apart",
            requirements=TRACE,
            assumption=LAW,
        ),
        always(
            "length is exact enough",
            sound.implies(own.length_high - own.length_low <= own.config.length_spread_mm * UM_PER_MM),
            statement="a sound record's length is never wider than permitted",
            requirements=TRACE,
            unconditional=True,
        ),
        always(
            "a fault spoils",
            own.fault.implies(mode.eq(spoilt)),
            statement="disagreeing channels or a disturbed head: no record, from the same cycle on",
            requirements=TRACE,
            unconditional=True,
        ),
        always(
            "turning spoils",
            (before(mode).eq(passing) & own.axle.ne(NO_AXLE) & own.axle.ne(before(own.came))).implies(mode.eq(spoilt)),
            statement="an axle in the other direction spoils the passage in the same cycle",
            requirements=TRACE,
            unconditional=True,
        ),
        always(
            "spoilt until over",
            (before(mode).eq(spoilt) & mode.ne(spoilt)).implies(own.over & mode.eq(done) & ~sound),
            statement="what is left of a spoilt passage is never taken for another train",
            requirements=TRACE,
            unconditional=True,
        ),
        always(
            "a record needs a passage",
            sound.implies(before(mode).eq(passing) & (own.count > 0)),
            statement="a sound record is made only at the end of an undisturbed passage",
            requirements=TRACE,
            unconditional=True,
        ),
        always(
            "nothing without a record",
            (~sound).implies(nothing[0].eq(0) & nothing[1].eq(0) & nothing[2].eq(0)),
            statement="without a sound record there are no numbers to verify with",
            requirements=TRACE,
            unconditional=True,
        ),
        always(
            "a flaw is told",
            mode.eq(spoilt).implies(own.flaw.ne(SOUND)),
            statement="a spoilt passage has a reason",
            requirements=TRACE,
            unconditional=True,
        ),
        reachable("record", sound & (own.count > 1), statement="a train gives a sound record", requirements=TRACE),
    ]


def _within_bounds(model: AxleCounter) -> Iterator[Property]:
    """What a sound record bounds, the train's truth between."""
    own = model.own
    bounds = {
        "length": (own.length_low, own.length, own.length_high),
        "speed": (own.low_speed, own.speed, own.high_speed),
        "place": (own.run_low, own.run, own.run_high),
    }
    meant = {
        "length": "the length from first to last axle, whatever the train's speed did",
        "speed": "the speed of its cycle",
        "place": "how far the first axle is beyond the counter",
    }
    for name, (low, truth, high) in bounds.items():
        unit = truth.unit
        assert isinstance(unit, Unit)
        yield always(
            f"{name} is true",
            model.machine.flag("record_sound").implies(between(exact_to(low, unit), truth, exact_to(high, unit))),
            statement=f"a sound record's bounds hold {meant[name]}",
            requirements=TRACE,
            assumption=LAW,
        )
