"""Judge a mutant of the world: a clause that requires less, more, or something else.

If the world allows more, claims may no longer be proved. If it allows less, they all are; the questions then are whether the
recordings are still lawful, and whether every row, mode and `reachable` property is still possible.
"""

from __future__ import annotations

from safeloc.assurance.mutation import results
from safeloc.assurance.mutation.claims import Held, held
from safeloc.assurance.mutation.induction import impossible, no_longer
from safeloc.assurance.mutation.judge_machine_mutant import Bench, by_a_run, unproved
from safeloc.assurance.mutation.mutants import Mutant
from safeloc.assurance.mutation.playing import WORLD, Event, Path, played
from safeloc.assurance.mutation.results import Outcome
from safeloc.assurance.mutation.stepping import Step, stepped
from safeloc.assurance.mutation.weaker import Relation
from safeloc.errors import SafelocError
from safeloc.language.expr import FALSE
from safeloc.language.system import environment, in_range


def of_world(on: Bench, mutant: Mutant) -> tuple[Outcome, Relation | str]:
    """Return the outcome, and the relation of the mutant's world to the original one; "" if the declaration is refused."""
    try:
        made = held(mutant.alone(on.unchanged.declared), on.canon, on.proofs.under_assumption)
    except SafelocError as error:
        return Outcome(results.REFUSED, (), str(error).splitlines()[-1].strip(" -")), ""
    how = _relation(on, made)
    if how == "same":
        return Outcome(results.EQUIVALENT, (), "the same world"), how
    lost = None if how == "stronger" else _lost(on, made)
    if lost is None and how != "weaker":
        lost = _shut_out(on, made)
    return lost or _left(how), how


def _left(how: Relation) -> Outcome:
    if how == "weaker":
        return Outcome(results.TOO_MUCH, (), "all claims are proved in the weaker world")
    if how == "stronger":
        return Outcome(results.UNSEEN, (), "every recording is lawful, and everything can still happen")
    return Outcome(results.SURVIVED)


def _relation(on: Bench, made: Held) -> Relation:
    """Return the relation of the mutant's world to the original; what is not decided within the limit counts as not following."""
    old, new = on.unchanged.system, made.system
    hypotheses = [in_range(old.state), environment(old, assume=False)]
    follows, returns = (
        not on.canon.asked.failures([*hypotheses, one.assume], {"": other.assume}, on.limits.seconds)
        for one, other in ((old, new), (new, old))
    )
    if follows:
        return "same" if returns else "weaker"
    return "stronger" if returns else "other"


def _lost(on: Bench, made: Held) -> Outcome | None:
    """Return the outcome if a claim is broken or no longer proved in this world; else None."""
    seen = played(made, on.known)
    if seen.broken:
        return by_a_run(seen)
    failed = no_longer(made, on.proofs, on.canon, on.limits)
    return unproved(made, failed, on.limits)[0] if failed.claims else None


def _shut_out(on: Bench, made: Held) -> Outcome | None:
    """Return the outcome if a world that allows less excludes a recording or an event; None if it excludes neither."""
    lawful = stepped((made.system.state, made.system.inputs), [made.system.assume])
    seen = set[Event]()
    trails = {trail.path.run.name: trail for trail in on.known.board}
    for path in on.known.layers[WORLD]:
        steps = _lawful_steps(path, lawful, len(made.system.state))
        if steps < len(path.rows) and path.run.recorded:
            return Outcome(results.EXCLUDED, (), f"{path.run.name}, step {steps + 1}")
        seen |= trails[path.run.name].seen(steps)
    facts = [claim.good for claim in on.unchanged.layers[0].claims if claim.goal is None]
    hypotheses = [in_range(made.system.state), environment(made.system), *facts]
    if not on.canon.asked.failures(hypotheses, {"": FALSE}, on.limits.seconds):
        return Outcome(results.NEVER, ("no step is lawful",), "the clauses contradict each other")
    never = impossible(made, seen, on.canon, on.limits, lawful=True)
    if never:
        before = impossible(on.unchanged, seen, on.canon, on.limits, lawful=True)
        never = [one for one in never if one not in before]
    return Outcome(results.NEVER, tuple(never), "excluded in one step, in this world") if never else None


def _lawful_steps(path: Path, lawful: Step, width: int) -> int:
    """Return how many steps of a path the world allows, without regard to the state of observers."""
    pairs = enumerate(zip(path.states, path.rows, strict=False))
    return next((number for number, (state, row) in pairs if not lawful(state[:width], row)[0]), len(path.rows))
