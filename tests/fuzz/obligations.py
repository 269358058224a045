"""Free obligations against the explicit search."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from itertools import combinations

from safeloc.language.trace import Trace
from safeloc.language.verdict import Proved, Unknown, Vacuous, Violated
from safeloc.proof.provers.obligation import Obligation
from safeloc.proof.provers.obligations import CHECKS
from safeloc.proof.provers.reachability import reached
from tests.fuzz.case import Case
from tests.fuzz.explore import Edge, Space, anyhow, lawful, search
from tests.fuzz.replay import NotARunError, again, row_of
from tests.fuzz.terms import fast
from tests.fuzz.world import Game, State, Var, Whole, World

Allowed = Callable[[Edge], int]
STEPS, FURTHER = 5, 60  # of the runs that show the assumption to be kept


def obligations(case: Case) -> None:
    """All of a machine or composition."""
    for check in (*CHECKS.values(), reached):
        try:
            found = list(check(case.built.system, case.limits))
        except Exception as error:
            case.tally.judge("obligation", f"{type(error).__name__} instead of obligations: {error}")
            continue
        for one in found:
            _judged(case, one, found)


def _judged(case: Case, one: Obligation, all_: list[Obligation]) -> None:
    kind, wrong = _wrong(case, one, all_)
    what = f"obligation {kind}"
    if isinstance(one.verdict, Unknown) and not wrong:
        case.tally.open(what)
    else:
        case.tally.judge(what, wrong and f"{wrong}; {one.name}: {one.verdict}, {one.method}")


def _wrong(case: Case, one: Obligation, all_: list[Obligation]) -> tuple[str, str]:
    """Its kind, and what is wrong with it."""
    name = one.name
    if name == "ranges":
        return "ranges", _ranges(case, one, {other.name for other in all_})
    if name.startswith("range of "):
        return "ranges", _range(case, one, name.removeprefix("range of "))
    if name.startswith("overlap "):
        return "overlap", _overlap(case, one, all_)
    if name == "absence":
        return "absence", _absence(case, one)
    if name.startswith(("mode ", "transition ")):
        return "reachable", _reached(case, one)
    if name == "assumption":
        return "assumption", _assumption(case, one)
    if name == "assumption lasts":
        return name, _lasts(case, one)
    if name == "dead ends":
        return name, _dead_ends(case, one)
    if name == "division":
        return "division", "" if isinstance(one.verdict, Proved) else "every divisor is a positive constant"
    if name.startswith("overflow"):
        grows = any(var.kind == "number" and _strays(case.space, var) for var in case.game.variables.values())
        fine = grows or isinstance(one.verdict, (Proved, Unknown))  # it rests on ranges, which may be undecided
        return "overflow", "" if fine else "small numbers do not leave 64 bits"
    return f"{name.split(' ')[0]} (not compared)", ""


# ------------------------------------------------------------------ ranges


def _strays(space: Space, var: Var, allowed: Allowed = anyhow) -> bool:
    """Whether some state has it out of range."""
    reached = space.reached(allowed)
    return (
        var.name in space.states[0]
        and any(not var.low <= space.states[state][var.name] <= var.high for state in reached)
        if space.states
        else False
    )


def _ranges(case: Case, one: Obligation, names: set[str]) -> str:
    if not isinstance(one.verdict, Proved):
        return f"{one.verdict}"
    board = case.board()
    for name, var in case.game.variables.items():
        ghost = name in case.game.ghost_names
        space, allowed = (case.space, lawful) if ghost else (board, anyhow)
        if name in case.game.state_names and f"range of {name}" not in names and _strays(space, var, allowed):
            return f"{name} leaves its range"
    return ""


def _range(case: Case, one: Obligation, name: str) -> str:
    var = case.game.variables.get(name)
    if var is None:
        return "a mode is told to leave its range" if isinstance(one.verdict, Violated) else ""
    allowed = lawful if name in case.game.ghost_names else anyhow
    match one.verdict:
        case Violated(trace=Trace() as trace):
            return _ends(case.space, trace, allowed, lambda env: not var.low <= env[name] <= var.high)
        case Violated():
            return "no run"
        case Unknown(depth=depth):
            reached = case.space.reached(allowed)
            early = [d for s, d in reached.items() if not var.low <= case.space.states[s][name] <= var.high]
            return f"out of range after {min(early)} steps" if early and min(early) <= depth else ""
    return ""


def _ends(space: Space, trace: Trace, allowed: Allowed, wanted: Callable[[State], bool]) -> str:
    """What is wrong with a run that is to end as wanted."""
    try:
        first, run = again(space.game, trace, allowed)
    except NotARunError as error:
        return f"its trace is no run: {error}"
    return "" if wanted({**(run[-1] if run else first)}) else "its trace does not show it"


# ------------------------------------------------------------------ overlap, absence


def _overlap(case: Case, one: Obligation, all_: list[Obligation]) -> str:
    """What is wrong with what is told of a pair of rows, or of all pairs that are not told apart."""
    about, _, pair = one.name.removeprefix("overlap ").partition(": ")
    whole = isinstance(case.game, Whole)
    world = next(w for w in case.game.worlds if w.name == about) if isinstance(case.game, Whole) else case.game
    space = search(world.board()) if whole else case.board()
    apart = {other.name.rpartition(": ")[2] for other in all_ if other.name.startswith(f"{one.name}: ")}
    happen = [rows for rows in _pairs_together(space, world) if (rows == pair if pair else rows not in apart)]
    match one.verdict:
        case Proved():
            return f"{happen[0]} are enabled together" if happen else ""
        case Violated():
            return "no run has both enabled" if case.expect.overlap_happens and not happen else ""
    return ""


def _pairs_together(space: Space, world: World) -> Iterator[str]:
    """Two rows of one rank that are enabled in the same step of some run."""
    guards = [(number, row, fast(row.guard)) for number, row in enumerate(world.rows, 1)]
    for _, edge in space.steps(anyhow):
        on = [(n, row) for n, row, guard in guards if edge.known["mode"] in row.sources and guard(edge.known)]
        yield from (f"rows {a} and {b}" for (a, x), (b, y) in combinations(on, 2) if x.rank == y.rank)


def _absence(case: Case, one: Obligation) -> str:
    """The value of an absent input, whatever it is, changes nothing on board; of a single machine."""
    if isinstance(case.game, Whole):
        return ""
    world = case.game.board()
    seen = next((name for name in _read_though_absent(case.board(), world)), None)
    if isinstance(one.verdict, Proved) and seen:
        return f"{seen} is read though absent"
    if isinstance(one.verdict, Violated) and case.expect.overlap_happens and not seen:
        return "no run reads what is absent"
    return ""


def _read_though_absent(space: Space, world: World) -> Iterator[str]:
    for _, edge in space.steps(anyhow):
        known = {name: value for name, value in edge.known.items()}
        for var in world.inputs:
            if var.optional and not known[var.present]:
                moves = {str(world.moved({**known, var.name: value})) for value in var.values}
                if len(moves) > 1:
                    yield var.name


# ------------------------------------------------------------------ what is reached


def _world(game: Game, one: Obligation) -> World:
    """The machine whose mode or row it is about."""
    worlds = game.worlds if isinstance(game, Whole) else (game,)
    rest = one.name.partition(" ")[2]
    return next(world for world in worlds if rest.startswith((f"{world.name} ", f"{world.name}: ")))


def _wanted(game: Game, one: Obligation) -> tuple[Callable[[State], bool], bool]:
    """What its target is in a step of the game, and whether the first state may show it."""
    world, (kind, _, rest) = _world(game, one), one.name.partition(" ")
    prefix = f"{world.name}." if isinstance(game, Whole) else ""
    if kind == "mode":
        mode = int(rest.removeprefix(f"{world.name} M"))
        return lambda env: env[f"{prefix}mode"] == mode, True
    name, row = f"{prefix}fired", rest.removeprefix(f"{world.name}: ")
    return lambda env: row_of(game, name, env[name]) == row, False


def _depth(space: Space, wanted: Callable[[State], bool], first: bool, allowed: Allowed) -> int | None:
    """Steps of the shortest run to the target."""
    if first and any(wanted(space.states[state]) for state in range(space.starts)):
        return 0
    return min((d + 1 for d, edge in space.steps(allowed) if wanted({**space.env(edge)})), default=None)


def _reached(case: Case, one: Obligation) -> str:
    wanted, first = _wanted(case.game, one)
    free = _depth(case.board(), wanted, first, anyhow)
    match one.verdict:
        case Proved(witness=Trace() as witness) if one.statement.endswith(", by itself"):
            return _by_itself(case, one, witness, wanted, first)
        case Proved(witness=Trace() as witness):
            return _witness(case, one, witness, wanted, first)
        case Proved():
            return "Proved, yet no run is shown"
        case Violated() | Vacuous():
            return "" if free is None else f"dead, yet reached after {free} steps"
        case Unknown(depth=depth):
            under = _depth(case.space, wanted, first, lawful)
            missed = under is not None and under <= min(depth, case.limits.depth)
            return f"no run of {depth} steps, yet there is one of {under}" if missed else ""
    return ""


BY_ITSELF = re.compile(
    r"of the machine by itself, (?:a defence: )?witness of (?P<steps>\d+) steps "
    r"(?:(?P<under>under its assumption)|that (?:begins in a state that its world excludes|[^;]*breaks [^;]+)); "
    r"(?:none of the whole in (?P<none>\d+) steps|(?P<never>proved impossible in the whole while the assumption is kept)"
    r"|the whole was not searched in time)"
)


def _by_itself(case: Case, one: Obligation, trace: Trace, wanted: Callable[[State], bool], first: bool) -> str:
    """Of the whole no run is told: whether the machine by itself comes there as told, and the whole is told of rightly."""
    said = BY_ITSELF.fullmatch(one.method)
    if said is None or not isinstance(case.game, Whole):
        return "it is not told what the machine does by itself, nor what is known of the whole"
    world = _world(case.game, one)
    space, allowed = (search(world), lawful) if said["under"] else (search(world.board()), anyhow)
    own, at_first = _wanted(world, one)
    wrong = _ends(space, trace, allowed, lambda env: (at_first or bool(trace.steps)) and own(env))
    if wrong:
        return wrong
    if len(trace.steps) != int(said["steps"]):  # it need not be the shortest: it may be drawn
        return f"the machine by itself comes there after {len(trace.steps)} steps"
    whole = _depth(case.space, wanted, first, lawful)
    if whole is not None and (said["never"] or whole <= int(said["none"] or -1)):
        return f"the whole comes there after {whole} steps"
    return ""


def _witness(case: Case, one: Obligation, trace: Trace, wanted: Callable[[State], bool], first: bool) -> str:
    under = "under the assumption" in one.method
    allowed = lawful if under else anyhow
    wrong = _ends(case.space, trace, allowed, lambda env: (first or bool(trace.steps)) and wanted(env))
    shortest = _depth(case.space if under else case.board(), wanted, first, allowed)
    drawn = "drawn run" in one.method  # need not be the shortest one
    if not wrong and not drawn and case.space.full is None and shortest != len(trace.steps):
        return f"its witness has {len(trace.steps)} steps, the shortest {shortest}"
    if not wrong and not under and _depth(case.space, wanted, first, lawful) is not None and "proved" in one.method:
        return "proved impossible under the assumption, yet it happens"
    return wrong


# ------------------------------------------------------------------ the assumption


def _assumption(case: Case, one: Obligation) -> str:
    kept = case.space.lasts(lawful, STEPS)
    match one.verdict:
        case Proved(witness=Trace() as witness):
            return _ends(case.space, witness, lawful, lambda _: True)
        case Proved():
            return "" if kept else "Proved, yet no run keeps it"
        case Violated():
            return "no run keeps it is told, yet one does" if kept else ""
    return ""


def _lasts(case: Case, one: Obligation) -> str:
    """Some run never ends: shown by one that comes round, or because no run ends."""
    endless = case.space.for_ever(lawful)
    match one.verdict:
        case Proved(witness=Trace() as witness):
            return _round(case, witness)
        case Proved():
            return _dead_ends(case, one)
        case Violated() if endless:
            return f"every run ends is told, yet from {case.space.states[min(endless)]} one never does"
        case Violated(trace=Trace() as trace):
            return _at_an_end(case, trace)
    return ""


def _round(case: Case, trace: Trace) -> str:
    """What is wrong with a run that is to come back to where it was."""
    *earlier, last = [trace.initial, *(step.state for step in trace.steps)]
    return _ends(case.space, trace, lawful, lambda _: True) or (
        "" if last in earlier else "its run does not come round"
    )


def _dead_ends(case: Case, one: Obligation) -> str:
    """Every state that a run comes to has a lawful next step; and there is a run."""
    ends = case.space.dead_ends(lawful)
    known = case.space.full is None
    match one.verdict:
        case Proved():
            if case.expect.dead_ends and known and not case.space.for_ever(lawful):
                return "Proved, yet no run lasts"
            return (
                f"Proved, yet {case.space.states[ends[0]]} is a dead end"
                if case.expect.dead_ends and known and ends
                else ""
            )
        case Violated(trace=trace):
            if not ends and known and case.space.starts:
                return "a dead end is told, yet there is none"
            return _at_an_end(case, trace) if isinstance(trace, Trace) else ""
    return ""


def _at_an_end(case: Case, trace: Trace) -> str:
    ends = [case.space.states[state] for state in case.space.dead_ends(lawful)]
    names = case.game.state_names
    return _ends(case.space, trace, lawful, lambda env: {name: env[name] for name in names} in ends)
