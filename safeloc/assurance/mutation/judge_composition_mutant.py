"""Judge a composition with a wrong machine or wire, by its recordings, its contracts and its own claims.

Each contract (a machine's wired inputs are in range; its discharged assumption holds) and each claim is one question. It may use
the facts of all machines before the step, and those of earlier machines after the step. Facts of the wrong machine are used, too,
since they were all proved for it. A goal that did not change is not asked again, unless a machine was given another truth: then the
facts on which it rests say something else. A claim that one step of induction does not decide is asked last, over as many steps as prove it of
the unchanged composition.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from safeloc.assurance.mutation import results
from safeloc.assurance.mutation.claims import Canon, Layer, layer_of, settled, variable
from safeloc.assurance.mutation.corpus import Run, recorded
from safeloc.assurance.mutation.equivalence import equal
from safeloc.assurance.mutation.members import Composed, joined
from safeloc.assurance.mutation.mutants import Mutant
from safeloc.assurance.mutation.playing import first_broken, outputs_along
from safeloc.assurance.mutation.results import Outcome
from safeloc.assurance.mutation.rewired import rewired
from safeloc.assurance.mutation.wires import WireEdit
from safeloc.errors import SafelocError
from safeloc.language.composed_names import contract_text, inputs_text
from safeloc.language.expr import TRUE, Bool, NumVar, all_of
from safeloc.language.spec import Property, observe
from safeloc.language.system import TransitionSystem, environment, in_range
from safeloc.language.terms import Substitution
from safeloc.proof.provers.facts import Fact
from safeloc.proof.provers.kinduction import queries
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.proved_base import Base
from safeloc.proof.provers.relevance import Relevance


@dataclass(frozen=True, eq=False)
class _Question:
    """A question about a composition: does a contract or a claim follow?"""

    name: str
    hypotheses: tuple[Bool, ...]
    goal: Bool


@dataclass(frozen=True, eq=False)
class CompositionBench:
    """All facts about a composition that are needed to judge its mutants.

    right   the unchanged composition
    asked   the goals that are proved for it, by name
    deeper  the claims that more than one step of induction proves for it, by name, with the number of steps
    told    outputs of the unchanged composition along its recordings, by name of the run
    """

    composed: Composed
    canon: Canon
    right: TransitionSystem
    asked: Mapping[str, Bool]
    deeper: Mapping[str, int]
    runs: Sequence[Run]
    told: Mapping[str, tuple[tuple[object, ...], ...]]
    limits: Limits


def composition_bench(composed: Composed, limits: Limits) -> CompositionBench:
    """Return the bench. Contracts and claims that are not proved for the unchanged composition are not asked of mutants."""
    canon = Canon()
    system = shared(composed.target.system, canon)
    proved = {
        one.name: one.goal for one in _questions(system, composed.claims, canon) if not _fails(one, canon, limits)
    }
    left = [one for one in composed.claims if f"property {one.name}" not in proved and one.kind != "reachable"]
    deeper = {one.name: k for one in left if (k := _least_steps(system, one, canon, limits))}
    runs = list(recorded(composed.target, composed.target.system))
    told = {run.name: outputs_along(system, run) for run in runs}
    return CompositionBench(composed, canon, system, proved, deeper, runs, told, limits)


def of_member(on: CompositionBench, mutant: Mutant, *, everywhere: bool) -> Outcome:
    """Return the outcome for the composition with this wrong machine, which the machine's own claims have not detected."""
    make = mutant.everywhere if everywhere and mutant.everywhere is not None else mutant.alone
    try:
        wrong = make(on.composed.members[mutant.machine])
        return _judged(on, joined(on.composed, wrong.machine), wrong.further)
    except SafelocError as error:
        return Outcome(results.REFUSED, (), str(error).splitlines()[-1].strip(" -"))


def of_wire(on: CompositionBench, edit: WireEdit) -> Outcome:
    """Return the outcome for the composition with this wire wrong."""
    try:
        made = rewired(on.composed, edit.wires, edit.late)
        return _judged(on, made.system, made.claims, by_truth=edit.to_a_ghost)
    except SafelocError as error:
        return Outcome(results.REFUSED, (), str(error).splitlines()[-1].strip(" -"))


def _judged(
    on: CompositionBench, made: TransitionSystem, claims: Sequence[Property], *, by_truth: bool = False
) -> Outcome:
    """Judge the composition. `by_truth`: the truth is wrong, which changes no output; that is no equivalence, but a question."""
    system = shared(made, on.canon)
    broken = first_broken(_layer(system, claims, on.canon), [run for run in on.runs if run.has_ghosts])
    if broken is not None:
        return Outcome(results.REFUTED, (broken.claim,), f"{broken.run}, {broken.steps} steps: {broken.claim}")
    failed = [
        one.name
        for one in _questions(system, claims, on.canon)
        if one.name in on.asked
        and (by_truth or one.goal is not on.asked[one.name])
        and _fails(one, on.canon, on.limits)
    ]
    if failed:
        return Outcome(results.UNPROVED, tuple(failed), "refuted or not decided in one step of the whole")
    apart = next((run.name for run in on.runs if outputs_along(system, run) != on.told[run.name]), "")
    if not (apart or by_truth) and _is_equivalent(on, system):
        return Outcome(
            results.EQUIVALENT, (), "the same step and outputs in every reachable state, under the assumption"
        )
    lost = [
        one.name
        for one in claims
        if one.name in on.deeper and not _by_steps(system, one, on.deeper[one.name], on.canon, on.limits)
    ]
    if lost:
        steps = max(on.deeper[name] for name in lost)
        names = tuple(f"property {name}" for name in lost)
        return Outcome(results.UNPROVED, names, f"refuted or not decided in {steps} steps of the whole")
    if apart:
        return Outcome(results.RECORDED, (), apart)
    return Outcome(results.SURVIVED, (), "neither its own claims nor those of the whole notice")


