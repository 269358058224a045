"""All engines together: k-induction first, then search for a violation, then Spacer; several properties in parallel.

A property may take its time limit twice, once to be decided and once to be re-checked; then the clock ends it: each
one has a process of its own.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import assert_never

from safeloc.errors import PropertyError
from safeloc.expr import NumVar
from safeloc.provers.base import Base, base, known_base, range_name, ranges_and_lemmas, remember
from safeloc.provers.bmc import Exhausted, bmc, search
from safeloc.provers.evidence import confirmed
from safeloc.provers.falsify import falsify
from safeloc.provers.implication import Undecided
from safeloc.provers.kinduction import kinduction
from safeloc.provers.limits import Limits, deadline
from safeloc.provers.recheck import ENGINE, file_name
from safeloc.provers.spacer import spacer
from safeloc.provers.transfer import pack, pack_base, unpack, unpack_base
from safeloc.provers.workers import Lost, Task, in_processes
from safeloc.results import Finding
from safeloc.spec import Goal, Property, always, observe
from safeloc.system import TransitionSystem
from safeloc.verdict import Proved, Unknown, Verdict, Violated

GRACE_SECONDS = 5.0
INDUCTION_SHARE, SEARCH_SHARE, FALSIFY_SHARE = 0.4, 0.4, 0.6  # of the time that is left when their turn comes
OnFinding = Callable[[Finding], None]


def prove_one(goal: Goal, limits: Limits) -> Verdict:
    """The verdict of the first engine that decides; Unknown with the greatest depth any of them reached."""
    if goal.prop.kind == "reachable":
        return _reach(goal, limits)
    ends, said, depth = deadline(limits.seconds), list[str](), -1
    for name, engine, share in _ENGINES:
        verdict = engine(goal, replace(limits, seconds=max(0.001, ends.left * share)))
        if not isinstance(verdict, Unknown):
            return verdict
        said.append(f"{name}: {verdict.reason}")
        depth = max(depth, verdict.depth)
    return Unknown("; ".join(said), depth)


def _falsify(goal: Goal, limits: Limits) -> Verdict:
    return falsify(goal, limits, limits.seed)


_ENGINES: tuple[tuple[str, Callable[[Goal, Limits], Verdict], float], ...] = (
    ("k-induction", kinduction, INDUCTION_SHARE),
    ("bounded search", bmc, SEARCH_SHARE),
    ("falsifiers", _falsify, FALSIFY_SHARE),
    ("Spacer", spacer, 1.0),
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
    findings: dict[int, Finding] = {}
    claims = [*_lemma_claims(system, known, limits), *(_property_claim(system, prop, limits) for prop in properties)]
    for index, finding in _settled(claims, seconds):
        findings[index] = finding
        if on_finding is not None:
            on_finding(finding)
    for index, finding in _proved(claims, limits, jobs):
        findings[index] = finding
        if on_finding is not None:
            on_finding(finding)
    return [findings[index] for index in range(len(claims))]


def _check_names(properties: Sequence[Property]) -> None:
    seen: dict[str, Property] = {}
    for prop in properties:
        other = seen.setdefault(file_name(prop.name), prop)
        if other is not prop:
            raise PropertyError(
                f"{prop.src}: property {prop.name!r} has the name of {other.name!r} ({other.src}), or one that gives the "
                "same file name; rename one of them."
            )


# ------------------------------------------------------------------ the base


def proved_base(system: TransitionSystem, limits: Limits) -> tuple[Base, float]:
    """The system's base, proved in a process that the clock ends; and the seconds it took."""
    known = known_base(system, limits.seconds)
    if known is not None:
        return known, 0.0
    task = Task(f"{system.name}: ranges and lemmas", lambda: pack_base(base(system, seconds=limits.seconds)), _end(limits))
    [(_, packed, seconds)] = in_processes([task], 1)
    terms = ranges_and_lemmas(system)
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
    """What is to be found out: at once (`verdict`), or by `work` in a process."""

    goal: Goal
    heading: Finding
    verdict: Verdict | None
    work: Callable[[Goal, Limits], Verdict]


def _lemma_claims(system: TransitionSystem, known: Base, limits: Limits) -> Iterator[_Claim]:
    """Proved lemmas as they are; for one that was dropped, a run that breaks it is searched."""
    for name, term in system.lemmas.items():
        goal = observe(system, always(name, term))
        heading = _heading(goal, "lemma", "")
        if name not in known.refuted:
            reach = "for all inputs in range" if name in known.always else "under the assumption"
            method = f"1-induction with all other lemmas, {reach}, re-checked by cvc5"
            verdict = Proved(term, "1-induction", 1, (ENGINE,), known.certificates)
            yield _Claim(goal, replace(heading, method=method), verdict, bmc)
        else:
            why = f"not used: {known.refuted[name]}"
            yield _Claim(goal, heading, None, lambda goal, limits, why=why: _broken_lemma(goal, limits, why))


def _broken_lemma(goal: Goal, limits: Limits, why: str) -> Verdict:
    found = bmc(goal, limits)
    return Unknown(f"{why}; {found.reason}", found.depth) if isinstance(found, Unknown) else found


def _property_claim(system: TransitionSystem, prop: Property, limits: Limits) -> _Claim:
    goal = observe(system, prop)
    return _Claim(goal, _heading(goal, "property", prop.assumption), None, prove_one)
