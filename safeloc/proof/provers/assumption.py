"""Check that the assumption can be satisfied: by a moving run, for ever, and from every reachable state.

assumption        some run exists, and in it as many inputs and ghosts as possible change
assumption lasts  it can be satisfied for ever: there is no dead end, or some run returns to an earlier state. It is
                  violated if no run has a certain length. A single run into a dead end decides nothing
dead ends         every reachable state has a lawful next step (safeloc.proof.provers.dead_ends)
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import z3

from safeloc.codegen.smt import Unrolling
from safeloc.language.expr import Var
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem
from safeloc.language.trace import Trace
from safeloc.language.verdict import Proved, Unknown, Vacuous, Verdict, Violated
from safeloc.proof.provers.asking import ask, new_solver, plain_solver, why_unknown
from safeloc.proof.provers.contradiction import no_run
from safeloc.proof.provers.dead_ends import lasts
from safeloc.proof.provers.limits import Deadline, Limits, deadline
from safeloc.proof.provers.obligation import Obligation
from safeloc.proof.provers.recheck import rechecked_in_words
from safeloc.proof.provers.recorded_witnesses import Recording, lasting
from safeloc.proof.provers.replayed_evidence import admissible_run
from safeloc.proof.provers.without_lemmas import search_limits

_ASSUMPTION_STEPS = 5
_RECORDED_STEPS = 65  # length of the recorded run that shows inputs changing
ROUND_STEPS = 250
PATIENCE = 2  # time limits of one search that all groups of inputs get together
_TOGETHER_SHARE = 0.25  # of the time left, for the questions in which all inputs and ghosts change at once
_FOR_EVER = "the assumption can be satisfied for ever"
_NO_DEAD_END = "every reachable state has a lawful next step"


def assumption_kept(
    system: TransitionSystem, limits: Limits, recordings: Sequence[Recording] = ()
) -> Iterator[Obligation]:
    """Check that a moving run exists under the assumption, that it can be satisfied for ever, and that no run reaches a
    dead end.
    """
    yield _moves(system, limits, recordings)
    verdict = lasts(system, search_limits(system, limits), recordings, patience=PATIENCE)
    yield Obligation("assumption lasts", _FOR_EVER, *_for_ever(system, limits, verdict))
    yield Obligation("dead ends", _NO_DEAD_END, verdict, how(verdict))


def how(verdict: Verdict) -> str:
    """Describe the method of the proof, or the methods tried."""
    match verdict:
        case Proved(engine=engine, rechecked=rechecked):
            return rechecked_in_words(engine, rechecked)
        case Violated(trace=None):
            return "bounded search"
        case Violated(engine=engine):
            return f"{engine}: a run into a dead end, replayed in the interpreter"
        case Unknown() | Vacuous():
            return "witness functions, bounded search, k-induction, Spacer, falsifiers"


# ------------------------------------------------------------------ a run that moves


def _moves(system: TransitionSystem, limits: Limits, recordings: Sequence[Recording]) -> Obligation:
    statement = (
        f"the assumption can be satisfied for {_ASSUMPTION_STEPS} steps from the start, by a run in which inputs change"
    )
    recorded = lasting(system, recordings, _RECORDED_STEPS) if system.parts else None
    if recorded is not None and _moved(recorded):
        method = f"a recorded run of {len(recorded.steps)} steps in which {_moved(recorded)} inputs and ghosts change"
        shown = Proved(None, "recorded", len(recorded.steps), ("interpreter",), witness=recorded)
        return Obligation("assumption", statement, shown, method)
    unrolling, solver, ends = Unrolling(system), new_solver(), deadline(limits.seconds)
    solver.add(unrolling.initially(), *(unrolling.transition(number) for number in range(_ASSUMPTION_STEPS)))
    answer = ask(solver, ends.left)
    if answer == z3.unsat:
        none = Violated(None, "bmc", no_run(system, _ASSUMPTION_STEPS, ends))
        return Obligation("assumption", statement, none, "bounded search")
    if answer == z3.unknown:
        return Obligation("assumption", statement, Unknown(f"solver: {why_unknown(solver)}"), "bounded search")
    model, still = _most_moving(system, unrolling, solver, ends)
    return Obligation("assumption", statement, *_shown(system, unrolling, model, still))


def _most_moving(
    system: TransitionSystem, unrolling: Unrolling, solver: z3.Solver, ends: Deadline
) -> tuple[z3.ModelRef, list[str]]:
    """Return a run in which as many inputs and ghosts as possible change, and the names of the others.

    The solver has found a run already. Another one is asked for a run in which all change, or all but those that contradict
    the others; if that takes too long, the first one is asked only about the variables that do not change in the run at hand.
    """
    wanted = {var: z3.Or(*_changes(unrolling, var)) for var in _moving(system)}
    together = _together(solver, wanted, deadline(_TOGETHER_SHARE * ends.left))
    if together is not None:
        return together
    model, still = solver.model(), list[str]()
    for var, changes in wanted.items():
        if z3.is_true(model.eval(changes, model_completion=True)):
            solver.add(changes)
            continue
        solver.push()
        solver.add(changes)
        if ask(solver, ends.left) == z3.sat:
            model = solver.model()
        else:
            solver.pop()
            still.append(var.name)
    return model, still


def _together(
    solver: z3.Solver, wanted: Mapping[Var, z3.BoolRef | z3.Probe], ends: Deadline
) -> tuple[z3.ModelRef, list[str]] | None:
    """Return a run in which all change but those that contradict the others, and their names; None if that takes too long."""
    fresh = plain_solver()
    fresh.add(*solver.assertions(), *wanted.values())
    answer = ask(fresh, ends.left)
    if answer == z3.sat:
        return fresh.model(), []
    return _all_but_contradicting(solver, wanted, ends) if answer == z3.unsat else None


def _all_but_contradicting(
    solver: z3.Solver, wanted: Mapping[Var, z3.BoolRef | z3.Probe], ends: Deadline
) -> tuple[z3.ModelRef, list[str]] | None:
    """Leave out the last one of those that the solver's core names, until the others can change together.

    At the end each one left out is asked for again, since a core may name more than are needed.
    """
    fresh, moves = plain_solver(), {var.name: z3.Bool(f"{var.name} moves") for var in wanted}
    fresh.add(*solver.assertions(), *(z3.Implies(moves[var.name], changes) for var, changes in wanted.items()))
    kept, left = dict(moves), dict[str, z3.BoolRef]()
    while (answer := ask(fresh, ends.left, *kept.values())) == z3.unsat:
        core = {str(named) for named in fresh.unsat_core()}
        name = [name for name, moving in kept.items() if str(moving) in core][-1]
        left[name] = kept.pop(name)
    if answer != z3.sat:
        return None
    model, still = fresh.model(), list[str]()
    for name, moving in reversed(left.items()):
        if ask(fresh, ends.left, *kept.values(), moving) == z3.sat:
            kept[name], model = moving, fresh.model()
        else:
            still.append(name)
    return model, [name for name in moves if name in still]


def _moved(run: Trace) -> int:
    """Count the inputs that take different values in the steps of a run."""
    first = run.steps[0].inputs
    return sum(any(step.inputs[name] != value for step in run.steps) for name, value in first.items())


def _shown(
    system: TransitionSystem, unrolling: Unrolling, model: z3.ModelRef, still: Sequence[str]
) -> tuple[Verdict, str]:
    witness = _run(system, unrolling, model, _ASSUMPTION_STEPS)
    moving = "all inputs and ghosts change" if not still else f"all inputs and ghosts change but {', '.join(still)}"
    if still and len(still) == len(list(_moving(system))):
        return Unknown("found only runs in which no input and no ghost ever changes"), "bounded search"
    return Proved(None, "bmc", _ASSUMPTION_STEPS, ("interpreter",), witness=witness), f"one run in which {moving}"


def _run(system: TransitionSystem, unrolling: Unrolling, model: z3.ModelRef, steps: int) -> Trace:
    stream: list[dict[str, Value]] = [unrolling.values(model, number, system.inputs) for number in range(steps)]
    return admissible_run(system, unrolling.values(model, 0, system.state), stream)


def _moving(system: TransitionSystem) -> Iterable[Var]:
    return (*system.inputs, *(var for var in system.state if var in system.ghosts))


def _changes(unrolling: Unrolling, var: Var) -> Iterator[z3.BoolRef | bool]:
    for number in range(_ASSUMPTION_STEPS - 1):
        yield unrolling.at(var, number) != unrolling.at(var, number + 1)


# ------------------------------------------------------------------ an endless run


@dataclass(frozen=True)
class Ended:
    """No lawful run is as long as `steps`."""

    steps: int


def _for_ever(system: TransitionSystem, limits: Limits, of_dead_ends: Verdict) -> tuple[Verdict, str]:
    """Decide whether some run continues for ever; return the verdict and the method."""
    match of_dead_ends:
        case Proved() | Violated(trace=None):  # every run goes on, or no run exists
            return of_dead_ends, how(of_dead_ends)
    match comes_round(system, limits):
        case Trace() as round_:
            shown = Proved(None, "bmc", len(round_.steps), ("interpreter",), witness=round_)
            return shown, "a run whose last state equals an earlier one, so it can be repeated"
        case Ended(steps):
            method = f"bounded search: no lawful run has {steps} steps"
            ends = Violated(None, "bmc", f"no run satisfies the assumption for {steps} steps")
            return of_dead_ends if isinstance(of_dead_ends, Violated) else ends, method
        case Unknown(reason, depth):
            known = "some run comes to a dead end" if isinstance(of_dead_ends, Violated) else of_dead_ends.reason
            return Unknown(f"{known}; {reason}", depth), "bounded search for a run that comes back to an earlier state"


def comes_round(system: TransitionSystem, limits: Limits) -> Trace | Ended | Unknown:
    """Find an admissible run whose last state equals an earlier one, so that it can be repeated for ever."""
    unrolling, solver, ends = Unrolling(system), new_solver(limits.seed), deadline(limits.seconds)
    solver.add(unrolling.initially())
    for steps in range(1, ROUND_STEPS + 1):
        solver.add(unrolling.transition(steps - 1))
        solver.push()
        solver.add(z3.Or(*(_same(unrolling, earlier, steps) for earlier in range(steps))))
        answer = ask(solver, ends.left)
        if answer == z3.sat:
            return _run(system, unrolling, solver.model(), steps)
        solver.pop()
        if answer == z3.unknown:
            return _none_comes_round(steps - 1)
        if _worth_asking(steps) and ask(solver, ends.left) == z3.unsat:
            return Ended(steps)
    return _none_comes_round(ROUND_STEPS)


def _worth_asking(steps: int) -> bool:
    """Return whether to check now that a run of this length exists: at each doubling of the length, and at the end."""
    return steps.bit_count() == 1 or steps == ROUND_STEPS


def _none_comes_round(steps: int) -> Unknown:
    return Unknown(f"no lawful run of at most {steps} steps comes back to an earlier state")


def _same(unrolling: Unrolling, one: int, other: int) -> z3.BoolRef:
    same: z3.BoolRef = z3.And(*(unrolling.at(var, one) == unrolling.at(var, other) for var in unrolling.system.state))  # pyright: ignore[reportAssignmentType] # no Probe here
    return same
