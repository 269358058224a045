"""The reference of the train: the record of the counter over which it came in, or what the neighbouring area hands over (FVA-3, FVA-D1).

    NONE         no reference comes in this cycle
    COUNTED      the record of a counter at one end of the area
    HANDED_OVER  the neighbour's record

A counter's record is this train's if the train was the outermost one at that end before the cycle, and the record is one of a passage into
the area. A passage with a flaw has no direction: it is a reference that is not sound. The record of a passage out of the area is no
reference: who has left is not verified. If both counters have a record of this train, the one at the low end counts; a counter's record
comes before the neighbour's.

The counter tells its record in the direction in which the train came; here it is turned upwards along the line, and the place is that of the
front: the end towards growing positions. Of a train that came in at the high end that is its last axle.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

from safeloc.language.declared import Declared
from safeloc.language.expr import (
    TRUE,
    Bool,
    BoolVar,
    Expr,
    Num,
    NumVar,
    Var,
    all_of,
    any_of,
    as_num,
    boolean,
    ceil_to,
    choice,
    enumeration,
    floor_to,
    ite,
    maximum,
    number,
)
from safeloc.language.machine import Model, Transition, modes
from safeloc.language.rows import Updates
from safeloc.language.units import COUNT, MM, MM_S, UM, UM_PER_MM, Unit
from safeloc.language.world import Law
from safeloc.models.axle_head import AXLE, DOWN, UP
from safeloc.models.fibre_area.entry_variables import THIS
from safeloc.models.fibre_device.configuration import SIDES, FibreDeviceConfig
from safeloc.models.verification.variables import AXLE_COUNTER, FROM, NEIGHBOUR, NOBODY

NAME = "reference"
ONE_TRAIN = "a passage over a counter is one train's"
REQUIREMENTS = ("FVA-3", "FVA-12", "FVA-D1")


@dataclass(frozen=True, eq=False)
class Counted:
    """The message of the counter at one end in this cycle, its place, and who was the outermost train there before the cycle.

    length, run  bounds, um, in the direction in which the train came; speed: bounds, mm/s
    end, outermost  place of the counter, mm; number of that train, 0: none
    passed  choice, wired to the counter's world: axles that passed in the passage that is recorded
    """

    into_area: Num
    ready: BoolVar
    sound: BoolVar
    direction: NumVar
    axles: NumVar
    length: tuple[NumVar, NumVar]
    run: tuple[NumVar, NumVar]
    speed: tuple[NumVar, NumVar]
    end: NumVar
    outermost: NumVar
    passed: NumVar

    @property
    def is_this_trains(self) -> Bool:
        """A record comes, of this train on its way in, or with a flaw."""
        return self.ready & self.outermost.eq(THIS) & (~self.sound | self.direction.eq(self.into_area))


_Flag = TypeVar("_Flag", bound=Bool, covariant=True)
_Number = TypeVar("_Number", bound=Num, covariant=True)


@dataclass(frozen=True, eq=False)
class Record(Generic[_Flag, _Number]):
    """A record as the verification reads it: bounds of length (mm), speed (mm/s) and place of the front (mm), counted upwards, and its age in cycles."""

    sound: _Flag
    axles: _Number
    length: tuple[_Number, _Number]
    speed: tuple[_Number, _Number]
    place: tuple[_Number, _Number]
    age: _Number

    @property
    def figures(self) -> list[_Number]:
        """All that a record with a flaw does not tell."""
        return [self.axles, *self.length, *self.speed, *self.place]

    @property
    def numbers(self) -> list[_Number]:
        """All but whether it is sound."""
        return [*self.figures, self.age]


class Parts:
    """The variables of the machine.

    counted    what each counter tells, at the low and at the high end
    enters     number of the train that comes in at this end, by train control; 0: none
    neighbour_sends  the neighbour's record comes; neighbours: that record
    sender, told   state: sender of the reference of this cycle, and the reference
    axles_of_one_that_enters, true_axles  choices: axles of this train, if it comes in, and as it was before the cycle
    """

    def __init__(self, config: FibreDeviceConfig) -> None:
        self.declared = declared = Declared()
        self.config = config
        trains = config.area.sections.area.trains
        low, high = (self._read(declared, side, config) for side in SIDES)
        self.counted = (low, high)
        self.enters = tuple(declared.sensor(number(f"enters_{side}", COUNT, 0, trains)) for side in SIDES)
        self.neighbour_sends = declared.sensor(boolean("neighbour_sends"))
        self.neighbours = _record_variables("neighbour_", config)
        self.sender = declared.state(choice("sender", enumeration(FROM)), first=NOBODY)
        self.told = _record_variables("", config)
        declared.sensor(self.neighbours.sound)
        declared.state(self.told.sound, first=False)
        for read, told in zip(self.neighbours.numbers, self.told.numbers, strict=True):
            declared.sensor(read)
            declared.state(told, first=0)
        most = config.area.verification.axle_limit
        self.axles_of_one_that_enters = declared.choice(number("axles_of_one_that_enters", COUNT, 0, most))
        self.true_axles = declared.choice(number("true_axles", COUNT, 0, most))

    def _read(self, declared: Declared, side: str, config: FibreDeviceConfig) -> Counted:
        counter, limit = config.counter, config.area.sections.area.limit_mm
        far, late = counter.run_limit_um, counter.late_mm * UM_PER_MM

        def bounds(name: str, low: int, high: int) -> tuple[NumVar, NumVar]:
            first, last = (declared.sensor(number(f"{side}_{name}_{end}_um", UM, low, high)) for end in SIDES)
            return first, last

        fast = counter.max_speed_mm_s
        slow, quick = (declared.sensor(number(f"{side}_speed_{end}_mm_s", MM_S, -fast, fast)) for end in SIDES)
        return Counted(
            UP if side == "low" else DOWN,
            declared.sensor(boolean(f"{side}_record_ready")),
            declared.sensor(boolean(f"{side}_record_sound")),
            declared.sensor(choice(f"{side}_direction", enumeration(AXLE))),
            declared.sensor(number(f"{side}_axles", COUNT, 0, counter.axle_limit)),
            bounds("length", -far - late, far + late),
            bounds("run", -far - late, far + late),
            (slow, quick),
            declared.sensor(number(f"{side}_end_mm", MM, -limit, limit)),
            declared.sensor(number(f"{side}_outermost", COUNT, 0, config.area.sections.area.trains)),
            declared.choice(number(f"{side}_axles_passed", COUNT, 0, 2**31)),
        )

    @property
    def comes_in(self) -> Bool:
        """This train comes in, at either end."""
        return any_of(came.eq(THIS) for came in self.enters)


def _record_variables(name: str, config: FibreDeviceConfig) -> Record[BoolVar, NumVar]:
    """Return fresh variables of a record."""
    verified = config.area.verification

    def bounds(what: str, unit: Unit, low: int, high: int) -> tuple[NumVar, NumVar]:
        suffix = "mm_s" if unit is MM_S else "mm"
        first, last = (number(f"{name}{what}_{end}_{suffix}", unit, low, high) for end in SIDES)
        return first, last

    fast, limit = verified.max_speed_mm_s, verified.position_limit_mm
    return Record(
        boolean(f"{name}sound"),
        number(f"{name}axles", COUNT, 0, verified.axle_limit),
        bounds("length", MM, 0, verified.length_limit_mm),
        bounds("speed", MM_S, -fast, fast),
        bounds("place", MM, -limit, limit),
        number(f"{name}age_cycles", COUNT, 0, verified.oldest_record_cycles),
    )


Reference = Model[Parts]


def build(own: Parts) -> Reference:
    """Return the machine over the given variables."""
    table = modes("NONE", "COUNTED", "HANDED_OVER")
    none, counted, handed_over = table
    rows = [
        *(
            Transition(
                f"record of the counter at the {side} end", table, counted, one.is_this_trains & ~own.comes_in,
                _set(own, AXLE_COUNTER, _record(own, one)), REQUIREMENTS, priority,
            )
            for priority, (side, one) in enumerate(zip(SIDES, own.counted, strict=True))
        ),
        Transition(
            "record of the neighbour", table, handed_over, own.neighbour_sends, _set(own, NEIGHBOUR, own.neighbours), REQUIREMENTS, 2
        ),
        Transition("no record", table, none, TRUE, {own.sender: NOBODY, **_nothing(own)}, REQUIREMENTS, 3),
    ]  # fmt: skip
    outputs: dict[str, Expr] = {"sender": own.sender}
    outputs |= {"sound": own.told.sound, **{one.name: one for one in own.told.numbers}}
    machine = own.declared.machine(
        name=NAME,
        modes=table,
        outputs=outputs,
        transitions=rows,
        world=own.declared.world(moves={}, clauses=_laws(own)),
        doc=(
            "The reference of the train: its counter's record, or what the neighbour hands over. Assumed: the axles of one passage are those of "
            "the train that is the outermost there; a neighbour's sound record has no more axles than the train."
        ),
    )
    return Model(machine, own)


# ------------------------------------------------------------------ rows


def _record(own: Parts, one: Counted) -> Record[Bool, Num]:
    """Return the counter's record, counted upwards, with the place of the front: for a train that came in at the high end its last axle."""
    up, (short, long), (near, far) = one.into_area.eq(UP), one.length, one.run
    slow, fast = one.speed
    place = ite(up, near, short - far), ite(up, far, long - near)
    return Record(
        one.sound,
        one.axles,
        (maximum(floor_to(short, MM), as_num(0, MM)), maximum(ceil_to(long, MM), as_num(0, MM))),
        (ite(up, slow, -fast), ite(up, fast, -slow)),
        (floor_to(place[0], MM) + one.end, ceil_to(place[1], MM) + one.end + own.config.overhang_mm),
        as_num(0, COUNT),
    )


