"""The odometry machine on a line with a marker every D mm: how far it runs between two resets (MRK-D5).

Vehicle length L and spacing D are variables, and so is the accuracy of the markers; the vehicle runs forward, at any
speed and acceleration that the plausibility gates let pass; both readers read every marker, and all units measure
exactly. The machine is the one that runs on board, with its own checks, queue and hand-over; only its ghosts are left
out, for here the field is the environment.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

from safeloc.language.composition import Composition, compose
from safeloc.language.expr import TRUE, Bool, Expr, Lit, Num, NumVar, Var, all_of, any_of, exact_to, number, with_unit
from safeloc.language.machine import Machine
from safeloc.language.terms import Substitution
from safeloc.language.units import COUNT, MM, NM, PPM
from safeloc.models.odometry import Odometry, build
from safeloc.models.odometry.distance_device import Device, Unit
from safeloc.models.odometry.variables import OdometryConfig, parts
from safeloc.models.odometry.world import on_board
from safeloc.models.vocabulary.error_law import ErrorLaw
from tests.theorems.odometry.field import LONGEST_VEHICLE_MM, SHORTER, Arrangement, Field, field_over, readings, world

ONE_LAW = OdometryConfig(
    first_unit=ErrorLaw(kind="wheel"),
    second_unit=ErrorLaw(kind="radar"),
    tolerance_mm=500_000,
    vehicle_length_tolerance_mm=0,
    reader_latency_ms=0,
    last_marker_identity=1_000_000_000,
)
"""The source's own case (l. 67, 137): the error grows with the distance run alone, alike in all units."""


@dataclass(frozen=True, eq=False)
class MarkerField:
    """The field, the odometry machine in it, and both as one system."""

    field: Field
    arrangement: Arrangement
    world: Machine
    source: Odometry
    composition: Composition

    @property
    def own(self) -> Substitution:
        """From the field's terms to the whole."""
        return self.composition.of(self.world)

    @property
    def says(self) -> Substitution:
        """From the odometry machine's terms to the whole."""
        return self.composition.of(self.source.machine)

    @property
    def lead_mm(self) -> Num:
        """Distance of end A past its last marker when end B passes the marker that waits for it."""
        return self.own.num(self.arrangement.lead_mm(self.field.length, self.field.spacing))


def compose_field(
    arrangement: Arrangement = SHORTER,
    config: OdometryConfig = ONE_LAW,
    change: Callable[[Machine], Machine] | None = None,
) -> MarkerField:
    """Wire the field to the odometry machine: exact distances, and every reading.

    change  what runs in the field instead of the machine itself, to show that a wrong one is noticed
    """
    field = field_over(config.limits)
    model = build(parts(config, length=number("length_mm", MM, 0, LONGEST_VEHICLE_MM)))
    board = on_board(model.machine)
    source = replace(model, machine=board if change is None else change(board))
    assert source.own.length is not None
    wires: dict[Var, Expr] = {source.own.length: field.length}
    for unit in source.own.units:
        wires |= {unit.measured.present: TRUE, unit.measured.value: field.step}
    wires |= readings(field, *source.own.readers)
    around = world(field, config.limits, arrangement)
    joined = compose("marker_field", [around, source.machine], wires)
    whole = MarkerField(field, arrangement, around, source, joined)
    system = replace(joined.system, lemmas={**joined.system.lemmas, **dict(_lemmas(whole))})
    return replace(whole, composition=replace(joined, system=system))


# ------------------------------------------------------------------ what helps to prove


def _lemmas(whole: MarkerField) -> Iterator[tuple[str, Bool]]:
    """Facts over both machines: what the odometry machine holds, as a function of where the ends are."""
    own, says = whole.source.own, whole.says
    yield "the vehicle runs forward", says.bool(~own.backwards & own.rolled.eq(0))
    for unit in own.units:
        yield f"{unit.name} heard", _delivered(whole, unit)
    for device, phase in zip(own.devices, (whole.field.phase_a, whole.field.phase_b), strict=True):
        yield from _measured(whole, device, phase)
    yield from _remembered(whole)
    yield from _paired(whole) if whole.arrangement.pairs else _unpaired(whole)


