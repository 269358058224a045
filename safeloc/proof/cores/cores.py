"""Proof cores: for each proved claim, a minimal set of clauses, lemmas and rows that suffices to prove it.

"Minimal" means that no element can be left out; another set may have fewer elements. The claim is proved again from each set
alone. z3 finds the sets; the verdicts rest on the certificates of `prove`, not on the sets.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from safeloc.language.spec import Property, observe
from safeloc.language.system import TransitionSystem
from safeloc.language.verdict import Proved
from safeloc.proof.cores.elements import Asked, Element, asked, asked_of_the_world
from safeloc.proof.cores.steps import Switched
from safeloc.proof.provers.by_its_machine import inherited
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove_one
from safeloc.proof.provers.proved_base import Base, base

_QUESTION_SHARE = 0.2
"""Share of the time limit for a claim that each query gets which tries to leave out one element."""
_ORDER = ("range", "lemma", "contract", "row", "move", "clause")
"""The order in which kinds of elements are left out; clauses come last, when the core is small already."""


@dataclass(frozen=True)
class Core:
    """A minimal set of elements from which a claim is proved.

    rests_on  the elements, none of which can be left out (unless `open_` names it)
    steps     k of the k-induction
    kept_by   for an inherited claim of a composition: the machine on which it is proved, and to which the elements belong
    open_     elements of which no solver decided within the limits whether they can be left out
    why_none  if there is no set: the reason
    """

    claim: str
    rests_on: tuple[Element, ...] = ()
    steps: int = 0
    kept_by: str = ""
    open_: tuple[Element, ...] = ()
    why_none: str = ""


def core(system: TransitionSystem, prop: Property, limits: Limits) -> Core:
    """Return the core of the claim; a claim of kind `reachable` has none, since a run shows it."""
    if prop.kind == "reachable":
        return Core(prop.name, why_none="shown by a run")
    of_one_machine = inherited(observe(system, prop))
    if of_one_machine is not None:
        part, claim = of_one_machine
        return _core(part.alone, claim, limits, prop.name, part.name)
    return _core(system, prop, limits, prop.name, "")


def of_the_world(system: TransitionSystem, prop: Property, limits: Limits) -> Asked | None:
    """Return what of its world, with lemmas, suffices to prove a claim on a single machine; None if no induction within the limits does.

    It is small, and not minimal: clauses and moves are left out one by one, lemmas and ranges only as far as the solver names them.
    """
    claim = asked_of_the_world(system, prop, base(system, seconds=limits.seconds))
    proof = _proof(claim, limits)
    if proof is None:
        return None
    left = _as_named(proof, claim.elements)
    for one in sorted(left, key=lambda element: (_ORDER.index(element.kind), element.name)):
        if one in left and one.kind in ("clause", "move"):
            fewer = proof.proved_by([other for other in left if other is not one])
            left = left if fewer is None else fewer
    return replace(
        claim,
        steps={one: claim.steps[one] for one in left if one in claim.steps},
        states={one: claim.states[one] for one in left if one in claim.states},
    )


def _as_named(proof: Switched, every: Sequence[Element]) -> tuple[Element, ...]:
    """Return the elements that the solver names as those of its proof, asked again as long as it names fewer."""
    left = tuple(every)
    while (named := proof.proved_by(left)) is not None and len(named) < len(left):
        left = named
    return left


def _core(system: TransitionSystem, prop: Property, limits: Limits, name: str, kept_by: str) -> Core:
    known = base(system, seconds=limits.seconds)
    proof = _proof(asked(system, prop, known), limits) or _with_invariant(system, prop, known, limits)
    if proof is None:
        return Core(name, kept_by=kept_by, why_none="not proved by induction within the limits")
    smallest, open_ = _smallest(proof)
    return Core(name, smallest, proof.k, kept_by, open_)


def _proof(claim: Asked, limits: Limits) -> Switched | None:
    """Return the proof with the least k; None if no k within the limits proves the claim."""
    for k in range(1, limits.induction + 1):
        proof = Switched(claim, k, replace(limits, seconds=limits.seconds * _QUESTION_SHARE))
        if proof.proved_by(claim.elements) is not None:
            return proof
    return None


def _with_invariant(system: TransitionSystem, prop: Property, known: Base, limits: Limits) -> Switched | None:
    """Return the proof with the invariant that the provers find for the claim as an additional lemma; None without one."""
    goal = observe(system, prop)
    verdict = prove_one(goal, limits)
    if not isinstance(verdict, Proved) or verdict.invariant is None:
        return None
    found = Element("lemma", system.name, f"the invariant that {verdict.engine} finds")
    return _proof(asked(system, prop, known, {found: verdict.invariant}), limits)


def _smallest(proof: Switched) -> tuple[tuple[Element, ...], tuple[Element, ...]]:
    """Leave out elements one by one, as long as the rest proves the claim; return the rest, and its undecided elements."""
    every = proof.elements
    left, open_ = list(proof.proved_by(every) or every), list[Element]()
    if proof.proved_by(left) is None:
        left = list(every)
    for one in sorted(left, key=lambda element: (_ORDER.index(element.kind), element.name)):
        if one not in left:
            continue
        fewer = proof.proved_by([other for other in left if other is not one])
        if fewer is not None:
            left = list(fewer)
        elif proof.undecided:
            open_.append(one)
    return tuple(left), tuple(one for one in open_ if one in left)
