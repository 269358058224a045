"""What can happen at all: every mode, every transition, and an environment that keeps its assumption.

One incremental search serves all targets; a target found is a stream, replayed in the interpreter.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import z3

from safeloc.backends.smt import Unrolling
from safeloc.backends.smtlib import Query
from safeloc.expr import TRUE, Bool, Lit, NumVar, Var, before, was
from safeloc.machine import Machine
from safeloc.nodes import Value
from safeloc.provers.base import base
from safeloc.provers.bmc import run_of
from safeloc.provers.evidence import admissible_run, confirmed
from safeloc.provers.implication import unproved
from safeloc.provers.kinduction import kinduction
from safeloc.provers.limits import Deadline, Limits, deadline, milliseconds
from safeloc.provers.obligation import Obligation
from safeloc.provers.recorded import Recording, lasting, shown
from safeloc.provers.spacer import spacer
from safeloc.spec import Goal, Watch, observe, reachable, watch
from safeloc.system import TransitionSystem, environment, in_range
from safeloc.terms import Substitution
from safeloc.trace import Trace
from safeloc.verdict import Proved, Unknown, Verdict, Violated

ASSUMPTION_STEPS = 5
FURTHER_STEPS = 60
GOES_ON = f"a run that keeps the assumption can go on for {FURTHER_STEPS} more steps"

# ------------------------------------------------------------------ search for many targets at once


@dataclass(frozen=True, eq=False)
class Runs:
    """Shortest runs by name of the target, and the number of steps that were searched completely."""

    found: Mapping[str, Trace]
    depth: int


def first_runs(goals: Sequence[Goal], limits: Limits, known: Container[str] = ()) -> Runs:
    """Shortest runs to as many targets as the limits allow; all goals are of one system and one assumption.

    The search ends where all that is left is `known` by name to be reached.
    """
    if not goals:
        return Runs({}, limits.depth)
    watched = watch(replace(goals[0].original, assume=goals[0].system.assume), goals)
    unrolling, solver, found = Unrolling(watched.system), z3.Solver(), dict[str, Trace]()
    ends = deadline(limits.seconds)
    solver.set("random_seed", limits.seed)
    solver.add(unrolling.initially())
    for depth in range(limits.depth + 1):
        if not _search_depth(watched, unrolling, solver, depth, found, ends):
            return Runs(found, depth - 1)
        if all(goal.prop.name in found or goal.prop.name in known for goal in goals):
            return Runs(found, depth)
        solver.add(unrolling.transition(depth))
    return Runs(found, limits.depth)


def _search_depth(
    watched: Watch, unrolling: Unrolling, solver: z3.Solver, depth: int, found: dict[str, Trace], ends: Deadline
) -> bool:
    """Adds what is found at this depth; whether the depth was searched completely."""
    while left := [goal for goal in watched.goals if goal.prop.name not in found]:
        if ends.passed:
            return False
        solver.set("timeout", milliseconds(ends.left))
        solver.push()
        solver.add(z3.Or(*(z3.Not(unrolling.at(goal.good, depth)) for goal in left)))
        answer = solver.check()
        model = solver.model() if answer == z3.sat else None
        solver.pop()
        if model is None:
            return bool(answer == z3.unsat)
        run = run_of(watched, unrolling, model, depth)
        for goal in left:
            if z3.is_false(model.eval(unrolling.at(goal.good, depth), model_completion=True)):
                found[goal.prop.name] = confirmed(goal, *run, "bmc")
    return True


def happens(system: TransitionSystem, name: str, term: Bool) -> Goal:
    """The goal that some step meets `term`, which is over the state before the step and its inputs."""
    twins = {var: before(var) if isinstance(var, NumVar) else was(var) for var in system.state}
    return observe(system, reachable(name, Substitution(dict(twins)).bool(term)))


def without_assumption(goal: Goal) -> Goal:
    """The same for all inputs in range."""
    free = replace(goal.prop, unconditional=True)
    return replace(goal, prop=free, system=replace(goal.system, assume=TRUE))


# ------------------------------------------------------------------ modes and transitions


@dataclass(frozen=True, eq=False)
class _Target:
    name: str
    statement: str
    goal: Goal


def reached(system: TransitionSystem, limits: Limits, recordings: Sequence[Recording] = ()) -> Iterator[Obligation]:
    """Modes and transitions: first under the assumption, found or recorded; what is neither, without it."""
    targets = list(_targets(system))
    defences = _impossible(system, targets, limits)
    possible = [target.goal for target in targets if target.name not in defences]
    seen = shown(possible, recordings)
    searched = first_runs(possible, limits, seen)
    kept = replace(searched, found={**seen, **searched.found})
    alone = _by_itself(system, {target.name for target in targets} - {*kept.found}, limits)
    shown_ = {*kept.found, *alone}
    free = first_runs([without_assumption(target.goal) for target in targets if target.name not in shown_], limits)
    for target in targets:
        witness = kept.found.get(target.name) or free.found.get(target.name)
        if target.name in alone:
            method = f"of the machine by itself, {alone[target.name]}; none of the whole in {kept.depth} steps"
            verdict = Proved(None, "bmc", kept.depth, ("interpreter",))
            yield Obligation(target.name, f"{target.statement}, by itself", verdict, method)
        elif witness is None:
            yield Obligation(target.name, target.statement, _dead(target.goal, free.depth, limits), "bounded search")
        else:
            verdict = Proved(None, "bmc", len(witness.steps), ("interpreter",), witness=witness)
            recorded = target.name in seen and target.name not in searched.found
            method = "a recorded run under the assumption" if recorded else _how(target.name, kept, defences)
            yield Obligation(target.name, target.statement, verdict, method)


def _by_itself(system: TransitionSystem, open_: Container[str], limits: Limits) -> dict[str, str]:
    """Of a composition, what no run of the whole was found for, but one of the machine alone; and what that run is."""
    found: dict[str, str] = {}
    for part in system.parts:
        goals = [target.goal for target in _targets(part.alone) if target.name in open_]
        lawful = first_runs(goals, limits).found
        others = [without_assumption(goal) for goal in goals if goal.prop.name not in lawful]
        found |= {name: f"witness of {len(run.steps)} steps under its assumption" for name, run in lawful.items()}
        found |= {
            name: f"a defence: witness of {len(run.steps)} steps with its assumption broken"
            for name, run in first_runs(others, limits).found.items()
        }
    return found


def _place(src: str) -> str:
    """File name and line, without the folder of whoever runs this."""
    return src.replace("\\", "/").rpartition("/")[2]


def _targets(system: TransitionSystem) -> Iterator[_Target]:
    for machine in system.machines:
        mode, fired = _own(system, machine)
        for label in machine.modes:
            name = f"mode {machine.name} {label.label}"
            goal = observe(system, reachable(name, mode.eq(label)))
            yield _Target(name, f"{machine.name} comes to mode {label.label}", goal)
        for number, transition in enumerate(machine.transitions, 1):
            name = f"transition {machine.name}: {transition.name}"
            goal = observe(system, reachable(name, fired.eq(Lit(number, fired.unit))))
            yield _Target(name, f"{machine.name}: {transition.name!r} fires ({_place(transition.src)})", goal)


def _own(system: TransitionSystem, machine: Machine) -> tuple[NumVar, NumVar]:
    """The variables for the machine's mode and fired transition, also where it is a part of a composition."""
    own = {machine.mode, machine.fired_name}
    named = {var.name: var for var in (*system.state, *system.fired) if isinstance(var, NumVar)}
    if own <= {*system.state, *system.fired}:
        return machine.mode, machine.fired_name
    return named[f"{machine.name}.{machine.mode.name}"], named[f"{machine.name}.{machine.fired_name.name}"]


