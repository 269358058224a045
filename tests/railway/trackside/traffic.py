"""Trains, and a vehicle that nobody reports, run through the area; what their reports meet on the way is drawn at random."""

from __future__ import annotations

import heapq
import json
import random
from collections.abc import Iterator
from dataclasses import dataclass, field

from tests.railway.trackside.areas import (
    CLOCK_ERROR_MS,
    END_MM,
    LENGTHS_MM,
    PERIOD_MS,
    SECTION_MM,
    Data,
    Process,
    clear,
    report,
)

TICK_MS, ERROR_MM, OUTSIDE_MM = 100, 3_000, 1_000_000
TOP_MM_S = 44_000
TROUBLES = ("late", "lost", "twice", "foreign", "damaged", "shifted", "bare")


@dataclass
class Train:
    """A train that runs upwards: its leading end, and the parts that it is made of now, rear and front, the last one first."""

    name: str
    front_mm: int
    length_mm: int
    speed_mm_s: int
    reports: bool = True
    offset_ms: int = 0
    lost: tuple[int, int] | None = None

    @property
    def parts(self) -> list[tuple[int, int]]:
        """Where it is."""
        return [*([] if self.lost is None else [self.lost]), (self.front_mm - self.length_mm, self.front_mm)]

    @property
    def rear_mm(self) -> int:
        """The end of its last part."""
        return min(low for low, _ in self.parts)


