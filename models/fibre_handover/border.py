"""The border between two areas: the record that goes over with a train, or is lost (FVA-D1).

Both areas see a shared stretch of line around their border. The train runs from the giving area into the taking one: upwards, or
downwards if the giving area lies above. The direction is taken over until the record is sent, and kept until the train is gone.

    BEFORE   the train has not come to the shared stretch, as far as is known
    OFFERED  it has: its record is sent in every cycle in which the giving area trusts it, until it arrives
    TAKEN    the record arrived
    LOST     the record did not arrive in time, or the giving area found a mismatch before it did
"""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import (
    FALSE,
    TRUE,
    Bool,
    Lit,
    NumVar,
    boolean,
    choice,
    enumeration,
    ite,
    number,
)
from safeloc.language.machine import ANY, Model, Transition, current_mode, modes
from safeloc.language.rows import Updates
from safeloc.language.units import COUNT, MM
from safeloc.models.verification.variables import FROM, NEIGHBOUR, NOBODY

REQUIREMENTS = ("FVA-D1", "FVA-2", "FVA-11")


class BorderConfig(Config):
    """Limits of the hand-over."""

    wait_cycles: int = quantity(6, "cycles", 1, 10_000, "[D] 3 s; the shared stretch is longer than the run in them")
    position_limit_mm: int = quantity(1_000_000_000, "mm", 1_000, 10_000_000_000, "[D] 1 000 km of line")


class Parts:
    """The variables of the machine.

    shared_from, shared_to     the shared stretch: fixed, any two places
    giving_trusts, giving_distrusts, low, high  the giving area's verification: trusted, a mismatch; bounds of the front
    train_runs_down  the train runs downwards, so the giving area lies above the taking one
    arrives          the record that is sent arrives in this cycle
    gone             the train has left the giving area, or is given up there
    runs_down        the direction of the hand-over: as told last before the record was sent
    sent_cycles           cycles since the record was first sent
    due, source, sound  messages to the taking area's verification
    """

    def __init__(self, config: BorderConfig, far_mm: int) -> None:
        self.declared = declared = Declared()
        self.giving_trusts = declared.sensor(boolean("giving_trusts"))
        self.giving_distrusts = declared.sensor(boolean("giving_distrusts"))
        self.low = declared.sensor(number("front_low_mm", MM, -far_mm, far_mm))
        self.high = declared.sensor(number("front_high_mm", MM, -far_mm, far_mm))
        self.train_runs_down = declared.sensor(boolean("train_runs_down"))
        self.arrives = declared.sensor(boolean("record_arrives"))
        self.gone = declared.sensor(boolean("train_gone"))
        self.shared_from = declared.state(number("shared_from_mm", MM, -far_mm, far_mm), first=ANY)
        self.shared_to = declared.state(number("shared_to_mm", MM, -far_mm, far_mm), first=ANY)
        self.runs_down = declared.state(boolean("runs_down"), first=False)
        self.sent_cycles = declared.state(number("sent_cycles", COUNT, 0, config.wait_cycles), first=0)
        self.due = declared.state(boolean("due"), first=False)
        self.source = declared.state(choice("from", enumeration(FROM)), first=NOBODY)
        self.sound = declared.state(boolean("record_sound"), first=False)

    def down(self, is_before: Bool) -> Bool:
        """Return the direction: as told in this cycle before the record is sent, and as kept from then on."""
        return ite(is_before, self.train_runs_down, self.runs_down)

    def here(self, down: Bool) -> Bool:
        """Return the condition that the giving area trusts the train, and that it may have come to the shared stretch."""
        return self.giving_trusts & ite(down, self.low <= self.shared_to, self.high >= self.shared_from)

    def table(self, modes_: tuple[Lit, ...], current: NumVar) -> Iterator[Transition]:
        """Yield all rows."""
        before, offered, taken, lost = modes_
        down = self.down(current.eq(before))
        here = self.here(down)
        way: Updates = {self.runs_down: down}
        longer = ite(self.sent_cycles < self.sent_cycles.high, self.sent_cycles + 1, self.sent_cycles)
        quiet: Updates = {self.due: FALSE, self.source: NOBODY, self.sound: FALSE, self.sent_cycles: 0, **way}
        over: Updates = {self.due: TRUE, self.source: NEIGHBOUR, self.sound: TRUE, self.sent_cycles: 0, **way}
        missing: Updates = {self.due: TRUE, self.source: NOBODY, self.sound: FALSE, self.sent_cycles: 0, **way}
        sent: Updates = {self.due: FALSE, self.source: NOBODY, self.sound: FALSE, self.sent_cycles: longer, **way}
        late = self.sent_cycles >= self.sent_cycles.high
        yield Transition("train is gone", modes_, before, self.gone, quiet, REQUIREMENTS, 0)
        yield Transition("record arrives", (before, offered), taken, here & self.arrives, over, REQUIREMENTS, 1)
        yield Transition(
            "trust lost on the way",
            offered,
            lost,
            self.giving_distrusts & ~self.giving_trusts,
            missing,
            REQUIREMENTS,
            1,
        )
        yield Transition("record lost on the way", offered, lost, late, missing, REQUIREMENTS, 2)
        yield Transition("record is sent", before, offered, here, sent, REQUIREMENTS, 3)
        yield Transition("record is sent again", offered, offered, TRUE, sent, REQUIREMENTS, 3)
        for mode, name in ((before, "not there yet"), (taken, "taken over"), (lost, "hand-over is lost")):
            yield Transition(name, mode, mode, TRUE, quiet, REQUIREMENTS, 4)


Border = Model[Parts]


def parts(config: BorderConfig, far_mm: int) -> Parts:
    """Return fresh variables for one train, on a line within `far_mm` to either side."""
    return Parts(config, far_mm)


def build(own: Parts) -> Border:
    """Return the machine over the given variables."""
    table = modes("BEFORE", "OFFERED", "TAKEN", "LOST")
    current = current_mode(table)
    machine = own.declared.machine(
        name="border",
        modes=table,
        outputs={
            "reference_due": own.due,
            "reference_from": own.source,
            "reference_sound": own.sound,
            "handover_lost": current.eq(table[3]),
            "sent_cycles_ago": own.sent_cycles,
        },
        transitions=list(own.table(table, current)),
        initially=own.shared_from <= own.shared_to,
        lemmas={"the shared stretch is in order": own.shared_from <= own.shared_to},
        doc="Hand-over of a train's record, in either direction, between two neighbouring areas that share a stretch of line.",
    )
    return Border(machine, own)
