"""A scene: the line, its events, and the detector's readings of the light.

The interrogator here sends 500 pulses a second and the cable is made of 5 m cells: half the pulses and half the cells
of the front end's usual figures, for a tenth of the time; windows last 50 ms and channels 10 m as usual.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from safeloc.language.units import MM_PER_M
from safeloc.models.fibre.code import Symbol
from safeloc.sensing.fibre.emitters import Heard
from safeloc.sensing.fibre.energy import Analyser
from safeloc.sensing.fibre.features import FibreFrame, TrainSeen
from safeloc.sensing.fibre.figures import (
    Band,
    Counting,
    Emission,
    Emitter,
    FibreConfig,
    Interrogator,
    PointPlace,
)
from safeloc.sensing.fibre.front_end import FrontEnd
from safeloc.simulation.faults import Fault
from safeloc.simulation.fibre import cable as laid
from safeloc.simulation.fibre.emitters import Sounding
from safeloc.simulation.fibre.ground import Car
from safeloc.simulation.fibre.optics import Drift
from safeloc.simulation.fibre.scene import Shot, TrainTruth, World, shots
from safeloc.simulation.fibre.trains import Train

Numbers = NDArray[np.float64]
PULSE_HZ, WINDOW_FRAMES, CELL_MM = 500, 25, 5_000
_MAX_AGE_MS = 1_000
RAISED, LOWERED = 8.0, 0.25
"Effect of a section on the strain: 18 dB more, or 12 dB less, which leaves the train audible."
_NO_DRIFT = Drift()


@dataclass(frozen=True)
class Section:
    """A localization section as surveyed, mm along the track, and its symbol; made by coupling or by material."""

    low_mm: int
    high_mm: int
    symbol: Symbol
    by_material: bool = False


@dataclass(frozen=True)
class Scene:
    """A line and the events beside it. The cable lies one to one along the track.

    points      reflecting points: name and place, mm
    emitters    test emitters: name, place in mm, bit pattern; `soundings`: times at which they really sound
    absorber    the fibre's end is absorbed; coupling_cdb: unevenness of the cable
    drift       of index and trigger at a second; faults: of the blocks
    """

    length_m: int
    seconds: int
    trains: tuple[Train, ...]
    sections: tuple[Section, ...] = ()
    points: Mapping[str, int] | None = None
    emitters: tuple[tuple[str, int, str], ...] = ()
    soundings: tuple[Sounding, ...] = ()
    cars: tuple[Car, ...] = ()
    faults: tuple[Fault, ...] = ()
    drift: Callable[[float], Drift] = lambda _: _NO_DRIFT
    absorber: bool = True
    coupling_cdb: int = 100
    axles_per_vehicle: int = 4
    seed: int = 1

    @property
    def config(self) -> FibreConfig:
        """The interrogator and the detector."""
        emitters = tuple(Emitter(id=name, fibre_mm=place, bits=bits) for name, place, bits in self.emitters)
        points = tuple(PointPlace(id=name, fibre_mm=place) for name, place in (self.points or {}).items())
        return FibreConfig(
            interrogator=Interrogator(
                fibre_mm=self.length_m * MM_PER_M, pulse_hz=PULSE_HZ, pulse_ns=100 if points else 50
            ),
            band=Band(window_frames=WINDOW_FRAMES),
            counting=Counting(axles_per_vehicle=self.axles_per_vehicle),
            emission=Emission(emitters=emitters),
            point_places=points,
        )


@dataclass(frozen=True, eq=False)
class Moment:
    """One block: its readings, and the truth at its last frame.

    refused  reason why the block gave no readings; empty otherwise
    energy   mean energy of each channel in the detector's band; NaN if no usable block came
    """

    second: float
    time_ms: int
    trains: tuple[TrainSeen, ...]
    heard: tuple[Heard, ...]
    refused: str
    truth: tuple[TrainTruth, ...]
    energy: Numbers


def listen(scene: Scene) -> list[Moment]:
    """Return the scene block by block, seen through the detector."""
    config, rng = scene.config, np.random.default_rng(scene.seed)
    world = _world(scene, config, rng)
    front, analyser = FrontEnd(config, _MAX_AGE_MS), Analyser(config)
    blocks = round(scene.seconds * MM_PER_M / (config.window_ms * config.band.windows_per_block))
    return [_moment(shot, front, analyser) for shot in shots(world, blocks, rng, faults=scene.faults)]


def _world(scene: Scene, config: FibreConfig, rng: np.random.Generator) -> World:
    cable = laid.cable(
        config.interrogator,
        rng,
        figures=laid.CableFigures(cell_mm=CELL_MM, coupling_cdb=scene.coupling_cdb),
        sections=[_shaken(one) for one in scene.sections],
        points_m=[place / MM_PER_M for place in (scene.points or {}).values()],
        absorber=scene.absorber,
    )
    return World(config, cable, scene.trains, scene.cars, scene.soundings, drift=scene.drift)


def _shaken(one: Section) -> laid.Section:
    factor = RAISED if one.symbol.rises else LOWERED
    return laid.Section(
        one.low_mm / MM_PER_M, one.high_mm / MM_PER_M, factor, "material" if one.by_material else "coupling"
    )


def _moment(shot: Shot, front: FrontEnd, analyser: Analyser) -> Moment:
    outcome = front.receive(shot.block, shot.delivered_ms)
    time_ms = round(shot.second * MM_PER_M)
    if isinstance(outcome, FibreFrame):
        return Moment(shot.second, time_ms, outcome.trains, outcome.heard, "", shot.trains, _energy(shot, analyser))
    refused = outcome.reason.value
    return Moment(shot.second, time_ms, (), (), refused, shot.trains, _energy(shot, analyser))


def _energy(shot: Shot, analyser: Analyser) -> Numbers:
    """Return the energy for a picture, also of blocks that the detector refused for their meaning."""
    if shot.block is None:
        return np.zeros(0)
    phase_rate = np.asarray(shot.block.phase_rate, dtype=np.float32)
    return np.asarray(analyser.energies(phase_rate).band.mean(axis=0), dtype=np.float64)
