"""Random small machines: what is decided of a tube is what all its streams, run one by one, show."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import product

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from safeloc.language.expr import BoolVar, Num, NumVar, Var
from safeloc.language.interpret import evaluate, read_inputs, start, step
from safeloc.language.nodes import Value
from safeloc.language.spec import always, observe
from safeloc.language.system import TransitionSystem, canonical, lower, without_ghosts
from safeloc.language.units import Enumeration
from safeloc.proof.around.containment import first_outside
from safeloc.proof.around.course import Space
from safeloc.proof.around.deviations import Channel, Deviations
from safeloc.proof.around.tube import Given, Tube
from safeloc.proof.around.windows import Breaks, Claim, Holds, Windows
from safeloc.proof.provers.limits import Limits
from tests.random_machines import machines, records

MOST = 4000


@st.composite
def tubes(draw: st.DrawFn) -> Tube:
    """A tube around a short stream of a random machine without its world."""
    board = without_ghosts(lower(draw(machines(most_terms=12))))
    rows = [read_inputs(board, row) for row in draw(st.lists(records(board), min_size=2, max_size=3))]
    flags = {one.present for one in board.optionals}
    plain = [var for var in board.inputs if var not in flags]
    numbers = [var for var in plain if isinstance(var, NumVar) and not isinstance(var.unit, Enumeration)]
    widths = {var.name: 1 for var in numbers if draw(st.booleans())}
    optional = {one.value for one in board.optionals}
    channels = []
    for var in plain:
        lost, late = draw(st.integers(0, 1)) if var in optional else 0, draw(st.integers(0, 1))
        if draw(st.booleans()) and (lost or late):
            channels.append(Channel((var.name,), lost, late))
    return Tube(board, Given(rows, start(board)), Deviations(widths, tuple(channels)))


def streams(tube: Tube) -> Iterator[list[Mapping[Var, Value]]]:
    """All streams of the tube: those of all values that could be near, without the ones that are outside."""
    every = [list(near_rows(tube, number)) for number in range(1, tube.length + 1)]
    for rows in product(*every):
        if first_outside(tube, rows) is None:
            yield list(rows)


def near_rows(tube: Tube, number: int) -> Iterator[Mapping[Var, Value]]:
    option: dict[Var, Var] = {one.value: one.present for one in tube.system.optionals}
    flags = set(option.values())
    names = {name: channel for channel in tube.deviations.channels for name in channel.names}
    given = tube.given.rows
    choices: list[list[dict[Var, Value]]] = []
    for var in tube.system.inputs:
        if var in flags:
            continue
        late = names[var.name].delay if var.name in names else 0
        sources = [given[at - 1] for at in range(max(1, number - late), number + 1)]
        found: list[dict[Var, Value]] = []
        for row in sources:
            near = (
                [row[var]]
                if isinstance(var, BoolVar)
                else range(row[var] - tube.width(var), row[var] + tube.width(var) + 1)
            )
            there = {option[var]: row[option[var]]} if var in option else {}
            found += [{var: value, **there} for value in near if not there or row[option[var]] or value == row[var]]
        if isinstance(var, NumVar) and var in option and var.name in names:
            found.append({var: canonical(var), option[var]: False})
        choices.append(
            [dict(one) for one in {tuple(sorted(each.items(), key=lambda pair: pair[0].name)) for each in found}]
        )
    for some in product(*choices):
        yield {var: value for one in some for var, value in one.items()}


def states(system: TransitionSystem, rows: Sequence[Mapping[Var, Value]]) -> list[Mapping[Var, Value]]:
    """The states of a run, the first one included."""
    found: list[Mapping[Var, Value]] = [start(system)]
    for row in rows:
        found.append(step(system, found[-1], row)[0])
    return found


def count(tube: Tube) -> int:
    """How many streams are looked at."""
    total = 1
    for number in range(1, tube.length + 1):
        total *= sum(1 for _ in near_rows(tube, number))
    return total


@given(st.data())
@settings(
    max_examples=40,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much, HealthCheck.data_too_large],
)
def test_verdicts_are_those_of_all_streams(data: st.DataObject) -> None:
    """A claim holds exactly if no stream breaks it; a stream that is found to break it does; no run leaves what is handed over."""
    tube = data.draw(tubes())
    if count(tube) > MOST:
        return
    board = tube.system
    output = board.outputs["number"]
    assert isinstance(output, Num)
    runs = [states(board, rows) for rows in streams(tube)]
    assert runs
    values = [int(evaluate([output], state)[0]) for run in runs for state in run]
    bound = data.draw(st.sampled_from(sorted({max(values), max(values) - 1, values[0], min(values)})))
    goal = observe(board, always("bounded", output <= bound))
    broken = any(value > bound for value in values)
    windows = Windows(Space(goal.system, tube), [Claim("bounded", goal)], Limits(), window=1)
    [outcome] = windows.outcomes().values()
    assert isinstance(outcome, Breaks if broken else Holds)
    if isinstance(outcome, Breaks):
        assert first_outside(tube, outcome.stream) is None
        assert int(evaluate([output], states(board, outcome.stream)[-1])[0]) > bound
    for cycle, pieces in windows.handed:
        known = [{var: piece.fixed[var] for var in piece.fixed if var in set(board.state)} for piece in pieces]
        for run in runs:
            assert any(
                all(run[cycle][var] == value for var, value in fixed.items())
                and all(
                    low <= run[cycle][var] <= high
                    for var, (low, high) in piece.ranges.items()
                    if var in set(board.state)
                )
                for piece, fixed in zip(pieces, known, strict=True)
            )
