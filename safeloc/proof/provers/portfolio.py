"""All engines together: k-induction first, bounded search, Spacer, then falsifiers; several properties in parallel.

Each property may use its time limit twice, once to be decided and once to be re-checked; then the clock ends its process. A process has
several properties, one after the other, and no property finds there what a solver did for another one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal, assert_never

from safeloc.errors import PropertyError
from safeloc.language.expr import TRUE
from safeloc.language.spec import Goal, Property, always, observe
from safeloc.language.system import TransitionSystem
from safeloc.language.verdict import Proved, Unknown, Vacuous, Verdict, Violated
from safeloc.proof.provers import antecedents
from safeloc.proof.provers.before_forking import prepare
from safeloc.proof.provers.beyond_depth import longer
from safeloc.proof.provers.bmc import bmc
from safeloc.proof.provers.by_its_machine import by_its_machine
from safeloc.proof.provers.case_search import CaseSearch
from safeloc.proof.provers.dead_ends import further_assumption_lasts
from safeloc.proof.provers.dropped import Dropped, broken
from safeloc.proof.provers.escape import escape
from safeloc.proof.provers.facts import Fact
from safeloc.proof.provers.falsify import falsify
from safeloc.proof.provers.from_known_runs import ENGINE, broken_onward
from safeloc.proof.provers.implication import Undecided
from safeloc.proof.provers.inherited import contract_properties, contracts
from safeloc.proof.provers.kinduction import kinduction
from safeloc.proof.provers.limits import CLOCK, Limits, deadline
from safeloc.proof.provers.proved_base import Base, base, known_base, ranges_and_lemmas, remember
from safeloc.proof.provers.reached import reached
from safeloc.proof.provers.recheck import confirmed_by, rechecked_in_words
from safeloc.proof.provers.recorded_witnesses import NO_WITNESSES, Recording, Witnesses
from safeloc.proof.provers.replayed_evidence import confirmed
from safeloc.proof.provers.spacer import CLAIMED, spacer
from safeloc.proof.provers.verdicts_as_data import Packed, hold_for_forked, pack, pack_base, unpack, unpack_base
from safeloc.proof.provers.without_lemmas import by_induction, search_limits, searched_together
from safeloc.proof.provers.workers import Lost, Queue, Task
from safeloc.proof.results import Finding

GRACE_SECONDS = 5.0
INDUCTION_SHARE, SEARCH_SHARE, SPACER_SHARE = 0.4, 0.3, 0.4  # of the time that is left when their turn comes
_ESCAPE_SHARE = 0.2
"""Share of the limit, on top of it, for a counterexample to induction of a property that no engine decides."""
_SEARCHED: Mapping[str, str] = {"lemma": "1-induction, bounded search", "property": "k-induction, bounded search"}
"""Methods of a search for runs that break what is not proved, for a verdict that it leaves open, by kind of finding."""
OnFinding = Callable[[Finding], None]


def prove_one(goal: Goal, limits: Limits, known_runs: Sequence[Recording] = ()) -> Verdict:
    """Return the verdict of the first engine that decides; else Unknown with the greatest depth that any of them
    reached.

    known_runs  recordings of a composition, from which runs are searched that break the claim
    """
    if goal.prop.kind == "reachable":
        return reached(goal, limits)
    verdict = _in_turn(_with_known_runs(_ENGINES, goal, known_runs), goal, limits)
    return _with_escape(goal, verdict, limits) if isinstance(verdict, Unknown) else verdict


def _with_escape(goal: Goal, verdict: Unknown, limits: Limits) -> Unknown:
    """Return the verdict with a counterexample to induction, if z3 finds one within a share of the limit."""
    found = escape(goal, replace(limits, seconds=limits.seconds * _ESCAPE_SHARE))
    return verdict if found is None else replace(verdict, escape=found.run)


def _in_turn(engines: Sequence[_Engine], goal: Goal, limits: Limits) -> Verdict:
    ends, reasons, depth = deadline(limits.seconds), list[str](), -1
    for name, engine, share in engines:
        verdict = engine(goal, replace(limits, seconds=max(0.001, ends.left * share), confirming=limits.seconds))
        if isinstance(verdict, Proved):
            return further_assumption_lasts(goal, verdict, limits)
        if not isinstance(verdict, Unknown):
            return verdict
        reasons.append(f"{name}: {verdict.reason}")
        depth = max(depth, verdict.depth)
        if engine is spacer and depth >= limits.depth:
            found = longer(goal, limits, ends.left, claimed=verdict.reason == CLAIMED)
            if not isinstance(found, Unknown):
                return found
            reasons, depth = [*reasons, f"longer runs: {found.reason}"], max(depth, found.depth)
    return Unknown("; ".join(reasons), depth)


_Engine = tuple[str, Callable[[Goal, Limits], Verdict], float]
_ENGINES: tuple[_Engine, ...] = (
    ("k-induction", kinduction, INDUCTION_SHARE),
    ("bounded search", bmc, SEARCH_SHARE),
    ("Spacer", spacer, SPACER_SHARE),
    ("falsifiers", falsify, 1.0),
)
_QUICK = _ENGINES[:2]
"""Engines that are asked about a composition of a claim that one of its machines breaks by itself: its run is what a reader needs."""


def _with_known_runs(engines: Sequence[_Engine], goal: Goal, known_runs: Sequence[Recording]) -> Sequence[_Engine]:
    """Return the engines with a search from known runs behind the first one; of a machine by itself as they are."""
    if not known_runs or not goal.original.parts:
        return engines
    return (*engines[:1], (ENGINE, partial(_from_known_runs, known_runs), SEARCH_SHARE), *engines[1:])


def _from_known_runs(known_runs: Sequence[Recording], goal: Goal, limits: Limits) -> Verdict:
    found = broken_onward([goal], known_runs, limits)
    return Violated(found[goal], ENGINE) if found else Unknown("none breaks it soon after one")


def prove(
    system: TransitionSystem,
    properties: Sequence[Property],
    limits: Limits,
    *,
    jobs: int = 1,
    on_finding: OnFinding | None = None,
    recordings: Sequence[Recording] = (),
    witnesses: Witnesses = NO_WITNESSES,
    lemmas: bool = True,
) -> list[Finding]:
    """Return a Finding for every declared lemma and every property, in order; `on_finding` gets each at once.

    Without `lemmas` there are Findings of properties only, and no run is searched that breaks a lemma.

    The base (ranges, lemmas) is proved first and shared. `jobs` processes work on the properties. Events that `recordings`
    or `witnesses` show need no search. PropertyError if two properties share a name.
    """
    queue, cases = Queue(jobs), CaseSearch(system, properties, limits, recordings, witnesses)
    proving = Proving(system, properties, limits, cases, on_finding, lemmas=lemmas)

    def begin(known: Base, seconds: float) -> None:
        cases.begin_search(queue)
        proving.begin(queue, known, seconds)

    with_base(queue, system, limits, begin)
    cases.begin_known_runs(queue)
    queue.run()
    return proving.findings


class Proving:
    """The proofs of a system's lemmas and properties, as tasks of a queue. PropertyError if two properties share a name."""

    def __init__(
        self,
        system: TransitionSystem,
        properties: Sequence[Property],
        limits: Limits,
        cases: CaseSearch,
        on_finding: OnFinding | None = None,
        *,
        lemmas: bool = True,
    ) -> None:
        _check_names(properties)
        self._system, self._properties, self._limits = system, properties, limits
        self._cases, self._tell, self._lemmas = cases, on_finding or (lambda _: None), lemmas
        self._found: dict[int, Finding] = {}

    @property
    def findings(self) -> list[Finding]:
        """The findings so far, in order of declaration, lemmas first."""
        return [self._found[index] for index in sorted(self._found)]

    def begin(self, queue: Queue, known: Base, seconds: float) -> None:
        """Add the claims that the base does not decide; `seconds` is how long its proof took."""
        facts = _facts(self._system, known, seconds) if self._lemmas else []
        dropped = {index: fact for index, fact in enumerate(facts) if isinstance(fact, Dropped)}
        for index, fact in enumerate(facts):
            if isinstance(fact, Finding):
                self._keep(index, fact)
        if dropped:
            queue.add(self._search([*dropped.values()], self._limits), partial(self._receive_search, "lemma", dropped))
        claims = {
            index: _property_claim(self._system, prop, self._cases.known_runs)
            for index, prop in enumerate(self._properties, len(facts))
        }
        together = searched_together(self._system, self._properties) if dropped else frozenset[Property]()
        unproved = _Unproved(len(together), partial(self._search_together, queue))
        for index, claim in claims.items():
            if claim.goal.prop in together:
                proving = replace(claim, prover=by_induction)
                queue.add(_task(proving, self._limits), partial(self._receive_induction, unproved, index, proving))
            else:
                queue.add(_task(claim, self._limits), partial(self._receive, index, claim))

    def _receive_search(
        self,
        kind: Literal["lemma", "property"],
        dropped: Mapping[int, Dropped],
        packed: list[Packed] | Lost,
        seconds: float,
    ) -> None:
        each: Sequence[Packed | Lost] = [packed] * len(dropped) if isinstance(packed, Lost) else packed
        for (index, fact), one in zip(dropped.items(), each, strict=True):
            verdict = _received(one, fact.goal)
            method = _SEARCHED[kind] if isinstance(verdict, Unknown) else _method(verdict)
            self._keep(index, _finding(fact.goal, kind, verdict, method, seconds))

    def _receive_induction(
        self, unproved: _Unproved, index: int, claim: _Claim, packed: Packed | Lost, seconds: float
    ) -> None:
        verdict = _received(packed, claim.goal)
        if isinstance(verdict, Unknown):
            unproved.add(index, Dropped(claim.goal, f"k-induction without some lemmas: {verdict.reason}"))
        else:
            self._receive(index, claim, packed, seconds)
            unproved.add(index, None)

    def _search_together(self, queue: Queue, unproved: Mapping[int, Dropped]) -> None:
        """Add one search for the runs that break these claims; for all inputs and under the assumption are two."""
        for free in (True, False):
            some = {index: fact for index, fact in unproved.items() if fact.goal.prop.unconditional == free}
            if some:
                limits = search_limits(self._system, self._limits)
                queue.add(self._search([*some.values()], limits), partial(self._receive_search, "property", some))

    def _search(self, dropped: Sequence[Dropped], limits: Limits) -> Task:
        name, known_runs = f"{self._system.name}: runs that break what is not proved", self._cases.known_runs
        return Task(name, lambda: [pack(verdict) for verdict in broken(dropped, limits, known_runs)], _end(limits))

    def _receive(self, index: int, claim: _Claim, packed: Packed | Lost, seconds: float) -> None:
        verdict = _received(packed, claim.goal)
        if isinstance(verdict, Proved) and antecedents.antecedents(claim.goal.prop):
            self._cases.when_known(lambda _: self._decide(index, claim, verdict, seconds))
        else:
            self._decide(index, claim, verdict, seconds)

    def _decide(self, index: int, claim: _Claim, verdict: Verdict, seconds: float) -> None:
        method = _method(verdict)
        judged = self._cases.judged(claim.goal.prop, verdict)
        self._keep(index, _finding(claim.goal, "property", judged, method, seconds))

    def _keep(self, index: int, finding: Finding) -> None:
        self._found[index] = finding
        self._tell(finding)


