"""The trains of an area: which vehicle has which slot of the machine, and what its report says of it in a cycle.

A report counts once, in the first cycle after it came, with its age then; or never. Nothing is held back for a later cycle:
a vehicle whose clock is ahead would seem to be fresh.

A vehicle gets a slot by its own reports. What the machine assumes of that is a matter of their intervals, at the end of the cycle:

    it is in         its leading end is surely beyond the end of the area, or so near that no vehicle fits between; and no farther
                     in than the machine allows for
    it came in here  it was surely outside that end before, so lately that it cannot have come by the other end
    in order         no train was given a slot at this end since it was outside, and detection was undisturbed

A vehicle that misses this stays one that nobody reports, and blocks the area until detection is clear.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Annotated, Any, NamedTuple

from pydantic import BaseModel, ConfigDict, Field

from safeloc.models.area import AreaConfig
from safeloc.railway.trackside.seen import Seen
from safeloc.railway.trackside.wiring import AreaWiring, VehicleWiring

_Count = Annotated[int, Field(ge=0)]
_Ends = tuple[_Count | None, _Count | None]
LOW, HIGH = 0, 1


class SavedTrains(BaseModel):
    """The trains in a snapshot. Reports that were not used yet are not in it: they are lost, as silence is."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    slots: dict[Annotated[str, Field(pattern=r"^[0-9]{1,2}$")], str] = {}
    last: dict[str, _Count] = {}
    outside: dict[str, _Ends] = {}
    admitted: _Ends = (None, None)


class _Now(NamedTuple):
    """A report at the end of a cycle: where end A is, widened by its age."""

    vehicle: str
    wiring: VehicleWiring
    seen: Seen
    age_ms: int
    low_mm: int
    high_mm: int


