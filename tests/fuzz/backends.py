"""All back ends against our own evaluation, at the limits of 64 bits."""

from __future__ import annotations

import atexit
import os
import shutil
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import z3

from safeloc.codegen.batch import simulate
from safeloc.codegen.batch_lanes import compile_lanes
from safeloc.codegen.c_loader import load_c
from safeloc.codegen.compiled import compile_system
from safeloc.codegen.javascript import on_board
from safeloc.codegen.smt import Terms
from safeloc.codegen.smtlib import Query, to_smtlib
from safeloc.errors import InputError
from safeloc.language.expr import Bool, Expr, Lit, Num, NumVar, Var
from safeloc.language.interpret import run
from safeloc.language.machine import STAY_NAME
from safeloc.language.nodes import TRUE
from safeloc.language.system import TransitionSystem, lower, without_ghosts
from safeloc.proof.provers.recheck import decide
from safeloc.runtime.embedding import Controller, Program
from safeloc.runtime.embedding.snapshot import opened
from safeloc.target import Target
from tests.codegen import in_node
from tests.codegen.in_node import Node, NodeError, as_json, loaded
from tests.fuzz.bounds import fits
from tests.fuzz.build import Built
from tests.fuzz.draw import Draw
from tests.fuzz.replay import row_of
from tests.fuzz.tally import Tally
from tests.fuzz.terms import below, reads, value
from tests.fuzz.world import Game, State, Whole, World
from tests.fuzz.world import Var as OwnVar

STEPS, RUNS = 12, 6


@dataclass(frozen=True)
class Moment:
    """What every back end has to say after a step: state, names of rows that fired, outputs."""

    state: State
    fired: Mapping[str, str]
    outputs: State


@dataclass(frozen=True)
class OwnRun:
    """A first state, inputs, and what our own semantics makes of them."""

    first: State
    inputs: list[State]
    moments: list[Moment]

    def record(self, game: Game, step: int) -> dict[str, Any]:
        """The inputs of one step as a host gives them: what is absent is left out."""
        given: dict[str, Any] = {}
        for var in game.own_inputs:
            if not var.optional or self.inputs[step][var.present]:
                given[var.name] = _typed(var, self.inputs[step][var.name])
        return given


@dataclass(frozen=True)
class Bench:
    """What runs on board, in both forms, and the runs that every back end has to make."""

    game: Game
    built: Built
    system: TransitionSystem
    made: list[OwnRun]


def _typed(var: OwnVar, number: int) -> int | bool:
    return bool(number) if var.kind == "truth" else int(number)


def runs(game: Game, draw: Draw, count: int = RUNS, steps: int = STEPS) -> list[OwnRun]:
    """Random runs, made by the recursive definition of terms and not by the faster one."""
    return [_run(game, draw, steps) for _ in range(count)]


def _run(game: Game, draw: Draw, steps: int) -> OwnRun:
    first = state = _first(game, draw)
    inputs = [_inputs(game, draw) for _ in range(steps)]
    moments = []
    for one in inputs:
        state, fired = game.moved({**state, **one})
        told = {name: value(term, state) for name, term in game.outputs.items()}
        moments.append(Moment(state, {name: row_of(game, name, n) for name, n in fired.items()}, told))
    return OwnRun(first, inputs, moments)


def _first(game: Game, draw: Draw) -> State:
    first: State = {}
    for world in game.worlds if isinstance(game, Whole) else (game,):
        called = (
            (lambda name, world=world: game.called(world, name)) if isinstance(game, Whole) else (lambda name: name)
        )
        first[called("mode")] = 0
        for name, given in _open(world, draw).items():
            first[called(name)] = given
    return first


def _open(world: World, draw: Draw) -> State:
    """First values of the state; open ones such that `initially` holds, near the constants that it speaks of."""
    constants = [
        one[1] + near for term in world.initially for one in below(term) if one[0] == "lit" for near in (-1, 0, 1)
    ]
    while True:
        first = {
            var.name: _value(var, constants, draw) if given is None else given for var, given in world.state.items()
        }
        if all(value(term, {**first, "mode": 0}) for term in world.initially):
            return first


def _value(var: OwnVar, constants: list[int], draw: Draw) -> int:
    near = [number for number in constants if var.kind == "number" and var.low <= number <= var.high]
    return draw.rng.choice(near) if near and draw.sometimes(0.5) else draw.value(var)


def _inputs(game: Game, draw: Draw) -> State:
    inputs: State = {}
    for var in game.own_inputs:
        there = not var.optional or draw.sometimes(0.6)
        inputs[var.name] = draw.value(var) if there else var.absent
        if var.optional:
            inputs[var.present] = there
    return inputs


