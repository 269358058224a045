"""Two machines on one stream: odometry with both readers, and beside it one that has the front reader alone (MRK-1).

The second one is the one-device machine; its rear reader reads nothing. Both have the same front units and the same front
reader. Whatever the rear units and the rear reader report, the first one must not be worse.

No ghost is needed: both are compared on every stream on which neither turns about, the two devices do not exclude each
other, and neither refuses what the front reader reads. `tests/theorems/odometry/line_ahead.py` shows which streams these are.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from safeloc.language.composition import Composition, compose
from safeloc.language.expr import FALSE, Bool, Expr, Lit, Num, Optional, Var, all_of
from safeloc.language.machine import Machine
from safeloc.language.terms import Substitution
from safeloc.language.world import World
from safeloc.models.odometry import Odometry, build
from safeloc.models.odometry.distance_device import Device
from safeloc.models.odometry.marker_reading import NOT_BETTER, OUT_OF_ORDER, OUT_OF_WINDOW, REPEATED, UNCONFIRMED
from safeloc.models.odometry.variables import OdometryConfig, parts
from safeloc.models.odometry.world import on_board

REFUSED = (REPEATED, OUT_OF_ORDER, OUT_OF_WINDOW, UNCONFIRMED)
"""Verdicts that no true reading of a new marker ahead gets, but for UNCONFIRMED in the very cycle of a loss."""


@dataclass(frozen=True, eq=False)
class Comparison:
    """Both machines, and the whole."""

    both: Odometry
    alone: Odometry
    composition: Composition

    @property
    def of_both(self) -> Substitution:
        """From the terms of the machine with both readers to the whole."""
        return self.composition.of(self.both.machine)

    @property
    def of_alone(self) -> Substitution:
        """From the terms of the machine with the front reader alone to the whole."""
        return self.composition.of(self.alone.machine)


def compose_comparison(
    config: OdometryConfig | None = None, *, change: Callable[[Machine], Machine] | None = None
) -> Comparison:
    """Compose both machines on one stream, under the assumption that the properties name.

    change  makes a wrong machine of the one with both readers, to show that it is noticed
    """
    config = config or OdometryConfig()
    both = _undisturbed(build(parts(config.model_copy(update={"devices": 2}))))
    both = both if change is None else replace(both, machine=change(both.machine))
    alone = _undisturbed(build(parts(config.model_copy(update={"devices": 1})), "front_only"))
    joined = compose("odometry_beside_front_only", [both.machine, alone.machine], _same_stream(both, alone))
    whole = Comparison(both, alone, joined)
    system = replace(
        joined.system,
        assume=joined.system.assume & _assumed(whole),
        lemmas={**joined.system.lemmas, **dict(_lemmas(whole))},
    )
    return replace(whole, composition=replace(joined, system=system))


def _undisturbed(model: Odometry) -> Odometry:
    """Return the machine on a stream without a turn, a contradiction or a refused reading at the front."""
    return replace(
        model,
        machine=replace(
            on_board(model.machine),
            world=World(
                clauses={"nothing disturbs the stream": undisturbed(model)},
                reads_machine="the machine judges what disturbs it; what is shown is of streams that do not",
            ),
        ),
    )


def undisturbed(model: Odometry) -> Bool:
    """Return whether a cycle has no turn, no contradiction between devices, and no refused reading at the front."""
    verdict = model.judgement.readings[0].verdict
    return ~(model.judgement.reversed | model.judgement.clash | verdict.one_of(*REFUSED))


def _same_stream(both: Odometry, alone: Odometry) -> dict[Var, Expr]:
    wires: dict[Var, Expr] = {}
    for unit, other in zip(alone.own.units, both.own.devices[0].units, strict=True):
        wires |= _reads(other.measured, unit.measured)
    front, rear = alone.own.readers
    for here, there in zip(front.inputs, both.own.readers[0].inputs, strict=True):
        wires |= _reads(there, here)
    for option in rear.inputs:
        wires |= {option.present: FALSE, option.value: Lit(max(0, option.value.low), option.value.unit)}
    return wires


def _reads(there: Optional, here: Optional) -> dict[Var, Expr]:
    return {here.present: there.present, here.value: there.value}


def _assumed(whole: Comparison) -> Bool:
    """Assume besides that no coarse marker is read at the front while the machine with the front reader alone reports nothing.

    A coarse marker is worth less than the values that the front device still has. The machine without a position takes it; the
    one with both readers keeps its better values, of which the second unit may later turn out to be the worse one.
    """
    verdict = whole.both.judgement.readings[0].verdict
    silent = whole.of_alone.bool(~whole.alone.machine.flag("valid"))
    worth = whole.of_both.bool(verdict.ne(NOT_BETTER))
    return silent.implies(worth)


# ------------------------------------------------------------------ what helps to prove


def _lemmas(whole: Comparison) -> Iterator[tuple[str, Bool]]:
    both, alone = whole.both, whole.alone
    yield "both run forward", whole.of_both.bool(~both.own.backwards) & whole.of_alone.bool(~alone.own.backwards)
    yield from _same_values(whole)
    yield "lost together", _together(whole, "DELOCALIZED")
    if both.own.config.trust_first_marker:  # no marker is a candidate
        return
    yield "a candidate together", _together(whole, "CANDIDATE")
    rear, candidate = both.own.devices[1].values.alive, both.in_mode("CANDIDATE")
    yield "no rear device beside a candidate", whole.of_both.bool(candidate.implies(~rear))
    waiting = alone.in_mode("CANDIDATE").implies(alone.own.devices[0].values.alive)
    yield "a candidate of the front reader alone is alive", whole.of_alone.bool(waiting)


def _together(whole: Comparison, label: str) -> Bool:
    """Where the machine with both readers is in that mode, the other one is too."""
    return whole.of_both.bool(whole.both.in_mode(label)).implies(whole.of_alone.bool(whole.alone.in_mode(label)))


def _same_values(whole: Comparison) -> Iterator[tuple[str, Bool]]:
    """The front devices have the same values, run and age."""
    here, there = whole.both.own.devices[0], whole.alone.own.devices[0]
    for one, twin in zip(_state(here), _state(there), strict=True):
        yield f"{one.name} the same", _equal(whole.of_both(one), whole.of_alone(twin))
    yield "a dead front device holds nothing", whole.of_alone.bool(_empty_when_dead(there))


def _state(device: Device) -> Iterator[Var]:
    for unit in device.units:
        yield from (unit.alive, unit.position, unit.above, unit.below, unit.last, unit.gap, unit.last_verdict)
    yield from (device.run, device.age, device.by_leading)


def _empty_when_dead(device: Device) -> Bool:
    units = [unit.alive | (unit.position.eq(0) & unit.above.eq(0) & unit.below.eq(0)) for unit in device.units]
    empty = device.run.eq(0) & device.age.eq(0)
    return all_of([*units, device.values.alive | empty, device.by_leading])


def _equal(left: Expr, right: Expr) -> Bool:
    if isinstance(left, Num) and isinstance(right, Num):
        return left.eq(right)
    assert isinstance(left, Bool) and isinstance(right, Bool)
    return left.iff(right)
