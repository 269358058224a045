"""Check that a single stream lies in a tube: it compares values only, independently of the terms by which the tube is
proved.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from safeloc.language.expr import BoolVar, Var
from safeloc.language.nodes import Value
from safeloc.language.system import canonical
from safeloc.proof.around.deviations import Channel
from safeloc.proof.around.tube import Tube

Row = Mapping[Var, Value]


def first_outside(tube: Tube, rows: Sequence[Row]) -> int | None:
    """Return the first cycle in which a stream (or the beginning of one) leaves the tube; None if it does not."""
    waiting = {channel: {(0, 0)} for channel in tube.deviations.channels if channel.drops or channel.delay}
    lanes = {name for channel in waiting for name in channel.names}
    for number, row in enumerate(rows, 1):
        if not _alone_near(tube, row, number, lanes):
            return number
        for channel, states in waiting.items():
            waiting[channel] = {after for state in states for after in _after(tube, channel, state, number, row)}
            if not waiting[channel]:
                return number
    return None


def _alone_near(tube: Tube, row: Row, number: int, lanes: set[str]) -> bool:
    """Return whether all inputs apart from those of channels are near what is given in the same cycle."""
    given = tube.given.rows[number - 1]
    owner: dict[Var, Var] = {one.present: one.value for one in tube.system.optionals}
    for var in tube.system.inputs:
        if owner.get(var, var).name in lanes:
            continue
        if var in tube.system.ghosts:
            near = not tube.named(var) or _near(tube, var, row[var], tube.given.choices[number - 1][var])
        else:
            near = _near(tube, var, row[var], given[var])
        if not near:
            return False
    return all(
        one.present not in row or row[one.present] or row[one.value] == canonical(one.value)
        for one in tube.system.optionals
    )


def _near(tube: Tube, var: Var, value: Value, at: Value) -> bool:
    if isinstance(var, BoolVar):
        return value == at
    return abs(value - at) <= tube.width(var) and var.low <= value <= var.high


def _after(tube: Tube, channel: Channel, state: tuple[int, int], number: int, row: Row) -> Iterator[tuple[int, int]]:
    """Yield what may have been taken and lost after a cycle that gives this row."""
    taken, lost = state
    options = [one for one in tube.system.optionals if one.value.name in channel.names]
    members = [var for var in tube.system.inputs if var.name in channel.names]
    rows = tube.given.rows
    if not options:
        for source in range(max(1, taken, number - channel.delay), number + 1):
            if all(_near(tube, var, row[var], rows[source - 1][var]) for var in members):
                yield source, lost
        return
    sent = [at for at, one in enumerate(rows, 1) if any(one[option.present] for option in options)]
    due, late = (sum(at <= limit for at in sent) for limit in (number, number - channel.delay))
    if not any(row[option.present] for option in options):
        for last in range(max(taken, late), due + 1):
            if lost + last - taken <= channel.drops:
                yield last, lost + last - taken
        return
    for last in range(max(taken + 1, late), due + 1):
        message = rows[sent[last - 1] - 1]
        same = all(row[one.present] == message[one.present] for one in options)
        near = same and all(
            not row[one.present] or _near(tube, one.value, row[one.value], message[one.value]) for one in options
        )
        if near and lost + last - taken - 1 <= channel.drops:
            yield last, lost + last - taken - 1
