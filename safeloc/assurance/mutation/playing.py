"""A mutant, run along the runs of the machine as it is: which claims break, and where its outputs differ.

Along a run that it leaves as it was, a mutant does what the machine did. So each run is first looked through for the step in
which the mutant moves otherwise, or a changed claim does not hold; only from there on is it run.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

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
"""The layer of claims that rely on the assumption."""
_MORE = 400
"""Steps that are run after the first claim has broken, to see which others break."""


@dataclass(frozen=True)
class _Broken:
    """A claim that a run breaks, after so many steps."""

    claim: str
    run: str
    steps: int


@dataclass(frozen=True)
class Played:
    """What came of all runs.

    broken   claims that broke, each with the first run that broke it
    differs  the first step of a recording in which another output comes, in words
    other    the same of any run
    seen     rows that fire and modes that are come to on the parts of runs on which the mutant does what the machine does
    """

    broken: tuple[_Broken, ...]
    differs: str
    other: str
    seen: frozenset[Event] = frozenset()


Event = tuple[str, int]
"""A row that fires, or a mode that is come to, by number."""


@dataclass(frozen=True, eq=False)
class Path:
    """A run of the machine as it is, in one system: the states before each step, and the last one; fewer where it is not allowed."""

    run: Run
    rows: tuple[Row, ...]
    states: tuple[Row, ...]


@dataclass(frozen=True, eq=False)
class _Trail:
    """A run of what runs on board: its path, the outputs in each state, and which row fired in each step."""

    system: TransitionSystem
    path: Path
    told: tuple[Row, ...]
    fired: tuple[Row, ...]

    def seen(self, steps: int | None) -> set[Event]:
        """What happens in the first steps; in all of them if that is None."""
        [machine] = self.system.machines
        mode = next(n for n, var in enumerate(self.system.state) if var is machine.mode)
        rows = {("row", int(fired[0])) for fired in self.fired[:steps]}
        until = None if steps is None else steps + 1
        return rows | {("mode", int(state[mode])) for state in self.path.states[:until]}


@dataclass(frozen=True, eq=False)
class Trodden:
    """The paths of all runs of the machine as it is: what runs on board, and each layer of claims.

    on_board, columns  the values of the machine's terms along these paths
    """

    whole: Held
    board: tuple[_Trail, ...]
    layers: tuple[tuple[Path, ...], ...]
    on_board: Columns
    columns: tuple[Columns, ...]


def trodden(whole: Held, runs: Sequence[Run]) -> Trodden:
    """Run the machine as it is. A run that breaks one of its claims is left out."""
    judging = [_Judging(layer) for layer in whole.layers]
    kept = [run for run in runs if not (run.whole and any(one.breaks(run) for one in judging))]
    lawful = [run for run in kept if run.whole]
    board = _Board(whole.system)
    layers = tuple(tuple(_paths(one, lawful)) for one in judging)
    trails = tuple(board.trail(run) for run in kept)
    columns = [
        _columns(one.system, paths, [claim.good for claim in _judged(one)])
        for one, paths in zip(whole.layers, layers, strict=True)
    ]
    on_board = _columns(without_ghosts(whole.system), [trail.path for trail in trails], ())
    return Trodden(whole, trails, layers, on_board, tuple(columns))


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
    """Run a mutant along all runs on which it does otherwise."""
    broken: dict[str, _Broken] = {}
    by_layer = zip(mutant.layers, known.whole.layers, known.layers, known.columns, strict=True)
    for layer, was, paths, columns in by_layer:
        for claim, run, steps in _broken(layer, was, paths, columns):
            name = str(claim)
            if name not in broken or steps < broken[name].steps:
                broken[name] = _Broken(name, run, steps)
    if broken:
        return Played(_confirmed(mutant, known, broken), "", "")
    return _otherwise(mutant, known)


def _confirmed(mutant: Held, known: Trodden, broken: Mapping[str, _Broken]) -> tuple[_Broken, ...]:
    """All of them, the shortest of them by the interpreter. EngineError where it does not break the claim."""
    first = min(broken.values(), key=lambda one: one.steps)
    run = next(trail.path.run for trail in known.board if trail.path.run.name == first.run)
    layer = next(layer for layer in mutant.layers for claim in _judged(layer) if str(claim) == first.claim)
    _confirm(layer, run, first)
    return tuple(broken.values())


def _confirm(layer: Layer, run: Run, broken: _Broken) -> None:
    """EngineError where the run does not break the claim in the interpreter."""
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
    """The claim that breaks first along the first run that breaks one; the interpreter has confirmed it."""
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
    """The outputs in each state of a run, as they come on board."""
    return _Board(system).trail(run).told


# ------------------------------------------------------------------ claims


def _broken(layer: Layer, was: Layer, paths: Sequence[Path], columns: Columns) -> Iterator[tuple[Claim, str, int]]:
    """The claims of a layer that break, by run, until enough steps were run."""
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
    """The paths on which something is otherwise, each with the number of steps before it is."""
    moves = _other_moves(layer.system, was.system)
    goods = [(new.good, old.good) for new, old in zip(_judged(layer), _judged(was), strict=True)]
    goods = [pair for pair in goods if pair[0] is not pair[1]]
    if moves or goods:
        begins = columns.first_different(moves, goods)
        yield from ((path, begin) for path, begin in zip(paths, begins, strict=True) if begin is not None)


def _other_moves(system: TransitionSystem, was: TransitionSystem) -> list[Pair]:
    """The next values that are other terms than they were."""
    return [(system.next[var], was.next[var]) for var in system.state if system.next[var] is not was.next[var]]


def _judged(layer: Layer) -> list[Claim]:
    return [claim for claim in layer.claims if claim.kind != "helper"]


def _next(system: TransitionSystem) -> list[Expr]:
    """The values after a step, in the order of a row of the state."""
    return [system.next[var] for var in system.state]


class _Judging:
    """The claims of one layer along a run."""

    def __init__(self, layer: Layer) -> None:
        self._system = system = layer.system
        self.claims = _judged(layer)
        self._step = stepped((system.state, system.inputs), [system.assume, *_next(system)])
        self._look = stepped((system.state, ()), [claim.good for claim in self.claims])

    def path(self, run: Run) -> Path | None:
        """The run as far as it is allowed; None where no run of the layer begins so."""
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
        """Whether the run breaks a claim."""
        path = self.path(run)
        return path is not None and not all(all(self._look(state, ())) for state in path.states)

    def broken(self, path: Path, begin: int) -> dict[int, int]:
        """The claims, by place, that break from some step of a path on, each with the steps after which it is broken."""
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
    """The first other output of a recording, and of any run."""
    one, other = known.board[0].system, without_ghosts(mutant.system)
    told = any(term is not one.outputs[name] for name, term in other.outputs.items())
    board, words, seen = _Board(mutant.system), dict[bool, str](), set[Event]()
    begins = known.on_board.first_different(_other_moves(other, one), ())
    for trail, moved in zip(known.board, begins, strict=True):
        seen |= trail.seen(moved)
        begin = 0 if told else moved
        if begin is not None and trail.path.run.recorded not in words:
            found = board.differs(trail, begin)
            if found:
                words[trail.path.run.recorded] = found
    recorded = words.get(True, "")
    return Played((), recorded, recorded or words.get(False, ""), frozenset(seen))


def told_side_by_side(mutant: Held, known: Trodden) -> Iterator[tuple[dict[str, Value], dict[str, Value]]]:
    """The outputs of the machine as it is, and of the mutant, in each state of each run where they are not the same."""
    board, names = _Board(mutant.system), list(mutant.system.outputs)
    for trail in known.board:
        for was, now in zip(trail.told, board.trail(trail.path.run).told, strict=True):
            if was != now:
                yield dict(zip(names, was, strict=True)), dict(zip(names, now, strict=True))


def tells_otherwise(whole: Held, mutant: Held, run: Run) -> bool:
    """Whether the world allows the run, and other outputs come along it than those of the machine as it is."""
    judging = _Judging(whole.layers[WORLD])
    path = judging.path(run)
    if path is None or len(path.rows) < len(run.rows):
        return False
    return outputs_along(whole.system, run) != outputs_along(mutant.system, run)


class _Board:
    """What runs on board, along a run."""

    def __init__(self, whole: TransitionSystem) -> None:
        self._system = system = without_ghosts(whole)
        self._columns = [number for number, var in enumerate(whole.inputs) if var not in whole.ghosts]
        self._step = stepped((system.state, system.inputs), _next(system))
        self._look = stepped((system.state, ()), list(system.outputs.values()))
        self._fired = stepped((system.state, system.inputs), list(system.fired.values()))

    def trail(self, run: Run) -> _Trail:
        """The whole run."""
        rows = tuple(tuple(row[column] for column in self._columns) for row in run.rows)
        states = [_first(self._system, run)]
        for row in rows:
            states.append(self._step(states[-1], row))
        told = tuple(self._look(state, ()) for state in states)
        fired = tuple(self._fired(state, row) for state, row in zip(states, rows, strict=False))
        return _Trail(self._system, Path(run, rows, tuple(states)), told, fired)

    def differs(self, trail: _Trail, begin: int) -> str:
        """The first step from there on after which another output comes, in words; "" where there is none."""
        path, state = trail.path, trail.path.states[begin]
        for number in range(begin, len(path.states)):
            now, was = self._look(state, ()), trail.told[number]
            if now != was:
                names = zip(self._system.outputs.items(), now, was, strict=True)
                told = [
                    f"{name} {_shown(term, new)} instead of {_shown(term, old)}"
                    for (name, term), new, old in names
                    if new != old
                ]
                return f"{path.run.name}, step {number}: {', '.join(told[:3])}"
            if number < len(path.rows):
                state = self._step(state, path.rows[number])
        return ""


def _shown(term: Expr, value: Value) -> str:
    if isinstance(term, Num) and isinstance(term.unit, Enumeration):
        return term.unit.members[value]
    return str(value)


def _first(system: TransitionSystem, run: Run) -> Row:
    """The first state of a run; InputError where no run of the system begins so."""
    values = start(system, _chosen(system, run))
    return tuple(values[var] for var in system.state)


def _chosen(system: TransitionSystem, run: Run) -> dict[str, Value]:
    """Of the run's first state what is open."""
    open_ = {var.name for var in system.state if isinstance(system.initial[var], Any_)}
    return {name: value for name, value in run.first.items() if name in open_}
