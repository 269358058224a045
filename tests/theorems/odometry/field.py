"""The field of evenly spaced markers as a machine: where both ends of a vehicle are, and what its readers read.

Vehicle length, spacing and accuracy are free and stay as they are. A marker's identity is its place in mm: machines
only compare identities, so any naming without doubles will do.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from safeloc.language.expr import (
    TRUE,
    Bool,
    BoolVar,
    Expr,
    Lit,
    Num,
    NumVar,
    Var,
    between,
    boolean,
    ite,
    number,
    with_unit,
)
from safeloc.language.machine import ANY, Initial, Machine, Transition, modes
from safeloc.language.units import COUNT, MM
from safeloc.language.world import World
from safeloc.models.odometry.marker_reading import Reader
from safeloc.models.vocabulary.measured import Limits

LONGEST_SPACING_MM = 20_000_000
LONGEST_VEHICLE_MM = 2_000_000


@dataclass(frozen=True, eq=False)
class Field:
    """Fixed figures of the field, the readers' places, and their readings in this cycle.

    phase_a, phase_b: distance of end A and of end B from the marker it passed last. place: of end A's last marker.
    """

    step: NumVar
    length: NumVar
    spacing: NumVar
    accuracy: NumVar
    phase_a: NumVar
    phase_b: NumVar
    place: NumVar
    last_step: NumVar
    front_reads: BoolVar
    rear_reads: BoolVar

    @property
    def position(self) -> Num:
        """Place of end A, mm."""
        return self.place + self.phase_a

    @property
    def rear_place(self) -> Num:
        """The marker that end B passed last, mm."""
        return self.position - self.length - self.phase_b


@dataclass(frozen=True)
class Arrangement:
    """Position of the vehicle relative to the markers.

    holds  what relates length, spacing and the places of both ends; it stays true while the vehicle runs
    under  the greatest whole number of spacings that the vehicle is longer than
    pairs  whether end B's readings find an identity that waits for them
    """

    name: str
    holds: Callable[[Field, int], Bool]
    under: int
    pairs: bool

    def lead_mm(self, length: Num, spacing: Num) -> Num:
        """Return the distance of end A past a marker when end B passes the marker that lies `under` spacings behind it."""
        return length - spacing * self.under


def _on_grid(field: Field, under: int) -> Bool:
    behind = field.place - field.rear_place
    return behind.eq(field.spacing * under) | behind.eq(field.spacing * (under + 1))


SHORTER = Arrangement(
    "no longer than the spacing",
    lambda field, step: (field.length >= step) & (field.length <= field.spacing) & _on_grid(field, 0),
    under=0,
    pairs=True,
)
QUEUED = Arrangement(
    "longer than one spacing and no longer than two, with identities that wait",
    lambda field, step: (
        (field.length >= field.spacing + step) & (field.length <= field.spacing * 2) & _on_grid(field, 1)
    ),
    under=1,
    pairs=True,
)
LONGER = Arrangement(
    "longer than the spacing, with one identity that waits",
    lambda field, step: field.length >= field.spacing + step,
    under=1,
    pairs=False,
)
WITHOUT_LENGTH = Arrangement(
    "both readers at one place",
    lambda field, step: field.length.eq(0) & field.phase_a.eq(field.phase_b),
    under=0,
    pairs=False,
)


def field_over(limits: Limits) -> Field:
    """Fresh variables. No cycle passes two markers with one reader: spacing >= the farthest run of a cycle."""
    farthest = limits.max_cycle_distance_mm
    return Field(
        number("distance_mm", MM, 0, farthest),
        number("length_mm", MM, 0, LONGEST_VEHICLE_MM),
        number("spacing_mm", MM, farthest, LONGEST_SPACING_MM),
        number("accuracy_mm", MM, 0, 100_000),
        number("end_a_past_marker_mm", MM, 0, LONGEST_SPACING_MM - 1),
        number("end_b_past_marker_mm", MM, 0, LONGEST_SPACING_MM - 1),
        number("marker_mm", MM, 1, limits.position_limit_mm),
        number("last_distance_mm", MM, 0, farthest),
        boolean("front_reads"),
        boolean("rear_reads"),
    )


def world(field: Field, limits: Limits, arrangement: Arrangement) -> Machine:
    """Return the field as a machine: in each step the vehicle runs `distance_mm`, and the readers may pass a marker."""
    (running,) = modes("RUNNING")
    front = field.phase_a + field.step >= field.spacing
    rear = field.phase_b + field.step >= field.spacing
    rest = (field.length, field.spacing, field.accuracy, field.phase_a, field.phase_b, field.place, field.last_step)
    first: dict[Var, Initial] = dict.fromkeys(rest, ANY)
    between_markers = (field.phase_a < field.spacing) & (field.phase_b < field.spacing)
    arranged = arrangement.holds(field, limits.max_cycle_distance_mm)
    meets = {"both readers pass": front & rear, "front reader passes": front, "rear reader passes": rear}
    return Machine(
        name="field",
        modes=(running,),
        inputs=[field.step],
        state={**first, field.front_reads: False, field.rear_reads: False},
        outputs={"position_mm": field.position},
        transitions=[
            Transition(name, running, running, when, _moved(field, front, rear), ("MRK-D5",), rank)
            for rank, (name, when) in enumerate({**meets, "between markers": TRUE}.items())
        ],
        world=World(
            clauses={"the vehicle runs forward on the line": _forward(field, limits)},
            reads_machine="the field has no devices: it is the world of the odometry machine, and its state is what is so there",
        ),
        initially=between_markers & arranged & (field.rear_place >= 1),
        lemmas={"both ends are between markers": between_markers, "the vehicle lies as arranged": arranged},
        doc="A line with evenly spaced markers; vehicle length, spacing and accuracy are free and stay as they are.",
    )


def _moved(field: Field, front: Bool, rear: Bool) -> dict[Var, Expr]:
    a, b = field.phase_a + field.step, field.phase_b + field.step
    return {
        field.phase_a: ite(front, a - field.spacing, a),
        field.phase_b: ite(rear, b - field.spacing, b),
        field.place: ite(front, field.place + field.spacing, field.place),
        field.last_step: field.step,
        field.front_reads: front,
        field.rear_reads: rear,
    }


def _forward(field: Field, limits: Limits) -> Bool:
    """The change of speed passes the gates, and the vehicle stays on the line."""
    change = field.step - field.last_step
    fair = between(-limits.max_cycle_distance_change_mm, change, limits.max_cycle_distance_change_mm)
    return fair & (field.position + field.step + field.spacing <= limits.position_limit_mm) & (field.rear_place >= 1)


def readings(field: Field, front: Reader, rear: Reader) -> dict[Var, Expr]:
    """Return the readers' inputs from the field: every marker is read, with the distance run since."""
    return {
        **_reading(front, field, field.front_reads, field.place, field.phase_a),
        **_reading(rear, field, field.rear_reads, field.rear_place, field.phase_b),
    }


def _reading(reader: Reader, field: Field, reads: BoolVar, place: Num, since: Num) -> dict[Var, Expr]:
    options = (
        (reader.marker, with_unit(place, COUNT), 1),
        (reader.place, place, 0),
        (reader.accuracy, field.accuracy, 0),
        (reader.since, since, 0),
    )
    inputs: dict[Var, Expr] = {}
    for option, value, absent in options:
        inputs |= {option.present: reads, option.value: ite(reads, value, Lit(absent, option.value.unit))}
    return inputs
