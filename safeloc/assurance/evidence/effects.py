"""The effects of broken clauses of the world on a target's claims, on its reported interval and on its hazard.

A broken clause is not assumed in any cycle: it may be broken once, always, or never. So a proof here holds for any duration
of the fault, and a run that is found is one of the worst.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

from safeloc.assurance.evidence.interval import HOLDS, holds_truth, valid_term, withdrawn_within
from safeloc.assurance.evidence.known_runs import known_runs, run_that_goes_on
from safeloc.assurance.evidence.top_event import hazard_claims
from safeloc.assurance.evidence.wired_facts import with_wired_facts
from safeloc.language.expr import Bool, Expr, Lit, NumVar, Var, all_of, any_of, before_step
from safeloc.language.nodes import Value
from safeloc.language.spec import Property, earlier_bool, observe, once, previous, reachable
from safeloc.language.system import TransitionSystem
from safeloc.language.terms import Substitution, variables
from safeloc.language.trace import Trace
from safeloc.language.units import Enumeration
from safeloc.language.verdict import Proved, Violated
from safeloc.proof.cores.clauses import ClauseId, assumed_clauses, without
from safeloc.proof.provers.bmc import Exhausted, search
from safeloc.proof.provers.kinduction import kinduction
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove_one
from safeloc.proof.provers.recorded_witnesses import Recording
from safeloc.target import Target

End = Literal["contained", "withdrawn", "wrong", "hazard", "no hazard", "undecided", "no interval"]
"""Effect on the reported interval, and on the declared hazard.

