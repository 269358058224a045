"""Shipped recordings of the localizer: short journeys, each with its expected outcome in words.

`python -m safeloc.models.localizer.simulation.recorded_runs` writes them; the tests check that it still writes the same.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from safeloc.models.balise.groups import Group
from safeloc.models.localizer import LocalizerConfig
from safeloc.models.localizer.simulation.journeys import METRO
from safeloc.models.localizer.simulation.simulate import Journey, Steps, Stretch, first_state, simulate
from safeloc.models.reflector.simulate import Balise, Reflector, Route
from safeloc.runtime.streams.steps import write_steps
from safeloc.simulation.faults import Fault
from safeloc.simulation.motion import Leg

FOLDER, SEED = Path(__file__).parents[1] / "recordings", 3


@dataclass(frozen=True)
class Run:
    """A journey to record, and its expected outcome in words."""

    journey: Journey
    says: str


STATION = replace(METRO, legs=[Leg(0, 1), Leg(15_000, 28), Leg(0, 18)], acceleration_mm_s2=1_000)
MAIN_LINE = Journey(
    legs=[Leg(0, 1), Leg(22_000, 29), Leg(0, 2)],
    markers=[(number, number * 100_000) for number in range(1, 9)],
    groups=[Group(number, number * 150_000 - 100_000) for number in range(1, 6)],
    dark=[Stretch(-1_000_000, 192_000), Stretch(330_000, 10_000_000)],
    satellites=5,
    length_mm=200_000,
    acceleration_mm_s2=1_000,
)
FREIGHT = Journey(
    legs=[Leg(0, 1), Leg(12_000, 35), Leg(0, 2)],
    groups=[Group(number, number * 150_000 - 120_000) for number in range(1, 5)],
    dark=[Stretch(-1_000_000, 172_000), Stretch(235_000, 10_000_000)],
    satellites=5,
    fibre=Stretch(60_000, 300_000),
    axles=44,
    length_mm=205_000,
    acceleration_mm_s2=700,
)
_DENSE = replace(
    STATION,
    legs=[Leg(0, 1), Leg(15_000, 28)],
    groups=[
        Group(1, 20_000, accuracy_mm=1_000), Group(2, 90_000, accuracy_mm=1_000),
        Group(3, 160_000, accuracy_mm=1_000, reflector_mm=80_000), Group(4, 190_000, accuracy_mm=1_000),
        Group(5, 225_000, accuracy_mm=1_000), Group(6, 260_000, accuracy_mm=1_000),
    ],
    reflectors=Route((Balise(3, 160_000),), (Reflector(240_000, "A", 80_000),)),
)  # fmt: skip
_TURNED = [Fault("balise turned", group) for group in (4, 5, 6)]
_SILENT_BALISE = [Fault("odometer silent", "", 320, 332), Fault("balise corrupted", 3)]
_REVOKED = [Fault("fibre error", "", 300, 310), Fault("satellites lost", "", 270, 400)]
RUNS: Mapping[str, Run] = {
    "metro": Run(
        STATION, "Into a station in a tunnel: the radar leads after its self-test, then odometry; balises confirm."
    ),
    "main-line": Run(
        MAIN_LINE, "Out of a hall, some 140 m under satellites, then into a tunnel where odometry and balises go on."
    ),
    "freight": Run(
        FREIGHT,
        "Through a fibre area: its position comes by the downlink; balises narrow it, and for a while satellites confirm it.",
    ),
    "metro-silent-odometer-corrupted-balise": Run(
        replace(STATION, troubles=_SILENT_BALISE),
        "The telegram that tells the distance to the reflector is corrupted: it anchors nothing, and the radar is not used without its self-test. Then the "
        "odometer is silent for 1.2 s: balises and the reflector machine withdraw, odometry goes on.",
    ),
    "metro-three-groups-turned": Run(
        replace(_DENSE, troubles=_TURNED),
        "Three announced groups in a row are read the wrong way round, which speaks against the position: the balise machine withdraws it, and with it goes what "
        "the radar was anchored by. Odometry goes on.",
    ),
    "freight-fibre-error-no-satellites": Run(
        replace(FREIGHT, troubles=_REVOKED),
        "Satellites are lost, then the fibre reports an error: the position that it had reported is revoked on board in the same cycle.",
    ),
}
"""The recordings, by the end of their names."""


def simulated(config: LocalizerConfig, seed: int) -> Steps:
    """Return the steps of the nominal journey into a station; the seed determines the sensors' errors."""
    return simulate(config, RUNS["metro"].journey, seed=seed)


def write(folder: Path = FOLDER) -> list[Path]:
    """Write all recordings, each with its first state; return their paths."""
    config, paths = LocalizerConfig(), list[Path]()
    for name, run in RUNS.items():
        paths.append(folder / f"localizer-{name}.jsonl.gz")
        steps, first = simulate(config, run.journey, seed=SEED), first_state(config, run.journey)
        write_steps(paths[-1], steps, machine="localizer", first=first, short=True)
    return paths


if __name__ == "__main__":
    for path in write():
        print(path)
