"""Simulated stays of a train in an area with all its sensors, as steps of the whole device.

Train, detector and emitter are those of `models.fibre_area.simulate`; the counting heads hear the axles of that train, and the light runs to
its ends and back. No record is written: the counters make it.

`python -m safeloc.models.fibre_device.simulate` writes the recordings that ship.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from random import Random

from safeloc.language.nodes import Value
from safeloc.models.fibre_area.simulate import REMARK, Journey, World, first_state, simulated_ends
from safeloc.models.fibre_area.simulated_counters import sweep
from safeloc.models.fibre_device.configuration import FibreDeviceConfig
from safeloc.models.fibre_device.simulated_heads import Head
from safeloc.models.fibre_timed.simulate import Timed, flight_cells
from safeloc.runtime.streams.steps import Cell, write_steps
from safeloc.simulated import SimulatedRun

Steps = list[dict[str, Cell]]
CONFIG = FibreDeviceConfig()
FOLDER = Path(__file__).with_name("recordings")
_AFTER_THE_SWEEP = 62
"A train comes in this many cycles after the counters are clear: at the headway after the trolley."
_LONG_MM = (0, 3_000_000)
_ENDS = ("front", "rear")
_OF_THE_END = {"amplitude_cdb": "additional", "true_run_nm": "course"}
"""Inputs of the machine of an end that come from the machine before it."""
_WIRED = (
    "axle_section.axles_", "axle_section.true_axles_", "axle_section.head_", "entry.enters_", "entry.reference_", "entry.record_",
    "entry.axles_of_one", "verification.record_",
)  # fmt: skip
"""Inputs of the area that the machines before it tell, by how their names begin."""
NOBODY: Mapping[str, Cell] = {
    "neighbour_sends": False, "neighbour_sound": False, "neighbour_axles": 0, "neighbour_length_low_mm": 0, "neighbour_length_high_mm": 0,
    "neighbour_speed_low_mm_s": 0, "neighbour_speed_high_mm_s": 0, "neighbour_place_low_mm": 0, "neighbour_place_high_mm": 0,
    "neighbour_age_cycles": 0,
}  # fmt: skip


@dataclass(frozen=True)
class Stay:
    """A journey, and what its sensors tell besides.

    told      of the time of flight
    spoilt    cycle of the journey -> inputs that are others in it; None: the input does not come
    """

    journey: Journey
    told: Timed = Timed()
    spoilt: Mapping[int, Mapping[str, Cell | None]] = field(default_factory=dict)


def simulate(config: FibreDeviceConfig, *, seed: int, journey: Journey | None = None) -> SimulatedRun:
    """Return one stay, with its first state."""
    journey = journey or SERVICE
    return SimulatedRun(simulate_stay(config, Stay(journey), seed=seed), first_values(config, journey))


def simulate_stay(config: FibreDeviceConfig, stay: Stay, *, seed: int) -> Steps:
    """Return the steps of one stay, with the front's true place as the remark `truth_mm`."""
    made = _Sensed(config, stay, seed)
    ends = simulated_ends(config.area, stay.journey, seed)
    begins = -len(sweep(config.area.axle_section))
    return [made.step(cycle, front, rear) for cycle, (front, rear) in enumerate(zip(*ends, strict=True), begins)]


class _Sensed:
    """The train of an area, its counting heads and its light. Cycles below 0 are of the sweep."""

    def __init__(self, config: FibreDeviceConfig, stay: Stay, seed: int) -> None:
        self._config, self._stay, self._rng = config, stay, Random(seed)
        self._world = World(config.area, stay.journey)
        low, high = stay.journey.area_mm
        self._heads = {"low": Head(config.counter, low), "high": Head(config.counter, high)}
        self._sweep = sweep(config.area.axle_section)

    def step(self, cycle: int, front: dict[str, Cell], rear: dict[str, Cell]) -> dict[str, Cell]:
        """Return one cycle."""
        before = self._axles()
        area = self._world.step(cycle, front, rear)
        counted = self._counted(cycle, before)
        reference = {f"reference.{name}": cell for name, cell in self._reference(area).items()}
        right = {**_named(area), **counted, **reference, **self._flights(cycle, front, rear)}
        changed = {**right, **self._stay.spoilt.get(cycle, {})}
        return {name: cell for name, cell in changed.items() if cell is not None}

    def _axles(self) -> list[int]:
        return [*self._world.axles_mm, *self._world.others_mm]

    def _counted(self, cycle: int, before_mm: Sequence[int]) -> dict[str, Cell]:
        """Return what the heads at both ends tell."""
        cells = dict[str, Cell]()
        for end, (side, head) in enumerate(self._heads.items()):
            if cycle < 0:
                told = head.trolley(int(self._sweep[cycle][("axles_in_low", "axles_out_high")[end]]))
                told["passage_over"] = cycle == -len(self._sweep)
            else:
                told = head.cycle(before_mm, self._axles(), self._world.speed_mm_s(cycle))
            cells |= {f"counter_{side}.{name}": cell for name, cell in told.items()}
        return cells

    def _reference(self, area: Mapping[str, Cell]) -> dict[str, Cell]:
        """Return who comes in, and what the neighbour sends."""
        told: dict[str, Cell] = {
            name: area[f"entry.{name}"] for name in ("enters_low", "enters_high", "axles_of_one_that_enters")
        }
        if area["entry.reference_comes"] != "NEIGHBOUR":
            return {**NOBODY, **told}
        names = [name.removeprefix("neighbour_") for name in NOBODY if name != "neighbour_sends"]
        sent = {f"neighbour_{name}": _record(area, name) for name in names}
        return {**told, "neighbour_sends": True, **sent}

    def _flights(self, cycle: int, front: Mapping[str, Cell], rear: Mapping[str, Cell]) -> dict[str, Cell]:
        """Return the delays of light to both ends, and the surveyed points nearest to them."""
        cells = dict[str, Cell]()
        for name, end in zip(_ENDS, (front, rear), strict=True):
            told = flight_cells(self._config.timed, int(end[REMARK]), self._stay.told, max(cycle, 0), self._rng)
            cells |= {f"{name}_flight.{key}": cell for key, cell in told.items()}
        return cells


