"""Simulates a run of trains and cars beside a cable, block by block, with faults and the true places of the trains."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from safeloc.sensing.array_types import Floats
from safeloc.sensing.fibre.blocks import FibreBlock
from safeloc.sensing.fibre.figures import FibreConfig
from safeloc.simulation.faults import Fault, Kinds, plain
from safeloc.simulation.fibre.cable import Cable
from safeloc.simulation.fibre.emitters import Sounding, emitted
from safeloc.simulation.fibre.ground import Car, GroundFigures, Sources
from safeloc.simulation.fibre.optics import Drift, OpticsFigures, Receiver
from safeloc.simulation.fibre.trains import Train

KINDS = Kinds(
    "a fibre",
    plain(
        "missing", "duplicate", "late", "frozen", "not finite", "wrong shape", "wrong type", "short", "dark", "silent",
        "shaken",
    ),
)  # fmt: skip
"""Faults of the only fibre (no place), in blocks."""
_NO_DRIFT = Drift()


@dataclass(frozen=True, eq=False)
class World:
    """The simulated environment. `drift`: second -> drift of the interrogator."""

    config: FibreConfig
    cable: Cable
    trains: tuple[Train, ...] = ()
    cars: tuple[Car, ...] = ()
    soundings: tuple[Sounding, ...] = ()
    ground: GroundFigures = GroundFigures()
    optics: OpticsFigures = OpticsFigures()
    drift: Callable[[float], Drift] = lambda _: _NO_DRIFT


@dataclass(frozen=True)
class TrainTruth:
    """A train at the end of a block: its true ends on the track in m, smaller place first, and speed in m/s."""

    low_m: float
    high_m: float
    speed_m_s: float


@dataclass(frozen=True, eq=False)
class Shot:
    """One block: delivered block (None: nothing), time of delivery, and the true trains at its last frame."""

    second: float
    block: FibreBlock | None
    delivered_ms: int
    trains: tuple[TrainTruth, ...]


def shots(
    world: World, blocks: int, rng: np.random.Generator, *, faults: Sequence[Fault] = (), first_s: float = 0.0
) -> Iterator[Shot]:
    """Yield `blocks` blocks from `first_s` on. InputError for a fault that would test nothing."""
    KINDS.require(faults, places=[""], length=blocks)
    inter, frames = world.config.interrogator, world.config.band.block_frames
    sources = Sources(world.trains, world.cars, world.ground, inter.frame_hz, rng)
    receiver = Receiver(inter, world.cable, rng, world.optics)
    before: FibreBlock | None = None
    for number in range(blocks):
        seconds = first_s + (number * frames + 1 + np.arange(frames)) / inter.frame_hz
        last = float(seconds[-1])
        shaken = any(fault.kind == "shaken" and fault.active(number) for fault in faults)
        light = receiver.receive(_felt(world, sources, seconds, shaken, rng), world.drift(last))
        block = FibreBlock(light.phase_rate, light.intensity, round(last * 1_000), number)
        delivered, late = _faulty(block, before, number, faults)
        yield Shot(last, delivered, round(last * 1_000) + late, tuple(_truth(one, last) for one in world.trains))
        before = block


def _felt(world: World, sources: Sources, seconds: Floats, shaken: bool, rng: np.random.Generator) -> Floats:
    """Return the strain in the fibre, [frames, cells] in 1e-9."""
    cable = world.cable
    strain = np.zeros((len(seconds), len(cable.track_m)))
    for cells, piece in sources.strain(seconds, cable.track_m):
        strain[:, cells] += piece
    for cells, piece in emitted(world.config, world.soundings, seconds, cable):
        strain[:, cells] += piece
    if shaken:
        strain += 30 * rng.standard_normal((len(seconds), 1))
    strain *= cable.coupling
    return strain


def _truth(train: Train, second: float) -> TrainTruth:
    low, high = train.ends_m(second)
    return TrainTruth(low, high, float(train.course.speed_m_s(np.array([second]))[0]))


def _faulty(
    block: FibreBlock, before: FibreBlock | None, number: int, faults: Sequence[Fault]
) -> tuple[FibreBlock | None, int]:
    delivered: FibreBlock | None = block
    late = 0
    for fault in faults:
        if fault.active(number):
            if fault.kind == "late":
                late = 10_000
            elif fault.kind == "missing":
                delivered = None
            elif fault.kind == "duplicate":
                delivered = before
            elif fault.kind == "frozen" and before is not None:
                delivered = replace(block, phase_rate=before.phase_rate)
            elif delivered is not None and fault.kind != "shaken":
                delivered = _spoilt(delivered, fault.kind)
    return delivered, late


def _spoilt(block: FibreBlock, kind: str) -> FibreBlock:
    rate = np.array(block.phase_rate)
    if kind == "not finite":
        rate[3, 5] = np.nan
    elif kind == "wrong shape":
        rate = rate[:, :-1]
    elif kind == "short":
        rate = rate[:-1]
    elif kind == "wrong type":
        rate = rate.astype(np.complex64)
    elif kind == "silent":
        rate[:] = 0
    elif kind == "dark":
        return replace(block, intensity=np.zeros_like(np.asarray(block.intensity)))
    return replace(block, phase_rate=rate)
