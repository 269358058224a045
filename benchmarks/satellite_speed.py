"""How fast the satellite chain and its machine are, one core, 32 satellites.

python -m benchmarks.satellite_speed [epochs, 200 unless told]

Epochs go through the whole chain: prediction, differences, selection, solution, step. The machine's step is measured by
itself, as generated Python, in numpy batches and as generated C, over the inputs that the chain made. Processor time, best of five rounds.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from functools import cache

import numpy as np

from safeloc.codegen.batch import compile_batch, simulate
from safeloc.codegen.c_loader import load_c
from safeloc.codegen.compiled import compile_system
from safeloc.language.nodes import BoolVar
from safeloc.language.system import TransitionSystem, without_ghosts
from safeloc.models.satellite import compose_machines
from safeloc.models.satellite.chain import ChainConfig, Cycle, EpochChain, Outcome, Reference
from safeloc.models.satellite.variables import SatelliteConfig
from safeloc.models.satellite_selection import SelectionConfig
from safeloc.sensing.satellite.ephemeris import Ephemeris
from safeloc.sensing.satellite.epochs import Epoch, Measured
from safeloc.sensing.satellite.navigation import Navigation
from safeloc.sensing.satellite.places import Place
from safeloc.sensing.satellite.predicted import Predicted, predicted
from safeloc.sensing.satellite.residuals import MASK_RAD
from safeloc.sensing.satellite.track_prediction import Portion
from safeloc.simulation.satellite.constellation import GALILEO, GPS, START_S, constellation

EPOCHS_TARGET, STEPS_TARGET = 200, 200_000
PERIOD_S, ROUNDS, RUNS = 0.2, 5, 4_096
HOME = Place.degrees(50.0, 8.0, 200.0)
STILL = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Speed:
    """Epochs, and machine steps, a second of processor time."""

    satellites: int
    epochs: float
    python_steps: float
    batch_steps: float
    c_steps: float


def track() -> Portion:
    """A kilometre to the north, standing place in the middle."""
    ends = (Place.degrees(49.9955, 8.0, 200.0), Place.degrees(50.0045, 8.0, 200.0))
    return Portion(-500.0, (ends[0].earth_fixed_m(), ends[1].earth_fixed_m()))


@cache
def sky(satellites: int) -> Navigation:
    """So many satellites above the mask, of two constellations with more satellites than there are."""
    crowded = (replace(GPS, in_plane=16), replace(GALILEO, in_plane=24))
    every = [_plain(one) for one in constellation(crowded, np.random.default_rng(1)).ephemerides]
    seen = [one for one in every if predicted(one, START_S, HOME, STILL, None).elevation_rad > MASK_RAD + 0.1]
    return Navigation(tuple(sorted(seen, key=lambda one: one.satellite[1:])[:satellites]), None)


def _plain(one: Ephemeris) -> Ephemeris:
    """With Python's own numbers, as a reader gives them."""
    return Ephemeris(
        **{name: value.item() if isinstance(value, np.generic) else value for name, value in asdict(one).items()}
    )


def epochs(count: int, navigation: Navigation) -> list[Epoch]:
    """What a receiver without noise measures standing in the middle of the track."""
    times = (START_S + number * PERIOD_S for number in range(count))
    place = Place.of_earth_fixed(track().at(0.0)[0])

    def one(time_s: float) -> Epoch:
        def measured(seen: Predicted) -> Measured:
            return Measured(seen.pseudorange_m + 30_000, seen.rate_m_per_s + 60)

        return Epoch(
            time_s,
            {e.satellite: measured(predicted(e, time_s - 1e-4, place, STILL, None)) for e in navigation.ephemerides},
        )

    return [one(time_s) for time_s in times]


def driven(config: ChainConfig, navigation: Navigation, given: list[Epoch]) -> list[Outcome]:
    """All epochs through one chain, a balise in the first."""
    course, chain = [track()], EpochChain(config, navigation, lambda low_m, high_m: course)
    first = Reference(0, 1_000, 0, 50)
    return [chain.step(Cycle(epoch, reference=first if n == 0 else None)) for n, epoch in enumerate(given)]


def configured(channels: int) -> ChainConfig:
    """So many channels, and a tolerance that keeps the state however the satellites stand."""
    selection = SelectionConfig(channels=channels)
    return ChainConfig(
        satellite=SatelliteConfig(selection=selection, tolerance_mm=500_000, protection_limit_mm=500_000)
    )


def _best(work: Callable[[], object], count: int) -> float:
    spent = []
    for _ in range(ROUNDS):
        began = time.process_time()
        work()
        spent.append(time.process_time() - began)
    return count / min(spent)


def measured(count: int, channels: int = 32) -> Speed:
    """Of the chain with as many satellites as channels, and of its machine."""
    config, navigation = configured(channels), sky(channels)
    given = epochs(count, navigation)
    outcomes = driven(config, navigation, given)
    system = without_ghosts(compose_machines(config.satellite).composition.system)
    return Speed(
        len(outcomes[-1].usable),
        _best(lambda: driven(config, navigation, given), count),
        _python(system, outcomes),
        _batch(system, outcomes),
        _c(system, outcomes),
    )


def _python(system: TransitionSystem, outcomes: list[Outcome]) -> float:
    code = compile_system(system)
    rows, first = [code.read(one.inputs) for one in outcomes] * 10, code.first()
    return _best(lambda: code.run(rows, first), len(rows))


def _batch(system: TransitionSystem, outcomes: list[Outcome]) -> float:
    code, batch = compile_system(system), compile_batch(system)
    rows = np.array([code.read(one.inputs) for one in outcomes], dtype=np.int64)[:20]
    inputs = {
        var.name: np.repeat(rows[:, column, None], RUNS, axis=1).astype(
            np.bool_ if isinstance(var, BoolVar) else np.int64
        )
        for column, var in enumerate(system.inputs)
    }
    return _best(lambda: simulate(batch, inputs), len(rows) * RUNS)


def _c(system: TransitionSystem, outcomes: list[Outcome]) -> float:
    machine = load_c(system)
    rows = machine.rows([one.inputs for one in outcomes] * 10)
    return _best(lambda: machine.run(rows), 10 * len(outcomes))


def main(count: int) -> None:
    """Print what was measured."""
    for channels in (8, 32):
        speed = measured(count, channels)
        print(
            f"{channels} channels, {speed.satellites} satellites used: {speed.epochs:.0f} epochs/s (target {EPOCHS_TARGET}); machine: "
            f"{speed.python_steps / 1e3:.0f} k steps/s as Python, {speed.batch_steps / 1e3:.0f} k in numpy, {speed.c_steps / 1e3:.0f} k in C (target {STEPS_TARGET / 1e3:.0f} k)"
        )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 200)
