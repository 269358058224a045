"""Check which claims of a mutant are still proved, mostly by one step of induction.

The claims that one step proves for the unchanged machine are asked together: does every step from a state that satisfies all of
them preserve them? Claims for which nothing changed are not asked again. If none fails, the properties that the unchanged machine
needs several steps for are asked by k-induction, one by one.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace

from safeloc.assurance.mutation.claims import Canon, Claim, Held, Layer, held
from safeloc.assurance.mutation.declared import Declared
from safeloc.language.expr import Bool, Lit, Num
from safeloc.language.spec import observe
from safeloc.language.system import environment, in_range
from safeloc.language.terms import Substitution
from safeloc.language.units import Enumeration
from safeloc.proof.provers.facts import Fact
from safeloc.proof.provers.kinduction import queries
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.proved_base import Base

_Asked = tuple[int, str]
"""The number of a layer, and a claim of it as text."""


@dataclass(frozen=True, eq=False)
class _Question:
    """A question about a layer: do the goals follow from the hypotheses?"""

    hypotheses: tuple[Bool, ...]
    goals: dict[str, Bool]


@dataclass(frozen=True, eq=False)
class Proofs:
    """The proofs of the claims of the unchanged machine.

    steps   for each layer, the question about a step
    starts  for each layer, the question about the first state
    hard    claims that one step of induction does not prove
    open    properties among them that k-induction does not prove either, within the limits
    under_assumption  lemmas that read no ghost, but hold only under the assumption
    """

    steps: tuple[_Question, ...]
    starts: tuple[_Question, ...]
    hard: frozenset[_Asked]
    open: frozenset[_Asked]
    under_assumption: frozenset[str] = frozenset()


def as_it_is(declared: Declared, canon: Canon, limits: Limits) -> tuple[Held, Proofs]:
    """Return the claims of the unchanged machine with their proofs. A lemma that needs the assumption is moved under it."""
    bound = frozenset[str]()
    while True:
        unchanged = held(declared, canon, bound)
        known = _proofs(unchanged, canon, limits)
        wrong = {
            name.removeprefix("lemma ") for number, name in known.hard if number == 0 and name.startswith("lemma ")
        }
        if wrong <= bound:
            return unchanged, replace(known, under_assumption=bound)
        bound |= wrong


def _proofs(unchanged: Held, canon: Canon, limits: Limits) -> Proofs:
    """Prove the claims of the unchanged machine; those that fail are removed from the hypotheses until the rest is proved."""
    hard = frozenset[_Asked]()
    while True:
        steps = tuple(_step(layer, number, canon, hard) for number, layer in enumerate(unchanged.layers))
        starts = tuple(_start(layer, number, canon, hard) for number, layer in enumerate(unchanged.layers))
        failed = {
            (number, key)
            for questions in (steps, starts)
            for number, one in enumerate(questions)
            for key in canon.asked.failures(one.hypotheses, one.goals, limits.seconds)
        }
        if not failed:
            break
        hard |= failed
    left = [
        (one, claim) for one, claim in _hard_claims(unchanged, hard) if not _by_steps(unchanged, claim, canon, limits)
    ]
    return Proofs(steps, starts, hard, frozenset(one for one, _ in left))


@dataclass(frozen=True, eq=False)
class Failed:
    """Claims of a mutant that are no longer proved.

    undecided  at least one of them is not refuted: the solver gave up on it, or k-induction did not prove it
    """

    claims: tuple[Claim, ...]
    undecided: bool


def no_longer(mutant: Held, known: Proofs, canon: Canon, limits: Limits) -> Failed:
    """Return the claims that are no longer proved for the mutant, without those that were not proved before."""
    failed, undecided = dict[Claim, None](), False
    for number, layer in enumerate(mutant.layers):
        by_name = {str(claim): claim for claim in layer.claims}
        for made, was in ((_step, known.steps[number]), (_start, known.starts[number])):
            changed = _changed(made(layer, number, canon, known.hard), was)
            for key, refuted in canon.asked.failures(changed.hypotheses, changed.goals, limits.seconds).items():
                failed[by_name[key]] = None
                undecided |= not refuted
    if not failed:
        for _, claim in _hard_claims(mutant, known.hard - known.open):
            if not _by_steps(mutant, claim, canon, limits):
                failed[claim], undecided = None, True
    return Failed(tuple(failed), undecided)


def excluded(mutant: Held, known: Held, canon: Canon, limits: Limits) -> list[str]:
    """Return the pairs of rows that were not proved exclusive for all inputs in range; unchanged pairs are not asked."""
    changed = {name: term for name, term in mutant.exclusions.items() if term is not known.exclusions.get(name)}
    board = mutant.layers[0]
    hypotheses = [
        environment(board.system, assume=False),
        *(claim.good for claim in board.claims if claim.goal is None),
    ]
    return list(canon.asked.failures(hypotheses, changed, limits.seconds)) if changed else []


def impossible(
    mutant: Held, seen: Collection[tuple[str, int]], canon: Canon, limits: Limits, *, lawful: bool = False
) -> list[str]:
    """Return the rows, modes and `reachable` properties that are proved impossible by ranges and lemmas.

    seen    rows and modes that are known to occur, by number; they are not asked
    lawful  consider only steps that the world allows; otherwise all inputs in range
    """
    board, system = mutant.layers[0], mutant.system
    after = Substitution(dict(system.next))
    [(_, fired)] = system.fired.items()
    mode = mutant.declared.machine.mode
    goals = {
        f"row {name!r} fires": ~fired.eq(Lit(number, fired.unit))
        for number, name in _rows(fired)
        if ("row", number) not in seen
    }
    for label in mutant.declared.machine.modes[1:]:
        if ("mode", label.value) in seen:
            continue
        goals[f"mode {label.label} is come to"] = mode.ne(label).implies(after.bool(mode.ne(label)))
    hypotheses = [environment(system, assume=lawful), *(claim.good for claim in board.claims if claim.goal is None)]
    possible = canon.asked.failures(hypotheses, goals, limits.seconds)
    never = set(goals) - set(possible)
    return [*sorted(never), *_unreachable(mutant, canon, limits)]


def _rows(fired: Num) -> list[tuple[int, str]]:
    assert isinstance(fired.unit, Enumeration)
    return list(enumerate(fired.unit.members))[1:]


def _unreachable(mutant: Held, canon: Canon, limits: Limits) -> Iterator[str]:
    """Return the `reachable` properties whose event one step of induction excludes."""
    for prop in mutant.declared.properties:
        if prop.kind == "reachable":
            goal = observe(mutant.system, prop)
            both = queries(goal, _base(mutant, limits), 1)
            if not any(canon.asked.failures(asked.hypotheses, asked.goals, limits.seconds) for asked in both):
                yield f"property {prop.name}"


def _hard_claims(unchanged: Held, hard: frozenset[_Asked]) -> Iterator[tuple[_Asked, Claim]]:
    for number, layer in enumerate(unchanged.layers):
        for claim in layer.claims:
            if (number, str(claim)) in hard and claim.kind == "property":
                yield (number, str(claim)), claim


def _by_steps(unchanged: Held, claim: Claim, canon: Canon, limits: Limits) -> bool:
    """Return whether k-induction proves a property, with ranges and lemmas as facts."""
    assert claim.goal is not None
    known = _base(unchanged, limits)
    for k in range(1, limits.induction + 1):
        start, step = queries(claim.goal, known, k)
        if canon.asked.failures(start.hypotheses, start.goals, limits.seconds):
            return False
        if not canon.asked.failures(step.hypotheses, step.goals, limits.seconds):
            return True
    return False


def _base(unchanged: Held, limits: Limits) -> Base:
    """Return ranges and lemmas in the form that k-induction takes."""
    board, world, *_ = (
        {Fact("lemma", str(one)): one.good for one in layer.claims if one.goal is None} for layer in unchanged.layers
    )
    return Base(board, world, {}, {}, limits.seconds)


def _changed(now: _Question, was: _Question) -> _Question:
    """Return the goals to ask: those that changed, or all if a hypothesis changed."""
    if [*map(id, now.hypotheses)] != [*map(id, was.hypotheses)]:
        return now
    return _Question(now.hypotheses, {key: goal for key, goal in now.goals.items() if was.goals.get(key) is not goal})


def _usable(layer: Layer, number: int, hard: frozenset[_Asked]) -> Sequence[Claim]:
    return [claim for claim in layer.claims if (number, str(claim)) not in hard]


def _step(layer: Layer, number: int, canon: Canon, hard: frozenset[_Asked]) -> _Question:
    claims, after = _usable(layer, number, hard), Substitution(dict(layer.system.next))
    hypotheses = [claim.good for claim in (*layer.hypotheses, *claims)]
    allowed = canon.share.bool(environment(layer.system))
    goals = {str(claim): canon.share.bool(after.bool(claim.good)) for claim in claims}
    return _Question((allowed, *hypotheses), goals)


def _start(layer: Layer, number: int, canon: Canon, hard: frozenset[_Asked]) -> _Question:
    claims = _usable(layer, number, hard)
    first = canon.share.bool(layer.system.init & in_range(layer.system.state))
    return _Question((first,), {str(claim): claim.good for claim in claims})
