"""All engines together: k-induction first, bounded search, Spacer, then falsifiers; several properties in parallel.

A property may take its time limit twice, once to be decided and once to be re-checked; then the clock ends it: each
one has a process of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal, assert_never

from safeloc.errors import PropertyError
from safeloc.expr import TRUE
from safeloc.provers.base import LAYERS, Base, base, known_base, ranges_and_lemmas, remember
from safeloc.provers.bmc import Exhausted, bmc, search
from safeloc.provers.evidence import confirmed
from safeloc.provers.falsify import falsify
from safeloc.provers.implication import Undecided
from safeloc.provers.inherited import contract_name, contract_properties, contracts
from safeloc.provers.kinduction import kinduction
from safeloc.provers.limits import Limits, deadline
from safeloc.provers.reachability import can_go_on
from safeloc.provers.recheck import ENGINE, file_name
from safeloc.provers.spacer import spacer
from safeloc.provers.transfer import Packed, pack, pack_base, unpack, unpack_base
from safeloc.provers.workers import Lost, Task, in_processes
from safeloc.results import Finding
from safeloc.spec import Goal, Property, always, observe
from safeloc.system import TransitionSystem
from safeloc.terms import variables
from safeloc.verdict import Proved, Unknown, Verdict, Violated

GRACE_SECONDS = 5.0
INDUCTION_SHARE, SEARCH_SHARE, SPACER_SHARE = 0.4, 0.3, 0.4  # of the time that is left when their turn comes
OnFinding = Callable[[Finding], None]


def prove_one(goal: Goal, limits: Limits) -> Verdict:
    """The verdict of the first engine that decides; Unknown with the greatest depth any of them reached."""
    if goal.prop.kind == "reachable":
        return _reach(goal, limits)
    ends, said, depth = deadline(limits.seconds), list[str](), -1
    for name, engine, share in _ENGINES:
        verdict = engine(goal, replace(limits, seconds=max(0.001, ends.left * share)))
        if isinstance(verdict, Proved) and goal.prop.given is not TRUE and not can_go_on(goal.system, limits):
            return Unknown(
                "empty: no run keeps what the property is given, so that nothing is said by its proof", depth
            )
        if not isinstance(verdict, Unknown):
            return verdict
        said.append(f"{name}: {verdict.reason}")
        depth = max(depth, verdict.depth)
    return Unknown("; ".join(said), depth)


_ENGINES: tuple[tuple[str, Callable[[Goal, Limits], Verdict], float], ...] = (
    ("k-induction", kinduction, INDUCTION_SHARE),
    ("bounded search", bmc, SEARCH_SHARE),
    ("Spacer", spacer, SPACER_SHARE),
    ("falsifiers", falsify, 1.0),
)


def _reach(goal: Goal, limits: Limits) -> Verdict:
    """A witness, or a proof that there is none."""
    half = replace(limits, seconds=limits.seconds / 2)
    found = search(goal, half)
    if not isinstance(found, Exhausted):
        return Proved(None, "bmc", len(found.steps), ("interpreter",), witness=found)
    never = kinduction(goal, half)
    if isinstance(never, Proved):
        return Violated(None, never.engine, f"no run comes there: proved by {never.engine}")
    return Unknown(found.reason, found.depth)


def prove(
    system: TransitionSystem,
    properties: Sequence[Property],
    limits: Limits,
    *,
    jobs: int = 1,
    on_finding: OnFinding | None = None,
) -> list[Finding]:
    """A Finding for every declared lemma and every property, in order; `on_finding` is told of each as it comes.

    The base (ranges, lemmas) is proved first and shared. `jobs` processes work on the properties. PropertyError if
    two properties would share a name or a certificate's file.
    """
    _check_names(properties)
    known, seconds = proved_base(system, limits)
    lemmas = [*_lemma_claims(system, known, seconds), *_contract_claims(system, known, seconds)]
    claims = [*lemmas, *(_property_claim(system, prop) for prop in properties)]
    findings: dict[int, Finding] = {}
    for index, finding in _findings(claims, limits, jobs):
        findings[index] = finding
        if on_finding is not None:
            on_finding(finding)
    return [findings[index] for index in range(len(claims))]


def _check_names(properties: Sequence[Property]) -> None:
    seen: dict[str, Property] = {}
    for prop in properties:
        if prop.name in LAYERS:
            raise PropertyError(
                f"{prop.src}: property {prop.name!r} has the name of a certificate of the base; rename it."
            )
        other = seen.setdefault(file_name(prop.name), prop)
        if other is not prop:
            raise PropertyError(
                f"{prop.src}: property {prop.name!r} has the name of {other.name!r} ({other.src}), or one that gives "
                "the same file name; rename one of them."
            )


# ------------------------------------------------------------------ the base


def proved_base(system: TransitionSystem, limits: Limits) -> tuple[Base, float]:
    """The system's base, proved in a process that the clock ends; and the seconds it took."""
    known = known_base(system, limits.seconds)
    if known is not None:
        return known, 0.0
    work = partial(base, system, seconds=limits.seconds)
    task = Task(f"{system.name}: ranges and lemmas", lambda: pack_base(work()), _end(limits) * (1 + len(system.parts)))
    [(_, packed, seconds)] = in_processes([task], 1)
    terms = {**ranges_and_lemmas(system), **contracts(system)}
    if isinstance(packed, Lost):
        known = Base({}, {}, {name: Undecided(packed.reason) for name in terms}, {}, limits.seconds)
    else:
        known = unpack_base(packed, terms)
    remember(system, known)
    return known, seconds


def _end(limits: Limits) -> float:
    return 2 * limits.seconds + GRACE_SECONDS


