"""Two axle counters and the machines that hear them, as the claims on them read them after a step."""

from __future__ import annotations

from functools import cached_property

from safeloc.language.expr import Bool, Num, all_of, any_of, as_num, ite
from safeloc.language.spec import earlier_bool, earlier_num
from safeloc.language.units import COUNT
from safeloc.models.fibre_area import FibreArea


class Counted:
    """The machines that hear the counters, after a step."""

    def __init__(self, model: FibreArea) -> None:
        self.model, of = model, model.composition.of
        self.heads, self.entry = of(model.axle_section.machine), of(model.entry.machine)
        self.order, self.area = of(model.order.machine), of(model.area.machine)

    @cached_property
    def counting(self) -> Bool:
        """The section between the counters is clear, or occupied by axles that were counted in."""
        machine = self.model.axle_section.machine
        return self.heads.num(machine.mode).one_of(*machine.modes[1:3])

    @cached_property
    def is_clear(self) -> Bool:
        """The section between the counters is clear."""
        machine = self.model.axle_section.machine
        return self.heads.num(machine.mode).eq(machine.modes[1])

    @cached_property
    def is_ordered(self) -> Bool:
        """The order of trains is known."""
        machine = self.model.order.machine
        return self.order.num(machine.mode).eq(machine.modes[1])

    @cached_property
    def was_ordered(self) -> Bool:
        """The order of trains was known before the step."""
        return earlier_bool(self.is_ordered)

    @cached_property
    def was_outermost(self) -> tuple[Num, Num]:
        """Numbers of the trains that were nearest to either end before the step; 0: none is known."""
        ranks = [self.order.num(one) for one in self.model.order.own.order]
        last = as_num(0, COUNT)
        for rank in ranks:
            last = ite(rank > 0, rank, last)
        none = as_num(0, COUNT)
        low, high = (ite(self.was_ordered, earlier_num(rank), none) for rank in (ranks[0], last))
        return low, high

    @cached_property
    def of_nobody(self) -> Bool:
        """Axles are counted in of no train that was known: none was, and none comes into an area of which the order was known; or none where an axle comes in."""
        nobody = all_of(last < 1 for last in self.was_outermost)
        heads, comes = self.model.axle_section.own.into, self.model.entry.own.enters
        at_an_end = any_of(
            (self.heads.num(into) > 0) & (last < 1) & (self.entry.num(one) < 1)
            for last, into, one in zip(self.was_outermost, heads, comes, strict=True)
        )
        return self.counting & ~self.is_clear & ((nobody & ~(self.anyone_enters & self.was_ordered)) | at_an_end)

    @cached_property
    def more(self) -> Bool:
        """Axles came in beside this train that are not its own."""
        return self.entry.bool(self.model.entry.own.of_others)

    @cached_property
    def believed(self) -> Bool:
        """The section between the counters is clear, or occupied by axles of trains that are known."""
        return self.counting & ~self.entry.bool(self.model.entry.own.unannounced)

    @cached_property
    def is_listed(self) -> Bool:
        """This train is in the known order of trains."""
        return self.is_ordered & any_of(self.order.num(one).eq(1) for one in self.model.order.own.order)

    @cached_property
    def anyone_enters(self) -> Bool:
        """A train comes in, at either end."""
        low, high = (self.entry.num(one) for one in self.model.entry.own.enters)
        return low + high > 0

    @cached_property
    def enters(self) -> Bool:
        """This train comes in, at either end."""
        return any_of(self.entry.num(one).eq(1) for one in self.model.entry.own.enters)

    @cached_property
    def surplus(self) -> Num:
        """Axles of this train that went out in the step, less those that came in, by the heads at both ends."""
        own, total = self.model.axle_section.own, as_num(0, COUNT)
        ends = zip(self.was_outermost, self.model.entry.own.enters, own.into, own.out, strict=True)
        for last, comes, into, out in ends:
            here = (self.entry.num(comes) < 1) & last.eq(1) | self.entry.num(comes).eq(1)
            total = total + ite(here, self.heads.num(out) - self.heads.num(into), 0)
        return total

    @cached_property
    def all_left(self) -> Bool:
        """All of this train has left."""
        return self.entry.bool(self.model.entry.own.left)