contained    the interval still contains the truth, and the hazard, if one is declared, does not occur (proved)
withdrawn    the interval may miss the truth, but is right again or withdrawn within a number of cycles (proved)
wrong        a run was found in which the interval misses the truth for longer
hazard       a run was found in which the hazard occurs
no hazard    the target reports no interval, and the hazard does not occur (proved)
undecided    undecided within the limits
no interval  the target reports no interval, or its truth is unknown; and it declares no hazard
"""
CYCLES = (1, 2, 5, 10)
"""Numbers of cycles within which a wrong interval has to be withdrawn, tried in turn; after more it counts as undetected."""
_TRANSITIONS = 4
"""Most transitions that are searched which withdraw the interval in the cycle of the breach."""
_SEARCH_SHARE = 0.1


@dataclass(frozen=True)
class Run:
    """A shortest run: first state and inputs of every cycle, by name, and the transition that fires in the last one."""

    first: dict[str, Value]
    inputs: tuple[dict[str, Value], ...]
    fired: str

    @property
    def cycles(self) -> int:
        """The number of cycles."""
        return len(self.inputs)


@dataclass(frozen=True)
class Effect:
    """The effect of broken clauses on a target.

    kept, lost, open_  claims that are still proved; claims that a run breaks, with its cycles; undecided claims
    end                effect on interval and hazard, with `within_cycles` for `withdrawn`
    run                for `wrong`, `withdrawn` and `hazard`: the shortest run that ends in the wrong interval or the hazard
    withdrawn_by       transitions that can withdraw the interval in the cycle of the breach
    """

    broken: tuple[ClauseId, ...]
    kept: tuple[str, ...] = ()
    lost: dict[str, int] = field(default_factory=dict)
    open_: tuple[str, ...] = ()
    end: End = "no interval"
    within_cycles: int = 0
    run: Run | None = None
    withdrawn_by: tuple[str, ...] = ()


def effect(target: Target, broken: tuple[ClauseId, ...], asked: Collection[str], limits: Limits) -> Effect:
    """Return the effect of these broken clauses on the target.

    asked  names of the claims whose proofs may need them; every other claim is kept, since it was proved without them
    """
    system = _broken(target, broken)
    found, runs = Effect(broken), dict[str, Run]()
    for prop in target.properties:
        if prop.kind != "reachable":
            found = _with_claim(found, system, prop, limits, runs) if prop.name in asked else _kept(found, prop.name)
    found = _with_longer_runs(found, target, system, limits, runs)
    return _with_hazard(_with_interval(found, target, system, asked, limits), target, runs)


def does_no_harm(target: Target, broken: tuple[ClauseId, ...], asked: Collection[str], limits: Limits) -> bool:
    """Return whether induction proves, without all of these clauses, that the interval contains the truth and no hazard occurs.

    asked  names of the claims whose proofs may need them
    """
    system, top = _broken(target, broken), holds_truth(target)
    claims = [*hazard_claims(target), *([top] if top is not None else [])]
    goals = (observe(system, replace(prop, kept_by=None)) for prop in claims if prop.name in asked)
    return all(isinstance(kinduction(goal, limits), Proved) for goal in goals)


def _broken(target: Target, broken: Collection[ClauseId]) -> TransitionSystem:
    return with_wired_facts(without(target.system, broken))


def _kept(found: Effect, name: str) -> Effect:
    return replace(found, kept=(*found.kept, name))


def _with_claim(
    found: Effect, system: TransitionSystem, prop: Property, limits: Limits, runs: dict[str, Run]
) -> Effect:
    """Judge a claim; `runs` gets the run that breaks it."""
    verdict = prove_one(observe(system, replace(prop, kept_by=None)), limits)
    if isinstance(verdict, Proved):
        return _kept(found, prop.name)
    if isinstance(verdict, Violated) and verdict.trace is not None:
        runs[prop.name] = _run(verdict.trace)
        return replace(found, lost={**found.lost, prop.name: len(verdict.trace.steps)})
    return replace(found, open_=(*found.open_, prop.name))


def _with_longer_runs(
    found: Effect, target: Target, system: TransitionSystem, limits: Limits, runs: dict[str, Run]
) -> Effect:
    """Search for runs that break the undecided claims and begin like known runs, or like those that break other claims."""
    if not found.open_:
        return found
    begun = [*known_runs(target), *map(_recording, runs.values())]
    for prop in target.properties:
        if prop.name in found.open_:
            goal = observe(system, replace(prop, kept_by=None))
            trace = run_that_goes_on(goal, begun, limits)
            if trace is not None:
                runs[prop.name] = _run(trace)
                begun.append(_recording(runs[prop.name]))
                lost = {**found.lost, prop.name: len(trace.steps)}
                found = replace(found, lost=lost, open_=tuple(name for name in found.open_ if name != prop.name))
    return found


def _recording(run: Run) -> Recording:
    return Recording(run.first, run.inputs)


def _with_hazard(found: Effect, target: Target, runs: Mapping[str, Run]) -> Effect:
    """Return the effect with the hazard judged by its claims. A wrong interval, which is decided by then, stands first."""
    claims = [prop.name for prop in hazard_claims(target)]
    if not claims or found.end in ("wrong", "withdrawn"):
        return found
    lost = [name for name in claims if name in found.lost]
    if lost:
        return replace(found, end="hazard", run=runs[min(lost, key=lambda name: found.lost[name])])
    if not set(claims).isdisjoint(found.open_):
        return replace(found, end="undecided")
    return replace(found, end="no hazard") if found.end == "no interval" else found


def _with_interval(
    found: Effect, target: Target, system: TransitionSystem, asked: Collection[str], limits: Limits
) -> Effect:
    top = holds_truth(target)
    if top is None:
        return found
    if HOLDS not in asked:
        return replace(found, end="contained")
    ended = _ended(found, target, system, top, limits)
    return replace(ended, withdrawn_by=_withdrawn_by(target, system, found.broken, limits))


def _ended(found: Effect, target: Target, system: TransitionSystem, top: Property, limits: Limits) -> Effect:
    verdict = prove_one(observe(system, top), limits)
    if isinstance(verdict, Proved):
        return replace(found, end="contained")
    trace = verdict.trace if isinstance(verdict, Violated) else None
    if trace is None:  # a bounded search from the first states may not come as far as a known run
        trace = run_that_goes_on(observe(system, top), known_runs(target), limits)
    if trace is None:
        return replace(found, end="undecided")
    run, wrong_for = _run(trace), 0
    begun = [run]
    for cycles in CYCLES:
        wrong_for = _prolonged(target, system, begun, (wrong_for, cycles), limits)
        if wrong_for == cycles:
            continue
        later = prove_one(observe(system, withdrawn_within(target, cycles)), limits)
        if isinstance(later, Proved):
            return replace(found, end="withdrawn", within_cycles=cycles, run=run)
        if not isinstance(later, Violated) or later.trace is None:
            return replace(found, end="undecided", run=run)
        begun.append(_run(later.trace))
        wrong_for = cycles
    return replace(found, end="wrong", run=run)


def _prolonged(
    target: Target, system: TransitionSystem, begun: list[Run], reach: tuple[int, int], limits: Limits
) -> int:
    """Prolong wrong runs one cycle at a time, and add them to `begun`; return for how many cycles the interval is wrong in the longest.

    reach  the cycles for which it is wrong so far, and those for which it is to be. A large machine is searched one cycle ahead where
           several at once are too many
    """
    so_far, wanted = reach
    for cycles in range(so_far + 1, wanted + 1):
        goal = observe(system, withdrawn_within(target, cycles))
        longer = run_that_goes_on(goal, list(map(_recording, begun)), limits)
        if longer is None:
            return cycles - 1
        begun.append(_run(longer))
    return wanted


def _run(trace: Trace) -> Run:
    fired = ", ".join(trace.steps[-1].fired.values()) if trace.steps else ""
    return Run(dict(trace.initial), tuple(dict(step.inputs) for step in trace.steps), fired)


# ------------------------------------------------------------------ transitions that withdraw the interval


def _withdrawn_by(
    target: Target, system: TransitionSystem, broken: Sequence[ClauseId], limits: Limits
) -> tuple[str, ...]:
    """Return transitions of the broken clauses' machines that fire when the first breach withdraws the interval."""
    clauses = assumed_clauses(target.system)
    breach = _of_the_step(any_of(~clauses[one] for one in broken), target.system)
    valid = valid_term(target)
    withdrawn = breach & ~previous(once(breach)) & earlier_bool(valid) & ~valid
    tables = _tables(system, {one.machine for one in broken})
    limited = replace(limits, seconds=limits.seconds * _SEARCH_SHARE)
    found = list[dict[str, str]]()
    while len(found) < _TRANSITIONS:
        others = [any_of(table.ne(_row(table, one[table.name])) for table in tables) for one in found]
        claim = reachable("the interval is withdrawn in the cycle of the breach", all_of([withdrawn, *others]))
        run = search(observe(system, claim), limited)
        if isinstance(run, Exhausted):
            break
        found.append({table.name: run.steps[-1].fired[table.name] for table in tables})
    return tuple(dict.fromkeys(name for one in found for name in one.values()))


def _tables(system: TransitionSystem, machines: Collection[str]) -> list[NumVar]:
    """Return the variables that name the fired transition of each of these machines."""
    if len(system.machines) == 1:
        return list(system.fired)
    return [fired for fired, one in zip(system.fired, system.machines, strict=True) if one.name in machines]


def _row(table: NumVar, name: str) -> Lit:
    assert isinstance(table.unit, Enumeration)
    return Lit(table.unit.index(name), table.unit)


def _of_the_step(term: Bool, system: TransitionSystem) -> Bool:
    """Return a clause, which reads state before the step and inputs, in the form of a claim."""
    state = set(system.state)
    twins: dict[Var, Expr] = {var: before_step(var) for var in variables([term]) if var in state}
    return Substitution(twins).bool(term)
