"""Simulated patterns of a test emitter, and of others, as steps of the machine that checks it.

`python -m safeloc.models.emitter.simulate` writes the runs that ship, `... simulate FOLDER` those that are made on demand.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from random import Random

from safeloc.models.emitter import EmitterConfig
from safeloc.proof.drawn_runs.worked import Steps, WorkedRun, write_named
from safeloc.runtime.streams.steps import Cell

_OTHER_BITS = 0b1010


@dataclass(frozen=True)
class Heard:
    """Events of an emitter and the fibre.

    regular    cycles in which the own pattern comes
    foreign    cycles in which another emitter's pattern comes, from beside the own emitter
    elsewhere  cycles in which the own pattern comes from a place far away
    placeless  cycles in which the own pattern comes without a place
    requests   cycles in which the pattern is requested
    dead       (from, to) cycles in which the chain does not work: no pattern comes
    """

    cycles: int
    regular: tuple[int, ...] = ()
    foreign: tuple[int, ...] = ()
    elsewhere: tuple[int, ...] = ()
    placeless: tuple[int, ...] = ()
    requests: tuple[int, ...] = ()
    dead: tuple[int, int] = (0, 0)


def every(config: EmitterConfig, times: int, start: int = 0) -> tuple[int, ...]:
    """Return the cycles in which a regular pattern comes: in the middle of its window each time."""
    apart = config.due_cycles - config.window_cycles // 2
    return tuple(start + apart * number for number in range(1, times + 1))


def listened(config: EmitterConfig, heard: Heard, seed: int = 0) -> Steps:
    """Return one step per cycle, with the ghost input that the chain works."""
    rng = Random(seed)
    return [_step(config, heard, cycle, rng) for cycle in range(heard.cycles)]


def simulate(config: EmitterConfig, *, seed: int) -> Steps:
    """Return forty regular patterns with a jitter of a quarter window, foreign ones between, now and then a request."""
    rng = Random(seed)
    jitter = max(config.window_cycles // 4, 0)
    regular, cycle = list[int](), 0
    for _ in range(40):
        cycle += config.due_cycles - config.window_cycles // 2 + rng.randint(-jitter, jitter)
        regular.append(cycle)
    foreign = rng.sample(range(cycle), 12)
    requests = [one + config.due_cycles // 2 for one in regular[::9]]
    answers = [one + config.answer_cycles // 2 for one in requests]
    kept = [one for one in regular if not any(0 < one - answer < config.due_cycles for answer in answers)]
    return listened(config, Heard(cycle + 5, (*kept, *answers), tuple(foreign), requests=tuple(requests)), seed)


def _step(config: EmitterConfig, heard: Heard, cycle: int, rng: Random) -> dict[str, Cell]:
    works = not heard.dead[0] <= cycle < heard.dead[1]
    step: dict[str, Cell] = {"test_requested": cycle in heard.requests, "next_chain_works": works}
    return {**step, **(_pattern(config, heard, cycle, rng) if works else {})}


def _pattern(config: EmitterConfig, heard: Heard, cycle: int, rng: Random) -> dict[str, Cell]:
    here = config.place_mm + rng.randint(-1, 1) * (config.place_tolerance_mm // 2)
    far = config.place_mm + 3 * config.place_tolerance_mm + 1_000
    if cycle in heard.elsewhere:
        return {"heard_pattern": config.pattern, "heard_place_mm": far}
    if cycle in heard.placeless:
        return {"heard_pattern": config.pattern}
    if cycle in heard.foreign:
        return {"heard_pattern": config.pattern ^ _OTHER_BITS, "heard_place_mm": here}
    return {"heard_pattern": config.pattern, "heard_place_mm": here} if cycle in heard.regular else {}


# ------------------------------------------------------------------ named runs


def _service(config: EmitterConfig) -> Heard:
    """Send regular patterns; then a request and its answer, and regular ones counted from there."""
    regular = every(config, 3)
    asked = regular[-1] + config.due_cycles // 2
    answered = asked + config.answer_cycles // 2
    later = every(config, 2, answered)
    return Heard(later[-1] + 5, (*regular, answered, *later), requests=(asked,))


def _missing(config: EmitterConfig) -> Heard:
    """Let the chain be dead for two due times; then it works again, and enough patterns pass."""
    regular = every(config, 2)
    dead = (regular[-1] + 3, regular[-1] + 3 + 2 * config.due_cycles)
    later = every(config, config.passes_to_recover + 1, dead[1])
    return Heard(later[-1] + 5, (*regular, *later), dead=dead)


def _foreign(config: EmitterConfig) -> Heard:
    """Let another emitter take the place of the own one."""
    regular = every(config, 3)
    return Heard(regular[-1] + config.due_cycles + 5, regular[:1], foreign=regular[1:])


def _early(config: EmitterConfig) -> Heard:
    """Send the own pattern when it is not due, and once without a place, in between."""
    regular = every(config, 3)
    return Heard(regular[-1] + 5, (*regular, regular[0] + 5), placeless=(regular[1] + 5,))


def _elsewhere(config: EmitterConfig) -> Heard:
    regular = every(config, 2)
    return Heard(regular[-1] + 20, regular, elsewhere=(regular[-1] + 6,))


def _unanswered(config: EmitterConfig) -> Heard:
    regular = every(config, 2)
    return Heard(regular[-1] + config.due_cycles - 1, regular, requests=(regular[-1] + 2,))


def _worked(outcome: str, heard: Callable[[EmitterConfig], Heard]) -> WorkedRun[EmitterConfig]:
    return WorkedRun(outcome, lambda config: listened(config, heard(config)))


RUNS: Mapping[str, WorkedRun[EmitterConfig]] = {
    "emitter-service": _worked("Tested from the first pattern on, also by the answer to a request.", _service),
    "emitter-missing-pattern": _worked(
        "The chain dies: failed one cycle after the due time; tested again once enough patterns passed.", _missing
    ),
    "emitter-foreign-pattern": _worked(
        "Another emitter's pattern comes in place of the own one: reported, renews nothing, failed one cycle "
        "after the due time.",
        _foreign,
    ),
    "emitter-not-due": _worked(
        "The own pattern comes too early, and without its place: each is reported and renews nothing; tested "
        "throughout by regular ones.",
        _early,
    ),
    "emitter-elsewhere": _worked("The own pattern from another place: failed in that cycle.", _elsewhere),
}
"""The recordings that ship, by name."""
ON_DEMAND: Mapping[str, WorkedRun[EmitterConfig]] = {
    "emitter-unanswered": _worked(
        "A request is not answered: failed when its time is over, before the regular pattern is due.", _unanswered
    ),
}
"""Runs that do not ship, by name: another one shows each of their transitions and cases."""


if __name__ == "__main__":
    write_named(__file__, RUNS, ON_DEMAND, EmitterConfig())
