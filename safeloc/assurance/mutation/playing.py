"""Run a mutant along the known runs of the machine, to see which claims break and where its outputs differ.

Until a mutant moves differently, its states are those of the machine. So each run is first searched for the step in which the
mutant moves differently or a changed claim fails, and the mutant is run only from there on.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from safeloc.assurance.mutation.claims import Claim, Held, Layer
from safeloc.assurance.mutation.columns import Columns, Pair
from safeloc.assurance.mutation.corpus import Run
from safeloc.assurance.mutation.stepping import Row, stepped
from safeloc.errors import EngineError, InputError
from safeloc.language.interpret import Program, holds, start
from safeloc.language.machine import Any_
from safeloc.language.nodes import Bool, Expr, Num, Value
from safeloc.language.system import TransitionSystem, environment, without_ghosts
from safeloc.language.units import Enumeration

WORLD = 1
"""Number of the layer of claims that need the assumption of the machine."""
_MORE = 400
"""Steps that are run, in each layer, after the first broken claim, to see which others break."""
_APART = 200
"""Greatest number of different states that are kept of a mutant that moves differently."""


@dataclass(frozen=True)
class _Broken:
    """A claim that a run breaks, and the number of steps after which it is broken."""

    claim: str
    run: str
    steps: int


@dataclass(frozen=True)
class Played:
    """The result of all runs. The last four are found only if no claim is broken.

    broken   broken claims, each with the run that breaks it in the fewest steps
    differs  a text about the first state along a recording with other outputs; "" if there is none
    other    the same along any run; recordings are preferred
    seen     rows that fire and modes that occur while the mutant moves as the machine does
    apart    states on board of the machine and of the mutant that differ, after the same steps, all of which the world allows; only some
    """

    broken: tuple[_Broken, ...]
    differs: str
    other: str
    seen: frozenset[Event] = frozenset()
    apart: tuple[Apart, ...] = ()


Apart = tuple[Row, Row]
"""A state of the machine, and that of a mutant after the same inputs."""
Event = tuple[str, int]
"""A row that fires, or a mode that occurs, by number."""


@dataclass(frozen=True, eq=False)
class Path:
    """A run in one system, with the state before each step and the last one; it ends where the assumption forbids a step."""

    run: Run
    rows: tuple[Row, ...]
    states: tuple[Row, ...]


@dataclass(frozen=True, eq=False)
class _Trail:
    """A run of the machine without its world: the path, the outputs in each state, and the row that fired in each step.

    lawful  number of its first states that the world allows
    """

    system: TransitionSystem
    path: Path
    outputs: tuple[Row, ...]
    fired: tuple[Row, ...]
    lawful: int = 0

    def seen(self, steps: int | None) -> set[Event]:
        """Return the events of the first steps; of all steps if `steps` is None."""
        [machine] = self.system.machines
        mode = next(n for n, var in enumerate(self.system.state) if var is machine.mode)
        rows = {("row", int(fired[0])) for fired in self.fired[:steps]}
        until = None if steps is None else steps + 1
        return rows | {("mode", int(state[mode])) for state in self.path.states[:until]}


@dataclass(frozen=True, eq=False)
class Trodden:
    """The paths of all runs of the unchanged machine: without its world (`board`), and for each layer of claims.

    on_board, columns  values of the machine's terms along the paths of `board` and of each layer
    """

    unchanged: Held
    board: tuple[_Trail, ...]
    layers: tuple[tuple[Path, ...], ...]
    on_board: Columns
    columns: tuple[Columns, ...]


def trodden(unchanged: Held, runs: Sequence[Run]) -> Trodden:
    """Run the unchanged machine along these runs. Those that break one of its claims are left out."""
    judging = [_Judging(layer) for layer in unchanged.layers]
    kept = [run for run in runs if not (run.has_ghosts and any(one.breaks(run) for one in judging))]
    lawful = [run for run in kept if run.has_ghosts]
    board = _Board(unchanged.system)
    layers = tuple(tuple(_paths(one, lawful)) for one in judging)
    allowed = {path.run.name: len(path.states) for path in layers[WORLD]}
    trails = tuple(replace(board.trail(run), lawful=allowed.get(run.name, 0)) for run in kept)
    columns = [
        _columns(one.system, paths, [claim.good for claim in _judged(one)])
        for one, paths in zip(unchanged.layers, layers, strict=True)
    ]
    on_board = _columns(without_ghosts(unchanged.system), [trail.path for trail in trails], ())
    return Trodden(unchanged, trails, layers, on_board, tuple(columns))


def _columns(system: TransitionSystem, paths: Sequence[Path], goods: Sequence[Bool]) -> Columns:
    made = Columns(system.state, system.inputs, [(path.states, path.rows) for path in paths])
    made.keep([*system.next.values(), *goods])
    return made


def _paths(judging: _Judging, runs: Sequence[Run]) -> Iterator[Path]:
    for run in runs:
        path = judging.path(run)
        if path is not None:
            yield path


def played(mutant: Held, known: Trodden) -> Played:
    """Run a mutant along all known runs on which it differs from the machine."""
    broken: dict[str, _Broken] = {}
    by_layer = zip(mutant.layers, known.unchanged.layers, known.layers, known.columns, strict=True)
    for layer, was, paths, columns in by_layer:
        for claim, run, steps in _broken(layer, was, paths, columns):
            name = str(claim)
            if name not in broken or steps < broken[name].steps:
                broken[name] = _Broken(name, run, steps)
    if broken:
        return Played(_confirmed(mutant, known, broken), "", "")
    return _otherwise(mutant, known)


def _confirmed(mutant: Held, known: Trodden, broken: Mapping[str, _Broken]) -> tuple[_Broken, ...]:
    """Return all broken claims; the interpreter confirms the one broken first, else EngineError."""
    first = min(broken.values(), key=lambda one: one.steps)
    run = next(trail.path.run for trail in known.board if trail.path.run.name == first.run)
    layer = next(layer for layer in mutant.layers for claim in _judged(layer) if str(claim) == first.claim)
    _confirm(layer, run, first)
    return tuple(broken.values())


def _confirm(layer: Layer, run: Run, broken: _Broken) -> None:
    """Confirm in the interpreter that the run breaks the claim; EngineError if it does not."""
    claim = next(claim for claim in _judged(layer) if str(claim) == broken.claim)
    system = layer.system
    state = start(system, _chosen(system, run))
    moving = Program([environment(system), *system.next.values()])
    for row in run.rows[: broken.steps]:
        allowed, *after = moving({**state, **dict(zip(system.inputs, row, strict=True))})
        if not allowed:
            raise EngineError(f"{system.name}: {run.name} breaks the assumption in the interpreter.")
        state = dict(zip(system.next, after, strict=True))
    if holds(claim.good, state):
        raise EngineError(f"{system.name}: {run.name} does not break {claim} in the interpreter.")


def first_broken(layer: Layer, runs: Sequence[Run]) -> _Broken | None:
    """Return the claim that is broken first along the first run that breaks any, confirmed by the interpreter; None if none is."""
    judging = _Judging(layer)
    for run in runs:
        found = judging.broken(Path(run, (), ()), 0)
        if found:
            place = min(found, key=lambda one: found[one])
            broken = _Broken(str(judging.claims[place]), run.name, found[place])
            _confirm(layer, run, broken)
            return broken
    return None


def outputs_along(system: TransitionSystem, run: Run) -> tuple[Row, ...]:
    """Return the outputs in each state of a run, without regard to what the world allows."""
    return _Board(system).trail(run).outputs


# ------------------------------------------------------------------ claims


def _broken(layer: Layer, was: Layer, paths: Sequence[Path], columns: Columns) -> Iterator[tuple[Claim, str, int]]:
    """Return the broken claims of a layer, with run and number of steps; it ends `_MORE` steps after the first one."""
    one, other = layer.system, was.system
    if one.init is not other.init or one.assume is not other.assume or one.state != other.state:
        entries: Iterator[tuple[Path, int]] = ((path, 0) for path in paths)
    else:
        entries = _entries(layer, was, paths, columns)
    judging, left = None, _MORE
    for path, begin in entries:
        judging = judging or _Judging(layer)
        found = judging.broken(path, begin)
        yield from ((judging.claims[place], path.run.name, steps) for place, steps in found.items())
        left -= len(path.rows) - begin if found or left < _MORE else 0
        if left <= 0:
            return


def _entries(layer: Layer, was: Layer, paths: Sequence[Path], columns: Columns) -> Iterator[tuple[Path, int]]:
    """Return the paths on which a move or a claim differs, each with the number of steps before that."""
    moves = _other_moves(layer.system, was.system)
    goods = [(new.good, old.good) for new, old in zip(_judged(layer), _judged(was), strict=True)]
    goods = [pair for pair in goods if pair[0] is not pair[1]]
    if moves or goods:
        begins = columns.first_different(moves, goods)
        yield from ((path, begin) for path, begin in zip(paths, begins, strict=True) if begin is not None)


def _other_moves(system: TransitionSystem, was: TransitionSystem) -> list[Pair]:
    """Return the pairs of new and old next values that are different terms."""
    return [(system.next[var], was.next[var]) for var in system.state if system.next[var] is not was.next[var]]


def _judged(layer: Layer) -> list[Claim]:
    return [claim for claim in layer.claims if claim.kind != "helper"]


def _next(system: TransitionSystem) -> list[Expr]:
    """Return the terms of the state after a step, in the order of the state."""
    return [system.next[var] for var in system.state]


class _Judging:
    """The claims of one layer, compiled to be judged along runs."""

    def __init__(self, layer: Layer) -> None:
        self._system = system = layer.system
        self.claims = _judged(layer)
        self._step = stepped((system.state, system.inputs), [system.assume, *_next(system)])
        self._look = stepped((system.state, ()), [claim.good for claim in self.claims])

    def path(self, run: Run) -> Path | None:
        """Return the run up to the first step that is not allowed; None if no run of the layer begins so."""
        try:
            states = [_first(self._system, run)]
        except InputError:
            return None
        for row in run.rows:
            allowed, *after = self._step(states[-1], row)
            if not allowed:
                break
            states.append(tuple(after))
        return Path(run, run.rows[: len(states) - 1], tuple(states))

    def breaks(self, run: Run) -> bool:
        """Return whether the allowed part of the run breaks a claim."""
        path = self.path(run)
        return path is not None and not all(all(self._look(state, ())) for state in path.states)

    def broken(self, path: Path, begin: int) -> dict[int, int]:
        """Return the claims, by place, that are broken from step `begin` of a path on, each with its number of steps."""
        if begin:
            state = path.states[begin]
        else:
            try:
                state = _first(self._system, path.run)
            except InputError:  # no run of this declaration begins there
                return {}
        found: dict[int, int] = {}
        self._judge(state, begin, found)
        for number in range(begin, len(path.run.rows)):
            allowed, *after = self._step(state, path.run.rows[number])
            if not allowed:
                break
            state = tuple(after)
            self._judge(state, number + 1, found)
        return found

    def _judge(self, state: Row, number: int, found: dict[int, int]) -> None:
        goods = self._look(state, ())
        if not all(goods):
            for place, good in enumerate(goods):
                if not good:
                    found.setdefault(place, number)


# ------------------------------------------------------------------ outputs


def _otherwise(mutant: Held, known: Trodden) -> Played:
    """Return where outputs first differ along a recording and along any run, and the events before the mutant differs."""
    one, other = known.board[0].system, without_ghosts(mutant.system)
    outputs = any(term is not one.outputs[name] for name, term in other.outputs.items())
    board, words, seen, apart = _Board(mutant.system), dict[bool, str](), set[Event](), dict[Apart, None]()
    begins = known.on_board.first_different(_other_moves(other, one), ())
    for trail, moved in zip(known.board, begins, strict=True):
        seen |= trail.seen(moved)
        begin = 0 if outputs else moved
        if begin is not None and trail.path.run.recorded not in words:
            found = board.differs(trail, begin, apart)
            if found:
                words[trail.path.run.recorded] = found
    recorded = words.get(True, "")
    return Played((), recorded, recorded or words.get(False, ""), frozenset(seen), tuple(apart))


def outputs_side_by_side(mutant: Held, known: Trodden) -> Iterator[tuple[dict[str, Value], dict[str, Value]]]:
    """Return the outputs of the machine and of the mutant for each state of the known runs in which they differ."""
    board, names = _Board(mutant.system), list(mutant.system.outputs)
    for trail in known.board:
        for was, now in zip(trail.outputs, board.trail(trail.path.run).outputs, strict=True):
            if was != now:
                yield dict(zip(names, was, strict=True)), dict(zip(names, now, strict=True))


def tells_otherwise(unchanged: Held, mutant: Held, run: Run) -> bool:
    """Return whether the world allows the whole run, and the mutant's outputs along it differ from the machine's."""
    judging = _Judging(unchanged.layers[WORLD])
    path = judging.path(run)
    if path is None or len(path.rows) < len(run.rows):
        return False
    return outputs_along(unchanged.system, run) != outputs_along(mutant.system, run)


class _Board:
    """The machine without its world, compiled to be run along runs."""

    def __init__(self, unchanged: TransitionSystem) -> None:
        self._system = system = without_ghosts(unchanged)
        self._columns = [number for number, var in enumerate(unchanged.inputs) if var not in unchanged.ghosts]
        self._step = stepped((system.state, system.inputs), _next(system))
        self._look = stepped((system.state, ()), list(system.outputs.values()))
        self._fired = stepped((system.state, system.inputs), list(system.fired.values()))

    def trail(self, run: Run) -> _Trail:
        """Return the complete run, with its outputs and the rows that fire."""
        rows = tuple(tuple(row[column] for column in self._columns) for row in run.rows)
        states = [_first(self._system, run)]
        for row in rows:
            states.append(self._step(states[-1], row))
        outputs = tuple(self._look(state, ()) for state in states)
        fired = tuple(self._fired(state, row) for state, row in zip(states, rows, strict=False))
        return _Trail(self._system, Path(run, rows, tuple(states)), outputs, fired)

    def differs(self, trail: _Trail, begin: int, apart: dict[Apart, None]) -> str:
        """Return a text about the first state from `begin` on with other outputs than in `trail`; "" if there is none.

        Lawful states that differ are added to `apart`, until these are enough.
        """
        path, state = trail.path, trail.path.states[begin]
        for number in range(begin, len(path.states)):
            if number < trail.lawful and len(apart) < _APART and state != path.states[number]:
                apart[path.states[number], state] = None
            now, was = self._look(state, ()), trail.outputs[number]
            if now != was:
                names = zip(self._system.outputs.items(), now, was, strict=True)
                outputs = [
                    f"{name} {_shown(term, new)} instead of {_shown(term, old)}"
                    for (name, term), new, old in names
                    if new != old
                ]
                return f"{path.run.name}, step {number}: {', '.join(outputs[:3])}"
            if number < len(path.rows):
                state = self._step(state, path.rows[number])
        return ""


def _shown(term: Expr, value: Value) -> str:
    if isinstance(term, Num) and isinstance(term.unit, Enumeration):
        return term.unit.members[value]
    return str(value)


def _first(system: TransitionSystem, run: Run) -> Row:
    """Return the first state of a run; InputError if no run of the system begins so."""
    values = start(system, _chosen(system, run))
    return tuple(values[var] for var in system.state)


def _chosen(system: TransitionSystem, run: Run) -> dict[str, Value]:
    """Return the values of the run's first state that the declaration leaves open."""
    open_ = {var.name for var in system.state if isinstance(system.initial[var], Any_)}
    return {name: value for name, value in run.first.items() if name in open_}