def _delivered(whole: MarkerField, unit: Unit) -> Bool:
    last = whole.says.num(unit.last).eq(whole.own.num(whole.field.last_step))
    return (whole.says.bool(unit.gap.eq(0)) & last) | whole.says.bool(unit.gap > unit.limits.gap_limit)


def _measured(whole: MarkerField, device: Device, phase: NumVar) -> Iterator[tuple[str, Bool]]:
    """A living unit is where end A is; its device has run since the marker; its margin grows with that run alone."""
    says, past, position = whole.says, whole.own.num(phase), whole.own.num(whole.field.position)
    run = says.bool(device.values.alive).implies(says.num(device.run).eq(past))
    yield f"{device.name} run is the distance past the marker", run
    for unit in device.units:
        fresh = exact_to(whole.own.num(whole.field.accuracy), NM) + 2 * unit.law.wander_nm
        margin = fresh + past * Lit(unit.law.rate_ppm, PPM)
        exact = says.num(unit.position).eq(position) & says.num(unit.above).eq(margin) & says.num(unit.below).eq(margin)
        yield f"{unit.name} is exact", says.bool(unit.alive).implies(exact)


def _remembered(whole: MarkerField) -> Iterator[tuple[str, Bool]]:
    """The machine knows the marker that end A passed last, and of those that wait none is twice there."""
    own, machine, says = whole.source.own, whole.source.machine, whole.says
    lost, candidate, *_ = machine.modes
    place, front = whole.own.num(whole.field.place), own.devices[0].values.alive
    last = says.num(own.last_marker).eq(_identity(whole, 0)) & says.num(own.last_marker_position).eq(place)
    yield "the last marker is known", says.bool(machine.mode.ne(lost)).implies(last)
    yield "identities wait in order", _ordered(whole)
    empty = all_of(waiting.eq(0) for waiting in own.pending.places)
    yield "nothing waits while delocalized", says.bool(machine.mode.eq(lost).implies(empty))
    waits = _waits(whole, 0) & says.bool(front & ~own.devices[1].values.alive)
    yield "a candidate comes from the front", says.bool(machine.mode.eq(candidate)).implies(waits)


def _ordered(whole: MarkerField) -> Bool:
    """Oldest first, without holes, none that end A has yet to pass."""
    queue = [whole.says.num(place) for place in whole.source.own.pending.places]
    pairs = [later.eq(0) | (earlier.ne(0) & (earlier < later)) for earlier, later in pairwise(queue)]
    return all_of([*pairs, *(place <= _identity(whole, 0) for place in queue)])


def _identity(whole: MarkerField, behind: int) -> Num:
    """The marker `behind` spacings behind the one that end A passed last."""
    return with_unit(whole.own.num(whole.field.place - whole.field.spacing * behind), COUNT)


def _waits(whole: MarkerField, behind: int) -> Bool:
    return any_of(whole.says.num(place).eq(_identity(whole, behind)) for place in whole.source.own.pending.places)


def _paired(whole: MarkerField) -> Iterator[tuple[str, Bool]]:
    """Before end B passes the waiting marker the front device is the younger one, after it the rear device."""
    front, rear = whole.source.own.devices
    under, past = whole.arrangement.under, whole.own.num(whole.field.phase_a)
    sure = whole.says.bool(whole.source.machine.flag("valid"))
    newer_front = whole.says.bool(front.values.alive & rear.values.alive.implies(rear.age >= front.age))
    newer_rear = whole.says.bool(rear.values.alive & front.values.alive.implies(front.age >= rear.age))
    waiting = [_waits(whole, behind) for behind in range(under + 1)]
    before = all_of([newer_front, *waiting])
    yield "before the second reading", (sure & (past < whole.lead_mm)).implies(before)
    yield "after the second reading", (sure & (past >= whole.lead_mm)).implies(all_of([newer_rear, *waiting[:under]]))


def _unpaired(whole: MarkerField) -> Iterator[tuple[str, Bool]]:
    """No identity that waits is one that end B has yet to meet, so its device is never set."""
    own = whole.source.own
    if len(own.pending.places) == 1:
        yield "only the last marker waits", whole.says.bool(own.pending.places[0].eq(0)) | _waits(whole, 0)
    front, rear = own.devices
    yield "the rear device is never set", whole.says.bool(~rear.values.alive)
    located = whole.source.machine.flag("valid")
    yield "the front device speaks", whole.says.bool(located.implies(front.values.alive))
