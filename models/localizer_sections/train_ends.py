"""On board: where the end of the train is that the localizer does not locate (FVA-9, FVA-18).

The localizer's position is that of the front end. The other end lies a train's length behind it, for as long as the train is
known to be whole; a part that was lost may stand anywhere behind. So the far end is known only while on-board integrity
monitoring confirms the train. The front end may face either way along the line.

    NOTHING     the localizer gives no position
    FRONT_ONLY  the train is not confirmed to be whole, or its far end would lie beyond the line
    BOTH        the far end is known as well
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import (
    TRUE,
    Bool,
    Expr,
    Lit,
    Num,
    NumVar,
    Var,
    as_num,
    between,
    boolean,
    ceil_to,
    floor_to,
    ite,
    maximum,
    minimum,
    number,
)
from safeloc.language.machine import ANY, Model, Transition, current_mode, modes
from safeloc.language.units import MM, NM, NM_PER_MM, UM
from safeloc.language.world import Law
from safeloc.models.area.slot import Slot
from safeloc.models.vocabulary.absent import margin_if, position_if
from safeloc.models.vocabulary.vehicle_world import stated_interval_holds

REQUIREMENTS = ("FVA-9", "FVA-18")
SENT = "the front end's interval holds it"
"""The clause that the machine before it has to keep."""


class TrainConfig(Config):
    """The train behind the front end."""

    length_mm: int = quantity(200_000, "mm", 1_000, 1_000_000, "[D] passenger train of eight coaches")
    length_tolerance_mm: int = quantity(1_000, "mm", 0, 50_000, "[D] couplers and train data")


@dataclass(frozen=True, eq=False)
class FrontEnd:
    """The front end of the train, as other machines have it: top speed over a cycle (nm), the line's end (mm), the place (ghost)."""

    most_nm: int
    limit_mm: int
    margin_mm: int
    truth: NumVar


class Parts:
    """The variables of the machine.

    valid, position, below, above  inputs: the front end's interval, as it is passed on
    train_whole      input: integrity monitoring confirms the train in this cycle
    upwards          the front end faces growing positions: fixed
    told, ...        the far end's interval
    truth, far_end       ghosts: front end and far end, nm
    train            ghosts of the area: the same train's rear and front along the line, um
    """

    def __init__(self, config: TrainConfig, world: FrontEnd, train: Slot) -> None:
        self.declared = declared = Declared()
        limit, widest = world.limit_mm, world.margin_mm
        wider, reach = widest + config.length_tolerance_mm, limit * NM_PER_MM
        self.config, self.world, self.train = config, world, train
        self.valid = declared.sensor(boolean("front_valid"))
        self.position = declared.sensor(number("front_position_mm", MM, -limit, limit))
        self.below = declared.sensor(number("front_margin_below_mm", MM, 0, widest))
        self.above = declared.sensor(number("front_margin_above_mm", MM, 0, widest))
        self.train_whole = declared.sensor(boolean("train_whole"))
        self.upwards = declared.state(boolean("faces_upwards"), first=ANY)
        self.far_position = declared.state(number("far_position_mm", MM, -limit, limit), first=0)
        self.far_margin_below = declared.state(number("far_margin_below_mm", MM, 0, wider), first=0)
        self.far_margin_above = declared.state(number("far_margin_above_mm", MM, 0, wider), first=0)
        declared.ghost(world.truth, first=ANY)
        self.far_end = declared.ghost(number("far_end_nm", NM, -reach, reach), first=ANY)
        declared.ghost(train.true_rear, first=ANY)
        declared.ghost(train.true_front, first=ANY)
        self.next_truth = declared.choice(number("next_truth_nm", NM, -reach, reach))
        self.next_far_end = declared.choice(number("next_far_end_nm", NM, -reach, reach))


TrainEnds = Model[Parts]


def parts(config: TrainConfig, world: FrontEnd, train: Slot) -> Parts:
    """Return fresh variables; the train's ghosts are those of its slot in the area."""
    return Parts(config, world, train)


