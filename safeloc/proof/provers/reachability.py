"""Reachability: can every mode and every transition occur?"""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from safeloc.codegen.smtlib import Query
from safeloc.language.expr import TRUE, Bool
from safeloc.language.spec import Goal, watch
from safeloc.language.system import TransitionSystem, environment, in_range
from safeloc.language.terms import Substitution
from safeloc.language.trace import Trace
from safeloc.language.verdict import Proved, Unknown, Verdict, Violated
from safeloc.proof.provers.beside import beside
from safeloc.proof.provers.drawn import drawn
from safeloc.proof.provers.facts import contract_of
from safeloc.proof.provers.found_run import FoundRun, shown_freely, shown_lawfully
from safeloc.proof.provers.implication import following
from safeloc.proof.provers.kinduction import kinduction
from safeloc.proof.provers.leaping import farther, leaping
from safeloc.proof.provers.limits import Limits, deadline
from safeloc.proof.provers.obligation import Obligation
from safeloc.proof.provers.proved_base import Base, base
from safeloc.proof.provers.reachable_targets import Target, targets_of
from safeloc.proof.provers.recorded_witnesses import NO_WITNESSES, Recording, Witnesses, shown
from safeloc.proof.provers.relevance import Relevance
from safeloc.proof.provers.searches import AT_FIRST, first_runs, sparing_runs
from safeloc.proof.provers.spacer import spacer
from safeloc.proof.provers.sparing_run import how_it_breaks, sparing_run

EXCLUSION, EXCLUSION_OF_ONE, EXCLUSION_OF_LAWFUL = 0.2, 0.6, 0.05
"""Share of the limit for excluding goals that read the same machines, those of one machine, and those of a composition that a run of
one machine under its assumption reaches: few of these are impossible in the whole. The goals left after it are searched.
"""
SHIPPED = "witness"
"""The engine of a run that ships with the machine."""
_EACH_LEAP = 0.2
"""Share of the limit for the search from one state, under the assumption."""


def reached(
    system: TransitionSystem,
    limits: Limits,
    recordings: Sequence[Recording] = (),
    witnesses: Witnesses = NO_WITNESSES,
) -> Iterator[Obligation]:
    """Check that modes and transitions occur: under the assumption in shipped, recorded, random or searched runs, else without it.

    witnesses  runs that an earlier search found, of the system and of its machines alone
    """
    known_runs = list(in_known_runs(system, limits, recordings, witnesses))
    return beyond_known_runs(system, limits, known_runs, witnesses)


def in_known_runs(
    system: TransitionSystem,
    limits: Limits,
    recordings: Sequence[Recording] = (),
    witnesses: Witnesses = NO_WITNESSES,
) -> Iterator[Obligation]:
    """Check the same in shipped, recorded and random runs alone; Unknown for modes and transitions that they do not show.

    This needs no proved fact, so it may run beside the proof of the base. `beyond_known_runs` goes on from what it yields.
    """
    targets = targets_of(system)
    alone = _shown_alone(system, targets, witnesses)
    runs = _known_runs([one.goal for one in targets], limits, recordings, witnesses, alone).runs
    for one in targets:
        shown_ = shown_lawfully(runs[one.goal]) if one.goal in runs else (Unknown("in no known run"), "known runs")
        yield Obligation(one.name, one.statement, *shown_)


