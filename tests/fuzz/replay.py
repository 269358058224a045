"""Runs that safeloc hands over, made again by our own semantics."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from safeloc.language.trace import Trace
from tests.fuzz.explore import Edge, anyhow
from tests.fuzz.judge import Claim, hit_at
from tests.fuzz.terms import fast, was
from tests.fuzz.world import Game, State, World


class NotARunError(Exception):
    """The trace is no run of the machine."""


def again(
    game: Game, trace: Trace, allowed: Callable[[Edge], int], *, free: bool = False
) -> tuple[State, list[Mapping[str, int]]]:
    """First state, and what a claim reads in each step; NotARunError where our own semantics says otherwise."""
    first = {name: trace.initial[name] for name in game.state_names}
    if first not in list(game.firsts()) and not ((free or allowed is anyhow) and _first_on_board(game, first)):
        raise NotARunError(f"{first} is no first state")
    state, run = first, list[Mapping[str, int]]()
    for number, step in enumerate(trace.steps, 1):
        inputs = {name: step.inputs[name] for var in game.own_inputs for name in var.names}
        _admissible(game, inputs, number)
        known = {**state, **inputs}
        after, fired = game.moved(known)
        if not allowed(Edge(known, -1, fired, bool(game.lawful(known)))):
            raise NotARunError(f"step {number} is not allowed: {known}")
        if after != {name: step.state[name] for name in game.state_names}:
            raise NotARunError(f"step {number} from {known} leads to {after}, not {dict(step.state)}")
        _told(game, after, fired, step.fired, step.outputs, number)
        run.append({**known, **{was(name): state[name] for name in state}, **fired, **after})
        state = after
    return first, run


def _first_on_board(game: Game, first: State) -> bool:
    """For all inputs means whatever the environment is at the start: what ties it to the machine is not known on board."""
    on_board = {name: value for name, value in first.items() if name not in game.ghost_names}
    return on_board in list(game.board().firsts())


def _admissible(game: Game, inputs: Mapping[str, int], number: int) -> None:
    for var in game.own_inputs:
        if {name: inputs[name] for name in var.names} not in var.choices:
            raise NotARunError(f"step {number} has inputs out of range: {dict(inputs)}")


def _told(
    game: Game, after: State, fired: State, names: Mapping[str, str], outputs: Mapping[str, int], number: int
) -> None:
    rows = {row_name: row_of(game, row_name, value) for row_name, value in fired.items()}
    if dict(names) != rows:
        raise NotARunError(f"step {number} fires {rows}, not {dict(names)}")
    told = {name: fast(term)(after) for name, term in game.outputs.items()}
    if dict(outputs) != told:
        raise NotARunError(f"step {number} tells {told}, not {dict(outputs)}")


def row_of(game: Game, name: str, number: int) -> str:
    """The name of the row that fired."""
    world = game if isinstance(game, World) else next(one for one in game.worlds if f"{one.name}.fired" == name)
    return "(stay)" if number == 0 else world.rows[number - 1].name


def complaint(game: Game, trace: Trace, allowed: Callable[[Edge], int], claim: Claim) -> str:
    """What is wrong with a trace that is to break a claim (or to reach it) in its last step, and not before."""
    try:
        first, run = again(game, trace, allowed, free=claim.unconditional)
    except NotARunError as error:
        return f"its trace is no run: {error}"
    hit = hit_at(claim, first, run, game.state_names)
    return "" if hit == len(run) else f"its trace of {len(run)} steps shows it after {hit}"