def _named(area: Mapping[str, Cell]) -> dict[str, Cell]:
    """Return the inputs of the area that are inputs of the whole, by their names there."""
    earlier = {f"{end}.{name}": f"{end}_{machine}.{name}" for end in _ENDS for name, machine in _OF_THE_END.items()}
    left_out = {f"{end}.flight_position_mm" for end in _ENDS}
    return {
        earlier.get(name, name): cell
        for name, cell in area.items()
        if name not in left_out and not name.startswith(_WIRED)
    }


def _record(area: Mapping[str, Cell], name: str) -> Cell:
    machine = "entry" if name in ("sound", "axles") else "verification"
    return area[f"{machine}.record_{name}"]


# ------------------------------------------------------------------ recordings

_COMES_IN = Journey(
    cycles=110,
    enters=_AFTER_THE_SWEEP,
    tested=_AFTER_THE_SWEEP,
    area_mm=_LONG_MM,
    referred_in=_AFTER_THE_SWEEP,
    counted_every=1,
)
SERVICE = replace(_COMES_IN, cycles=240)
_FROM_HIGH = replace(
    SERVICE, enters=_AFTER_THE_SWEEP + 1, tested=_AFTER_THE_SWEEP - 3, from_high=True, speeds_mm_s=((0, -40_000),), referred_in=0,
    counted_every=5, emitter_dead=(_AFTER_THE_SWEEP + 130, 240),
)  # fmt: skip
_HANDED_OVER = replace(
    _COMES_IN, cycles=152, record=_AFTER_THE_SWEEP + 1, sender="NEIGHBOUR", front_missed=(1,), rear_missed=(1,)
)
_NO_SPEED: Mapping[int, Mapping[str, Cell | None]] = {
    _AFTER_THE_SWEEP + 4: {"counter_low.axle_speed_low_mm_s": None},
    _AFTER_THE_SWEEP + 270: {"counter_low.passage_over": True},
}
_BY_CODE = replace(
    _COMES_IN, cycles=450, speeds_mm_s=((0, 30_000),), referred=False, area_mm=(0, 8_000_000), cuts_mm=((5_500_000, 6_500_000),),
    front_stuck=(100_000, 850_000), rear_stuck=(100_000, 850_000), counted_every=3,
)  # fmt: skip
_SPLIT = replace(SERVICE, cycles=260, cuts_mm=((700_000, 1_200_000),), split=_AFTER_THE_SWEEP + 60, counted_every=3)
_TROUBLED = replace(SERVICE, cycles=170, silent=(_AFTER_THE_SWEEP + 40, _AFTER_THE_SWEEP + 48))
_TROUBLES: Mapping[int, Mapping[str, Cell | None]] = {
    _AFTER_THE_SWEEP + 20: {f"{end}_flight.map_known": False for end in _ENDS},
    _AFTER_THE_SWEEP + 80: {"counter_low.head_fault": True, "counter_high.head_fault": True},
}
RUNS: Mapping[str, Stay] = {
    "service": Stay(SERVICE, Timed(untimed=(90, 91))),
    "from-high": Stay(_FROM_HIGH),
    "handed-over": Stay(_HANDED_OVER),
    "no-speed": Stay(replace(SERVICE, cycles=340, speeds_mm_s=((0, 20_000),)), spoilt=_NO_SPEED),
    "code": Stay(_BY_CODE),
    "split": Stay(_SPLIT),
    "troubled": Stay(_TROUBLED, spoilt=_TROUBLES),
}
"""The recordings that ship, by the end of their name.

service      a train comes in at the low end, is verified by its record, and leaves at the high end
from-high    the same from the high end; before it leaves, the emitter is silent
handed-over  the neighbour hands the train over before its record is there; later a section of the fibre is missed
no-speed     the head does not tell the speed of an axle: the record is overdue, has a flaw when it comes, and nobody is verified
code         the ends get no reference; the fifth section of the position code locates them
split        the last wagons come off, and stand
troubled     a surveyed point is missing, and the pattern is lost; at last both heads are at fault
"""


def write(folder: Path, stays: Mapping[str, Stay] = RUNS) -> list[Path]:
    """Write the recordings anew; return their paths."""
    paths = list[Path]()
    for name, stay in stays.items():
        paths.append(folder / f"fibre_device-{name}.jsonl.gz")
        steps, first = simulate_stay(CONFIG, stay, seed=1), first_values(CONFIG, stay.journey)
        write_steps(paths[-1], steps, machine="fibre_device", first=first, short=True)
    return paths


def first_values(config: FibreDeviceConfig, journey: Journey) -> dict[str, Value]:
    """Return the open values at the start: those of the area, and of the counters' worlds."""
    values = first_state(config.area, journey)
    for side in ("low", "high"):
        pause = config.counter.headway_ms // config.counter.period_ms + 1
        values |= {
            f"counter_{side}.true_speed_um_s": 0, f"counter_{side}.true_pause_cycles": pause,
            f"counter_{side}.last_axle_upwards": True,
        }  # fmt: skip
    for end in _ENDS:
        values |= {f"{end}_flight.true_distance_um": 0, f"{end}_flight.truth_nm": 0, f"{end}_additional.truth_nm": 0}
    return values


if __name__ == "__main__":
    print(*write(FOLDER), sep="\n")