@dataclass
class Drive:
    """A drive; `upwards`: towards growing places, else the same in a mirror.

    troubles  what may happen to a report, each to so many in a hundred
    wrong     reports of clear sections with a vehicle in them
    """

    process: Process
    seed: int
    upwards: bool = True
    troubles: tuple[str, ...] = TROUBLES
    per_cent: int = 25
    kills: bool = True
    parts: bool = True
    wrong: list[str] = field(default_factory=list)
    clear_told: int = 0
    admitted: int = 0

    def run(self, cycles: int) -> None:
        """Run so many cycles of the area."""
        self._random = draw = random.Random(self.seed)
        self._trains = self._made(draw)
        self._way: list[tuple[int, int, str, bytes]] = []
        self._count = 0
        places = {0: [list(one.parts) for one in self._trains]}
        for cycle in range(1, cycles + 1):
            outside = [True, True]
            for tick in range((cycle - 1) * PERIOD_MS + TICK_MS, cycle * PERIOD_MS + 1, TICK_MS):
                self._move(cycle)
                places[tick] = [list(one.parts) for one in self._trains]
                outside = [
                    was and free
                    for was, free in zip(
                        outside, (self._free(-OUTSIDE_MM, 0), self._free(END_MM, END_MM + OUTSIDE_MM)), strict=True
                    )
                ]
                self._report(tick)
                self._deliver(tick)
            self._judge(self._detected(cycle, outside), places)
            if self.kills and draw.random() < 0.05:
                self._judge(self.process.move(), places)
            elif draw.random() < 0.3:
                self.process.save()

    # ------------------------------------------------------------------ what is true

    def _made(self, draw: random.Random) -> list[Train]:
        gap = draw.randint(5_000, 400_000)
        first = Train("a", -draw.randint(10_000, 60_000), LENGTHS_MM["a"], draw.randint(5_000, TOP_MM_S))
        loose = Train("?", first.rear_mm - draw.randint(1_000, 60_000), 6_000, TOP_MM_S, reports=False)
        behind = loose if draw.random() < 0.5 else first
        second = Train("b", behind.rear_mm - gap, LENGTHS_MM["b"], TOP_MM_S)
        trains = [first, *([loose] if behind is loose else []), second]
        for one in trains:
            one.offset_ms = draw.randint(-CLOCK_ERROR_MS, CLOCK_ERROR_MS)
        self._parts_at = draw.randint(5, 60) if self.parts and draw.random() < 0.5 else 0
        return trains

    def _move(self, cycle: int) -> None:
        draw = self._random
        ahead: int | None = None
        for one in self._trains:
            if draw.random() < 0.02:
                one.speed_mm_s = draw.choice((0, 3_000, 15_000, 30_000, TOP_MM_S, TOP_MM_S, -4_000))
            run = one.speed_mm_s * TICK_MS // 1_000
            front = one.front_mm + run
            if ahead is not None:
                front = min(front, ahead - 500)
            behind = [other for other in self._trains if other.front_mm < one.rear_mm]
            if run < 0 and behind and front - one.length_mm < max(other.front_mm for other in behind) + 6_000:
                front = one.front_mm
            one.front_mm = max(one.front_mm - TOP_MM_S * TICK_MS // 1_000, front) if front < one.front_mm else front
            ahead = one.rear_mm
        first = self._trains[0]
        if self._parts_at and cycle == self._parts_at and first.lost is None:
            lost = first.length_mm // 2
            first.lost = (first.front_mm - first.length_mm, first.front_mm - first.length_mm + lost)
            first.length_mm -= lost
        if first.lost is not None and first.front_mm - first.length_mm < first.lost[1]:
            first.front_mm = first.lost[1] + first.length_mm

    def _free(self, low_mm: int, high_mm: int) -> bool:
        return not any(low <= high_mm and high >= low_mm for one in self._trains for low, high in one.parts)

    # ------------------------------------------------------------------ what is told

    def _report(self, tick: int) -> None:
        draw = self._random
        for one in self._trains:
            if not one.reports:
                continue
            low, high = one.front_mm - draw.randint(0, ERROR_MM), one.front_mm + draw.randint(0, ERROR_MM)
            if not self.upwards:
                low, high = END_MM - high, END_MM - low
            said = report(one.name, tick + 10_000_000 + one.offset_ms, low, high, whole=one.lost is None)
            trouble = draw.choice(self.troubles) if self.troubles and draw.randint(1, 100) <= self.per_cent else ""
            self._send(tick, one.name, said, trouble)

    def _send(self, tick: int, name: str, said: bytes, trouble: str) -> None:
        draw = self._random
        at = tick + draw.randint(10, 90)
        if trouble == "lost":
            return
        if trouble == "late":
            at += draw.randint(100, 6_000)
        if trouble == "twice":
            self._put(at + draw.randint(0, 6_000), name, said)
        if trouble == "foreign":
            name = draw.choice(["a", "b", "c", "nobody"])
        if trouble == "damaged":
            place = draw.randrange(len(said))
            said = said[:place] + bytes([said[place] ^ 1 << draw.randrange(8)]) + said[place + draw.randint(1, 4) :]
        if trouble == "shifted":
            fields = json.loads(said)
            fields["interval_mm"] = [one + draw.choice((-40_000, 40_000)) for one in fields["interval_mm"][:1] * 2]
            said = json.dumps(fields).encode()
        if trouble == "bare":
            said = said[: said.rindex(b', "code"')] + b"}"
        self._put(at, name, said)

    def _put(self, at: int, name: str, said: bytes) -> None:
        self._count += 1
        heapq.heappush(self._way, (at, self._count, name, said))

    def _deliver(self, tick: int) -> None:
        while self._way and self._way[0][0] <= tick:
            _, _, name, said = heapq.heappop(self._way)
            self.process.hear(name, said)

    def _detected(self, cycle: int, outside: list[bool]) -> list[Data]:
        half = END_MM // 2
        inner = [self._free(0, half), self._free(half + 1, END_MM)]
        if self._random.random() < 0.01:
            return []  # a line of detection is lost
        if not self.upwards:
            outside, inner = outside[::-1], [self._free(half, END_MM), self._free(0, half - 1)]
        return self.process.detect(
            cycle + 10_000_000 // PERIOD_MS,
            counters_clear=self._free(0, END_MM), low_side_clear=outside[0], high_side_clear=outside[1],
            inner_1_clear=inner[0], inner_2_clear=inner[1],
        )  # fmt: skip

    # ------------------------------------------------------------------ what is wrong

    def _judge(self, told: list[Data], places: dict[int, list[list[tuple[int, int]]]]) -> None:
        for one in told:
            assert one.get("event") not in ("failed", "halted"), one
            if "mode" not in one:
                continue
            assert not one.get("assumptions_broken"), one["assumptions_broken"]
            self.admitted += bool(one["trains"])
            there = places.get(one["time_ms"] - 10_000_000, [])
            for section in clear(one):
                self.clear_told += 1
                for low, high in self._stretches(there):
                    if low <= section * SECTION_MM and high >= (section - 1) * SECTION_MM:
                        self.wrong.append(
                            f"seed {self.seed}, {one['time_ms']} ms: section {section} over [{low}, {high}]"
                        )

    def _stretches(self, there: list[list[tuple[int, int]]]) -> Iterator[tuple[int, int]]:
        for parts in there:
            for low, high in parts:
                yield (low, high) if self.upwards else (END_MM - high, END_MM - low)