def _is_equivalent(on: CompositionBench, system: TransitionSystem) -> bool:
    """Return whether the same laws allow the same steps, with the same outputs, in every state that the facts of the machines allow."""
    right, relevant = on.right, Relevance(on.right)
    facts = [term for number in range(len(right.parts)) for term in _facts(right, number)]
    alike = [] if system.assume is right.assume else [equal(system.assume, right.assume)]
    moved = [equal(system.next[var], term) for var, term in right.next.items() if system.next[var] is not term]
    told = [
        equal(system.outputs[name], term) for name, term in right.outputs.items() if system.outputs[name] is not term
    ]
    questions = (
        ([environment(right, assume=False), *facts], alike),
        ([environment(right), *facts], moved),
        (facts, told),
    )
    return not any(
        on.canon.asked.failures(relevant.select(hypotheses, goals), {"": all_of(goals)}, on.limits.seconds)
        for hypotheses, goals in questions
        if goals
    )


def shared(system: TransitionSystem, canon: Canon) -> TransitionSystem:
    """Return the system, with its contracts, with terms replaced by the shared nodes."""
    share = canon.share
    parts = [
        replace(part, inputs_in_range=share.bool(part.inputs_in_range), contract=share.bool(part.contract))
        for part in system.parts
    ]
    return replace(settled(system, canon), parts=tuple(parts))


# ------------------------------------------------------------------ contracts and claims


def _questions(system: TransitionSystem, claims: Sequence[Property], canon: Canon) -> Iterator[_Question]:
    """Return the questions for all contracts, in the order of the machines, then for the claims."""
    facts = [_facts(system, number) for number in range(len(system.parts))]
    relevant, after = Relevance(system), Substitution(dict(system.next))
    before = [term for own in facts for term in own]
    known, lawful = list[Bool](), environment(system)
    for part, own in zip(system.parts, facts, strict=True):
        for words, term in (
            (inputs_text(part.name), part.inputs_in_range),
            (contract_text(part.name), part.contract),
        ):
            if term is not TRUE:
                hypotheses = relevant.select([lawful, *before, *known], [term])
                yield _Question(words, tuple(hypotheses), canon.share.bool(term))
        known += [after.bool(term) for term in own]
    contracts = [part.contract for part in system.parts]
    for prop in claims:
        yield _of_claim(system, prop, [*before, *known, *contracts], relevant, canon)


def _of_claim(
    system: TransitionSystem, prop: Property, known: Sequence[Bool], relevant: Relevance, canon: Canon
) -> _Question:
    goal = observe(system, prop)
    settle = canon.observers(goal.observers)
    moves = {variable(settle(var)): settle(goal.system.next[var]) for var in goal.observers}
    good = settle.bool(goal.good & goal.helper & in_range(goal.observers))
    wanted = canon.share.bool(Substitution({**system.next, **moves}).bool(good))
    hypotheses = relevant.select([environment(goal.plain), *known], [wanted, good])
    return _Question(f"property {prop.name}", (*hypotheses, good), wanted)


def _least_steps(system: TransitionSystem, prop: Property, canon: Canon, limits: Limits) -> int:
    """Return by how many steps of induction the claim is proved, from 2 on; 0 if by none within the limits."""
    return next((k for k in range(2, limits.induction + 1) if _by_steps(system, prop, k, canon, limits)), 0)


def _by_steps(system: TransitionSystem, prop: Property, k: int, canon: Canon, limits: Limits) -> bool:
    """Return whether so many steps of induction prove the claim, from the facts of all machines and their contracts."""
    facts = [term for number in range(len(system.parts)) for term in _facts(system, number)]
    known = {Fact("lemma", str(number)): term for number, term in enumerate(facts)}
    kept = {Fact("contract", part.name): part.contract for part in system.parts}
    asked = queries(observe(system, prop), Base(known, {}, {}, {}, limits.seconds, kept), k)
    return not any(canon.asked.failures(one.hypotheses, one.goals, limits.seconds) for one in asked)


def _facts(system: TransitionSystem, number: int) -> list[Bool]:
    """Return ranges and lemmas of one machine, in the variables of the composition."""
    part = system.parts[number]
    own = [part.into(var) for var in part.alone.state]
    ranges = [in_range([var]) for var in own if isinstance(var, NumVar)]
    return [*ranges, *(part.into.bool(term) for term in part.alone.lemmas.values())]


def _fails(one: _Question, canon: Canon, limits: Limits) -> bool:
    return bool(canon.asked.failures(one.hypotheses, {"": one.goal}, limits.seconds))


def _layer(system: TransitionSystem, claims: Sequence[Property], canon: Canon) -> Layer:
    """Return the claims without a further assumption as a layer, to be judged along runs."""
    return layer_of(system, [observe(system, prop) for prop in claims if prop.further_assumption is TRUE], canon)
