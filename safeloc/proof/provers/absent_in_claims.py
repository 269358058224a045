"""Check that no claim depends on the value of an absent input: a stored number that nobody measured.

Most claims ask for the input's presence; the value disappears once the presence flag is set to false. For the others a solver
proves that a step leaves the claim the same whatever number is stored, first for all inputs in range, then under the assumption.
Of what is left a run is searched after which the claim differs. That machine and laws do not read the value is an obligation of
its own (`absence`). A claim that a composition inherits is asked on its machine alone, where it is proved.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from safeloc.codegen.smtlib import Query
from safeloc.language.expr import Bool, Optional
from safeloc.language.interpret import run
from safeloc.language.read_twice import other_value, read_alike, reads, reads_while_absent, told_apart
from safeloc.language.spec import Property, observe
from safeloc.language.system import TransitionSystem, canonical, in_range
from safeloc.language.trace import Trace
from safeloc.language.verdict import Proved, Unknown, Verdict, Violated
from safeloc.proof.provers.facts import about
from safeloc.proof.provers.limits import Deadline, Limits, deadline
from safeloc.proof.provers.never import never
from safeloc.proof.provers.obligation import Obligation
from safeloc.proof.provers.proved_base import Base, base
from safeloc.proof.provers.recheck import confirmed_by
from safeloc.proof.provers.replayed_evidence import replayed
from safeloc.proof.provers.settle import settled_but

_NAME = "absence in claims"
_STATEMENT = "no claim depends on the value of an absent input"
_NAMED = 3  # undecided claims that the verdict names; it only counts the others


@dataclass
class _Found:
    """The readings of all claims: how many, how many a solver was asked of, and the answers."""

    held: int = 0
    asked: int = 0
    broken: list[tuple[str, Trace]] = field(default_factory=list)
    open: list[str] = field(default_factory=list)
    texts: dict[str, str] = field(default_factory=dict)


def absence_in_claims(claims: Sequence[Property], system: TransitionSystem, limits: Limits) -> Iterator[Obligation]:
    """Yield one obligation for all claims; none if no claim reads an optional input."""
    found = _Found()
    for alone, own in _asked_on(claims, system):
        _look(alone, own, limits, found)
    if found.held:
        by_folding = (
            f"{found.held - found.asked} of {found.held} readings disappear when the presence flag is set to false"
        )
        method = f"{by_folding}; {found.asked} checked by two readings of a step"
        yield Obligation(_NAME, _STATEMENT, _verdict(found, by_folding), method)


def some_read(claims: Sequence[Property], system: TransitionSystem) -> bool:
    """Return whether some claim reads an optional input."""
    return any(
        reads(one, option) for alone, own in _asked_on(claims, system) for one in own for option in alone.optionals
    )


def _asked_on(
    claims: Sequence[Property], system: TransitionSystem
) -> Iterator[tuple[TransitionSystem, list[Property]]]:
    """Yield each machine alone with the claims that are inherited from it, then the system with its own claims."""
    for part in system.parts:
        yield (
            part.alone,
            [one.kept_by[1] for one in claims if one.kept_by is not None and one.kept_by[0] is part.machine],
        )
    yield system, [one for one in claims if one.kept_by is None]


def _look(system: TransitionSystem, claims: Sequence[Property], limits: Limits, found: _Found) -> None:
    ends = deadline(limits.seconds)
    for option in system.optionals:
        held = [one for one in claims if reads(one, option)]
        left = [one for one in held if reads_while_absent(one, option)]
        found.held, found.asked = found.held + len(held), found.asked + len(left)
        if left:
            _Asking(system, option, limits, ends, found).about(left)


class _Asking:
    """Questions about one optional input of a system."""

    def __init__(
        self, system: TransitionSystem, option: Optional, limits: Limits, ends: Deadline, found: _Found
    ) -> None:
        self._system, self._option, self._other = system, option, other_value(option)
        self._limits, self._ends, self._found = limits, ends, found

    def about(self, claims: Sequence[Property]) -> None:
        """Ask of all claims together if a step leaves them the same, and search for runs where this is not proved."""
        system = self._system
        known = base(system, seconds=self._limits.seconds)
        alike = {one: read_alike(system, one, self._option, self._other) for one in claims}
        absent = [in_range([*system.inputs, self._other]), ~self._option.present]
        self._settle("absence", [*absent, *known.always.values()], alike, known)
        lawful = {one: same for one, same in alike.items() if not one.unconditional}
        under = [*absent, *known.everything, system.assume]
        self._settle("absence under the assumption", under, lawful, known)
        for one in alike:
            if one.unconditional or one in lawful:
                self._search(one)

    def _settle(self, rule: str, hypotheses: Sequence[Bool], alike: dict[Property, Bool], known: Base) -> None:
        """Keep the certificate of what follows, and take it out of `alike`."""
        if not alike:
            return
        name = self._option.value.name
        query = Query(
            f"{self._system.name} {rule} of {name} in claims", hypotheses, alike, about(self._system, rule, of=name)
        )
        answer, follow = settled_but(query, self._ends, list(known.certificates))
        if answer.texts:
            self._found.texts |= {**known.certificates, **answer.texts}
        for one in follow:
            del alike[one]

    def _search(self, claim: Property) -> None:
        """Search for a run after which the claim differs: a single step may start in an unreachable state."""
        goal = told_apart(self._system, claim, self._option, self._other)
        verdict = never(goal, "the readings differ in some state", self._limits)
        who = f"{claim.name!r} ({claim.src}) reads {self._option.value.name}"
        if isinstance(verdict, Violated):
            assert verdict.trace is not None
            self._found.broken.append(self._witness(claim, verdict.trace, who))
        elif isinstance(verdict, Proved):
            self._found.texts |= verdict.certificates
        else:
            assert isinstance(verdict, Unknown)
            self._found.open.append(f"{who}: {verdict.reason}")

    def _witness(self, claim: Property, both: Trace, who: str) -> tuple[str, Trace]:
        """Return in words how the readings differ after the run, and the run with the numbers that are stored."""
        system, option, other = self._system, self._option, self._other.name
        own = {var.name for var in system.state}
        stream = [{name: value for name, value in one.items() if name != other} for one in both.stream()]
        first = {name: value for name, value in both.initial.items() if name in own}
        kept = replayed(observe(system, claim), first, stream) is None
        instead = [str(step.inputs[other]) for step in both.steps if not step.inputs[option.present.name]]
        with_stored, with_other = ("kept", "broken") if kept else ("broken", "kept")
        told = (
            f"{who} while it is absent: after a run of {len(stream)} steps it is {with_stored} with the stored "
            f"{canonical(option.value)}, and {with_other} with {', '.join(instead)}"
        )
        return told, run(system, stream, first=first)


def _verdict(found: _Found, by_folding: str) -> Verdict:
    if found.broken:
        texts, runs = zip(*found.broken, strict=True)
        reason = (
            f"the claim {'; the claim '.join(texts)}. Ask for its presence: x.present.implies(...), or x.present & ..."
        )
        return Violated(runs[0], "bmc", reason)
    if found.open:
        more = f"; and {len(found.open) - _NAMED} more" if len(found.open) > _NAMED else ""
        return Unknown("; ".join(found.open[:_NAMED]) + more)
    if not found.asked:
        return Proved(None, "folding", by_construction=by_folding)
    return Proved(None, "z3", 1, confirmed_by(found.texts), found.texts, by_construction=by_folding)
