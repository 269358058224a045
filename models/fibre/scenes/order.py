"""The association of patterns with trains in a scene, from its patterns and its axle counters' events."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

from safeloc.codegen.compiled import Compiled, compile_system
from safeloc.language.system import lower, without_ghosts
from safeloc.language.units import MM_PER_M, UM_PER_MM
from safeloc.models.fibre.scenes.counters import Ends, events
from safeloc.models.fibre.scenes.scene import Moment
from safeloc.models.train_order import TrainOrderConfig, machine
from safeloc.runtime.streams.steps import Cell
from safeloc.sensing.fibre.features import TrainSeen

Steps = list[dict[str, Cell]]
ORDER = TrainOrderConfig()


@dataclass(frozen=True)
class Ordered:
    """Inputs of each step; the association of each train's pattern after it (None: no train's), and the trains in the area."""

    steps: Steps
    patterns: list[list[TrainSeen | None]]
    inside: list[list[bool]]


Places = Sequence[tuple[float, float]]


def places_of(moments: Sequence[Moment], train: int) -> Places:
    """Return the place of a train of the scene in each moment, m."""
    return [(moment.truth[train].low_m, moment.truth[train].high_m) for moment in moments]


def order_of(ends: Ends, moments: Sequence[Moment], trains: Sequence[Places]) -> Ordered:
    """Return the trains that the counters report, by their places, numbered from 1 on in the order given."""
    code = _on_board()
    passages = [events(ends, places) for places in trains]
    state, steps, patterns = code.first(), Steps(), list[list[TrainSeen | None]]()
    inside, inside_each = [False] * len(trains), list[list[bool]]()
    for number, moment in enumerate(moments):
        now = [one[number] for one in passages]
        was = any(inside)
        inside = [
            (one or event.startswith("ENTERS")) and not event.startswith("LEAVES")
            for one, event in zip(inside, now, strict=True)
        ]
        seen = [one for one in moment.trains if inside_area(one, ends)]
        step = _counted(now, clear=not was and not any(inside)) | patterns_of(seen, ORDER.trains)
        state, _ = code.step(state, code.read(step))
        owners = [code.named_outputs(state)[f"train_of_pattern_{rank}"] for rank in range(1, ORDER.trains + 1)]
        steps.append(step)
        inside_each.append(inside)
        patterns.append([_owned(seen, owners, train) for train in range(1, len(trains) + 1)])
    return Ordered(steps, patterns, inside_each)


def inside_area(one: TrainSeen, ends: Ends) -> bool:
    """Return the condition that some of the pattern is certainly between the counters, by the middle of its bounds."""
    low = one.low is not None and one.low.path_mm.low + one.low.path_mm.high >= 2 * ends.high_mm
    high = one.high is not None and one.high.path_mm.low + one.high.path_mm.high <= 2 * ends.low_mm
    return not low and not high


def _counted(now: Sequence[str], *, clear: bool) -> dict[str, Cell]:
    def train(event: str) -> int:
        return now.index(event) + 1 if event in now else 0

    return {
        "enters_low": train("ENTERS_LOW"), "enters_high": train("ENTERS_HIGH"), "leaves_low": "LEAVES_LOW" in now,
        "leaves_high": "LEAVES_HIGH" in now, "counters_clear": clear, "counter_fault": False,
    }  # fmt: skip


def patterns_of(patterns: Sequence[TrainSeen], trains: int) -> dict[str, Cell]:
    """Return the patterns in the area, from the low end, as the machine for `trains` trains hears them."""
    made: dict[str, Cell] = {"patterns": min(len(patterns), trains + 1)}
    for rank in range(1, trains + 1):
        one = patterns[rank - 1] if rank <= len(patterns) else None
        made[f"pattern_{rank}_low_mm"] = 0 if one is None or one.low is None else one.low.path_mm.low
        made[f"pattern_{rank}_high_mm"] = 0 if one is None or one.high is None else one.high.path_mm.high
    return made


def _owned(seen: Sequence[TrainSeen], owners: Sequence[int], train: int) -> TrainSeen | None:
    return next((one for one, owner in zip(seen, owners, strict=False) if owner == train), None)


def truth_of(trains: Sequence[Places], ordered: Ordered) -> Steps:
    """Return the ghost inputs: each train's middle, its presence in the area, and the train that each pattern of the steps contains."""
    made = Steps()
    for now, inside, seen in zip(zip(*trains, strict=True), ordered.inside, ordered.steps, strict=True):
        middles = [round(MM_PER_M * UM_PER_MM * (low + high) / 2) for low, high in now]
        step: dict[str, Cell] = {}
        for n in range(1, ORDER.trains + 1):
            step |= {f"next_train_{n}_inside": n <= len(inside) and inside[n - 1]}
            step |= {f"next_train_{n}_place_um": _at(middles, n)}
        made.append(step | {f"pattern_{n}_owner": _held(middles, seen, n) for n in range(1, ORDER.trains + 1)})
    return made


def _held(middles: Sequence[int], inputs: Mapping[str, Cell], pattern: int) -> int:
    low, high = (int(inputs[f"pattern_{pattern}_{side}_mm"]) * UM_PER_MM for side in ("low", "high"))
    return next((number for number, middle in enumerate(middles, 1) if low <= middle <= high), 1)


def _at(places: Sequence[int], number: int) -> int:
    return places[number - 1] if number <= len(places) else 0


@cache
def _on_board() -> Compiled:
    """Return the machine that associates patterns without its world, compiled once."""
    return compile_system(without_ghosts(lower(machine(ORDER))))