def all_back_ends(game: Game, built: Built, draw: Draw, tally: Tally, *, compiled_c: bool) -> None:
    """Every back end on the same runs; `game` and `built` are whole, what runs is what runs on board."""
    bare = game.board()
    system = without_ghosts(built.system)
    told = _told_the_truth(game)
    tally.judge("on board", f"accepted, and {told} cannot run: it hears what is not on board" if told else "")
    if told:
        return
    bench = Bench(bare, built, system, runs(bare, draw))
    narrow = _fits(bare)
    checks = {"interpreter": _interpreted, "Python": _python, "solvers": _solvers}
    checks |= {"JavaScript": _javascript} if shutil.which("node") else {}
    checks |= {"transitions": _transitions} if isinstance(game, World) else {}
    wide = {"numpy": _numpy, **({"C": _c, "lanes": _lanes} if compiled_c else {})}
    for name, check in {**checks, **wide}.items():
        try:
            for complaint in check(bench):
                tally.judge(name, complaint)
        except Exception as error:
            right = isinstance(error, InputError) and name in wide and not narrow
            tally.judge(name, "" if right else f"{type(error).__name__}: {error}")


def _told_the_truth(game: Game) -> str:
    """A wire to an input on board that reads a ghost, by name; empty if there is none."""
    if isinstance(game, World):
        return ""
    ghosts = {game.called(world, name) for world in game.worlds for name in world.ghost_names}
    return next((name for name, term in game.board().wires.items() if reads(term) & ghosts), "")


def _fits(game: Game) -> bool:
    """Whether no term of it leaves 64 bits, by our own bounds."""
    if isinstance(game, Whole):
        ranges = {name: (var.low, var.high) for name, var in game.variables.items()}
        return all(_fits(world) for world in game.worlds) and all(fits(t, ranges) for t in game.wires.values())
    ranges = {name: (var.low, var.high) for name, var in game.variables.items()}
    terms = [term for row in game.rows for term in (row.guard, *row.sets.values())]
    return all(fits(term, ranges) for term in (*terms, *game.outputs.values()))


def _differs(
    moment: Moment, state: Mapping[str, Any], fired: Mapping[str, str] | None, outputs: Mapping[str, Any]
) -> str:
    """What a back end says otherwise; empty if nothing. Truths must be truths."""
    wrong = [f"{n} is {state[n]!r}, not {v!r}" for n, v in moment.state.items() if state[n] != v]
    wrong += [f"{n} tells {outputs[n]!r}, not {v!r}" for n, v in moment.outputs.items() if outputs[n] != v]
    if fired is not None and dict(fired) != dict(moment.fired):
        wrong.append(f"fires {dict(fired)}, not {dict(moment.fired)}")
    return "; ".join(wrong)


def _chosen(game: Game, system: TransitionSystem, one: OwnRun) -> dict[str, Any]:
    """Values of the variables whose first value is open."""
    return {
        var.name: _typed(game.variables[var.name], one.first[var.name])
        for var in system.state
        if repr(system.initial[var]) == "ANY"
    }


def _interpreted(on: Bench) -> Iterator[str]:
    for one in on.made:
        stream = [one.record(on.game, step) for step in range(len(one.inputs))]
        trace = run(on.system, stream, first=_chosen(on.game, on.system, one))
        for moment, step in zip(one.moments, trace.steps, strict=True):
            yield _differs(moment, step.state, step.fired, step.outputs)


def _python(on: Bench) -> Iterator[str]:
    code = compile_system(on.system)
    for one in on.made:
        state = begin = code.first(_chosen(on.game, on.system, one))
        rows = [code.read(one.record(on.game, step)) for step in range(len(one.inputs))]
        for moment, row, later in zip(one.moments, rows, code.history(rows, begin), strict=True):
            state, fired = code.step(state, row)
            same = "" if state == later else f"history tells {later}, step {state}"
            named = dict(zip(code.state_names, state, strict=True))
            yield same or _differs(moment, named, code.fired(fired), code.named_outputs(state))


@cache
def _node(process: int) -> Node:  # noqa: ARG001 # one for each process, also for those of a pool
    node = Node()
    atexit.register(node.close)
    return node


def _javascript(on: Bench) -> Iterator[str]:
    """The script; where a term leaves 64 bits it may say so instead."""
    node, system = _node(os.getpid()), on_board(on.built.system)
    loaded(node, system, _chosen(on.game, system, on.made[0]))
    for one in on.made:
        node.ask("first", as_json(_chosen(on.game, system, one)))
        for step, moment in enumerate(one.moments):
            try:
                found = node.ask("step", as_json(one.record(on.game, step)))
            except NodeError as error:
                if _fits(on.game) or "exceeds 64 bits" not in str(error):
                    raise
                break
            yield "" if found == _told(system, moment) else f"tells {found}, not {moment}"


def _told(system: TransitionSystem, moment: Moment) -> dict[str, Any]:
    """A moment as a script tells it."""

    def text(term: Expr, number: int) -> str | bool | None:
        return in_node.told(term, int(number) if isinstance(term, Num) else bool(number))

    return {
        "state": {var.name: text(var, moment.state[var.name]) for var in system.state},
        "outputs": {name: text(term, moment.outputs[name]) for name, term in system.outputs.items()},
        "fired": [moment.fired[var.name] for var in system.fired],
    }