def _set(own: Parts, sender: Expr, record: Record[Bool, Num]) -> Updates:
    """Tell the record; of one with a flaw nothing but that it came."""
    told: dict[Var, Expr] = {own.sender: sender, own.told.sound: record.sound, own.told.age: record.age}
    figures = zip(own.told.figures, record.figures, strict=True)
    return {**told, **{var: ite(record.sound, term, 0) for var, term in figures}}


def _nothing(own: Parts) -> Updates:
    """Tell nothing."""
    return {own.told.sound: False, own.told.age: 0, **dict.fromkeys(own.told.figures, 0)}


# ------------------------------------------------------------------ world


def _laws(own: Parts) -> dict[str, Law]:
    stays = all_of(came.ne(THIS) for came in own.enters)
    recorded = [
        all_of([stays, one.sound, one.direction.eq(one.into_area), one.outermost.eq(THIS)]).implies(
            one.passed <= own.true_axles
        )
        for one in own.counted
    ]
    axles = ite(stays, own.true_axles, own.axles_of_one_that_enters)
    return {
        ONE_TRAIN: Law(
            all_of(recorded),
            "The axles that pass a counter in one passage, into the area, are of the train that is the outermost there when the passage ends.",
            source="[D] one track, and trains that follow each other at the headway; [M] announcements by train control",
            owner="infrastructure",
            check="no switch at a counter; headway of trains; axles counted in while no train is announced",
        ),
        "a neighbour hands over no more axles than the train has": Law(
            (own.neighbour_sends & own.neighbours.sound).implies(own.neighbours.axles <= axles),
            "A sound record of the neighbouring area has no more axles than the train.",
            source="[S] FVA-D1: the neighbour hands over what it verified",
            owner="supplier",
            check="count and record compared at the next counter",
        ),
    }
