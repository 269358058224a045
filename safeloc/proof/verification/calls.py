"""Verification as function calls: prove, test or verify one target without the command line.

A target comes from `safeloc.catalogue.load_target`. Replay a recording with
`safeloc.proof.verification.replay.replay_stream`; write findings as a report with `safeloc.report.folder.write_folder`.

In every call, `store` is the cache of earlier results (None: no cache), and `fresh` ignores what is in it. `on_phase` and
`on_finding` are called during the work, for a display of progress.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from safeloc.errors import InputError
from safeloc.language.spec import Property
from safeloc.proof.cache.answers import kept_in
from safeloc.proof.cache.store import Store
from safeloc.proof.cache.targets import asked, found_before, keep
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import OnFinding
from safeloc.proof.results import Finding, Findings
from safeloc.proof.verification.many import Event, OnEvent, verify_targets
from safeloc.proof.verification.one import ASSUMPTION_COUNT, OnPhase, Plan, Work, claims, obligation_count
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
    with_assumption: bool = True,
    limits: Limits = _LIMITS,
    jobs: int = 2,
    store: Store | None = None,
    fresh: bool = False,
    on_phase: OnPhase = _no_phase,
    on_finding: OnFinding = _no_finding,
) -> Findings:
    """Prove the properties and obligations of a target in at most `jobs` processes; return the findings.

    only    names of properties: only these are proved, and of the obligations those of the assumption, since without these a proof under
            it may be empty; lemmas and contracts alone, without any obligation, if no name is given. InputError for a name that the target
            does not have
    with_assumption  of `only`: also the obligations of the assumption; False for one that asks them itself
    limits  bounds of the provers, for each property
    """
    properties, work = chosen_properties(target, only), Work(target, jobs, on_phase, on_finding)

    def chosen() -> list[Finding]:
        return [*nothing_asked(target), *work.proved(properties, limits)]

    def every() -> list[Finding]:
        return [finding for part in work.proved_and_obliged(limits) for finding in part]

    keeping = _Keeping(target, store, fresh)
    if only is None:
        return Findings(keeping.found(every, "proved", limits, None))
    proved = keeping.found(chosen, "proved", limits, list(only))
    kept = keeping.found(lambda: work.assumption_kept(limits), "assumption", limits) if only and with_assumption else []
    return Findings([*proved, *kept])


@dataclass(frozen=True)
class _Keeping:
    """Findings of a target, kept from run to run if there is a store."""

    target: Target
    store: Store | None
    fresh: bool

    def found(self, work: Callable[[], list[Finding]], *question: object) -> list[Finding]:
        """Return the kept findings of a request, or those that the work finds now."""
        request = None if self.store is None else asked(self.target, *question)
        found = None if self.fresh or request is None else found_before(self.store, request)
        if found is None:
            with kept_in(self.store, fresh=self.fresh):
                found = work()
            if request is not None:
                found = keep(self.store, request, found)
        return found


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
    obliged = obligation_count(target) if only is None else ASSUMPTION_COUNT
    return claims(target, chosen_properties(target, only)) + obliged


def expected_of_tests(target: Target) -> int:
    """Estimate the number of findings of `run_property_tests`."""
    return obligation_count(target) + len(target.properties)
