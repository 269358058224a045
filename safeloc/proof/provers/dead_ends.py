"""Proof that every reachable state has a lawful next step, by witness functions; or a run into a dead end.

covered    some known witness function gives lawful inputs (safeloc.proof.provers.cover); a term over state
proved     every state with the proved facts is covered; or every step preserves `covered`, proved as a property is
refuted    a run reaches a state without lawful inputs: found by bounded search, in long lawful runs, or in recordings

A state that is not covered but has lawful inputs only shows that a witness function is missing: it is learned, and the
search goes on. No proof relies on where witness functions come from.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import z3

from safeloc.codegen.smt import Unrolling
from safeloc.codegen.smtlib import Query, to_smtlib
from safeloc.errors import InputError
from safeloc.language.expr import TRUE, Bool, all_of
from safeloc.language.interpret import start, stepped
from safeloc.language.nodes import Value
from safeloc.language.spec import Goal, Property, always, observe
from safeloc.language.system import TransitionSystem
from safeloc.language.verdict import Proved, Unknown, Vacuous, Verdict, Violated
from safeloc.proof.provers.asking import ask, new_solver, why_unknown
from safeloc.proof.provers.contradiction import no_run
from safeloc.proof.provers.cover import Cover, Group, Learned, State, cover_facts
from safeloc.proof.provers.deepening import Deepening
from safeloc.proof.provers.facts import about
from safeloc.proof.provers.falsify import falsify
from safeloc.proof.provers.further_assumption import EMPTY
from safeloc.proof.provers.kinduction import kinduction
from safeloc.proof.provers.limits import Deadline, Limits, deadline
from safeloc.proof.provers.proved_base import Base, base, remember
from safeloc.proof.provers.recheck import certify, confirmed_by, file_name
from safeloc.proof.provers.recorded_witnesses import Recording, lawful_part
from safeloc.proof.provers.replayed_evidence import admissible_run
from safeloc.proof.provers.spacer import spacer

_LASTS = "the assumption can be kept for ever"  # in names of certificates
SHALLOW, DEEPEST = 5, 160  # steps of bounded search: before induction, and after it where time allows
DIRECT, INDUCTION, SEARCH, INVARIANT = 0.6, 0.4, 0.5, 0.5  # shares of the time that is left when their turn comes
_LEAST_SECONDS = 0.05

Inputs = Mapping[str, Value]


def lasts(
    system: TransitionSystem,
    limits: Limits,
    recordings: Sequence[Recording] = (),
    *,
    of: Property | None = None,
    patience: int = 1,
) -> Verdict:
    """Decide whether every reachable state, the first ones included, has inputs that satisfy the system's assumption.

    Proved comes with certificates. Violated comes with a run into a dead end, or without a run if none exists. `of` is
    the property whose further assumption is included, if any. The search gets the limit `patience` times; what is proved
    of the system is not proved anew for it.
    """
    patient = replace(limits, seconds=patience * limits.seconds)
    search = _Search(system, base(system, seconds=limits.seconds), patient, of, tuple(recordings))
    for verdict in search.engines():
        if verdict is not None:
            return verdict
    return Unknown("; ".join(search.reasons), search.depth)


@dataclass(eq=False)
class _Search:
    """The state of the search for a system's dead ends."""

    system: TransitionSystem
    known: Base
    limits: Limits
    of: Property | None
    recordings: tuple[Recording, ...]
    reasons: list[str] = field(default_factory=list)
    depth: int = -1
    cover: Cover = field(init=False)
    open: list[Group] = field(init=False)
    texts: dict[str, str] = field(default_factory=dict)
    ends: Deadline = field(init=False)

    def __post_init__(self) -> None:
        self.cover = Cover(self.system)
        self.open = list(self.cover.groups)
        self.ends = deadline(self.limits.seconds)

    def engines(self) -> Iterator[Verdict | None]:
        """Run the engines in turn; yield a verdict, or None from an engine that does not decide."""
        yield self._beginning()
        yield self._facts()
        runs = Deepening(Unrolling(self.system), new_solver(self.limits.seed))
        yield self._bounded(runs, SHALLOW, self._share(SEARCH))
        yield self._recorded()
        yield self._induction(self._share(INDUCTION))
        yield self._bounded(runs, max(self.limits.depth, DEEPEST), self._share(SEARCH))
        yield self._invariant()
        yield self._runs()

    @property
    def name(self) -> str:
        """The name of the claim in certificates."""
        return f"{self.of.name}: its further assumption can be kept for ever" if self.of else _LASTS

    def _share(self, part: float) -> Deadline:
        return deadline(self.ends.left * part)

    def _some(self, part: float = 1.0) -> Limits:
        return replace(self.limits, seconds=max(_LEAST_SECONDS, self.ends.left * part))

    def _learn(self, state: State) -> Learned:
        return self.cover.learn(state, max(_LEAST_SECONDS, self.ends.left))

    def _goal(self) -> Goal:
        """Make the goal that the open conditions are covered in every state. Its terms carry no units."""
        return replace(observe(self.system, always(self.name, TRUE)), good=self._covered())

    def _covered(self) -> Bool:
        return all_of(group.covered for group in self.open)

    def _beginning(self) -> Verdict | None:
        """Check that a first state exists, and a lawful step from some first state."""
        unrolling, solver = Unrolling(self.system), new_solver()
        solver.add(unrolling.initially(), unrolling.transition(0))
        answer = ask(solver, self.ends.left)
        if answer == z3.unknown:
            self.reasons.append(f"the first step: solver: {why_unknown(solver)}")
        return Violated(None, "bmc", no_run(self.system, 1, self.ends)) if answer == z3.unsat else None

    # -------------------------------------------------------------- every state with the proved facts

    def _facts(self) -> Verdict | None:
        """Check, group by group, that every state with the proved facts is covered."""
        ends = self._share(DIRECT)
        came = [(group, cover_facts(group, self.known.everything, ends, self.limits.seed)) for group in self.open]
        unsure = self._confirm([group for group, learned in came if learned is Learned.COVERED])
        self.open = [group for group, learned in came if learned is not Learned.COVERED or group in unsure]
        self.reasons += [f"from the proved facts: {why}" for why in sorted({one.value for _, one in came} - _FINE)]
        self.reasons += ["cvc5 could not confirm in time that every state is covered"] if unsure else []
        if self.open:
            return None
        texts = {**self.known.certificates, **self.texts, **self._witnesses()}
        return Proved(None, "witness functions", 1, confirmed_by(texts), texts)

    def _witnesses(self) -> dict[str, str]:
        """Write the witness functions as a text of their own, for the checker: the goals do not name them."""
        witnesses = {
            f"{place}.{number}": witness
            for place, group in enumerate(self.cover.groups, 1)
            for number, witness in enumerate(group.witnesses, 1)
        }
        head = about(self.system, "witnesses", **self._of())
        text = to_smtlib(Query[str](f"{self.system.name} {self.name}, by what", [], {}, head, witnesses))
        return {file_name(f"{self.system.name} {self.name}, by what", text): text}

    def _of(self) -> dict[str, str]:
        return {"property": self.of.name} if self.of else {}

    def _confirm(self, groups: Sequence[Group]) -> list[Group]:
        """Store the certificates of the groups that the second solver confirms; return the other groups."""
        if not groups:
            return []
        named = {f"a lawful step, inputs {number}": group for number, group in enumerate(groups, 1)}
        goals = {name: group.covered for name, group in named.items()}
        head = about(self.system, "lasts", **self._of())
        query = Query(f"{self.system.name} {self.name}", self.known.everything, goals, head)
        made = certify(query, seconds=self.limits.seconds, relies_on=list(self.known.certificates))
        unsure = [named[name] for name in made.undecided]
        if not unsure:
            self.texts[made.file] = made.text
            return []
        return unsure + self._confirm([group for group in groups if group not in unsure])

    # -------------------------------------------------------------- every reachable state

    def _induction(self, ends: Deadline) -> Verdict | None:
        """Prove by induction over several steps that the open conditions are covered."""
        for k in range(1, self.limits.induction + 1):
            learned = self._inductive(k, ends)
            if learned is Learned.COVERED:
                return self._proved(kinduction(self._goal(), self._some(INDUCTION)))
            if learned is Learned.UNDECIDED:
                break
        self.reasons.append(f"not shown by {self.limits.induction}-induction")
        return None

    def _inductive(self, k: int, ends: Deadline) -> Learned:
        """Check that k covered states are followed by a covered one; learn witness functions as long as that helps."""
        unrolling = Unrolling(self.system)
        conditions = [all_of([*self.known.everything, *self.known.kept.values()])] * k
        steps = [
            part for at, term in enumerate(conditions) for part in (unrolling.at(term, at), unrolling.transition(at))
        ]
        while not ends.passed:
            covered, solver = self._covered(), new_solver()
            solver.add(*steps, *(unrolling.at(covered, at) for at in range(k)))
            solver.add(z3.Not(unrolling.at(covered, k)))
            answer = ask(solver, ends.left)
            if answer != z3.sat:
                return Learned.COVERED if answer == z3.unsat else Learned.UNDECIDED
            learned = self._learn(_of_state(self.system, unrolling.values(solver.model(), k, self.system.state)))
            if learned is not Learned.COVERED:
                return learned
        return Learned.UNDECIDED

    def _invariant(self) -> Verdict | None:
        return self._proved(spacer(self._goal(), self._some(INVARIANT)))

    def _proved(self, verdict: Verdict) -> Verdict | None:
        """Return the proof with the earlier certificates; None if the verdict is no proof."""
        if isinstance(verdict, Proved):
            texts = {**self.texts, **verdict.certificates, **self._witnesses()}
            return replace(verdict, rechecked=confirmed_by(texts), certificates=texts)
        self.reasons.append(getattr(verdict, "reason", ""))
        return None

    # -------------------------------------------------------------- a run into a dead end

    def _bounded(self, runs: Deepening, depth: int, ends: Deadline) -> Verdict | None:
        """Find the shortest run into a dead end, up to the depth limit."""
        while runs.depth < depth and not ends.passed:
            model = runs.run(runs.fails(self._covered()), ends)
            if runs.stuck:
                break
            if model is None:
                runs.deeper()
                continue
            learned = self._learn(_of_state(self.system, runs.end(model, self.system.state)))
            if learned is Learned.DEAD:
                return self._dead_end(runs.first(model, self.system.state), runs.stream(model), "bmc")
            if learned is Learned.UNDECIDED:
                break
        self.depth = runs.depth
        self.reasons.append(f"no dead end in {runs.depth} steps")
        return None

    def _recorded(self) -> Verdict | None:
        """Find a recorded run whose last lawful state is a dead end."""
        for recording in self.recordings:
            first, stream = lawful_part(self.system, recording)
            if self.ends.passed:
                break
            if stream and self._learn(_after(self.system, first, stream)) is Learned.DEAD:
                return self._dead_end(first, stream, "recorded")
        return None

    def _runs(self) -> Verdict | None:
        """Search in long lawful runs, as the falsifier makes them."""
        while not self.ends.passed:
            try:
                found = falsify(self._goal(), self._some())
            except InputError as error:
                self.reasons.append(f"falsify: {error}")
                return None
            if not isinstance(found, Violated) or found.trace is None:
                self.reasons.append(getattr(found, "reason", ""))
                return None
            first, stream = found.trace.initial, [one.inputs for one in found.trace.steps]
            learned = self._learn(_after(self.system, first, stream))
            if learned is Learned.DEAD:
                return self._dead_end(first, stream, found.engine)
            if learned is Learned.UNDECIDED:
                break
        return None

    def _dead_end(self, first: Inputs, stream: Sequence[Inputs], engine: str) -> Verdict:
        after = f"after these {len(stream)} steps" if stream else "in this first state"
        why = f"{after} no inputs satisfy the assumption, so no proof covers any later step"
        return Violated(admissible_run(self.system, first, stream), engine, why)


