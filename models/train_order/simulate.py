"""Simulated trains of an area and the fibre's patterns, as steps of the machine that associates them.

`python -m safeloc.models.train_order.simulate` writes the runs that ship, `... simulate FOLDER` those that are made on demand.
A cycle is a second. Trains run along the track; if two come so near that the fibre sees one pattern, there is one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from random import Random

from safeloc.language.units import UM_PER_MM
from safeloc.models.train_order import TrainOrderConfig
from safeloc.proof.drawn_runs.worked import Steps, WorkedRun, write_named
from safeloc.runtime.streams.steps import Cell

_HALF_MM = 120_000  # half a pattern: a train with the uncertainty of its ends
_ENDS_MM = (0, 10_000_000)


@dataclass(frozen=True)
class TrainRun:
    """A train that comes in at an end.

    enters_s  second in which it comes in; from above: at the high end
    speeds    (from this second on, mm/s), its sign by the line; the train is out when it has left an end behind
    """

    number: int
    enters_s: int
    speeds: tuple[tuple[int, int], ...]
    from_above: bool = False


@dataclass(frozen=True)
class Scene:
    """Events in an area; times in s.

    clear    seconds in which the counters report an empty area
    fault    seconds in which a counter is disturbed
    ghosts   (from, to, place): a pattern that is no train
    lost     (from, to, number): a train whose pattern is not seen
    events   second -> cells of the counters that differ
    """

    seconds: int
    trains: tuple[TrainRun, ...]
    clear: tuple[int, ...] = (1,)
    fault: tuple[int, ...] = ()
    ghosts: tuple[tuple[int, int, int], ...] = ()
    lost: tuple[tuple[int, int, int], ...] = ()
    events: tuple[tuple[int, Mapping[str, Cell]], ...] = ()


def seen(config: TrainOrderConfig, scene: Scene, seed: int = 0) -> Steps:
    """Return one step per second: counters, patterns, and the true places of the trains."""
    world = _World(config, scene, Random(seed))
    return [world.step(second) for second in range(scene.seconds)]


def simulate(config: TrainOrderConfig, *, seed: int) -> Steps:
    """Return as many trains as the machine can distinguish, one behind the other, some faster than the one before."""
    rng = Random(seed)
    trains, enters = list[TrainRun](), 5
    for number in range(1, config.trains + 1):
        trains.append(TrainRun(number, enters, ((enters, rng.randint(22_000, 30_000)),)))
        enters += rng.randint(60, 200)
    return seen(config, Scene(enters + 200, tuple(trains)), seed)


class _World:
    def __init__(self, config: TrainOrderConfig, scene: Scene, rng: Random) -> None:
        self._config, self._scene, self._rng = config, scene, rng
        self._places = {run.number: _ENDS_MM[run.from_above] for run in scene.trains}
        self._inside = list[int]()  # from the low end

    def step(self, second: int) -> dict[str, Cell]:
        """Return one cycle."""
        inputs = self._run(second)
        patterns = self._patterns(second)
        step: dict[str, Cell] = {
            "enters_low": 0, "enters_high": 0, "leaves_low": False, "leaves_high": False,
            "counters_clear": second in self._scene.clear, "counter_fault": second in self._scene.fault, **inputs,
            "patterns": min(len(patterns), self._config.trains + 1),
        }  # fmt: skip
        step |= dict(self._scene.events).get(second, {})
        for rank in range(self._config.trains):
            low, high, owner = patterns[rank] if rank < len(patterns) else (0, 0, 0)
            name = f"pattern_{rank + 1}"
            step |= {f"{name}_low_mm": low, f"{name}_high_mm": high, f"{name}_owner": owner}
        for number in range(1, self._config.trains + 1):
            step[f"next_train_{number}_place_um"] = self._places.get(number, 0) * UM_PER_MM
            step[f"next_train_{number}_inside"] = number in self._inside
        return step

    def _run(self, second: int) -> dict[str, Cell]:
        """Move every train; return the counters' inputs, at most one event."""
        inputs: dict[str, Cell] = {}
        for run in self._scene.trains:
            if second == run.enters_s:
                inputs["enters_high" if run.from_above else "enters_low"] = run.number
                self._inside.insert(len(self._inside) if run.from_above else 0, run.number)
            if run.number in self._inside:
                self._places[run.number] += [speed for begin, speed in run.speeds if begin <= second][-1]
                inputs |= self._leaves(run.number)
        return inputs

    def _leaves(self, number: int) -> dict[str, Cell]:
        low, high = _ENDS_MM
        if low - _HALF_MM <= self._places[number] <= high + _HALF_MM:
            return {}
        self._inside.remove(number)
        return {"leaves_low" if self._places[number] < low else "leaves_high": True}

    def _patterns(self, second: int) -> list[tuple[int, int, int]]:
        """Return low end, high end and owner of every pattern in order; patterns that overlap are one pattern."""
        hidden = {number for begin, end, number in self._scene.lost if begin <= second < end}
        middles = [(self._places[number], number) for number in self._inside if number not in hidden]
        middles += [(place, 0) for begin, end, place in self._scene.ghosts if begin <= second < end]
        merged = list[tuple[int, int, int]]()
        for middle, owner in sorted(middles):
            blur = self._rng.randint(0, 20_000)
            low, high = middle - _HALF_MM - blur, middle + _HALF_MM + blur
            if merged and low <= merged[-1][1]:
                merged[-1] = (merged[-1][0], high, merged[-1][2])
            else:
                merged.append((low, high, owner))
        return merged