class _Unproved:
    """Claims that induction did not prove; `then` gets all of them at once, when the last of `expected` claims is here."""

    def __init__(self, expected: int, then: Callable[[Mapping[int, Dropped]], None]) -> None:
        self._left, self._then, self._facts = expected, then, dict[int, Dropped]()

    def add(self, index: int, fact: Dropped | None) -> None:
        """Note a claim; None if it was proved."""
        self._left -= 1
        if fact is not None:
            self._facts[index] = fact
        if not self._left and self._facts:
            self._then(self._facts)


def _check_names(properties: Sequence[Property]) -> None:
    """Refuse two properties of one name: a report identifies properties by name."""
    seen: dict[str, Property] = {}
    for prop in properties:
        other = seen.setdefault(prop.name, prop)
        if other is not prop:
            raise PropertyError(
                f"{prop.src}: property {prop.name!r} has the name of another one ({other.src}); rename one of them."
            )


# ------------------------------------------------------------------ the base


def proved_base(system: TransitionSystem, limits: Limits) -> tuple[Base, float]:
    """Return the system's base and the seconds it took; a process with a time limit proves it."""
    queue, made = Queue(1), list[tuple[Base, float]]()
    with_base(queue, system, limits, lambda known, seconds: made.append((known, seconds)))
    queue.run()
    return made[0]


