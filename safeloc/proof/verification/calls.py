"""Verification as function calls: prove, test or verify one target without the command line.

A target comes from `safeloc.catalogue.load_target`. Replay a recording with
`safeloc.proof.verification.replay.replay_stream`; write findings as a report with `safeloc.report.folder.write_folder`.

In every call, `store` is the cache of earlier results (None: no cache), and `fresh` ignores what is in it. `on_phase` and
`on_finding` are called during the work, for a display of progress.
"""

from __future__ import annotations

from collections.abc import Sequence

from safeloc.errors import InputError
from safeloc.language.spec import Property
from safeloc.proof.cache.answers import kept_in
from safeloc.proof.cache.store import Store
from safeloc.proof.cache.targets import asked, found_before, keep
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import OnFinding
from safeloc.proof.results import Finding, Findings
from safeloc.proof.verification.many import Event, OnEvent, verify_targets
from safeloc.proof.verification.one import OnPhase, Plan, Work, claims, obligation_count
from safeloc.proof.verification.unasked import nothing_asked, nothing_tested
from safeloc.target import Target

_LIMITS = Limits()
_PLAN = Plan(_LIMITS, examples=60, steps=60, seed=0)


def _no_phase(_text: str, _planned: int) -> None: ...


def _no_finding(_finding: Finding) -> None: ...


def _no_event(_event: Event) -> None: ...


def prove_target(
    target: Target,
    *,
    only: Sequence[str] | None = None,
    limits: Limits = _LIMITS,
    jobs: int = 2,
    store: Store | None = None,
    fresh: bool = False,
    on_phase: OnPhase = _no_phase,
    on_finding: OnFinding = _no_finding,
) -> Findings:
    """Prove the properties and obligations of a target in at most `jobs` processes; return the findings.

    only    names of properties: only these are proved, and no obligation; InputError for a name that the target does not have
    limits  bounds of the provers, for each property
    """
    properties = chosen_properties(target, only)
    question = None if store is None else asked(target, "proved", limits, None if only is None else list(only))
    found = None if fresh or question is None else found_before(store, question)
    if found is None:
        with kept_in(store, fresh=fresh):
            work = Work(target, jobs, on_phase, on_finding)
            if only is None:
                found = [finding for part in work.proved_and_obliged(limits) for finding in part]
            else:
                found = [*nothing_asked(target), *work.proved(properties, limits)]
        if question is not None:
            keep(store, question, found)
    return Findings(found)


def run_property_tests(
    target: Target,
    plan: Plan = _PLAN,
    *,
    jobs: int = 2,
    on_phase: OnPhase = _no_phase,
    on_finding: OnFinding = _no_finding,
) -> Findings:
    """Run the property tests of a target along plausible and faulty streams; return the findings.

    Obligations are proved first, within the limits of `plan`, and tests also start along the runs that these proofs
    find.
    """
    work = Work(target, jobs, on_phase, on_finding)
    obliged = work.obliged(plan.limits)
    return Findings([*nothing_tested(target), *work.tested(plan, obliged)])


def verify_target(
    target: Target,
    plan: Plan = _PLAN,
    *,
    jobs: int = 2,
    store: Store | None = None,
    fresh: bool = False,
    on_event: OnEvent = _no_event,
) -> Findings:
    """Prove and test a target and replay the recordings that ship with it; return all findings.

    `safeloc.proof.verification.many.verify_targets` does the same for several targets at a time.
    """
    look_in = None if fresh else store
    found = verify_targets([target], plan, jobs=jobs, on_event=on_event, look_in=look_in, keep_in=store)
    return Findings(found[target.name])


def chosen_properties(target: Target, names: Sequence[str] | None) -> list[Property]:
    """Return the properties of these names; all if None is given. InputError for a name that the target does not have."""
    if names is None:
        return list(target.properties)
    known = {prop.name: prop for prop in target.properties}
    missing = [name for name in names if name not in known]
    if missing:
        raise InputError(f"{target.name} has no property {missing[0]!r}; it has {', '.join(known)}.")
    return [known[name] for name in names]


def expected_of_proof(target: Target, only: Sequence[str] | None) -> int:
    """Estimate the number of findings of `prove_target`."""
    return claims(target, chosen_properties(target, only)) + (obligation_count(target) if only is None else 0)


def expected_of_tests(target: Target) -> int:
    """Estimate the number of findings of `run_property_tests`."""
    return obligation_count(target) + len(target.properties)