# ------------------------------------------------------------------ claims


@dataclass(frozen=True, eq=False)
class _Claim:
    """A statement to be decided by `prover` in a process of its own, or decided already: `finding`."""

    goal: Goal
    kind: Literal["lemma", "property"]
    prover: Callable[[Goal, Limits], Verdict]
    finding: Finding | None = None


def _property_claim(system: TransitionSystem, prop: Property) -> _Claim:
    return _Claim(observe(system, prop), "property", prove_one if prop.kept_by is None else _kept_by_a_machine)


def _kept_by_a_machine(goal: Goal, limits: Limits) -> Verdict:
    """What a machine keeps by itself, where it hears what it may hear and is owed what it assumes; else as of the whole."""
    assert goal.prop.kept_by is not None
    machine, own = goal.prop.kept_by
    part = next(part for part in goal.original.parts if part.alone.machines[0] is machine)
    known = base(goal.original, seconds=limits.seconds)
    free = own.unconditional and part.alone.ghosts.isdisjoint(variables([own.term]))
    owed = free or part.owed is TRUE or contract_name(part) in known.kept
    if not owed or part.name not in known.heard:
        return prove_one(goal, limits)
    verdict = prove_one(observe(part.alone, own), replace(limits, seconds=limits.seconds / 2))
    if isinstance(verdict, Proved):
        return replace(verdict, invariant=None, engine=f"{verdict.engine} of {part.name} by itself")
    return prove_one(goal, replace(limits, seconds=limits.seconds / 2))


def _lemma_claims(system: TransitionSystem, known: Base, seconds: float) -> Iterator[_Claim]:
    """Proved lemmas; for one that was dropped, a run that breaks it is searched."""
    for name, term in system.lemmas.items():
        goal = observe(system, always(name, term))
        if name in known.refuted:
            yield _Claim(goal, "lemma", _breaking(f"not used: {known.refuted[name]}"))
        else:
            verdict = Proved(term, "1-induction", 1, (ENGINE,), known.certificates)
            reach = "for all inputs in range" if name in known.always else "under the assumption"
            method = f"1-induction, all lemmas together, {reach}, re-checked by {ENGINE}"
            yield _Claim(goal, "lemma", bmc, _finding(goal, "lemma", verdict, method, seconds))


def _contract_claims(system: TransitionSystem, known: Base, seconds: float) -> Iterator[_Claim]:
    """What machines of a composition owe each other; for what was not shown, a run that breaks it is searched."""
    for prop in contract_properties(system):
        goal = observe(system, prop)
        if prop.name in known.kept:
            verdict = Proved(known.kept[prop.name], "1-induction", 1, (ENGINE,), known.certificates)
            method = f"assume-guarantee: what is known of the machines before it, re-checked by {ENGINE}"
            yield _Claim(goal, "lemma", bmc, _finding(goal, "lemma", verdict, method, seconds))
        else:
            why = known.refuted.get(prop.name, "a machine before it does not keep what it should")
            yield _Claim(goal, "lemma", _breaking(f"not shown: {why}"))


def _breaking(why: str) -> Callable[[Goal, Limits], Verdict]:
    def prover(goal: Goal, limits: Limits) -> Verdict:
        found = bmc(goal, limits)
        return Unknown(f"{why}; {found.reason}", found.depth) if isinstance(found, Unknown) else found

    return prover


def _findings(claims: Sequence[_Claim], limits: Limits, jobs: int) -> Iterator[tuple[int, Finding]]:
    """Findings as they come, with the place of their claim."""
    open_: list[int] = []
    for index, claim in enumerate(claims):
        if claim.finding is None:
            open_.append(index)
        else:
            yield index, claim.finding
    tasks = [_task(claims[index], limits) for index in open_]
    for number, packed, seconds in in_processes(tasks, jobs):
        claim = claims[open_[number]]
        verdict = _received(packed, claim.goal)
        yield open_[number], _finding(claim.goal, claim.kind, verdict, _method(verdict), seconds)


def _task(claim: _Claim, limits: Limits) -> Task:
    goal = claim.goal
    return Task(f"{goal.original.name}: {goal.prop.name}", lambda: pack(claim.prover(goal, limits)), _end(limits))


def _received(packed: Packed | Lost, goal: Goal) -> Verdict:
    """The verdict of another process; its trace is judged once more in this one."""
    if isinstance(packed, Lost):
        return Unknown(packed.reason)
    verdict = unpack(packed, goal.original, goal.system)
    trace = verdict.trace if isinstance(verdict, Violated) else verdict.witness if isinstance(verdict, Proved) else None
    if trace is not None:
        confirmed(goal, trace.initial, [step.inputs for step in trace.steps], "the prover's process")
    return verdict


def _finding(goal: Goal, kind: Literal["lemma", "property"], verdict: Verdict, method: str, seconds: float) -> Finding:
    prop, machine = goal.prop, goal.original.name
    return Finding(
        id=f"{machine}/{kind}/{prop.name}",
        machine=machine,
        kind=kind,
        statement=prop.statement,
        result=verdict,
        method=method,
        seconds=seconds,
        requirements=prop.trace,
        assumption=prop.relies_on,
    )


def _method(verdict: Verdict) -> str:
    match verdict:
        case Proved(engine=engine, rechecked=rechecked):
            return f"{engine}, re-checked by {' and '.join(rechecked)}"
        case Violated(engine=engine, trace=None):
            return f"{engine}, re-checked by {ENGINE}"
        case Violated(engine=engine):
            return f"{engine}, replayed in the interpreter"
        case Unknown():
            return "k-induction, bounded search, Spacer, falsifiers"
        case _:
            assert_never(verdict)