def _impossible(system: TransitionSystem, targets: Sequence[_Target], limits: Limits) -> set[str]:
    """Targets that the first state is not and that no step from a state with the proved facts comes to."""
    watched = watch(system, [target.goal for target in targets])
    after = Substitution(dict(watched.system.next))
    first = {target.name: target.goal.good for target in targets}
    later = {target.name: target.goal.good.implies(after.bool(target.goal.good)) for target in targets}
    facts = base(system, seconds=limits.seconds).everything
    start = Query("first", [watched.system.init, in_range(watched.system.state)], first)
    step = Query("step", [environment(system), *facts], later)
    possible = {**unproved(start, limits.seconds), **unproved(step, limits.seconds)}
    return {target.name for target in targets if target.name not in possible}


def _how(name: str, kept: Runs, defences: set[str]) -> str:
    if name in kept.found:
        return "witness under the assumption"
    proved = "proved impossible" if name in defences else f"not found in {kept.depth} steps"
    return f"a defence: witness with the assumption broken, {proved} while it is kept"


def _dead(goal: Goal, depth: int, limits: Limits) -> Verdict:
    for engine in (kinduction, spacer):
        never = engine(without_assumption(goal), replace(limits, seconds=limits.seconds / 2))
        if isinstance(never, Proved):
            return Violated(None, never.engine, "never occurs, whatever the inputs: dead; remove it or mend its guard")
    return Unknown("no run found that comes there", depth)


# ------------------------------------------------------------------ the assumption


