"""Judge one mutant, cheap questions first.

It may be refused as a declaration; break a claim on a known run; let rows overlap; leave claims unproved, which a bounded search may
refute; be equivalent; make something impossible; be conservative; or change the outputs of a recording. If none of this is
shown, it survives.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from safeloc.assurance.mutation import results
from safeloc.assurance.mutation.claims import Canon, Claim, Held, held
from safeloc.assurance.mutation.conservative import conservative
from safeloc.assurance.mutation.corpus import Run, corpus, run_of
from safeloc.assurance.mutation.declared import Declared
from safeloc.assurance.mutation.equivalence import equivalent
from safeloc.assurance.mutation.induction import Failed, Proofs, as_it_is, excluded, impossible, no_longer
from safeloc.assurance.mutation.mutants import Mutant
from safeloc.assurance.mutation.playing import WORLD, Played, Trodden, played, tells_otherwise, trodden
from safeloc.assurance.mutation.results import Judged, Outcome
from safeloc.errors import SafelocError
from safeloc.language.spec import Goal, always, observe
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.searches import first_runs
from safeloc.reported import Reported
from safeloc.target import Target

_SEARCH_DEPTH = 6


@dataclass(frozen=True, eq=False)
class Bench:
    """All facts about a target that are needed to judge its mutants."""

    unchanged: Held
    proofs: Proofs
    canon: Canon
    known: Trodden
    limits: Limits
    reported: Reported | None = None


def bench(target: Target, declared: Declared, limits: Limits, seed: int, *, searched: bool = True) -> Bench:
    """Return the bench: proofs and runs of the unchanged machine. `searched` is that of `corpus`."""
    canon = Canon()
    unchanged, known = as_it_is(declared, canon, limits)
    canon.asked.learnt()
    runs = corpus(target, unchanged.system, limits, seed, searched=searched)
    return Bench(unchanged, known, canon, trodden(unchanged, runs), limits, target.reported)


def judged(on: Bench, mutant: Mutant) -> Judged:
    """Judge a mutant of the machine, made in both ways: the machine alone wrong, and the term wrong everywhere."""
    started = time.monotonic()
    alone = outcome_of(on, mutant.alone, on.unchanged.declared)
    everywhere = alone if mutant.everywhere is None else outcome_of(on, mutant.everywhere, on.unchanged.declared)
    return with_outcome(mutant, alone, everywhere, time.monotonic() - started)


def with_outcome(mutant: Mutant, alone: Outcome, everywhere: Outcome, seconds: float, direction: str = "") -> Judged:
    """Return the result of a mutant: its description with its outcomes."""
    return Judged(
        id=mutant.id,
        machine=mutant.machine,
        kind=mutant.kind,
        words=mutant.words,
        place=mutant.place,
        source=mutant.source,
        term=mutant.term,
        becomes=mutant.becomes,
        where=mutant.where,
        shared_with=mutant.shared_with,
        requirements=mutant.requirements,
        everywhere=everywhere,
        alone=alone,
        seconds=max(0.001, round(seconds, 3)),
        of=mutant.of,
        direction=direction,
    )


def outcome_of(on: Bench, make: Callable[[Declared], Declared], declared: Declared) -> Outcome:
    """Return the outcome of the mutant that `make` makes of this declaration, whose claims may be weaker than the original ones."""
    try:
        mutant = held(make(declared), on.canon, on.proofs.under_assumption)
    except SafelocError as error:
        return Outcome(results.REFUSED, (), str(error).splitlines()[-1].strip(" -"))
    seen = played(mutant, on.known)
    if seen.broken:
        return by_a_run(seen)
    overlapping = excluded(mutant, on.unchanged, on.canon, on.limits)
    if overlapping:
        return Outcome(results.OVERLAP, tuple(f"rows {pair} exclude each other" for pair in overlapping), "one query")
    failed = no_longer(mutant, on.proofs, on.canon, on.limits)
    noticed, run = unproved(mutant, failed, on.limits) if failed.claims else (None, None)
    is_other = bool(seen.other) or (run is not None and tells_otherwise(on.unchanged, mutant, run))
    if not is_other and not failed.undecided:
        same = equivalent(on.unchanged, mutant, seen.apart, on.canon, on.limits, still_proved=not failed.claims)
        if same:
            return Outcome(results.EQUIVALENT, (), same)
    if noticed is not None:
        return noticed
    never = impossible(mutant, seen.seen, on.canon, on.limits)
    if never:
        return Outcome(results.NEVER, tuple(never), "excluded in one step, for all inputs in range")
    careful = conservative(on.unchanged, on.known, mutant, seen.apart, on.reported, on.canon, on.limits)
    if careful:
        return Outcome(results.CONSERVATIVE, (), careful)
    return Outcome(results.RECORDED, (), seen.differs) if seen.differs else Outcome(results.SURVIVED, (), seen.other)


def by_a_run(seen: Played) -> Outcome:
    """Return the outcome of claims that known runs break; the shortest run is named."""
    first = min(seen.broken, key=lambda one: one.steps)
    return Outcome(
        results.REFUTED, tuple(one.claim for one in seen.broken), f"{first.run}, {first.steps} steps: {first.claim}"
    )


def unproved(mutant: Held, failed: Failed, limits: Limits) -> tuple[Outcome, Run | None]:
    """Search a run that breaks one of the claims. Return the outcome and the run; without a run the claims are unproved."""
    claims = failed.claims
    for number, layer in enumerate(mutant.layers):
        some = [claim for claim in claims if any(claim is own for own in layer.claims)]
        goals = {_goal(mutant, claim, unconditional=number < WORLD): claim for claim in some}
        found = first_runs(list(goals), Limits(depth=_SEARCH_DEPTH, seconds=limits.seconds)).found
        if found:
            shortest = min(found, key=lambda goal: len(found[goal].steps))
            names = tuple(str(goals[goal]) for goal in found)
            text = f"{len(found[shortest].steps)} steps: {goals[shortest]}"
            return Outcome(results.SEARCHED, names, text), run_of(mutant.system, "found", found[shortest])
    how = "not all decided within the limits" if failed.undecided else "refuted in one step of induction"
    return Outcome(results.UNPROVED, tuple(map(str, claims)), f"{how}; no run of {_SEARCH_DEPTH} steps was found"), None


def _goal(mutant: Held, claim: Claim, *, unconditional: bool) -> Goal:
    """Return the claim as a goal with the assumption of its layer, since all goals of one search have the same assumption."""
    if claim.goal is not None:
        return claim.goal
    return observe(mutant.system, always(claim.name, claim.good, unconditional=unconditional))