class Trains:
    """Slots and reports.

    slots  slot (from 1) -> vehicle
    """

    def __init__(
        self, area: AreaWiring, vehicles: Mapping[str, VehicleWiring], config: AreaConfig, clock_error_ms: int,
        shortest_mm: int = 0,
    ) -> None:  # fmt: skip
        self.slots: dict[int, str] = {}
        self._area, self._vehicles, self._config, self._clock_error_ms = area, vehicles, config, clock_error_ms
        self._held: dict[str, Seen] = {}
        self._last: dict[str, int] = {}
        self._outside: dict[str, list[int | None]] = {}
        self._admitted: list[int | None] = [None, None]
        self._telling: list[tuple[int, str, int]] = []
        run_mm = config.reach.cycle_mm + config.max_speed_mm_s * config.entry_report_delay_ms // 1_000
        self._entry_mm, self._shortest_mm = run_mm, shortest_mm

    def hear(self, vehicle: str, seen: Seen, end_ms: int) -> str:
        """Take a report for the cycle that ends then; return why it is not used, or "" if it is."""
        if seen.time_ms <= self._last.get(vehicle, -1):
            return "repeated, or out of order"
        if self._age_ms(seen, end_ms) > self._config.report_age_limit_ms:
            return "too old" if seen.time_ms < end_ms else "ahead of the clock of the area"
        held = self._held.get(vehicle)
        if held is None or held.time_ms < seen.time_ms:
            self._held[vehicle] = seen
        return ""

    def inputs(self, end_ms: int, *, clear: bool) -> dict[str, object]:
        """Return the inputs of all slots in the cycle that ends then. `clear`: detection says that nobody is in the area."""
        now = {one.vehicle: one for one in self._now(end_ms)}
        self._note_outside(now.values(), end_ms)
        found: dict[str, object] = {}
        for slot in range(1, self._config.trains + 1):
            found |= self._of_slot(slot, now.get(self.slots.get(slot, "")))
        if not clear:
            found |= self._admissions(now, end_ms)
        return found

    def skip(self) -> None:
        """Note a cycle without inputs: what was heard for it is not used."""
        self._held.clear()

    def stepped(self, end_ms: int, present: Sequence[bool], *, undisturbed: bool) -> bool:
        """Note what the machine made of the cycle: slots that have a train. Return whether a vehicle got or lost its slot."""
        before = dict(self.slots)
        for slot, vehicle, side in self._telling:
            self.slots[slot] = vehicle
            if present[slot - 1]:
                self._admitted[side] = end_ms
        self._telling = []
        self.slots = {slot: vehicle for slot, vehicle in self.slots.items() if present[slot - 1]}
        if not undisturbed:
            self._outside.clear()  # whoever is in by now may have come in with others, in whatever order
        return self.slots != before

    def begin_anew(self) -> None:
        """Forget everything, as the machine does."""
        self.slots, self._telling = {}, []
        self._held.clear()
        self._outside.clear()

    def freeze(self) -> dict[str, Any]:
        """Return the memory as plain data."""
        return {
            "slots": {str(slot): vehicle for slot, vehicle in self.slots.items()},
            "last": dict(self._last),
            "outside": {vehicle: list(ends) for vehicle, ends in self._outside.items()},
            "admitted": list(self._admitted),
        }

    def restore(self, saved: SavedTrains) -> None:
        """Continue with the memory of a snapshot."""
        self.slots = {int(slot): vehicle for slot, vehicle in saved.slots.items()}
        self._last, self._admitted = dict(saved.last), list(saved.admitted)
        self._outside = {vehicle: list(ends) for vehicle, ends in saved.outside.items()}

    # ------------------------------------------------------------------ reports of a cycle

    def _now(self, end_ms: int) -> Iterator[_Now]:
        """Use up the reports that were heard, as they are at the end of the cycle; those without a place, or too old, say nothing."""
        held, self._held = self._held, {}
        limit = self._config.limit_mm
        for vehicle, seen in held.items():
            age_ms, wiring = self._age_ms(seen, end_ms), self._vehicles[vehicle]
            if age_ms > self._config.report_age_limit_ms:
                continue
            self._last[vehicle] = seen.time_ms
            if seen.low_mm is None or seen.high_mm is None:
                continue
            if -limit <= seen.low_mm - wiring.length_mm and seen.high_mm + wiring.length_mm <= limit:
                run_mm = -(-self._config.max_speed_mm_s * age_ms // 1_000)
                yield _Now(vehicle, wiring, seen, age_ms, seen.low_mm - run_mm, seen.high_mm + run_mm)

    def _age_ms(self, seen: Seen, end_ms: int) -> int:
        """Return the greatest time between the report and the end of the cycle, before or after it."""
        return abs(end_ms - seen.time_ms) + self._clock_error_ms

    def _of_slot(self, slot: int, one: _Now | None) -> dict[str, object]:
        name = f"area.train_{slot}"
        found: dict[str, object] = {
            f"{name}_event": "NONE", f"{name}_report_age_ms": 0, f"{name}_trusted": False, f"{name}_integer": False,
            f"{name}_downwards": False,
        }  # fmt: skip
        if one is None:
            return found
        low, high, back_mm = one.seen.low_mm, one.seen.high_mm, one.wiring.length_mm if one.seen.whole else 0
        assert low is not None
        assert high is not None
        rear, front = (low - back_mm, high) if one.wiring.faces_upwards else (low, high + back_mm)
        return found | {
            f"{name}_event": self._leaves(one), f"{name}_rear_mm": rear, f"{name}_front_mm": front,
            f"{name}_report_age_ms": one.age_ms, f"{name}_trusted": True, f"{name}_integer": one.seen.whole,
            f"{name}_downwards": not one.wiring.faces_upwards,
        }  # fmt: skip

    def _leaves(self, one: _Now) -> str:
        """Return the event of a train that is surely beyond an end with all its vehicles."""
        up, whole, back_mm = one.wiring.faces_upwards, one.seen.whole, one.wiring.length_mm
        highest, lowest = one.high_mm + (0 if up else back_mm), one.low_mm - (back_mm if up else 0)
        if (up or whole) and highest < self._area.low_end_mm:
            return "LEAVES_LOW"
        if (not up or whole) and lowest > self._area.high_end_mm:
            return "LEAVES_HIGH"
        return "NONE"

    # ------------------------------------------------------------------ vehicles that come in

    def _note_outside(self, now: Iterable[_Now], end_ms: int) -> None:
        """Remember when each vehicle was surely outside the end that it would come in by, its leading end first."""
        for one in now:
            ends = self._outside.setdefault(one.vehicle, [None, None])
            if one.wiring.faces_upwards and one.high_mm < self._area.low_end_mm:
                ends[LOW] = end_ms
            if not one.wiring.faces_upwards and one.low_mm > self._area.high_end_mm:
                ends[HIGH] = end_ms

    def _admissions(self, now: Mapping[str, _Now], end_ms: int) -> dict[str, object]:
        """Return the events of vehicles that come in: one for each end and cycle, into slots that are free."""
        found: dict[str, object] = {}
        free = [slot for slot in range(1, self._config.trains + 1) if slot not in self.slots]
        for side, event in ((LOW, "ENTERS_LOW"), (HIGH, "ENTERS_HIGH")):
            coming = [one for one in now.values() if self._comes_in(one, side, end_ms)]
            if coming and free:
                foremost = max(coming, key=lambda one: one.high_mm if one.wiring.faces_upwards else -one.low_mm)
                slot = free.pop(0)
                found |= {**self._of_slot(slot, foremost), f"area.train_{slot}_event": event}
                self._telling.append((slot, foremost.vehicle, side))
        return found

    def _comes_in(self, one: _Now, side: int, end_ms: int) -> bool:
        area, entry_mm, shortest_mm = self._area, self._entry_mm, self._shortest_mm
        if one.vehicle in self.slots.values() or one.wiring.faces_upwards is not (side == LOW):
            return False
        if side == LOW:
            is_in = area.low_end_mm - shortest_mm <= one.low_mm and one.high_mm <= area.low_end_mm + entry_mm
        else:
            is_in = one.high_mm <= area.high_end_mm + shortest_mm and area.high_end_mm - entry_mm <= one.low_mm
        outside_ms = self._outside.get(one.vehicle, [None, None])[side]
        if not is_in or outside_ms is None:
            return False
        others = self._admitted[side]
        came_here = (end_ms - outside_ms) * self._config.max_speed_mm_s < (area.high_end_mm - area.low_end_mm) * 1_000
        return came_here and (others is None or others <= outside_ms)
