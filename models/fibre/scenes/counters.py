"""The axle counters at an area's ends in a scene: entries, exits, and the records of trains that passed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

from safeloc.codegen.compiled import Compiled, compile_system
from safeloc.errors import InputError
from safeloc.language.nodes import Value
from safeloc.language.system import lower, without_ghosts
from safeloc.language.units import MM_PER_M, UM_PER_MM
from safeloc.models.axle_counter import AxleCounterConfig, machine
from safeloc.models.axle_counter.simulate import Passage, passed
from safeloc.simulation.fibre.trains import Train

_BEYOND_MM = 60_000
_AXLES = AxleCounterConfig()


@dataclass(frozen=True)
class Ends:
    """Places of the counters at the low and at the high end of an area, mm."""

    low_mm: int
    high_mm: int


@dataclass(frozen=True)
class Record:
    """The counter's record of a train that has passed: axles, and bounds of length (mm), speed (mm/s) and run since
    the first axle (mm), with the time from the first axle to the record.
    """

    axles: int
    length_mm: tuple[int, int]
    speed_mm_s: tuple[int, int]
    run_mm: tuple[int, int]
    after_ms: int


def record_of(train: Train, *, miscounted: int = 0) -> Record:
    """Return the record that the axle counter's machine makes at the train's first speed; `miscounted`: axles counted too many.

    InputError for a train of which the machine makes no record.
    """
    behind = [round(MM_PER_M * place) for place in train.axles_m()]
    speed = round(MM_PER_M * train.course.speeds[0][1])
    cycles = (behind[-1] - behind[0] + _BEYOND_MM) * MM_PER_M // (speed * _AXLES.period_ms)
    steps = passed(_AXLES, [Passage(tuple(place - behind[0] for place in behind), (speed,) * cycles)])
    code = _on_board()
    state, since_first = code.first(), 0
    for step in steps:
        state, _ = code.step(state, code.read({name: cell for name, cell in step.items() if "true" not in name}))
        outputs = code.named_outputs(state)
        since_first += bool(since_first) or step["axle"] != "NONE"
        if outputs["record_ready"] and outputs["record_sound"]:
            return _record(outputs, miscounted, (since_first - 1) * _AXLES.period_ms)
    raise InputError(f"a train of {train.length_m:.0f} m at {speed} mm/s gives no record at an axle counter.")


def _record(outputs: dict[str, Value], miscounted: int, after_ms: int) -> Record:
    def bounds(name: str) -> tuple[int, int]:
        return outputs[f"{name}_low_um"] // UM_PER_MM, -(-outputs[f"{name}_high_um"] // UM_PER_MM)

    speeds = (outputs["record_speed_low_mm_s"], outputs["record_speed_high_mm_s"])
    return Record(outputs["record_axles"] + miscounted, bounds("record_length"), speeds, bounds("record_run"), after_ms)


Stretch = tuple[float, float]


def events(ends: Ends, places: Sequence[Stretch]) -> list[str]:
    """Return the counters' events of a train, from its ends in each moment, m: the front enters, the rear has left."""
    made, inside, before = list[str](), False, places[0]
    for now in places:
        event = _event(ends, before, now, inside)
        inside = event.startswith("ENTERS") or (inside and event == "NONE")
        made.append(event)
        before = now
    return made


def _event(ends: Ends, before: Stretch, now: Stretch, inside: bool) -> str:
    low, high = ends.low_mm / MM_PER_M, ends.high_mm / MM_PER_M
    if inside:
        return "LEAVES_HIGH" if now[0] > high else "LEAVES_LOW" if now[1] < low else "NONE"
    if before[1] <= low < now[1]:
        return "ENTERS_LOW"
    return "ENTERS_HIGH" if now[0] < high <= before[0] else "NONE"


@cache
def _on_board() -> Compiled:
    """Return the counter without its world, compiled once."""
    return compile_system(without_ghosts(lower(machine(_AXLES))))