def beyond_known_runs(
    system: TransitionSystem, limits: Limits, known_runs: Sequence[Obligation], witnesses: Witnesses = NO_WITNESSES
) -> Iterator[Obligation]:
    """Check the same from what `in_known_runs` has yielded: search what it leaves open, with the proved facts."""
    targets = targets_of(system)
    known = base(system, seconds=limits.seconds)
    soon = {one: early for one, early in zip(targets, known_runs, strict=True) if isinstance(early.verdict, Proved)}
    kept = _going_on(targets, soon)
    members = list(_members(system, targets, kept.left, known, limits, witnesses))
    kept = _excluded_in_the_whole(kept, members, known.everything, limits)
    in_vain = _shown_alone(system, targets, witnesses)
    kept = _searched(kept, replace(limits, seconds=limits.seconds * AT_FIRST), without=in_vain)
    if not system.parts:
        kept = _searched(_leapt(kept, limits), limits)
    unseen = [one for one in targets if one.goal in kept.left]
    alone, depth = _by_itself(members, unseen, limits, witnesses), kept.depth
    if system.parts:
        kept = _searched(kept, limits, without={one.goal for one in alone})
    open_ = [one for one in targets if one.goal not in kept.runs]
    dead = _dead_in_the_composition(list(alone), known, limits)
    free = [one.free for one in open_ if one not in alone]
    broken = _without_assumption(
        free, list(known.always.values()), limits, kept, [one.free for one in targets if one.mode], witnesses
    )
    for one in targets:
        excluded = one.goal in kept.excluded
        if one in soon:
            yield soon[one]
        elif one.goal in kept.runs:
            yield Obligation(one.name, one.statement, *shown_lawfully(kept.runs[one.goal]))
        elif one.free in broken.runs:
            how = shown_freely(one.free, broken.runs[one.free], _while_kept(kept.depth, excluded))
            yield Obligation(one.name, one.statement, *how)
        elif one in dead:
            why = f"a run of the machine alone reaches it ({alone[one].words}), but no run of the composition, whatever the inputs: dead in the composition"
            yield Obligation(one.name, one.statement, Violated(None, "1-induction", why), "1-induction")
        elif one in alone:
            searched = _IN_VAIN if one.goal in in_vain else _none_of_the_composition(depth)
            yield _only_alone(one, alone[one], searched, excluded)
        else:
            yield Obligation(one.name, one.statement, _dead(one.free, broken.depth, limits), "bounded search")


def _going_on(targets: Sequence[Target], soon: Mapping[Target, Obligation]) -> _Looked:
    """Return the goals of all targets, with the runs that are known."""
    verdicts = {one: early.verdict for one, early in soon.items()}
    runs = {
        one.goal: FoundRun(verdict.witness, verdict.engine, "")
        for one, verdict in verdicts.items()
        if isinstance(verdict, Proved) and verdict.witness is not None
    }
    return _Looked([one.goal for one in targets], runs)


def _while_kept(depth: int, excluded: bool) -> str:
    searched = f"not found in {depth} steps" if depth >= 0 else "not searched in time"
    return f"{'proved impossible' if excluded else searched} while the assumption is kept"


# ------------------------------------------------------------------ looking for runs


@dataclass(frozen=True, eq=False)
class _Looked:
    """Goals, runs to some of them, those that are proved unreachable, and the number of steps searched completely for the others."""

    goals: Sequence[Goal]
    runs: Mapping[Goal, FoundRun]
    excluded: Container[Goal] = ()
    depth: int = -1

    @property
    def left(self) -> list[Goal]:
        """The goals without a run."""
        return [goal for goal in self.goals if goal not in self.runs]

    def also(self, found: Mapping[Goal, Trace], engine: str, words: str) -> _Looked:
        """Return the result with further runs."""
        return replace(self, runs={**self.runs, **{goal: FoundRun(run, engine, words) for goal, run in found.items()}})


def _known_runs(
    goals: Sequence[Goal],
    limits: Limits,
    recordings: Sequence[Recording] = (),
    witnesses: Witnesses = NO_WITNESSES,
    undrawn: Container[Goal] = (),
) -> _Looked:
    """Find the goals that witnesses, recordings or random runs reach, and in a composition random runs beside recordings.

    undrawn  goals for which no random run is drawn
    """
    looked = _Looked(goals, {})
    if not goals:
        return looked
    looked = looked.also(shown(goals, witnesses.get(goals[0].plain.name, ())), SHIPPED, "a shipped witness")
    looked = looked.also(shown(looked.left, recordings), "recorded", "a recorded run")
    looked = looked.also(drawn(_without(looked.left, undrawn), limits.seed), "drawn", "a drawn run")
    left = _without(looked.left, undrawn)
    if left and left[0].original.parts:
        found = beside(left, recordings, limits.seed)
        looked = looked.also(found, "drawn", "a drawn run beside a recording")
    return looked


