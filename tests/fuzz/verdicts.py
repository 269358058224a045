"""Verdicts of every engine against the explicit search."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from safeloc.errors import InputError, ModelError, PropertyError
from safeloc.language.expr import Bool
from safeloc.language.spec import Goal, observe
from safeloc.language.verdict import Proved, Result, Unknown, Vacuous, Violated
from safeloc.proof.provers.antecedents import Outcome, found
from safeloc.proof.provers.bmc import bmc
from safeloc.proof.provers.falsify import falsify
from safeloc.proof.provers.kinduction import kinduction
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove, prove_one
from safeloc.proof.provers.proved_base import Base, base
from safeloc.proof.provers.spacer import spacer
from tests.fuzz.build import read
from tests.fuzz.case import Case
from tests.fuzz.explore import Edge, Space, Truth, allowed_by, anyhow, false_somewhere, lawful, occurs, truth
from tests.fuzz.judge import Claim
from tests.fuzz.occurrence import of_cases, silent
from tests.fuzz.replay import complaint
from tests.fuzz.speaks import cases
from tests.fuzz.terms import TRUE, reads
from tests.fuzz.world import Game, Whole

Engine = Callable[[Goal, Limits], Result]
ENGINES: dict[str, Engine] = {
    "k-induction": kinduction,
    "bmc": bmc,
    "Spacer": spacer,
    "portfolio": prove_one,
    "falsifier": falsify,
}
SHORTEST = ("bmc",)


def claim(case: Case, one: Claim, engines: Sequence[str]) -> None:
    """One claim by several engines."""
    try:
        goal = observe(case.built.system, case.built.prop(one))
    except (ModelError, PropertyError) as error:
        refused(case, "helper reads inputs" if _helper_reads(one, case.game) else "", f"{one}: {error}")
        return
    true = truth(case.spoken_of(one), one)
    for name in engines:
        if one.kind == "reachable" and name not in ("bmc", "portfolio"):
            continue
        _by(case, one, true, name, goal)


def _helper_reads(one: Claim, game: Game) -> bool:
    names = {name for var in game.own_inputs for name in var.names}
    return one.helper is not None and bool(reads(one.helper) & names)


def refused(case: Case, trap: str, why: str) -> None:
    """A refusal is right where a trap was drawn."""
    if trap:
        case.tally.refused[trap] += 1
    else:
        case.tally.judge("refusal", f"well-formed, yet refused: {why}")


def _by(case: Case, one: Claim, true: Truth, name: str, goal: Goal) -> None:
    limits = Limits(12, 3, 0.2) if name == "falsifier" else case.limits
    try:
        said = ENGINES[name](goal, limits)
    except Exception as error:
        if not _excused(case, name, error):
            case.tally.judge(name, f"{type(error).__name__} instead of a verdict: {error}; {one}")
        return
    judged(case, one, true, name, said)


def _excused(case: Case, name: str, error: Exception) -> bool:
    """A falsifier that finds no first state (d16)."""
    return isinstance(error, InputError) and name in ("falsifier", "portfolio") and not case.expect.falsifier_starts


def judged(case: Case, one: Claim, true: Truth, name: str, said: Result, told: Sequence[Outcome] = ()) -> None:
    """What one engine says against what is true; `told` is what is told of the claim's cases besides."""
    wrong = wrong_verdict(case, one, true, name, said, told)
    if isinstance(said, Unknown) and not wrong:
        case.tally.open(name)
    else:
        case.tally.judge(name, wrong and f"{wrong}; true: {true}; {one}")


def wrong_verdict(case: Case, one: Claim, true: Truth, name: str, said: Result, told: Sequence[Outcome] = ()) -> str:
    """What is wrong with a verdict; empty if nothing."""
    allowed, wanted = allowed_by(one), one.kind == "reachable"
    match said:
        case Proved() if wanted:
            return _shown(case, one, true, name, said.witness, allowed)
        case Proved():
            return _proved(case, one, true, name, said, told)
        case Violated(trace=None):
            return (
                "Violated without a run"
                if not wanted
                else "Violated, yet it is reached"
                if true.depth is not None
                else ""
            )
        case Violated(trace=trace):
            return _shown(case, one, true, name, trace, allowed)
        case Unknown(depth=depth):
            early = true.depth is not None and true.depth <= depth
            return f"no violation up to depth {depth}, yet there is one at {true.depth}" if early else ""
        case Vacuous():
            return "" if _may_be_empty(case, one, true) else "Vacuous, yet it occurs and every run goes on"
    return f"no verdict: {said}"


