"""A proof as data: each step claims a formula, from earlier steps as premises and under open assumptions."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass, field
from typing import NamedTuple

from safeloc.checker.proofs.terms import FALSE, Term, make, no


class Step(NamedTuple):
    """One step: its rule, the numbers of the earlier steps that are its premises, its arguments, and the formula it claims."""

    rule: str
    premises: tuple[int, ...]
    args: tuple[Term, ...]
    claim: Term


class Inference(NamedTuple):
    """The input of a rule: formulas, arguments, and the claim (read only by rules that check instead of compute)."""

    premises: tuple[Term, ...]
    args: tuple[Term, ...]
    claim: Term


class WrongStep(Exception):
    """A step that its rule does not allow."""


Rule = Callable[[Inference], Term]


@dataclass(frozen=True)
class Checked:
    """Every step was checked, except those of `trusted` (rule -> count); if it is empty, the proof needs no trust."""

    steps: int
    rules: Mapping[str, int]
    trusted: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True)
class Failed:
    """There is no proof, or it is wrong; `where` gives the step and the reason."""

    where: str


def check(
    steps: Sequence[Step], allowed: Set[Term], rules: Mapping[str, Rule], *, families: Mapping[str, Rule] | None = None
) -> Checked | Failed:
    """Check that the last step proves `false` from allowed assumptions.

    families  the part of a rule's name before a colon -> rule; a step that such a rule refuses with NotImplementedError counts
              as trusted
    """
    trail = _Trail(rules, families or {})
    for at, step in enumerate(steps):
        try:
            trail.take(at, step)
        except (WrongStep, TypeError, ValueError, IndexError, RecursionError) as error:
            return Failed(f"step {at} of {len(steps)}, {step.rule}: {error}")
    if not steps or steps[-1].claim is not FALSE:
        return Failed("the last step does not claim false")
    strange = [term for term in trail.assumptions(len(steps) - 1) if term not in allowed]
    if strange:
        return Failed(f"assumes what the text does not assert: {strange[0]}")
    return Checked(len(steps), dict(Counter(step.rule for step in steps)), dict(trail.trusted))


class _Trail:
    """The steps checked so far: the claim of each, and the assumptions on which it depends, as bits of a number."""

    def __init__(self, rules: Mapping[str, Rule], families: Mapping[str, Rule]) -> None:
        self.rules, self.families = rules, families
        self.claims: list[Term] = []
        self.open: list[int] = []
        self.bits: dict[Term, int] = {}
        self.trusted: Counter[str] = Counter()

    def take(self, at: int, step: Step) -> None:
        """Check one step and store it. WrongStep if it does not follow."""
        if any(not 0 <= premise < at for premise in step.premises):
            raise WrongStep("uses a step that does not come before it")
        under = 0
        for premise in step.premises:
            under |= self.open[premise]
        if step.rule == "ASSUME":
            under = self._assumed(step)
        elif step.rule == "SCOPE":
            under &= ~self._discharged(step)
        else:
            self._inferred(step)
        self.claims.append(step.claim)
        self.open.append(under)

    def _assumed(self, step: Step) -> int:
        if step.args != (step.claim,) or step.premises or step.claim.sort != "Bool":
            raise WrongStep("claims another formula than it assumes")
        return self._bit(step.claim)

    def _bit(self, term: Term) -> int:
        return 1 << self.bits.setdefault(term, len(self.bits))

    def _discharged(self, step: Step) -> int:
        [premise] = step.premises
        if not step.args:
            raise WrongStep("discharges nothing")
        joined = step.args[0] if len(step.args) == 1 else make("and", *step.args)
        claim = self.claims[premise]
        if step.claim is not (no(joined) if claim is FALSE else make("=>", joined, claim)):
            raise WrongStep("claims something else than the implication")
        return sum({self._bit(one) for one in step.args})

    def _inferred(self, step: Step) -> None:
        rule = self.rules.get(step.rule) or self.families.get(step.rule.partition(":")[0])
        inference = Inference(tuple(self.claims[one] for one in step.premises), step.args, step.claim)
        try:
            if rule is None:
                raise NotImplementedError
            found = rule(inference)
        except NotImplementedError:
            self.trusted[step.rule] += 1
            return
        if found is not step.claim:
            raise WrongStep(f"claims {step.claim}, but {found} follows")

    def assumptions(self, at: int) -> list[Term]:
        """Return the assumptions on which the step depends."""
        return [term for term, bit in self.bits.items() if self.open[at] >> bit & 1]