def _without(goals: Sequence[Goal], others: Container[Goal]) -> list[Goal]:
    return [goal for goal in goals if goal not in others]


def _excluded(looked: _Looked, facts: Sequence[Bool], limits: Limits, share: float | None = None) -> _Looked:
    return replace(looked, excluded=_never(looked.left, facts, limits, share))


def _searched(looked: _Looked, limits: Limits, without: Container[Goal] = ()) -> _Looked:
    """Search a run for each goal left that is not excluded and not in `without`."""
    goals = [goal for goal in looked.left if goal not in looked.excluded and goal not in without]
    if not goals:
        return looked
    search = (
        sparing_runs if goals[0].original.composition else first_runs
    )  # of one machine of a composition, or of a target
    searched = search(goals, limits)
    return replace(looked.also(searched.found, "bmc", "witness"), depth=max(looked.depth, searched.depth))


def _without_assumption(
    goals: Sequence[Goal],
    always: Sequence[Bool],
    limits: Limits,
    lawful: _Looked,
    modes: Sequence[Goal],
    witnesses: Witnesses,
) -> _Looked:
    """Find runs to goals without the assumption, also beyond the lawful runs to other goals; exclude goals by the facts `always`.

    modes  goals without the assumption that may lie on the way: the modes of the machine
    """
    looked = _excluded(_known_runs(goals, limits, witnesses=witnesses), always, limits)
    near = [goal for goal in looked.left if goal not in looked.excluded]
    found = leaping(near, limits, [run.trace for run in lawful.runs.values()], modes) if near else {}
    return _sparing(_searched(looked.also(found, "bmc", "witness"), limits), limits)


def _sparing(looked: _Looked, limits: Limits) -> _Looked:
    """Put a run that breaks few laws in the place of each run that was drawn or searched; a shipped one has been looked for so before.

    All goals together get the limit once more.
    """
    ends, runs = deadline(limits.seconds), dict(looked.runs)
    left = [goal for goal, run in runs.items() if run.engine != SHIPPED]
    for number, goal in enumerate(left):
        share = ends.left / (len(left) - number)
        if not share:
            break
        found = sparing_run(goal, runs[goal].trace, replace(limits, seconds=share))
        if found is not runs[goal].trace:
            runs[goal] = FoundRun(found, "bmc", "witness")
    return replace(looked, runs=runs)


def _leapt(looked: _Looked, limits: Limits) -> _Looked:
    """Go on from the runs found so far, under the assumption: in a large machine that is far less work than longer runs from its first state."""
    goals = [goal for goal in looked.left if goal not in looked.excluded]
    if not goals:
        return looked
    runs, half = [run.trace for run in looked.runs.values()], replace(limits, seconds=limits.seconds / 2)
    return looked.also(farther(goals, goals, half, runs, limits.seconds * _EACH_LEAP), "bmc", "witness")


def _never(goals: Sequence[Goal], facts: Sequence[Bool], limits: Limits, share: float | None = None) -> set[Goal]:
    """Return the goals that hold in no first state and after no step from a state with these facts.

    In a composition, goals that read the same machines are asked together, with the facts about these machines; `share` is that of
    the limit for each such group.
    """
    if not goals:
        return set()
    watched, relevance = watch(goals[0].plain, goals), Relevance(goals[0].original)
    one = not goals[0].original.parts
    seconds = limits.seconds * (share or (EXCLUSION_OF_ONE if one else EXCLUSION))
    hypotheses = [environment(watched.system), *facts]
    after = Substitution(dict(watched.system.next))
    later = {number: goal.good.implies(after.bool(goal.good)) for number, goal in enumerate(goals)}
    alike: dict[frozenset[int], list[int]] = {}
    for number, term in later.items():
        alike.setdefault(relevance.machines([term]), []).append(number)
    start = Query("first", [watched.system.init, in_range(watched.system.state)], {n: goals[n].good for n in later})
    not_first, never = following(start, limits.seconds), set[int]()
    for numbers in alike.values():
        wanted = {number: later[number] for number in numbers if number in not_first}
        never |= following(Query("step", relevance.select(hypotheses, wanted.values()), wanted), seconds)
    return {goal for number, goal in enumerate(goals) if number in never}


