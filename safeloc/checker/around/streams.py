"""Single streams, run by the reference interpreter: whether one is lawful, lies in the tube, and breaks a claim."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from safeloc.checker.around.question import Channel, Claim, Question
from safeloc.checker.around.windows import first_values
from safeloc.errors import InputError
from safeloc.language.expr import BoolVar, Optional, Var
from safeloc.language.interpret import Values, holds, read_inputs, start, step
from safeloc.language.spec import Goal
from safeloc.language.system import TransitionSystem, canonical, environment
from safeloc.runtime.streams.steps import StepStream

Row = Mapping[Var, int | bool]


@dataclass(frozen=True, eq=False)
class Ran:
    """A stream that was run: its inputs, and the states, the first one included."""

    rows: Sequence[Values]
    states: Sequence[Values]


def ran(system: TransitionSystem, stream: StepStream, claim: Claim | None = None, goal: Goal | None = None) -> Ran:
    """Run a stream, with the observers of a goal if there is one. InputError for a cycle that breaks a law."""
    watched = system if goal is None else goal.system
    state, rows, condition = start(watched, stream.first), list[Values](), environment(system)
    states = [state]
    for number, record in enumerate(stream.steps, 1):
        row = read_inputs(system, record)
        if not holds(condition, {**state, **row}):
            raise InputError(f"the stream breaks a law in cycle {number}")
        state, _ = step(watched, state, row)
        if claim is not None and goal is not None and number == claim.first - 1:
            state = {**state, **first_values(goal)}
        rows.append(row)
        states.append(state)
    return Ran(rows, states)


def first_broken(claim: Claim, goal: Goal, found: Ran) -> int | None:
    """Return the first cycle in which a stream breaks a claim; None if it breaks it in none."""
    judged = claim.cycles(len(found.rows))
    return next((cycle for cycle in judged if not holds(goal.good, found.states[cycle])), None)


def first_outside(of: Question, found: Ran, system: TransitionSystem) -> int | None:
    """Return the first cycle in which a stream leaves the tube, 0 for the first state; None if it does not."""
    if not _begins_as_given(of, found, system) or not _ghosts_near(of, found.states[0], 0):
        return 0
    waiting = {one: {(0, 0)} for one in of.channels if one.drops or one.delay}
    lanes = {name for one in waiting for name in one.names}
    for number, row in enumerate(found.rows, 1):
        if not _alone_near(of, row, number, system, lanes) or not _ghosts_near(of, found.states[number], number):
            return number
        for channel, states in waiting.items():
            waiting[channel] = {after for state in states for after in _after(of, channel, state, number, row, system)}
            if not waiting[channel]:
                return number
    return None


def _begins_as_given(of: Question, found: Ran, system: TransitionSystem) -> bool:
    board = of.given.board[0]
    return all(found.states[0][var] == board[var] for var in system.state if var in board)


def _ghosts_near(of: Question, state: Row, cycle: int) -> bool:
    return all(
        abs(state[var] - value) <= of.widths[var.name]
        for var, value in (of.given.ghosts[cycle].items() if of.given.ghosts else ())
        if var in of.system.ghosts and var in state and var.name in of.widths
    )


def _alone_near(of: Question, row: Row, number: int, system: TransitionSystem, lanes: set[str]) -> bool:
    """Return whether all inputs that are on no channel are near those given in the same cycle."""
    owner: dict[Var, Var] = {option.present: option.value for option in of.system.optionals}
    for var in system.inputs:
        if owner.get(var, var).name in lanes:
            continue
        ghost = var in of.system.ghosts
        if ghost and var.name not in of.widths:
            continue
        at = (of.given.choices if ghost else of.given.rows)[number - 1][var]
        if not _near(of, var, row[var], at):
            return False
    return True


def _near(of: Question, var: Var, value: int | bool, at: int | bool) -> bool:
    return value == at if isinstance(var, BoolVar) else abs(value - at) <= of.widths.get(var.name, 0)


def _after(
    of: Question, channel: Channel, state: tuple[int, int], number: int, row: Row, system: TransitionSystem
) -> Iterator[tuple[int, int]]:
    """Yield how many messages may have been taken, and how many of them lost, after a cycle with this row."""
    taken, lost = state
    rows = of.given.rows
    options = [option for option in system.optionals if option.value.name in channel.names]
    if not options:
        members = [var for var in system.inputs if var.name in channel.names]
        for at in range(max(1, taken, number - channel.delay), number + 1):
            if all(_near(of, var, row[var], rows[at - 1][var]) for var in members):
                yield at, lost
        return
    sent = [at for at, one in enumerate(rows, 1) if any(one[option.present] for option in options)]
    late, due = (sum(at <= limit for at in sent) for limit in (number - channel.delay, number))
    comes = any(row[option.present] for option in options)
    for last in range(max(taken + comes, late), due + 1):
        gone = lost + last - taken - comes
        if gone <= channel.drops and (not comes or _is_message(of, options, row, rows[sent[last - 1] - 1])):
            yield last, gone


def _is_message(of: Question, options: Sequence[Optional], row: Row, sent: Row) -> bool:
    return all(
        row[one.present] == sent[one.present]
        and (
            _near(of, one.value, row[one.value], sent[one.value])
            if row[one.present]
            else row[one.value] == canonical(one.value)
        )
        for one in options
    )