# ------------------------------------------------------------------ named runs

FIRST = TrainRun(1, 5, ((5, 40_000),))
_SLOWER = TrainRun(1, 5, ((5, 30_000), (60, 8_000), (160, 30_000)))
_CATCHES_UP = TrainRun(2, 50, ((50, 30_000), (114, 8_000)))
_FROM_ABOVE = TrainRun(3, 100, ((100, -5_000), (120, -30_000), (160, 30_000)), from_above=True)


def _worked(outcome: str, scene: Scene) -> WorkedRun[TrainOrderConfig]:
    return WorkedRun(outcome, lambda config: seen(config, scene))


RUNS: Mapping[str, WorkedRun[TrainOrderConfig]] = {
    "train_order-service": _worked(
        "Two trains follow each other, a third comes from above and goes back: every pattern belongs to its train.",
        Scene(300, (FIRST, TrainRun(2, 80, ((80, 30_000), (160, 0), (220, 30_000))), _FROM_ABOVE)),
    ),
    "train_order-counter-fault": _worked(
        "A disturbed counter ends the order; patterns belong to no train until the counters report an empty "
        "area; then the next train has its own.",
        Scene(300, (FIRST, TrainRun(2, 275, ((275, 40_000),))), clear=(1, 265), fault=(100, 101)),
    ),
    "train_order-impossible-event": _worked(
        "A train is counted out of an empty area: the order is unknown from that cycle on, until the counters "
        "report an empty area.",
        Scene(60, (), clear=(1, 40), events=((20, {"leaves_high": True}),)),
    ),
}
"""The recordings that ship, by name."""
ON_DEMAND: Mapping[str, WorkedRun[TrainOrderConfig]] = {
    "train_order-close-together": _worked(
        "The second train comes so near to the first that there is one pattern: it belongs to no train; apart "
        "again, each has its own.",
        Scene(220, (_SLOWER, _CATCHES_UP)),
    ),
    "train_order-ghost-pattern": _worked(
        "Three patterns of two trains: none belongs to a train for as long as that lasts.",
        Scene(200, (FIRST, TrainRun(2, 80, ((80, 30_000),))), ghosts=((120, 160, 2_500_000),)),
    ),
    "train_order-lost-pattern": _worked(
        "A train that is not seen: the other's pattern belongs to no train, not to the nearest.",
        Scene(200, (FIRST, TrainRun(2, 80, ((80, 30_000),))), lost=((120, 150, 2),)),
    ),
}
"""Runs that do not ship, by name: another one shows each of their transitions and cases."""


if __name__ == "__main__":
    write_named(__file__, RUNS, ON_DEMAND, TrainOrderConfig())
