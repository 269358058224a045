"""Proof cores: for a proved claim a smallest set of clauses, lemmas and rows that still proves it, by itself.

"Smallest" means that no element can be taken away; another set may have fewer. Every set was proved again with that set
alone. The sets are found by z3; the verdicts themselves rest on the certificates of `prove`, not on them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from safeloc.language.spec import Property, observe
from safeloc.language.system import TransitionSystem
from safeloc.language.verdict import Proved
from safeloc.proof.cores.elements import Asked, Element, asked
from safeloc.proof.cores.steps import Switched
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import inherited, prove_one
from safeloc.proof.provers.proved_base import Base, base

QUESTION_SHARE = 0.2
"""Of the limit for a claim, for each question whether it can do without an element."""
ORDER = ("range", "lemma", "contract", "row", "clause")
"""What is tried to be left out first: what is left then rests on as few clauses as can be."""


@dataclass(frozen=True)
class Core:
    """What the proof of a claim rests on.

    rests_on  the elements, none of which can be left out (unless `open_` names it)
    steps     k of the k-induction
    kept_by   of a composition's claim that is one machine's own: the machine, which the set is of
    open_     elements for which it was not decided within the limits whether they can be left out
    why_none  where there is no set: the reason
    """

    claim: str
    rests_on: tuple[Element, ...] = ()
    steps: int = 0
    kept_by: str = ""
    open_: tuple[Element, ...] = ()
    why_none: str = ""


def core(system: TransitionSystem, prop: Property, limits: Limits) -> Core:
    """Return what the proof of the claim rests on; of kind `reachable`, which a run shows, there is none."""
    if prop.kind == "reachable":
        return Core(prop.name, why_none="shown by a run")
    own = inherited(observe(system, prop))
    if own is not None:
        part, claim = own
        return _core(part.alone, claim, limits, prop.name, part.name)
    return _core(system, prop, limits, prop.name, "")


def _core(system: TransitionSystem, prop: Property, limits: Limits, name: str, kept_by: str) -> Core:
    known = base(system, seconds=limits.seconds)
    proof = _proof(asked(system, prop, known), limits) or _with_invariant(system, prop, known, limits)
    if proof is None:
        return Core(name, kept_by=kept_by, why_none="not proved by induction within the limits")
    smallest, open_ = _smallest(proof)
    return Core(name, smallest, proof.k, kept_by, open_)


def _proof(claim: Asked, limits: Limits) -> Switched | None:
    """The proof with the fewest steps; None where several steps do not prove it."""
    for k in range(1, limits.induction + 1):
        proof = Switched(claim, k, replace(limits, seconds=limits.seconds * QUESTION_SHARE))
        if proof.proved_by(claim.elements) is not None:
            return proof
    return None


def _with_invariant(system: TransitionSystem, prop: Property, known: Base, limits: Limits) -> Switched | None:
    """The proof with the invariant that the provers find for the claim, as one more lemma."""
    goal = observe(system, prop)
    verdict = prove_one(goal, limits)
    if not isinstance(verdict, Proved) or verdict.invariant is None:
        return None
    found = Element("lemma", system.name, f"the invariant that {verdict.engine} finds")
    return _proof(asked(system, prop, known, {found: verdict.invariant}), limits)


def _smallest(proof: Switched) -> tuple[tuple[Element, ...], tuple[Element, ...]]:
    """Leave out one after the other, as long as the rest proves the claim."""
    every = proof.elements
    left, open_ = list(proof.proved_by(every) or every), list[Element]()
    if proof.proved_by(left) is None:
        left = list(every)
    for one in sorted(left, key=lambda element: (ORDER.index(element.kind), element.name)):
        if one not in left:
            continue
        fewer = proof.proved_by([other for other in left if other is not one])
        if fewer is not None:
            left = list(fewer)
        elif proof.undecided:
            open_.append(one)
    return tuple(left), tuple(one for one in open_ if one in left)