def with_base(queue: Queue, system: TransitionSystem, limits: Limits, then: Callable[[Base, float], None]) -> None:
    """Call `then` with the system's base and the seconds it took: now, if it is known, or when a task of the queue has proved it."""
    prepare()
    known = known_base(system, limits.seconds)
    if known is not None:
        then(known, 0.0)
        return
    work = partial(_packed_bases, system, limits.seconds)
    task = Task(f"{system.name}: ranges and lemmas", work, _end(limits) * (1 + len(system.parts)))
    queue.add(task, partial(_remember_base, system, limits, then))


def _packed_bases(system: TransitionSystem, seconds: float) -> list[Packed]:
    """Return the system's base, and then those of its machines, from which it is made: other tasks ask for them as well."""
    return [pack_base(base(one, seconds=seconds)) for one in (system, *(part.alone for part in system.parts))]


def _remember_base(
    system: TransitionSystem,
    limits: Limits,
    then: Callable[[Base, float], None],
    packed: list[Packed] | Lost,
    seconds: float,
) -> None:
    terms = {**ranges_and_lemmas(system), **contracts(system)}
    if isinstance(packed, Lost):
        known = Base({}, {}, {name: Undecided(packed.reason) for name in terms}, {}, limits.seconds)
    else:
        known = unpack_base(packed[0], terms)
        for part, its in zip(system.parts, packed[1:], strict=True):
            remember(part.alone, unpack_base(its, {**ranges_and_lemmas(part.alone), **contracts(part.alone)}))
        hold_for_forked(known.certificates)
    remember(system, known)
    then(known, seconds)


