"""The proved base of a system, before any property: ranges of its variables and its declared lemmas.

Both are PROVED, once per system, and then serve every property as hypotheses:

    always    ranges of the machine's own variables, and every lemma that needs no assumption: for ALL inputs in range
    facts     the other lemmas, and ranges of ghosts, under the assumption
    kept      of a composition: the contracts (discharged assumptions), in every step (safeloc.proof.provers.inherited)
    in_range  of a composition: the machines whose wired inputs stay in range

A composition inherits the facts of its machines without a new proof. A fact that is not inductive together with the others,
or that the second solver does not confirm, is dropped and named in `refuted`; it is never assumed.
"""

from __future__ import annotations

import weakref
from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, field

from safeloc.codegen.smtlib import Query
from safeloc.language.expr import Bool, NumVar, Var
from safeloc.language.system import Part, TransitionSystem, environment, first_without_the_world, in_range
from safeloc.language.terms import Substitution, variables
from safeloc.proof.provers.facts import Fact, about, range_of
from safeloc.proof.provers.implication import Failure, Undecided, unproved
from safeloc.proof.provers.inherited import Alone, inherit
from safeloc.proof.provers.limits import Deadline, deadline
from safeloc.proof.provers.recheck import UNCONFIRMED, certify


@dataclass(frozen=True, eq=False)
class Base:
    """Proved facts, the dropped facts with reasons, and the texts that the second solver has confirmed.

    `seconds` is the time limit that was used: with a longer one, undecided facts may still be proved.
    """

    always: Mapping[Fact, Bool]
    facts: Mapping[Fact, Bool]
    refuted: Mapping[Fact, Failure]
    certificates: Mapping[str, str]
    seconds: float
    kept: Mapping[Fact, Bool] = field(default_factory=dict)
    in_range: Sequence[str] = ()

    @property
    def everything(self) -> list[Bool]:
        """All proved facts."""
        return [*self.always.values(), *self.facts.values()]

    def serves(self, seconds: float) -> bool:
        """Return whether another attempt of that length could prove no more."""
        return seconds <= self.seconds or not any(isinstance(why, Undecided) for why in self.refuted.values())


@dataclass(frozen=True, eq=False)
class _Layer:
    """Terms to be proved inductive together, from the facts of earlier layers.

    first    condition on the first state
    allowed  condition on every step
    hypotheses  facts of earlier layers
    """

    system: TransitionSystem
    name: str
    first: Bool
    allowed: Bool
    hypotheses: Sequence[Bool]
    relies_on: Sequence[str]

    def queries(self, kept: Mapping[Fact, Bool]) -> tuple[Query[Fact], Query[Fact]]:
        """Return the queries for initiation and consecution of the conjunction."""
        system, after = self.system, Substitution(dict(self.system.next))
        first = [self.first, in_range(system.state), *self.hypotheses]
        step = [self.allowed, *self.hypotheses, *kept.values()]
        later = {key: after.bool(term) for key, term in kept.items()}
        return self._query("start", first, dict(kept)), self._query("step", step, later)

    def _query(self, when: str, hypotheses: Sequence[Bool], goals: Mapping[Fact, Bool]) -> Query[Fact]:
        head = about(self.system, f"layer {when}", layer=self.name)
        return Query(f"{self.system.name} {self.name} {when}", hypotheses, goals, head)


_KNOWN: weakref.WeakKeyDictionary[TransitionSystem, Base] = weakref.WeakKeyDictionary()


def base(system: TransitionSystem, *, seconds: float = 30.0) -> Base:
    """Return the system's proved base; computed once per system, and again only if more time could prove more.

    seconds  for the system, and also for each machine of a composition
    """
    known = known_base(system, seconds)
    if known is None:
        known = _KNOWN[system] = _prove(system, seconds)
    return known


def known_base(system: TransitionSystem, seconds: float) -> Base | None:
    """Return the base if it is known and an attempt of that length could prove no more; else None."""
    known = _KNOWN.get(system)
    return known if known is not None and known.serves(seconds) else None


def remember(system: TransitionSystem, known: Base) -> None:
    """Store a base that another process has proved."""
    _KNOWN[system] = known


def _prove(system: TransitionSystem, seconds: float) -> Base:
    visible, hidden = _ranges(system, ghosts=False), _ranges(system, ghosts=True)
    had = inherit(system, [_alone(part, seconds) for part in system.parts], seconds)
    ends = deadline(seconds)
    lemmas = {Fact("lemma", name): term for name, term in system.lemmas.items()}
    wanted = _without(_for_all_inputs(system), had.always)
    always, texts, failed = _inductive(_board(system, had.always, list(had.certificates)), wanted, ends)
    always |= had.always
    rest = _without({**hidden, **lemmas}, {**always, **had.facts})
    world = _world(system, {**always, **had.facts}, [*had.certificates, *texts])
    facts, more_texts, refuted = _inductive(world, rest, ends)
    refuted |= {key: why for key, why in failed.items() if key in visible} | had.refuted
    certificates = {**had.certificates, **texts, **more_texts}
    return Base(always, {**had.facts, **facts}, refuted, certificates, seconds, had.kept, had.in_range)