# ------------------------------------------------------------------ a machine of a composition by itself


@dataclass(frozen=True)
class _Alone:
    """A run of one machine alone, and its description."""

    words: str
    run: Trace


@dataclass(frozen=True, eq=False)
class _Member:
    """A machine of a composition by itself, with those of its targets that no known run of the composition reaches.

    pairs   its targets, each with that of the composition
    looked  its shipped and drawn runs, and what is impossible under its assumption
    kept    whether the composition keeps that assumption: then the same is impossible there
    """

    alone: TransitionSystem
    pairs: Sequence[tuple[Target, Target]]
    looked: _Looked
    kept: bool

    @property
    def excluded(self) -> set[Goal]:
        """The goals of the composition that this machine excludes."""
        return {theirs.goal for mine, theirs in self.pairs if self.kept and mine.goal in self.looked.excluded}

    @property
    def lawful(self) -> set[Goal]:
        """The goals of the composition that a known run of this machine reaches under its assumption."""
        return {theirs.goal for mine, theirs in self.pairs if mine.goal in self.looked.runs}


def _members(
    system: TransitionSystem,
    targets: Sequence[Target],
    left: Sequence[Goal],
    known: Base,
    limits: Limits,
    witnesses: Witnesses,
) -> Iterator[_Member]:
    """Yield the machines of a composition that have targets with a goal in `left`."""
    for number, part in enumerate(system.parts):
        own = [target for target in targets if target.part == number]
        pairs = [
            (mine, theirs) for mine, theirs in zip(targets_of(part.alone), own, strict=True) if theirs.goal in left
        ]
        if pairs:
            looked = _known_runs([mine.goal for mine, _ in pairs], limits, witnesses=witnesses)
            facts = base(part.alone, seconds=limits.seconds).everything
            kept = part.name in known.in_range and (part.contract is TRUE or contract_of(part) in known.kept)
            yield _Member(part.alone, pairs, _excluded(looked, facts, limits), kept)


def _excluded_in_the_whole(
    looked: _Looked, members: Sequence[_Member], facts: Sequence[Bool], limits: Limits
) -> _Looked:
    """Exclude what a machine by itself excludes, and by the facts of the composition what they exclude."""
    excluded = {goal for member in members for goal in member.excluded}
    lawful = {goal for member in members for goal in member.lawful}
    left = [goal for goal in looked.left if goal not in excluded]
    excluded |= _never([goal for goal in left if goal not in lawful], facts, limits)
    excluded |= _never([goal for goal in left if goal in lawful], facts, limits, EXCLUSION_OF_LAWFUL)
    return replace(looked, excluded=excluded)


_IN_VAIN = "the whole was searched in vain when this witness was made"


def _only_alone(target: Target, alone: _Alone, searched: str, excluded: bool) -> Obligation:
    """Report a target that only the machine alone reaches, with the result for the composition."""
    in_composition = "proved impossible in the whole while the assumption is kept" if excluded else searched
    verdict = Proved(None, "bmc", len(alone.run.steps), ("interpreter",), witness=alone.run)
    method = f"of the machine by itself, {alone.words}; {in_composition}"
    return Obligation(target.name, f"{target.statement}, by itself", verdict, method)


def _none_of_the_composition(depth: int) -> str:
    return "the whole was not searched in time" if depth < 0 else f"none of the whole in {depth} steps"


