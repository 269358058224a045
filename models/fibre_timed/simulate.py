"""Simulated runs past localization sections, with the time of flight of each cycle, as steps of the whole.

The features of the sections are those of `models.fibre.simulate`; the delay is that of light to the same end and back.

`python -m safeloc.models.fibre_timed.simulate` writes the runs that ship.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from random import Random

from safeloc.language.units import PPM_PER_ONE, UM_PER_MM
from safeloc.models.fibre import simulate as sections
from safeloc.models.fibre.simulate import Drive, steady
from safeloc.models.fibre_timed.configuration import FibreTimedConfig
from safeloc.models.time_of_flight.simulate import delay_ps
from safeloc.proof.drawn_runs.worked import Steps, WorkedRun, write_named
from safeloc.runtime.streams.steps import Cell

_START_MM = 5_000_000
_OF_THE_WHOLE = ("amplitude_cdb", "true_run_nm")
"""Names of the fibre machine's own steps that all machines share."""


@dataclass(frozen=True)
class Timed:
    """Times and surveyed points that are told on a run.

    points_mm   distance between surveyed points; the nearest one is asked
    untimed     cycles without a delay
    unheard     cycles without an amplitude
    index_ppm   change of the index of refraction in each cycle, ppm of it
    """

    points_mm: int = 1_000_000
    untimed: tuple[int, ...] = ()
    unheard: tuple[int, ...] = ()
    index_ppm: int = 0


def timed(config: FibreTimedConfig, drive: Drive, told: Timed, seed: int) -> Steps:
    """Return the steps of one run, with the world beside it; an index that drifts breaks its law."""
    rng, steps = Random(seed), Steps()
    for cycle, seen in enumerate(sections.simulate(config.fibre, seed=seed, drive=drive)):
        features = {name: cell for name, cell in seen.items() if name != "truth_mm"}
        named = {name if name in _OF_THE_WHOLE else f"fibre.{name}": cell for name, cell in features.items()}
        if cycle in told.unheard:
            del named["amplitude_cdb"]
        flight = flight_cells(config, int(seen["truth_mm"]), told, cycle, rng)
        steps.append(named | {f"time_of_flight.{name}": cell for name, cell in flight.items()})
    return steps


def flight_cells(config: FibreTimedConfig, truth_mm: int, told: Timed, cycle: int, rng: Random) -> dict[str, Cell]:
    """Return the delay to an end at this place, and the surveyed point nearest to it; the cable is longer by half its slack."""
    own = config.time_of_flight
    distance_um = (_START_MM + _cable_mm(config, truth_mm)) * UM_PER_MM
    off_um = rng.randint(-own.pattern_error_mm, own.pattern_error_mm) * UM_PER_MM * 9 // 10
    point_mm = (truth_mm + told.points_mm // 2) // told.points_mm * told.points_mm
    step: dict[str, Cell] = {
        "map_known": True, "map_distance_mm": _START_MM + _cable_mm(config, point_mm), "map_position_mm": point_mm,
        "map_upwards": True, "next_true_distance_um": distance_um, "pattern_origin_um": distance_um + off_um,
    }  # fmt: skip
    if cycle in told.untimed:
        return step
    wrong = 1 + told.index_ppm * cycle / PPM_PER_ONE
    return step | {"delay_ps": int(delay_ps(own, distance_um + off_um, rng) * wrong)}


def _cable_mm(config: FibreTimedConfig, along_mm: int) -> int:
    return along_mm * PPM_PER_ONE // (PPM_PER_ONE - config.time_of_flight.slack_ppm // 2)


def simulate(config: FibreTimedConfig, *, seed: int) -> Steps:
    """Return a run past two sections, with cycles without a delay and without an amplitude."""
    rng = Random(seed)
    untimed, unheard = (tuple(rng.sample(range(5, 60), 4)) for _ in range(2))
    return timed(config, Drive(steady(30_000, 170), flight_off_mm=None), Timed(untimed=untimed, unheard=unheard), seed)


def _lawful(config: FibreTimedConfig) -> Steps:
    drive = Drive(steady(30_000, 110), flight_off_mm=None)
    return timed(config, drive, Timed(untimed=(20, 21), unheard=(30,)), seed=2)


def _few_points(config: FibreTimedConfig) -> Steps:
    return timed(config, Drive(steady(30_000, 110), flight_off_mm=None), Timed(points_mm=4_000_000), seed=3)


def _code(config: FibreTimedConfig) -> Steps:
    drive = Drive(steady(45_000, 290), referred=False, flight_off_mm=None)
    return timed(config, drive, Timed(), seed=6)


RUNS: Mapping[str, WorkedRun[FibreTimedConfig]] = {
    "fibre_timed-service": WorkedRun(
        "A train runs past a localization section: its place by the time of flight is compared in each cycle with a delay, except in the "
        "one after a missed amplitude, and agrees.",
        _lawful,
    ),
    "fibre_timed-code": WorkedRun(
        "No reference is known: the end is located by the fifth section of the code, and from there on compared with its time of flight.",
        _code,
    ),
    "fibre_timed-few-points": WorkedRun(
        "Surveyed points lie 4 km apart: some 600 m beyond one the place by time of flight is too wide to be compared, and the end stays located.",
        _few_points,
    ),
}
"""The recordings that ship, by name."""


if __name__ == "__main__":
    write_named(__file__, RUNS, {}, FibreTimedConfig())