def proved_always(system: TransitionSystem, *, seconds: float) -> Mapping[Fact, Bool]:
    """Return `always` of the system's base, without a proof of the other facts, which can take many times as long."""
    known = known_base(system, seconds)
    if known is not None:
        return known.always
    alone = [Alone(proved_always(part.alone, seconds=seconds), {}, {}) for part in system.parts]
    had = inherit(system, alone, seconds, assumed=False)
    wanted = _without(_for_all_inputs(system), had.always)
    proved, _, _ = _inductive(_board(system, had.always, list(had.certificates)), wanted, deadline(seconds))
    return {**proved, **had.always}


def _for_all_inputs(system: TransitionSystem) -> dict[Fact, Bool]:
    """Return what may hold for all inputs in range: the ranges of the machine's own variables, and lemmas without ghosts."""
    lemmas = {Fact("lemma", name): term for name, term in system.lemmas.items()}
    free = {key: term for key, term in lemmas.items() if not set(variables([term])) & system.ghosts}
    return {**_ranges(system, ghosts=False), **free}


def _alone(part: Part, seconds: float) -> Alone:
    known = base(part.alone, seconds=seconds)
    return Alone(known.always, known.facts, known.certificates)


def _without(terms: Mapping[Fact, Bool], known: Container[Fact]) -> dict[Fact, Bool]:
    return {key: term for key, term in terms.items() if key not in known}


def ranges_and_lemmas(system: TransitionSystem) -> dict[Fact, Bool]:
    """Return the terms of all ranges and lemmas, proved or not."""
    ranges = {**_ranges(system, ghosts=False), **_ranges(system, ghosts=True)}
    return {**ranges, **{Fact("lemma", name): term for name, term in system.lemmas.items()}}


def _ranges(system: TransitionSystem, *, ghosts: bool) -> dict[Fact, Bool]:
    numeric = [var for var in system.state if isinstance(var, NumVar)]
    return {range_of(var): in_range([var]) for var in numeric if (var in system.ghosts) == ghosts}


def _board(system: TransitionSystem, known: Mapping[Fact, Bool], relies_on: Sequence[str]) -> _Layer:
    """Make the layer of facts for all inputs in range and for any start of the environment.

    Conditions of `initially` that tie the machine to ghosts are therefore left out.
    """
    first = first_without_the_world(system)
    return _Layer(system, "always", first, environment(system, assume=False), list(known.values()), relies_on)


def _world(system: TransitionSystem, always: Mapping[Fact, Bool], relies_on: Sequence[str]) -> _Layer:
    return _Layer(system, "facts", system.init, environment(system), list(always.values()), relies_on)


def _inductive(
    layer: _Layer, terms: Mapping[Fact, Bool], ends: Deadline
) -> tuple[dict[Fact, Bool], dict[str, str], dict[Fact, Failure]]:
    """Return the largest subset that is inductive together, its certificates, and the dropped terms."""
    kept, refuted = dict(terms), dict[Fact, Failure]()
    while kept:
        kept, both, failed = _inductive_for_z3(layer, kept, ends)
        refuted |= failed
        if not kept:
            break
        texts, unconfirmed = _confirmed(both, layer.relies_on, ends)
        if not unconfirmed:
            return kept, texts, refuted
        refuted |= unconfirmed
        kept = _without(kept, unconfirmed)
    return {}, {}, refuted


def _inductive_for_z3(
    layer: _Layer, terms: Mapping[Fact, Bool], ends: Deadline
) -> tuple[dict[Fact, Bool], tuple[Query[Fact], Query[Fact]], dict[Fact, Failure]]:
    """Return the largest subset of which z3 proves that it is inductive together, its queries, and the dropped terms."""
    kept, refuted = dict(terms), dict[Fact, Failure]()
    while True:
        both = layer.queries(kept)
        failed = {key: why for query in both for key, why in unproved(query, ends.left).items()}
        if not failed:
            return kept, both, refuted
        refuted |= failed
        kept = _without(kept, failed)


def inductive_beside(
    system: TransitionSystem, known: Base, terms: Sequence[Bool], seconds: float, *, unconditional: bool = False
) -> list[Bool]:
    """Return the largest subset of the terms that is inductive together, given the base; z3 alone decides.

    unconditional  for all inputs in range, not only under the assumption; terms over ghosts are then left out
    """
    ghosts = system.ghosts if unconditional else frozenset[Var]()
    named = {
        Fact("lemma", f"candidate {n}"): term for n, term in enumerate(terms) if ghosts.isdisjoint(variables([term]))
    }
    layer = _board(system, known.always, ()) if unconditional else _world(system, {**known.always, **known.facts}, ())
    kept, _, _ = _inductive_for_z3(layer, named, deadline(seconds))
    return list(kept.values())


def _confirmed(
    both: tuple[Query[Fact], Query[Fact]], relies_on: Sequence[str], ends: Deadline
) -> tuple[dict[str, str], dict[Fact, Failure]]:
    texts: dict[str, str] = {}
    failed: dict[Fact, Failure] = {}
    for query in both:
        certificate = certify(query, seconds=ends.left, relies_on=relies_on)
        texts[certificate.file] = certificate.text
        failed |= {key: Undecided(UNCONFIRMED) for key in certificate.undecided}
    return texts, failed
