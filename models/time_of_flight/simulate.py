"""Simulated delays between pulses and the pattern of a train's end, as steps of the machine that tells its distance.

`python -m safeloc.models.time_of_flight.simulate` writes the runs that ship.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from random import Random

from safeloc.language.units import NM_PER_UM, PPM_PER_ONE, UM_PER_MM
from safeloc.models.time_of_flight.variables import LIGHT_M_S, TimeOfFlightConfig
from safeloc.proof.drawn_runs.worked import Steps, WorkedRun, write_named
from safeloc.runtime.streams.steps import Cell

_POINTS_MM = 1_000_000


@dataclass(frozen=True)
class Ride:
    """One run of a train's end along the fibre.

    start_mm, step_mm  distance along the fibre before the first cycle, and its change in each
    upwards     places along the track grow along the fibre
    unmeasured  cycles without a delay
    unmapped    cycles without a surveyed point
    """

    cycles: int
    start_mm: int
    step_mm: int
    upwards: bool = True
    unmeasured: tuple[int, ...] = ()
    unmapped: tuple[int, ...] = ()


def measured(config: TimeOfFlightConfig, ride: Ride, seed: int = 0) -> Steps:
    """Return one step per cycle, with the world beside it."""
    rng = Random(seed)
    return [_step(config, ride, cycle, rng) for cycle in range(ride.cycles)]


def simulate(config: TimeOfFlightConfig, *, seed: int) -> Steps:
    """Return a run along a fifth of the fibre, with gaps."""
    rng = Random(seed)
    cycles, step = 120, config.fibre_mm // 600
    upwards = rng.random() < 0.5
    ride = Ride(cycles, config.fibre_mm // 2, step if rng.random() < 0.5 else -step, upwards,
                unmeasured=tuple(rng.sample(range(cycles), 12)), unmapped=tuple(rng.sample(range(cycles), 6)))  # fmt: skip
    return measured(config, ride, seed)


def _step(config: TimeOfFlightConfig, ride: Ride, cycle: int, rng: Random) -> dict[str, Cell]:
    distance_um = (ride.start_mm + ride.step_mm * (cycle + 1)) * UM_PER_MM
    shorter = PPM_PER_ONE - config.slack_ppm // 2
    point_mm = distance_um // UM_PER_MM // _POINTS_MM * _POINTS_MM
    sign = 1 if ride.upwards else -1
    map_position_mm = sign * point_mm * shorter // PPM_PER_ONE
    ran_um = (distance_um - point_mm * UM_PER_MM) * shorter // PPM_PER_ONE
    step: dict[str, Cell] = {
        "map_known": cycle not in ride.unmapped, "map_distance_mm": point_mm, "map_position_mm": map_position_mm,
        "map_upwards": ride.upwards,
    }  # fmt: skip
    off_um = rng.randint(-config.pattern_error_mm, config.pattern_error_mm) * UM_PER_MM * 9 // 10
    origin_um = max(distance_um + off_um, 0)
    ghosts: dict[str, Cell] = {
        "next_true_distance_um": distance_um, "pattern_origin_um": origin_um,
        "next_truth_nm": (map_position_mm * UM_PER_MM + sign * ran_um) * NM_PER_UM,
    }  # fmt: skip
    if cycle in ride.unmeasured:
        return step | ghosts
    return step | ghosts | {"delay_ps": delay_ps(config, origin_um, rng)}


def delay_ps(config: TimeOfFlightConfig, origin_um: int, rng: Random) -> int:
    """Return the delay as measured: with an index and a time that are each wrong by up to nine tenths of their errors."""
    wrong_index = config.index_ppm * config.index_error_ppm * 9 // (10 * PPM_PER_ONE)
    index = config.index_ppm + rng.randint(-wrong_index, wrong_index)
    wrong_ps = rng.randint(-config.time_error_ps, config.time_error_ps) * 9 // 10
    return max(2 * origin_um * index // LIGHT_M_S + wrong_ps, 0)


RUNS: Mapping[str, WorkedRun[TimeOfFlightConfig]] = {
    "time_of_flight-service": WorkedRun(
        "A train runs away from the sensing end: time and distance grow, and are absent in the cycles without a delay; the "
        "place is absent where the cable map has no surveyed point.",
        lambda config: measured(config, Ride(60, 9_500_000, 22_000, unmeasured=(20, 21), unmapped=(30,))),
    ),
    "time_of_flight-towards": WorkedRun(
        "The cable runs against the track, and a train comes towards the sensing end: the distance shrinks, the place grows.",
        lambda config: measured(config, Ride(40, 1_000_000, -22_000, upwards=False)),
    ),
}
"""The recordings that ship, by name."""


if __name__ == "__main__":
    write_named(__file__, RUNS, {}, TimeOfFlightConfig())