def build(own: Parts) -> TrainEnds:
    """Build the machine over the given variables."""
    table = modes("NOTHING", "FRONT_ONLY", "BOTH")
    current = current_mode(table)
    both, train = current.eq(table[2]), own.train
    rear, front = _along_the_line(own.world.truth, own.far_end)
    next_rear, next_front = _along_the_line(own.next_truth, own.next_far_end)
    machine = own.declared.machine(
        name="ends",
        modes=table,
        outputs={
            "valid": both,
            "position_mm": position_if(both, own.far_position),
            "margin_below_mm": margin_if(both, own.far_margin_below),
            "margin_above_mm": margin_if(both, own.far_margin_above),
            "faces_upwards": own.upwards,
        },
        transitions=list(_table(own, table)),
        world=own.declared.world(
            moves={
                own.world.truth: own.next_truth,
                own.far_end: own.next_far_end,
                train.true_rear: next_rear,
                train.true_front: next_front,
            },
            clauses=_clauses(own),
        ),
        initially=_behind(own, own.world.truth, own.far_end) & train.true_rear.eq(rear) & train.true_front.eq(front),
        lemmas={
            "the far end is inside": both.implies(
                stated_interval_holds(own.far_position, own.far_margin_below, own.far_margin_above, own.far_end)
            ),
            "the far end is behind": _behind(own, own.world.truth, own.far_end),
            "the train lies between its ends": train.true_rear.eq(rear) & train.true_front.eq(front),
        },
        doc=(
            "Where the train's far end is, a length behind its front end. Assumed: a train that is confirmed to be whole has "
            "its length within the tolerance; nothing of it is ahead of the front end, and no part runs faster than the "
            "line's top speed."
        ),
    )  # fmt: skip
    return TrainEnds(machine, own)


def _table(own: Parts, table: tuple[Lit, ...]) -> Iterator[Transition]:
    nothing, front_only, both = table
    length, limit = own.config.length_mm, own.world.limit_mm
    far, wider = own.position + ite(own.upwards, as_num(-length, MM), length), own.config.length_tolerance_mm
    set_both: dict[Var, Expr] = {
        own.far_position: far, own.far_margin_below: own.below + wider, own.far_margin_above: own.above + wider
    }  # fmt: skip
    cleared: dict[Var, Expr] = {var: as_num(0, MM) for var in set_both}
    known = own.valid & own.train_whole & between(-limit, far, limit)
    yield Transition("both ends known", table, both, known, set_both, REQUIREMENTS, 0)
    yield Transition("front end known", table, front_only, own.valid, cleared, REQUIREMENTS, 1)
    yield Transition("nothing known", table, nothing, TRUE, cleared, REQUIREMENTS, 2)


# ------------------------------------------------------------------ the environment


def _along_the_line(front: Num, far: Num) -> tuple[Num, Num]:
    """Rear and front along the line, um, rounded outward; nm are the localizer's."""
    low, high = minimum(front, far), maximum(front, far)
    return floor_to(low, UM), ceil_to(high, UM)


def _behind(own: Parts, front: Num, far: Num) -> Bool:
    """The far end is not ahead of the front end."""
    return (own.upwards & (far <= front)) | (~own.upwards & (front <= far))


def _clauses(own: Parts) -> dict[str, Law]:
    most = own.world.most_nm
    length, slack = own.config.length_mm * NM_PER_MM, own.config.length_tolerance_mm * NM_PER_MM
    extent = ite(own.upwards, own.next_truth - own.next_far_end, own.next_far_end - own.next_truth)
    return {
        "the far end lies behind the near one": Law(
            extent >= 0,
            "Nothing of the train is ahead of its front end; it faces the same way all the time.",
            source="[D] the localizer locates the front end",
            owner="operator",
            check="train data entry: which end is the front",
        ),
        "a complete train has its length": Law(
            own.train_whole.implies(between(length - slack, extent, length + slack)),
            "A train that integrity monitoring confirms as whole is as long as its data say, within their tolerance.",
            ("length_mm", "length_tolerance_mm"),
            "[D] passenger train of eight coaches; couplers and train data",
            "operator",
            "train data entry; on-board integrity monitoring",
        ),
        "the far end never exceeds the highest speed": Law(
            between(-most, own.next_far_end - own.far_end, most),
            "No part of the train runs faster than the line's highest speed.",
            source="[D] line speed",
            owner="operator",
            check="speed supervision",
        ),
        SENT: Law(
            _sent_truly(own),
            "The interval of the front end that is passed on as valid holds the true front end.",
            source="[D] containment of the localizer, whose own proof it is",
            owner="supplier",
            check="replayed recordings with a known true position",
        ),
    }


def _sent_truly(own: Parts) -> Bool:
    return own.valid.implies(stated_interval_holds(own.position, own.below, own.above, own.next_truth))