_FINE = {Learned.COVERED.value}


def _of_state(system: TransitionSystem, named: Mapping[str, Value]) -> State:
    return {var: named[var.name] for var in system.state}


def _after(system: TransitionSystem, first: Inputs, stream: Sequence[Inputs]) -> State:
    begin = start(system, first)
    rows = ({var: record[var.name] for var in system.inputs} for record in stream)
    return [begin, *(after for _, after, _ in stepped(system, begin, rows))][-1]


# ------------------------------------------------------------------ the further assumption of a property


def further_assumption_lasts(goal: Goal, proved: Proved, limits: Limits) -> Verdict:
    """Return the proof if its further assumption can be satisfied for ever; else Vacuous, or Unknown if undecided."""
    if goal.prop.further_assumption is TRUE:
        return proved
    known = base(goal.original, seconds=limits.seconds)
    remember(goal.plain, replace(known, facts={}, kept={}) if goal.prop.unconditional else known)
    verdict = lasts(goal.plain, limits, of=goal.prop)
    match verdict:
        case Proved(certificates=certificates):
            texts = {**proved.certificates, **certificates}
            return replace(proved, rechecked=confirmed_by(texts), certificates=texts)
        case Violated(trace=None):
            return Vacuous(EMPTY)
        case Violated(trace=trace, reason=reason):
            return Vacuous(f"the further assumption comes to an end: {reason}", trace)
        case _:
            return Unknown(
                f"proved, but it is not known if the further assumption can be satisfied for ever: {verdict.reason}"
            )
