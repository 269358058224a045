"""Quick streams of a tube, at its corners: each run is one stream, so it proves nothing; it may break a claim at once.

They come before the proof. A stream that is found here is replayed and brought nearer like any other.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence

from safeloc.language.expr import NumVar, Var
from safeloc.language.nodes import Value
from safeloc.language.system import canonical
from safeloc.proof.around.containment import first_outside
from safeloc.proof.around.course import Space, first_piece
from safeloc.proof.around.tube import Tube
from safeloc.proof.around.windows import Breaks, Claim
from safeloc.proof.drawn_runs.allowed import compiled_terms

_RANDOM, _LOST = 4, 40
"""Runs with values drawn anew in each cycle, and with one message lost each."""
Row = Mapping[Var, Value]


def broken_at_corners(space: Space, claims: Sequence[Claim]) -> dict[Claim, Breaks]:
    """Return claims that one of the streams breaks: each with the stream given if that breaks it, else with the shortest one.

    The space has no ghosts.
    """
    known = first_piece(space)
    state = tuple(space.system.state)
    start = [known.fixed[var] for var in state]
    runs = _Runs(space, claims)
    first, every = dict(zip(state, start, strict=True)), streams(space.tube)
    given = next(every)
    by_itself = {claim: Breaks(first, given[:cycle]) for claim, cycle in runs.broken(start, given).items()}
    left = [claim for claim in claims if claim not in by_itself]
    found: dict[Claim, Breaks] = {}
    for rows in every if left else ():
        most = max(found[claim].cycle if claim in found else len(rows) for claim in left)
        for claim, cycle in runs.broken(start, rows[:most]).items():
            if claim in left and (claim not in found or cycle < found[claim].cycle):
                found[claim] = Breaks(first, rows[:cycle])
    return found | by_itself


class _Runs:
    """The machine compiled, with what the claims say after each step."""

    def __init__(self, space: Space, claims: Sequence[Claim]) -> None:
        system = space.system
        self._claims, self._restarts, self._inputs = claims, space.restarts, tuple(system.inputs)
        self._state = tuple(system.state)
        self._step = compiled_terms((*self._state, *self._inputs), [system.next[var] for var in self._state])
        self._goods = compiled_terms(self._state, [claim.goal.good for claim in claims])

    def broken(self, start: Sequence[Value], rows: Sequence[Row]) -> dict[Claim, int]:
        """Return the first cycle in which a stream breaks each claim that it breaks."""
        found: dict[Claim, int] = {}
        state = list(start)
        for cycle, row in enumerate(rows, 1):
            state = list(self._step([*state, *(row[var] for var in self._inputs)]))
            restart = self._restarts.get(cycle)
            if restart is not None:
                state = [restart.get(var, value) for var, value in zip(self._state, state, strict=True)]
            for claim, good in zip(self._claims, self._goods(state), strict=True):
                if not good and claim not in found and claim.judges(cycle):
                    found[claim] = cycle
        return found


def streams(tube: Tube) -> Iterator[list[Row]]:
    """Yield the stream given, and streams of the tube in which inputs are at the ends of their widths or a message is lost."""
    yield list(tube.given.rows)
    wide = [var for var in tube.system.inputs if isinstance(var, NumVar) and tube.width(var)]
    signs = [dict.fromkeys(wide, 1), dict.fromkeys(wide, -1)]
    signs += [{var: sign} for var in wide if len(wide) > 1 for sign in (1, -1)]
    for some in signs if wide else []:
        yield _moved(tube, [some] * tube.length)
        yield _moved(
            tube, [{var: sign * (-1) ** number for var, sign in some.items()} for number in range(tube.length)]
        )
    draw = random.Random(0)
    for _ in range(_RANDOM if wide else 0):
        yield _moved(tube, [{var: draw.choice((-1, 0, 1)) for var in wide} for _ in range(tube.length)])
    yield from _lost(tube)


def _moved(tube: Tube, signs: Sequence[Mapping[NumVar, int]]) -> list[Row]:
    rows: list[Row] = []
    presence = {one.value: one.present for one in tube.system.optionals}
    for row, some in zip(tube.given.rows, signs, strict=True):
        moved = dict(row)
        for var, sign in some.items():
            if var not in presence or row[presence[var]]:
                moved[var] = min(var.high, max(var.low, int(row[var]) + sign * tube.width(var)))
        rows.append(moved)
    return rows


def _lost(tube: Tube) -> Iterator[list[Row]]:
    """Yield streams without one message of a channel, as far as the tube allows."""
    for channel in tube.deviations.channels:
        options = [one for one in tube.system.optionals if one.value.name in channel.names]
        sent = [n for n, row in enumerate(tube.given.rows) if any(row[one.present] for one in options)]
        for number in sent[:: max(1, len(sent) // _LOST)] if channel.drops else []:
            rows: list[Row] = list(tube.given.rows)
            gone = {
                var: value
                for one in options
                for var, value in ((one.present, False), (one.value, canonical(one.value)))
            }
            rows[number] = {**rows[number], **gone}
            if first_outside(tube, rows) is None:
                yield rows
