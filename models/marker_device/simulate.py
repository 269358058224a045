"""Simulated runs of the marker device as step streams, ghosts included: markers, odometers and a receiver of one vehicle.

`python -m safeloc.models.marker_device.simulate` writes the recordings; the tests check that it still writes the same.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from safeloc.language.nodes import Value
from safeloc.language.units import NM_PER_MM
from safeloc.models.guard.variables import FAULT
from safeloc.models.marker_device import NAME
from safeloc.models.marker_device.configuration import MarkerDeviceConfig
from safeloc.models.odometry import simulate as odometry_streams
from safeloc.proof.drawn_runs.worked import WorkedRun, write_runs
from safeloc.runtime.streams.steps import Cell
from safeloc.simulation.faults import Fault, Kinds, plain
from safeloc.simulation.motion import Leg, Motion, VehicleConfig, move

Steps = list[dict[str, Cell]]
FOLDER, SEED, FIX_EVERY_MS = Path(__file__).with_name("recordings"), 5, 400
KINDS = Kinds("a receiver", {**plain("silent", "across"), "jump": {"by_mm": 180_000}})
"""Faults by cycle: no fix; a fix on a course across the way, 90 m off; a fix `by_mm` along the way."""
ACROSS_MM, ACROSS_MRAD = 90_000, 600
SHARED = "true_cycle_distance_nm"
"""The movement in odometry's own steps is that of the whole."""
LEFT_OUT = ("truth_mm", *odometry_streams.NO_SATELLITES)
"""Names of odometry's own steps: a remark that says what a ghost of the whole has, and inputs that the guard gives."""


@dataclass(frozen=True)
class Scene:
    """A run: markers as (identity, place in mm), faults of receiver and readers in cycles, and what is to come of it in words.

    both_ways  the route permits to set back
    """

    legs: Sequence[Leg]
    markers: Sequence[tuple[int, int]]
    receiver: Sequence[Fault] = ()
    readers: Sequence[Fault] = ()
    both_ways: bool = False
    says: str = ""


SCENES: Mapping[str, Scene] = {
    "tunnel": Scene(
        [Leg(0, 8), Leg(35_000, 190), Leg(0, 40)],
        [(1, 300_000), *((number, 1_300_000 + 400_000 * number) for number in range(2, 10))],
        receiver=(Fault("silent", "", 0, 400), Fault("silent", "", 850, 1_650)),
        says="The first marker is the candidate and satellites confirm it. In the open, positions of satellites bound the margin "
        "without a marker; in the tunnel the markers do, at both ends. Behind it satellites lead again.",
    ),
    "loss": Scene(
        [Leg(0, 8), Leg(30_000, 150)],
        [(1, 100_000), (2, 300_000), (3, 2_500_000), (4, 2_900_000), (5, 3_300_000)],
        receiver=(Fault("silent", "", 200, 900),),
        readers=(Fault("misplaced", "front_marker", 1_050, 1_120, {"reach": 1}),),
        says="No satellites and no markers: the tolerance is exceeded, the vehicle is restrictive. Positions of satellites come back "
        "and are a candidate only; a marker with a wrong place contradicts it; the next marker agrees with the satellites, and the "
        "position is passed on again.",
    ),
    "false-fixes": Scene(
        [Leg(0, 8), Leg(30_000, 100)],
        [(1, 100_000), (2, 300_000), (3, 2_400_000)],
        receiver=(
            Fault("jump", "", 300, 306), Fault("across", "", 450, 530), Fault("jump", "", 650, 666, {"by_mm": -120_000}),
        ),
        says="The receiver jumps 180 m ahead for two fixes, runs across the way, and falls back by 120 m for four: the guard withholds "
        "all of it, and the margin grows by the odometers' error until fixes agree again.",
    ),
    "backwards": Scene(
        [Leg(0, 5), Leg(-25_000, 60), Leg(0, 35), Leg(20_000, 50)],
        [(1, -900_000), (2, -400_000), (3, -250_000)],
        receiver=(Fault("silent", "", 0, 400),),
        both_ways=True,
        says="The vehicle sets back: end B leads, its reader reads each marker first and the one at end A after it. Satellites set the "
        "device at end A all the same. Then it turns, and end A leads.",
    ),
}  # fmt: skip
"""The scenes, by the end of the recordings' names."""


def simulate(config: MarkerDeviceConfig, scene: Scene, *, seed: int) -> Steps:
    """Return the scene as steps: inputs, and ghosts that obey every law."""
    KINDS.require(scene.receiver)
    motion = _motion(config, scene)
    own = odometry_streams.simulate(
        config.odometry, seed=seed, motion=motion, markers=scene.markers, dropout=0, missed=0, foreign=0, faults=scene.readers,
    )  # fmt: skip
    receiver = _receiver(config, scene, motion, np.random.default_rng(seed + 1))
    return [{**_named(step), **given} for step, given in zip(own, receiver, strict=True)]