def _end(limits: Limits) -> float:
    return CLOCK * 2 * limits.seconds + GRACE_SECONDS


# ------------------------------------------------------------------ claims


@dataclass(frozen=True, eq=False)
class _Claim:
    """A property that `prover` decides in a process of its own."""

    goal: Goal
    prover: Callable[[Goal, Limits], Verdict]


def _property_claim(system: TransitionSystem, prop: Property, recordings: Sequence[Recording]) -> _Claim:
    if prop.kind == "reachable":
        return _Claim(observe(system, prop), partial(reached, recordings=recordings))
    prover = prove_one if prop.kept_by is None else _kept_by_a_machine
    return _Claim(observe(system, prop), partial(prover, known_runs=recordings) if system.parts else prover)


def _kept_by_a_machine(goal: Goal, limits: Limits, known_runs: Sequence[Recording] = ()) -> Verdict:
    """Prove a property on the machine alone; else on the composition."""
    half = replace(limits, seconds=limits.seconds / 2)
    match by_its_machine(goal, limits, lambda alone: prove_one(alone, half)):
        case None:
            return prove_one(goal, limits, known_runs)
        case Proved() as verdict:
            return verdict
        case Violated():
            return _of_the_composition(goal, half, known_runs)
        case _:
            return prove_one(goal, half, known_runs)


def _of_the_composition(goal: Goal, limits: Limits, known_runs: Sequence[Recording]) -> Verdict:
    """Decide a claim that a machine breaks by itself on the composition, whose wires may exclude the run."""
    verdict = _in_turn(_with_known_runs(_QUICK, goal, known_runs), goal, limits)
    machine_and_claim = goal.prop.kept_by
    if not isinstance(verdict, Unknown) or machine_and_claim is None:
        return verdict
    machine, claim = machine_and_claim
    return replace(
        verdict, reason=f"{machine.name} by itself breaks {claim.name!r}; in the composition {verdict.reason}"
    )


def _facts(system: TransitionSystem, known: Base, seconds: float) -> list[Finding | Dropped]:
    """Return a Finding for each lemma and contract that the base has proved, and the dropped ones, in order of declaration."""
    return [*_lemmas(system, known, seconds), *_contracts(system, known, seconds)]


def _lemmas(system: TransitionSystem, known: Base, seconds: float) -> Iterator[Finding | Dropped]:
    by = confirmed_by(known.certificates)
    for name, term in system.lemmas.items():
        goal, key = observe(system, always(name, term)), Fact("lemma", name)
        if key in known.refuted:
            yield Dropped(goal, f"not used: {known.refuted[key]}")
        else:
            verdict = Proved(term, "1-induction", 1, by, known.certificates)
            reach = "for all inputs in range" if key in known.always else "under the assumption"
            method = rechecked_in_words(f"1-induction, all lemmas together, {reach}", by)
            yield _finding(goal, "lemma", verdict, method, seconds)


def _contracts(system: TransitionSystem, known: Base, seconds: float) -> Iterator[Finding | Dropped]:
    for key, prop in contract_properties(system):
        goal = observe(system, prop)
        if key in known.kept:
            by = confirmed_by(known.certificates)
            verdict = Proved(known.kept[key], "1-induction", 1, by, known.certificates)
            method = rechecked_in_words("assume-guarantee: what is known of the machines before it", by)
            yield _finding(goal, "lemma", verdict, method, seconds)
        else:
            why = known.refuted.get(key, "the machines before it do not guarantee this assumption")
            yield Dropped(goal, f"not shown: {why}")


def _task(claim: _Claim, limits: Limits) -> Task:
    goal = claim.goal
    end = _end(limits) * (1 if goal.prop.further_assumption is TRUE else 2)  # proving that it lasts takes as long again
    name = f"{goal.original.name}: {goal.prop.name}"
    return Task(name, lambda: pack(claim.prover(goal, limits)), end, follows=True)


def _received(packed: Packed | Lost, goal: Goal) -> Verdict:
    """Receive the verdict of another process; its trace is checked again in this one."""
    if isinstance(packed, Lost):
        return Unknown(packed.reason)
    verdict = unpack(packed, goal.plain, goal.system)
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
        requirements=prop.requirements,
        assumption=prop.relies_on,
    )


def _method(verdict: Verdict) -> str:
    match verdict:
        case Proved(engine=engine, rechecked=rechecked):
            return rechecked_in_words(engine, rechecked)
        case Violated(engine=engine, trace=None):
            return engine
        case Violated(engine=engine):
            return f"{engine}, replayed in the interpreter"
        case Vacuous():
            return "proved, but vacuously"
        case Unknown():
            return "k-induction, bounded search, Spacer, falsifiers"
        case _:
            assert_never(verdict)