def assumption_kept(
    system: TransitionSystem, limits: Limits, recordings: Sequence[Recording] = ()
) -> Iterator[Obligation]:
    """A run under the assumption in which as many inputs and ghosts as possible take different values."""
    statement = f"the assumption can be kept for {ASSUMPTION_STEPS} steps from the start, and not by standing still"
    recorded = lasting(system, recordings, ASSUMPTION_STEPS + FURTHER_STEPS) if system.parts else None
    if recorded is not None and _moved(recorded):
        how = f"a recorded run of {len(recorded.steps)} steps in which {_moved(recorded)} inputs and ghosts change"
        yield Obligation("assumption", statement, _lasts(recorded, how).verdict, how)
        yield _lasts(recorded, how)
        return
    unrolling, solver, ends = Unrolling(system), z3.Solver(), deadline(limits.seconds)
    solver.add(unrolling.initially(), *(unrolling.transition(number) for number in range(ASSUMPTION_STEPS)))
    answer = _checked(solver, ends)
    if answer != z3.sat:
        yield Obligation("assumption", statement, _no_run(answer, solver), "bounded search")
        return
    model, still = solver.model(), list[str]()
    for var in _moving(system):
        solver.push()
        solver.add(z3.Or(*(step for step in _changes(unrolling, var))))
        if _checked(solver, ends) == z3.sat:
            model = solver.model()
        else:
            solver.pop()
            still.append(var.name)
    yield Obligation("assumption", statement, *_shown(system, unrolling, model, still))
    last = unrolling.values(model, ASSUMPTION_STEPS, system.state)
    first, stream = unrolling.values(model, 0, system.state), _stream(system, unrolling, model)
    found = _lasting(system, first, stream, last, ends)
    recorded = lasting(system, recordings, ASSUMPTION_STEPS + FURTHER_STEPS) if _undecided(found) else None
    yield found if recorded is None else _lasts(recorded, f"a recorded run of {len(recorded.steps)} steps")


def _shown(
    system: TransitionSystem, unrolling: Unrolling, model: z3.ModelRef, still: Sequence[str]
) -> tuple[Verdict, str]:
    first = unrolling.values(model, 0, system.state)
    witness = admissible_run(system, first, _stream(system, unrolling, model))
    moving = "all inputs and ghosts change" if not still else f"all inputs and ghosts change but {', '.join(still)}"
    if still and len(still) == len(list(_moving(system))):
        return Unknown("found only runs in which no input and no ghost ever changes"), "bounded search"
    return Proved(None, "bmc", ASSUMPTION_STEPS, ("interpreter",), witness=witness), f"one run in which {moving}"


def _stream(system: TransitionSystem, unrolling: Unrolling, model: z3.ModelRef) -> list[dict[str, Value]]:
    return [unrolling.values(model, number, system.inputs) for number in range(ASSUMPTION_STEPS)]


def _lasting(
    system: TransitionSystem,
    first: Mapping[str, Value],
    stream: list[dict[str, Value]],
    state: Mapping[str, Value],
    ends: Deadline,
) -> Obligation:
    """Goes on from the end of the run, step by step: a state from which nothing lawful follows is a dead end."""
    unrolling, solver = Unrolling(system), z3.Solver()
    solver.add(unrolling.transition(0))
    for _ in range(FURTHER_STEPS):
        solver.push()
        solver.add(*(unrolling.at(var, 0) == state[var.name] for var in system.state))
        answer = _checked(solver, ends)
        if answer != z3.sat:
            solver.pop()
            return Obligation("assumption lasts", GOES_ON, _stuck(system, first, stream, answer), "step by step")
        model = solver.model()
        solver.pop()
        stream.append(unrolling.values(model, 0, system.inputs))
        state = unrolling.values(model, 1, system.state)
    return _lasts(admissible_run(system, first, stream), f"one run of {len(stream)} steps, step by step")


def _moved(run: Trace) -> int:
    """How many inputs take different values in the steps of a run."""
    first = run.steps[0].inputs
    return sum(any(step.inputs[name] != value for step in run.steps) for name, value in first.items())


def _undecided(found: Obligation) -> bool:
    return isinstance(found.verdict, Unknown)


def _lasts(run: Trace, method: str) -> Obligation:
    verdict = Proved(None, "bmc", len(run.steps), ("interpreter",), witness=run)
    return Obligation("assumption lasts", GOES_ON, verdict, method)


def _stuck(
    system: TransitionSystem, first: Mapping[str, Value], stream: list[dict[str, Value]], answer: z3.CheckSatResult
) -> Verdict:
    if answer == z3.unsat:
        why = f"after these {len(stream)} steps no inputs keep the assumption: what comes later is proved of nothing"
        return Violated(admissible_run(system, first, stream), "bmc", why)
    return Unknown("the solver did not decide whether the run can go on", len(stream))


def can_go_on(system: TransitionSystem, limits: Limits) -> bool:
    """Whether some run of a few steps keeps the system's assumption; undecided counts as no."""
    unrolling, solver = Unrolling(system), z3.Solver()
    solver.add(unrolling.initially(), *(unrolling.transition(number) for number in range(ASSUMPTION_STEPS)))
    return bool(_checked(solver, deadline(limits.seconds)) == z3.sat)


def _no_run(answer: z3.CheckSatResult, solver: z3.Solver) -> Verdict:
    if answer == z3.unsat:
        return Violated(None, "bmc", "no run keeps the assumption: every proof under it would be empty")
    return Unknown(f"solver: {solver.reason_unknown()}")


def _checked(solver: z3.Solver, ends: Deadline) -> z3.CheckSatResult:
    solver.set("timeout", milliseconds(ends.left))
    return solver.check()


def _moving(system: TransitionSystem) -> Iterable[Var]:
    return (*system.inputs, *(var for var in system.state if var in system.ghosts))


def _changes(unrolling: Unrolling, var: Var) -> Iterator[z3.BoolRef | bool]:
    for number in range(ASSUMPTION_STEPS - 1):
        yield unrolling.at(var, number) != unrolling.at(var, number + 1)
