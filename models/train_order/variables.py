"""Configuration and variables of the machine that tells whose a pattern is."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.config import Config, quantity
from safeloc.language.expr import BoolVar, NumVar, Var, boolean, number
from safeloc.language.units import COUNT, MM, UM, UM_PER_MM


class TrainOrderConfig(Config):
    """How many trains are told apart."""

    trains: int = quantity(3, "count", 1, 8, "[D] trains at a time in 10 to 40 km")
    position_limit_mm: int = quantity(1_000_000_000, "mm", 1_000, 10_000_000_000, "[D] 1 000 km of line")


@dataclass(frozen=True, eq=False)
class TrainGhosts:
    """Of one train: whether it is between the counters, and where, um; before the cycle and, freely chosen, after it."""

    number: int
    inside: BoolVar
    next_inside: BoolVar
    place: NumVar
    next_place: NumVar


@dataclass(frozen=True, eq=False)
class Parts:
    """The variables of the machine. Trains are numbers from 1 on; 0 is none.

    enters_low, enters_high, leaves_low, leaves_high  what the axle counters at both ends tell, complete trains
    clear     the axle counters tell that the area is empty
    fault     a counter is disturbed
    patterns  how many patterns the fibre sees; lows, highs: where, in order
    order     the trains in the area, from the low end; belongs: whose the patterns are
    trains    ghosts: which trains are in the area, and where
    owners    ghosts: the train that each pattern holds
    """

    config: TrainOrderConfig
    enters_low: NumVar
    enters_high: NumVar
    leaves_low: BoolVar
    leaves_high: BoolVar
    clear: BoolVar
    fault: BoolVar
    patterns: NumVar
    lows: tuple[NumVar, ...]
    highs: tuple[NumVar, ...]
    order: tuple[NumVar, ...]
    belongs: tuple[NumVar, ...]
    trains: tuple[TrainGhosts, ...]
    owners: tuple[NumVar, ...]

    @property
    def inputs(self) -> list[Var]:
        """What is heard in a cycle."""
        counters: list[Var] = [self.enters_low, self.enters_high, self.leaves_low, self.leaves_high]
        return [*counters, self.clear, self.fault, self.patterns, *self.lows, *self.highs]


def parts(config: TrainOrderConfig) -> Parts:
    """Fresh variables for one area."""
    count, far = config.trains, config.position_limit_mm
    ranks = range(1, count + 1)
    return Parts(
        config,
        number("enters_low", COUNT, 0, count),
        number("enters_high", COUNT, 0, count),
        boolean("leaves_low"),
        boolean("leaves_high"),
        boolean("counters_clear"),
        boolean("counter_fault"),
        number("patterns", COUNT, 0, count + 1),
        tuple(number(f"pattern_{n}_low_mm", MM, -far, far) for n in ranks),
        tuple(number(f"pattern_{n}_high_mm", MM, -far, far) for n in ranks),
        tuple(number(f"order_{n}", COUNT, 0, count) for n in ranks),
        tuple(number(f"pattern_{n}_train", COUNT, 0, count) for n in ranks),
        tuple(_train(n, far * UM_PER_MM) for n in ranks),
        tuple(number(f"pattern_{n}_owner", COUNT, 0, count) for n in ranks),
    )


def _train(number_: int, far_um: int) -> TrainGhosts:
    name = f"train_{number_}"
    return TrainGhosts(
        number_,
        boolean(f"{name}_inside"),
        boolean(f"next_{name}_inside"),
        number(f"{name}_place_um", UM, -far_um, far_um),
        number(f"next_{name}_place_um", UM, -far_um, far_um),
    )