def _shown_alone(system: TransitionSystem, targets: Sequence[Target], witnesses: Witnesses) -> set[Goal]:
    """Return the goals that a witness of one machine alone reaches: when it was made, the whole was searched in vain."""
    found: set[Goal] = set()
    for number, part in enumerate(system.parts):
        if part.alone.name not in witnesses:
            continue
        wanted = [target.goal for target in targets if target.part == number]
        pairs = {
            one: theirs
            for mine, theirs in zip(targets_of(part.alone), wanted, strict=True)
            for one in (mine.goal, mine.free)
        }
        for free in (False, True):
            goals = [one for one in pairs if one.prop.unconditional == free]
            found |= {pairs[one] for one in shown(goals, witnesses.get(part.alone.name, ()))}
    return found


def _by_itself(
    members: Sequence[_Member], open_: Container[Target], limits: Limits, witnesses: Witnesses
) -> dict[Target, _Alone]:
    """Return runs of one machine alone to those of these targets that it reaches."""
    return {
        theirs: _Alone(*shown_)
        for member in members
        for theirs, shown_ in _runs_alone(member, open_, limits, witnesses)
    }


def _runs_alone(
    member: _Member, open_: Container[Target], limits: Limits, witnesses: Witnesses
) -> Iterator[tuple[Target, tuple[str, Trace]]]:
    """Return the targets that the machine reaches alone, each with its description and the run."""
    pairs = [(mine, theirs) for mine, theirs in member.pairs if theirs in open_]
    if not pairs:
        return
    known = base(member.alone, seconds=limits.seconds)
    modes = [one.free for one in targets_of(member.alone) if one.mode]
    looked = replace(member.looked, goals=[mine.goal for mine, _ in pairs])
    lawful = _searched_lawfully(looked, {mine.free: mine.goal for mine, _ in pairs}, limits, witnesses)
    free = [mine.free for mine, _ in pairs if mine.goal not in lawful.runs]
    unlawful = _without_assumption(free, list(known.always.values()), limits, lawful, modes, witnesses).runs
    for mine, theirs in pairs:
        if mine.goal in lawful.runs:
            run = lawful.runs[mine.goal].trace
            yield theirs, (f"witness of {len(run.steps)} steps under its assumption", run)
        elif mine.free in unlawful:
            run = unlawful[mine.free].trace
            breaks, words = how_it_breaks(mine.free.original, run), f"witness of {len(run.steps)} steps"
            yield theirs, (f"a defence: {words} that {breaks}" if breaks else f"{words} under its assumption", run)


def _searched_lawfully(looked: _Looked, goals: Mapping[Goal, Goal], limits: Limits, witnesses: Witnesses) -> _Looked:
    """Search runs of one machine under its assumption, only briefly where a shipped witness breaks it: the search for that witness
    had found none.

    goals  goal without the assumption -> the same under it
    """
    defences = {goals[free] for free in shown(list(goals), witnesses.get(next(iter(goals)).plain.name, ()))}
    searched = _searched(looked, limits, without=defences)
    others = set(goals.values()) - defences
    return _searched(searched, replace(limits, seconds=limits.seconds * AT_FIRST), without=others)


def _dead_in_the_composition(targets: Sequence[Target], known: Base, limits: Limits) -> set[Target]:
    """Return the targets that no run of the composition reaches for any inputs in range, proved without the assumption."""
    dead = _never([target.free for target in targets], list(known.always.values()), limits)
    return {target for target in targets if target.free in dead}


_FURTHER = "Give a recording that goes there (`recordings`), or search longer runs with --depth"


def _dead(free: Goal, depth: int, limits: Limits) -> Verdict:
    for engine in (kinduction, spacer):
        never = engine(free, replace(limits, seconds=limits.seconds / 2))
        if isinstance(never, Proved):
            return Violated(None, never.engine, "never occurs, whatever the inputs: dead; remove it or mend its guard")
    return Unknown(f"no run found that reaches it. {_FURTHER}", depth)