def _transitions(on: Bench) -> Iterator[str]:
    machine = on.built.machines[on.game.name]
    program = Program(Target(machine.name, (machine,), lower(machine), ()))
    for one in on.made[:2]:
        host: Any = SimpleNamespace()
        controller = Controller(program, period_ms=100, first=_chosen(on.game, on.system, one))
        controller.follow(host)
        for step, moment in enumerate(one.moments):
            report = controller.step_inputs(one.record(on.game, step))
            wrong = "" if host.state == f"M{moment.state['mode']}" else f"in state {host.state}"
            state = opened(controller.snapshot())["state"]
            fired = {"fired": report.moves[0].name if report.moves else STAY_NAME}
            yield wrong or _differs(moment, state, fired, report.values)


def _c(on: Bench) -> Iterator[str]:
    machine = load_c(on.system, first=_chosen(on.game, on.system, on.made[0]))
    for one in on.made:
        machine.reset(_chosen(on.game, on.system, one))
        stream = [one.record(on.game, step) for step in range(len(one.inputs))]
        for moment, record in zip(one.moments, stream, strict=True):
            outputs = machine.step(record)
            yield _differs(moment, machine.state, machine.fired, outputs)
        machine.reset(_chosen(on.game, on.system, one))
        for moment, outputs in zip(one.moments, machine.history(machine.rows(stream)), strict=True):
            yield _differs(Moment({}, {}, moment.outputs), {}, None, outputs)
        yield _differs(Moment(one.moments[-1].state, {}, {}), machine.state, None, {})


# ------------------------------------------------------------------ many runs at once


def _numpy(on: Bench) -> Iterator[str]:
    yield from _arrays(on, on.system)


def _lanes(on: Bench) -> Iterator[str]:
    yield from _arrays(on, compile_lanes(on.system, _kept(on.system), threads=1))


def _kept(system: TransitionSystem) -> list[str]:
    return [*(var.name for var in system.state), *system.outputs, *(var.name for var in system.fired)]


def _arrays(on: Bench, what: Any) -> Iterator[str]:
    names = {name: var.kind == "truth" or name != var.name for var in on.game.own_inputs for name in var.names}
    inputs = {
        name: np.array(
            [[one.inputs[step][name] for one in on.made] for step in range(STEPS)], bool if truth else np.int64
        )
        for name, truth in names.items()
    }
    start = {name: _column(on.game, name, on.made) for name in _chosen(on.game, on.system, on.made[0])}
    keep = _kept(on.system) if isinstance(what, TransitionSystem) else ()
    trace = simulate(what, inputs, start_state=start, keep=keep)
    kept = trace.kept
    for step in range(STEPS):
        for place, one in enumerate(on.made):
            told = {name: kept[name][step, place].item() for name in kept}
            fired = {name: row_of(on.game, name, told[name]) for name in one.moments[step].fired}
            yield _differs(one.moments[step], told, fired, told)


def _column(game: Game, name: str, made: list[OwnRun]) -> Any:
    kind = bool if game.variables[name].kind == "truth" else np.int64
    return np.array([one.first[name] for one in made], kind)


# ------------------------------------------------------------------ solvers


def _solvers(on: Bench) -> Iterator[str]:
    """One step of each run: z3 folds it to a constant, cvc5 finds that it cannot be otherwise."""
    for one in on.made[:2]:
        now = {**one.first, **one.inputs[0]}
        moment = one.moments[0]
        given: dict[Var, Any] = {var: now[var.name] for var in (*on.system.state, *on.system.inputs)}
        yield from _by_z3(on.system, given, moment)
        yield _by_cvc5(on.system, given, moment)


def _by_z3(system: TransitionSystem, given: Mapping[Var, Any], moment: Moment) -> Iterator[str]:
    terms = Terms({v: z3.IntVal(x) if isinstance(v, NumVar) else z3.BoolVal(bool(x)) for v, x in given.items()})
    for var, move in system.next.items():
        found = z3.simplify(terms(move))
        told = found.as_long() if isinstance(found, z3.IntNumRef) else z3.is_true(found)
        wanted = moment.state[var.name]
        yield "" if told == wanted else f"z3: {var.name} becomes {told}, not {wanted}"


def _by_cvc5(system: TransitionSystem, given: Mapping[Var, Any], moment: Moment) -> str:
    facts = [_is(var, number) for var, number in given.items()]
    goals = {var.name: _is(move, moment.state[var.name]) for var, move in system.next.items()}
    answers = decide("step", to_smtlib(Query("step", [TRUE, *facts], goals)), seconds=10)
    wrong = [name for name, answer in zip(goals, answers, strict=True) if answer != "unsat"]
    return f"cvc5: {wrong} become otherwise: {answers}" if wrong else ""


def _is(term: Num | Bool, number: int) -> Bool:
    if isinstance(term, Num):
        return term.eq(Lit(int(number), term.unit))
    return term if number else ~term
