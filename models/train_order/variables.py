"""Configuration and variables of the machine that associates patterns with trains."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import BoolVar, NumVar, boolean, number
from safeloc.language.machine import ANY
from safeloc.language.units import COUNT, MM, UM, UM_PER_MM


class TrainOrderConfig(Config):
    """Number of trains and range of positions."""

    trains: int = quantity(3, "count", 1, 8, "[D] trains at a time in 10 to 40 km")
    position_limit_mm: int = quantity(1_000_000_000, "mm", 1_000, 10_000_000_000, "[D] 1 000 km of line")


@dataclass(frozen=True, eq=False)
class TrainGhosts:
    """Ghosts of one train: between the counters or not, and its place, um; before the cycle and, freely chosen, after it."""

    number: int
    inside: BoolVar
    next_inside: BoolVar
    place: NumVar
    next_place: NumVar


class Parts:
    """The variables of the machine. Trains are numbers from 1 on; 0 is none.

    enters_low, enters_high, leaves_low, leaves_high  reports of the axle counters at both ends, of complete trains
    clear     the axle counters report an empty area
    fault     a counter is disturbed
    patterns  number of patterns that the fibre sees; lows, highs: their ends, in order
    order     the trains in the area, from the low end; belongs: the train of each pattern
    trains    ghosts: trains in the area, with their places
    owners    ghosts: the train that each pattern contains
    """

    def __init__(self, config: TrainOrderConfig) -> None:
        self.declared = declared = Declared()
        count, far = config.trains, config.position_limit_mm
        ranks = range(1, count + 1)
        self.config = config
        self.enters_low = declared.sensor(number("enters_low", COUNT, 0, count))
        self.enters_high = declared.sensor(number("enters_high", COUNT, 0, count))
        self.leaves_low = declared.sensor(boolean("leaves_low"))
        self.leaves_high = declared.sensor(boolean("leaves_high"))
        self.clear = declared.sensor(boolean("counters_clear"))
        self.fault = declared.sensor(boolean("counter_fault"))
        self.patterns = declared.sensor(number("patterns", COUNT, 0, count + 1))
        self.lows = tuple(declared.sensor(number(f"pattern_{n}_low_mm", MM, -far, far)) for n in ranks)
        self.highs = tuple(declared.sensor(number(f"pattern_{n}_high_mm", MM, -far, far)) for n in ranks)
        self.order = tuple(declared.state(number(f"order_{n}", COUNT, 0, count), first=0) for n in ranks)
        self.belongs = tuple(declared.state(number(f"pattern_{n}_train", COUNT, 0, count), first=0) for n in ranks)
        self.trains = tuple(_train(declared, n, far * UM_PER_MM) for n in ranks)
        self.owners = tuple(declared.choice(number(f"pattern_{n}_owner", COUNT, 0, count)) for n in ranks)


def parts(config: TrainOrderConfig) -> Parts:
    """Return fresh variables for one area."""
    return Parts(config)


def _train(declared: Declared, number_: int, far_um: int) -> TrainGhosts:
    name = f"train_{number_}"
    return TrainGhosts(
        number_,
        declared.ghost(boolean(f"{name}_inside"), first=ANY),
        declared.choice(boolean(f"next_{name}_inside")),
        declared.ghost(number(f"{name}_place_um", UM, -far_um, far_um), first=ANY),
        declared.choice(number(f"next_{name}_place_um", UM, -far_um, far_um)),
    )
