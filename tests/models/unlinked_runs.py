"""Runs of the machine of the unlinked group for its tests: plain figures, one metre a cycle."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache

from safeloc.language.interpret import run
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem, lower, without_ghosts
from safeloc.language.trace import Trace
from safeloc.language.units import Enumeration
from safeloc.models import unlinked_group
from safeloc.models.balise.groups import Group, telegram
from safeloc.models.unlinked_group.variables import UnlinkedGroupConfig
from safeloc.models.vocabulary.error_law import ErrorLaw
from safeloc.runtime.streams.steps import Cell

PLAIN = UnlinkedGroupConfig(
    odometer=ErrorLaw(kind="wheel", constant_mm=4_000, rate_ppm=50_000),
    tolerance_mm=60_000,
    max_acceleration_mm_s2=10_000,
    antenna_mm=3_000,
    detection_mm=1_000,
    measuring_step_mm=0,
    default_accuracy_mm=12_000,
)
"""Margins of 5 m at a reading with a latched counter, and 5 % of the way since then; 0.1 m more or less from cycle to cycle."""
NOT_READ = ("telegram_position_mm", "telegram_orientation")
UNLINKED = Group(7, 0, balises=2, linked=False)
Record = dict[str, Cell]


@cache
def on_board(config: UnlinkedGroupConfig = PLAIN) -> TransitionSystem:
    """The machine without its world."""
    return without_ghosts(lower(unlinked_group.machine(config)))


def reading(group: Group = UNLINKED, **changed: Cell | None) -> Record:
    """A reading of a group right under the antenna, with some values changed, or left out (None)."""
    read = {**telegram(group, since_mm=0), **changed}
    return {name: value for name, value in read.items() if value is not None and name not in NOT_READ}


def step(distance: int | None = 1_000, *more: Mapping[str, Cell]) -> Record:
    """One cycle: a measured distance and whatever else comes."""
    record: Record = {} if distance is None else {"odometer_mm": distance}
    for part in more:
        record |= part
    return record


def held(*more: Mapping[str, Cell]) -> list[Record]:
    """The odometer measures, then the unlinked group is read."""
    return [step(), step(1_000, reading(), *more)]


def drive(stream: Sequence[Record], config: UnlinkedGroupConfig = PLAIN) -> Trace:
    """The run of a stream on board."""
    return run(on_board(config), stream)


def out(trace: Trace, index: int = -1) -> Mapping[str, Value]:
    """The outputs of a step."""
    return trace.steps[index].outputs


def label(trace: Trace, name: str, index: int = -1) -> str:
    """An enumerated output as its member."""
    unit = trace.system.outputs[name].unit  # type: ignore[union-attr]
    assert isinstance(unit, Enumeration)
    return unit.members[int(out(trace, index)[name])]


def interval(trace: Trace, index: int = -1) -> tuple[int, int, int]:
    """The distance and the margins above and below it, mm."""
    found = out(trace, index)
    return int(found["distance_mm"]), int(found["margin_above_mm"]), int(found["margin_below_mm"])
