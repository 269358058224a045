"""Runs of the balise machine for its tests: one metre a cycle, groups at round places, plain figures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache

from safeloc.language.interpret import run
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem, lower, without_ghosts
from safeloc.language.trace import Trace
from safeloc.language.units import Enumeration
from safeloc.models import balise
from safeloc.models.balise.groups import Group, announcement, telegram
from safeloc.models.balise.variables import BaliseConfig
from safeloc.models.vocabulary.error_law import ErrorLaw
from safeloc.runtime.streams.steps import Cell

PLAIN = BaliseConfig(
    odometer=ErrorLaw(kind="wheel", constant_mm=0, rate_ppm=50_000),
    antenna_mm=0,
    detection_mm=0,
    measuring_step_mm=0,
    default_accuracy_mm=2_000,
    trust_first_group=True,
)
START = Group(1, 0, accuracy_mm=None)
NEXT = Group(2, 50_000, accuracy_mm=1_000, reaction="NONE")
LATER = Group(3, 90_000, accuracy_mm=1_000, reaction="NONE")
Record = dict[str, Cell]


@cache
def on_board(config: BaliseConfig = PLAIN) -> TransitionSystem:
    """The machine without its environment."""
    return without_ghosts(lower(balise.machine(config)))


def step(distance: int = 1_000, *more: Mapping[str, Cell]) -> Record:
    """One cycle: a measured distance and whatever else comes."""
    record: Record = {"odometer_mm": distance}
    for part in more:
        record |= part
    return record


def located(*announced: Group) -> list[Record]:
    """Running at 1 m a cycle, a trusted group at place 0 at the end of the first cycle; then the announcements.

    After k further cycles the estimate is k m, with 2 m and 5 % of the way on either side.
    """
    return [step(1_000, telegram(START, since_mm=0)), *(step(1_000, announcement(group)) for group in announced)]


def until(cycle: int, stream: list[Record]) -> list[Record]:
    """The stream, run on to the cycle before the given one."""
    return [*stream, *(step() for _ in range(cycle - len(stream)))]


def read_at(cycle: int, group: Group = NEXT, *announced: Group, **changed: Cell | None) -> Trace:
    """The group (with changed fields) is read at the end of the given cycle; NEXT is announced, or other groups."""
    read = {**telegram(group, since_mm=0), **changed}
    stream = until(cycle, located(*(announced or (NEXT,))))
    return drive([*stream, step(1_000, {name: value for name, value in read.items() if value is not None})])


def drive(stream: Sequence[Record], config: BaliseConfig = PLAIN) -> Trace:
    """The run of a stream on board."""
    return run(on_board(config), stream)


def label(trace: Trace, name: str, index: int = -1) -> str:
    """An enumerated output as its member."""
    unit = trace.system.outputs[name].unit  # type: ignore[union-attr]
    assert isinstance(unit, Enumeration)
    return unit.members[int(trace.steps[index].outputs[name])]


def out(trace: Trace, index: int = -1) -> Mapping[str, Value]:
    """The outputs of a step."""
    return trace.steps[index].outputs


def interval(trace: Trace, index: int = -1) -> tuple[int, int, int]:
    """Position and the margins above and below it in mm."""
    found = out(trace, index)
    return int(found["position_mm"]), int(found["margin_above_mm"]), int(found["margin_below_mm"])


def intervals(trace: Trace) -> list[tuple[int, int, int]]:
    """Position and the margins above and below it of every step."""
    return [interval(trace, index) for index in range(len(trace.steps))]


def wrong(stream: Sequence[Mapping[str, Cell]], trace: Trace) -> list[int]:
    """The steps whose reported interval misses the truth by more than its rounding to mm."""
    found = []
    for index, record in enumerate(stream):
        position, above, below = interval(trace, index)
        holds = position - below <= int(record["truth_mm"]) + 1 and int(record["truth_mm"]) <= position + above
        if out(trace, index)["valid"] and not holds:
            found.append(index)
    return found


def board_only(record: Mapping[str, Cell]) -> Record:
    """A simulated step without ghosts and remarks."""
    return {name: value for name, value in record.items() if not name.endswith("_nm") and name != "truth_mm"}