def _named(step: Mapping[str, int | bool]) -> dict[str, Cell]:
    own = {key: cell for key, cell in step.items() if key not in LEFT_OUT}
    return {key if key == SHARED else f"odometry.{key}": cell for key, cell in own.items()}


def first_state(config: MarkerDeviceConfig) -> dict[str, Value]:
    """Return first values of the open variables: the vehicle stands at place 0, and no reading was ever stray."""
    own, behind = config.odometry, config.antenna_mm * NM_PER_MM
    return {
        "truth_nm": 0, "antenna_nm": -behind, "guard.true_speed_um_s": 0,
        "odometry.since_stray_ms": own.age_limit_ms + own.period_ms,
    }  # fmt: skip


def simulated(config: MarkerDeviceConfig, seed: int) -> Steps:
    """Return the run through a tunnel; the seed gives the errors of the sensors."""
    return simulate(config, SCENES["tunnel"], seed=seed)


def _motion(config: MarkerDeviceConfig, scene: Scene) -> Motion:
    slowest = min(config.guard.acceleration_mm_s2, config.guard.brake_mm_s2)
    vehicle = VehicleConfig(
        length_mm=max(1_000, config.odometry.vehicle_length_mm), max_speed_mm_s=int(config.odometry.max_speed_mm_s * 0.9),
        acceleration_mm_s2=min(900, slowest), brake_mm_s2=min(900, slowest),
    )  # fmt: skip
    return move(vehicle, scene.legs, config.odometry.period_ms)


# ------------------------------------------------------------------ the receiver


def _receiver(config: MarkerDeviceConfig, scene: Scene, motion: Motion, rng: np.random.Generator) -> Steps:
    """Return the guard's inputs and the true speed, cycle by cycle; there is a fix every 0.4 s."""
    speeds, every = _speeds_um_s(motion), max(1, FIX_EVERY_MS // config.guard.period_ms)
    steps: Steps = []
    for cycle, end_a_nm in enumerate(motion.position_nm):
        antenna_nm = int(end_a_nm) - config.antenna_mm * NM_PER_MM
        fault = next((one for one in scene.receiver if one.active(cycle)), None)
        given = _fix(config, antenna_nm, rng, fault) if cycle % every == 0 else {}
        steps.append(
            _nothing(int(speeds[cycle]), not scene.both_ways) | {f"guard.{name}": cell for name, cell in given.items()}
        )
    return steps


def _nothing(speed_um_s: int, forwards_only: bool) -> dict[str, Cell]:
    return {
        "guard.fault": FAULT[0].label, "guard.fix_offset_mm": 0, "guard.fix_age_ms": 0, "guard.fix_ambiguous": False,
        "guard.fix_elsewhere": False, "guard.forwards_only": forwards_only, "guard.start_anew": False,
        "guard.next_speed_um_s": speed_um_s,
    }  # fmt: skip


def _fix(config: MarkerDeviceConfig, antenna_nm: int, rng: np.random.Generator, fault: Fault | None) -> dict[str, Cell]:
    """Return a fix up to 3 m beside the track, along it within nine tenths of its error; or what a fault makes of it."""
    if fault is not None and fault.kind == "silent":
        return {}
    offset = int(rng.integers(0, 3_001))
    bound = config.guard.fix_error_mm + offset * config.guard.offset_charge_permille // 1_000
    place = antenna_nm // NM_PER_MM + int(rng.uniform(-0.9, 0.9) * bound)
    given: dict[str, Cell] = {"fix_mm": place, "fix_offset_mm": offset}
    if fault is None:
        return given
    if fault.kind == "across":
        return given | {"fix_mm": place + ACROSS_MM, "fix_course_mrad": ACROSS_MRAD}
    return given | {"fix_mm": place + KINDS.figure(fault, "by_mm")}


def _speeds_um_s(motion: Motion) -> NDArray[np.int64]:
    """Return the speed at the end of each cycle: the mean over the cycles before and after."""
    after = np.append(motion.distance_nm[1:], motion.distance_nm[-1:])
    return np.asarray((motion.distance_nm + after) // (2 * motion.period_ms), dtype=np.int64)


def _worked(scene: Scene) -> WorkedRun[MarkerDeviceConfig]:
    return WorkedRun(scene.says, lambda config: simulate(config, scene, seed=SEED), first_state(MarkerDeviceConfig()))


def write(folder: Path = FOLDER) -> list[Path]:
    """Write all recordings, each with its first state; return their paths."""
    runs = {f"{NAME}-{name}": _worked(scene) for name, scene in SCENES.items()}
    return write_runs(folder, runs, MarkerDeviceConfig(), short=True)


if __name__ == "__main__":
    print(*write(), sep="\n")