def _shown(case: Case, one: Claim, true: Truth, name: str, trace: object, allowed: Callable[[Edge], int]) -> str:
    """A run as evidence: it must be one, show what it is to show, and be a shortest one of bounded search."""
    from safeloc.language.trace import Trace

    if not isinstance(trace, Trace):
        return "no run as evidence"
    if true.known and true.depth is None:
        return "a run is shown for what no run does"
    wrong = complaint(case.game, trace, allowed, one)
    if not wrong and true.known and name in SHORTEST and len(trace.steps) != true.depth:
        return f"its trace has {len(trace.steps)} steps, the shortest {true.depth}"
    return wrong


def _says_nothing(case: Case, one: Claim, true: Truth, name: str, told: Sequence[Outcome]) -> bool:
    """Whether a case never occurs is asked where all properties are; whether a further assumption lasts, by the portfolio."""
    together = name in ("prove", "inherited")
    ends = one.further_assumption != TRUE and not true.lasts
    return (together and silent(case, one, told)) or ((together or name == "portfolio") and ends)


def _may_be_empty(case: Case, one: Claim, true: Truth) -> bool:
    """Whether a case never occurs, or its further assumption ends, as far as the search saw."""
    if true.depth is not None:
        return False
    ends = one.further_assumption != TRUE and not (true.known and true.goes_on)
    return ends or not all(occurs(case.spoken_of(one), one, term) for term in cases(one))


def _proved(case: Case, one: Claim, true: Truth, name: str, said: Proved, told: Sequence[Outcome]) -> str:
    if true.depth is not None:
        return f"Proved, yet broken after {true.depth} steps"
    if case.expect.vacuous and true.known and _says_nothing(case, one, true, name, told):
        return "Proved, yet it says nothing"
    return _invariant(case, one, said.invariant)


def _invariant(case: Case, one: Claim, invariant: Bool | None) -> str:
    """An invariant over the state holds in every state that the claim speaks of."""
    if invariant is None:
        return ""
    own = read(invariant)
    if not reads(own) <= set(case.game.state_names):
        return ""  # it speaks of observers, which we have otherwise
    case.tally.compared["invariant"] += 1
    state = false_somewhere(case.space, own, allowed_by(one))
    return "" if state is None else f"its invariant does not hold in {state}"


# ------------------------------------------------------------------ what is proved before any claim


def facts(case: Case) -> Base | None:
    """Ranges, lemmas and contracts of the base, in every state they speak of."""
    try:
        known = base(case.built.system, seconds=case.limits.seconds)
    except Exception as error:
        case.tally.judge("base", f"{type(error).__name__} instead of facts: {error}")
        return None
    _hold(case, case.board() if known.always else case.space, known.always, anyhow, "base, for all inputs")
    _hold(case, case.space, known.facts, lawful, "base, under the assumption")
    if isinstance(case.game, Whole):
        _contracts(case, case.game, known)
    return known


def _hold(case: Case, space: Space, found: Mapping[str, Bool], allowed: Callable[[Edge], int], what: str) -> None:
    for name, term in found.items():
        own = read(term)
        where = space if reads(own) <= set(space.game.state_names) else case.space
        state = false_somewhere(where, own, allowed)
        case.tally.judge(what, "" if state is None else f"{name!r} ({own}) does not hold in {state}")


def _contracts(case: Case, whole: Whole, known: Base) -> None:
    """Wired inputs are in range and contracts hold, in every step."""
    for world in whole.worlds:
        name = f"contract of {world.name} holds"
        if world.name in known.in_range:
            bad = next((e.known for _, e in case.space.steps(anyhow) if not whole.hears(world.name, e.known)), None)
            case.tally.judge("heard", "" if bad is None else f"{world.name} hears what it may not: {bad}")
        if name in known.kept:
            bad = next((e.known for _, e in case.space.steps(lawful) if not whole.kept(world.name, e.known)), None)
            case.tally.judge("contract", "" if bad is None else f"{name}: not in {bad}")


def proved_together(case: Case, claims: Sequence[Claim]) -> None:
    """Claims as `prove` decides them, machines of a composition by themselves included; in processes of their own."""
    props = [case.built.prop(one) for one in claims]
    try:
        findings = prove(case.built.system, props, case.limits)
    except Exception as error:
        if not _excused_text(case, str(error)):
            case.tally.judge("prove", f"{type(error).__name__} instead of findings: {error}")
        return
    for one, prop, finding in zip(claims, props, findings[len(findings) - len(claims) :], strict=True):
        told = [each.outcome for each in found(case.built.system, [prop]).cases]
        of_cases(case, one, told)
        true = truth(case.spoken_of(one), one)
        judged(case, one, true, "inherited" if one.of else "prove", finding.result, told)


def _excused_text(case: Case, text: str) -> bool:
    return "InputError" in text and "first state" in text and not case.expect.falsifier_starts
