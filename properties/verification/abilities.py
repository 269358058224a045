"""A train's abilities between two readings, in figures of their own: brakes, traction, speed (FVA-6, FVA-7)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, partial

from safeloc.language.expr import Bool, Lit, Num, before, between, exact_to, ite, maximum, minimum, was, with_unit
from safeloc.language.spec import Property, always
from safeloc.language.units import MM_S2, NM, UM_S
from safeloc.models.verification import Verification
from safeloc.models.verification.variables import Parts

REQUIREMENTS = ("FVA-6", "FVA-15", "FVA-7", "FVA-16")
for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)


@dataclass(frozen=True, eq=False)
class Abilities:
    """Terms over the inputs of a cycle and the state before it, in um/s. A brake of 1 mm/s2 changes the speed by 1 um/s per ms."""

    own: Parts

    @cached_property
    def _brake(self) -> Num:
        """Configured braking ability, or the weaker one that train control reports."""
        told, most = self.own.control_brake, self.own.config.brake_mm_s2
        weaker = told.present & (told.value < most)
        return self._in_a_cycle(ite(weaker, told.value, Lit(most, MM_S2)))

    @cached_property
    def _traction(self) -> Num:
        return self._in_a_cycle(Lit(self.own.config.traction_mm_s2, MM_S2))

    def _in_a_cycle(self, ability: Num) -> Num:
        return with_unit(ability * self.own.config.period_ms, UM_S)

    @cached_property
    def last(self) -> Num:
        """The last speed reading, um/s."""
        return with_unit(before(self.own.last_speed) * 1_000, UM_S)

    @cached_property
    def changes(self) -> tuple[Num, Num]:
        """Greatest decrease and increase of the speed in the cycle, um/s; the direction of running may be uncertain."""
        slower, faster = before(self.own.slower_by), before(self.own.faster_by)
        both = maximum(self._traction, self._brake)
        up, down = self.last >= both + slower, self.last + both <= -faster
        less = ite(up, self._brake, ite(down, self._traction, both))
        more = ite(up, self._traction, ite(down, self._brake, both))
        return less, more

    @cached_property
    def since_last(self) -> tuple[Num, Num]:
        """Greatest decrease and increase of the speed since the last reading, after the cycle, um/s."""
        less, more = self.changes
        return less + before(self.own.slower_by), more + before(self.own.faster_by)

    def exceeded_by(self, speed: Num) -> Bool:
        """Return the condition that the train cannot have this speed, even if both readings are off by all of their tolerance."""
        less, more = self.since_last
        gain = with_unit((speed - before(self.own.last_speed)) * 1_000, UM_S)
        slack = 2_000 * self.own.config.speed_tolerance_mm_s
        return (gain + slack < -less) | (gain - slack > more)

    @cached_property
    def run_nm(self) -> Num:
        """Greatest run of the cycle, nm: um/s times ms."""
        own, (less, more) = self.own, self.since_last
        fastest, slack = own.config.max_speed_mm_s * 1_000, own.config.speed_tolerance_mm_s * 1_000
        known = minimum(maximum(more + self.last, less - self.last) + slack, fastest)
        speed = ite(was(own.speed_known), known, Lit(fastest, UM_S))
        return with_unit(speed * own.config.period_ms, NM)


def properties(model: Verification) -> Iterator[Property]:
    """Yield the properties of the stored course: it grows by the train's abilities, and begins anew with a reading."""
    yield from _speed_bounds(model)
    yield from _reach(model)
    yield from _last_readings(model)


def _speed_bounds(model: Verification) -> Iterator[Property]:
    machine, own = model.machine, model.own
    _, withheld, trusted, _ = machine.modes
    follows = before(machine.mode).one_of(withheld, trusted) & machine.mode.one_of(withheld, trusted)
    less, more = Abilities(own).changes
    seen, cap = own.associated & own.fibre_speed.present, own.slower_by.high
    slower, faster = minimum(before(own.slower_by) + less, cap), minimum(before(own.faster_by) + more, cap)
    yield for_all_inputs(
        "speed is bounded by the train's abilities",
        follows.implies(own.slower_by.eq(ite(seen, 0, slower)) & own.faster_by.eq(ite(seen, 0, faster))),
        statement="without a speed reading its bounds grow by brake and traction, by the brakes that train control reports "
        "if it does; with a reading they begin anew",
    )


def _reach(model: Verification) -> Iterator[Property]:
    machine, own = model.machine, model.own
    _, withheld, trusted, _ = machine.modes
    follows = before(machine.mode).one_of(withheld, trusted) & machine.mode.one_of(withheld, trusted)
    placed = own.associated & own.located & own.fibre_position.present
    grown = exact_to(own.reach_since - before(own.reach_since), NM) - Abilities(own).run_nm
    widened = between(0, grown, Lit(999_999, NM)) | own.reach_since.eq(own.reach_since.high)
    yield for_all_inputs(
        "reach grows by the fastest run",
        follows.implies(ite(placed, own.reach_since.eq(0), widened)),
        statement="without a place the possible distance of the front grows by the run of the cycle at its greatest speed, "
        "rounded up to a millimetre",
    )


def _last_readings(model: Verification) -> Iterator[Property]:
    machine, own = model.machine, model.own
    _, withheld, trusted, _ = machine.modes
    follows = before(machine.mode).one_of(withheld, trusted) & machine.mode.one_of(withheld, trusted)
    seen = own.associated & own.fibre_speed.present
    placed = own.associated & own.located & own.fibre_position.present
    last = [
        (own.associated & own.fibre_length.present, own.last_length, own.fibre_length, own.length_known),
        (seen, own.last_speed, own.fibre_speed, own.speed_known),
        (placed, own.last_place, own.fibre_position, own.place_known),
    ]
    for given, kept, told, known in last:
        yield for_all_inputs(
            f"{kept.name} is the last reading",
            follows.implies(ite(given, kept.eq(told.value) & known, kept.eq(before(kept)) & known.iff(was(known)))),
            statement="later readings are compared with the last reading of the train's own pattern",
        )
