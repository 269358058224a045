"""Each recording of a machine that has more than three shows what no other one does, or stands in the documentation."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

from safeloc.catalogue import ENTRIES, load_target
from safeloc.language.antecedents import occurs
from safeloc.language.interpret import run
from safeloc.language.system import TransitionSystem, without_ghosts
from safeloc.language.units import Enumeration
from safeloc.proof.provers.antecedents import all_cases
from safeloc.proof.provers.recorded_witnesses import Recording, Replay, is_label
from safeloc.runtime.streams.gzipped import name_of
from safeloc.runtime.streams.steps import StepStream, read_steps
from safeloc.target import recorded

DOCS = "".join(path.read_text(encoding="utf-8") for path in Path(__file__).parents[2].glob("docs/*.md"))
MANY = sorted(
    (name for name in ENTRIES if len(recorded(name)) > 3),
    key=lambda name: sum(path.stat().st_size for path in recorded(name)),
)
"""The smallest recordings first: those of the first machine are looked at in every run of the tests."""
ORDINARY = {
    "axle_counter-service",
    "axle_section-service",
    "emitter-service",
    "fibre_area-service",
    "localizer-metro",
    "unlinked_group-service",
    "verification-stay",
}
"""Runs in which nothing goes wrong, one of a machine, for a user to begin with."""


def happens(system: TransitionSystem, stream: StepStream) -> Iterator[tuple[str, object]]:
    """Transitions that fire, and modes, choices and flags that come up, whatever is assumed."""
    inputs = {var.name for var in system.inputs}
    states = {var.name for var in system.state}
    first = {name: value for name, value in stream.first.items() if name in states}
    steps = [{name: cell for name, cell in step.items() if name in inputs} for step in stream.steps]
    told = [var.name for var in system.state if is_label(var)]
    answers = [name for name, term in system.outputs.items() if isinstance(getattr(term, "unit", None), Enumeration)]
    for step in run(system, steps, first=first).steps:
        yield from step.fired.items()
        yield from ((name, step.state[name]) for name in told)
        yield from ((name, step.outputs[name]) for name in answers)


def shown(machine: str) -> dict[str, set[tuple[str, object]]]:
    """What happens in each recording, and which cases of properties occur in it while it keeps what is assumed."""
    target = load_target(machine)
    cases = {
        number: occurs(target.system, case, f"case {number}")
        for number, case in enumerate(all_cases(target.properties))
    }
    replay, plain, found = Replay(target.system, cases), without_ghosts(target.system), {}
    for path in target.streams:
        stream = read_steps(path)
        occurring = replay.first_times(list(replay.states(Recording(stream.first, stream.steps))))
        found[name_of(path)] = {*happens(plain, stream), *(("case", number) for number in occurring)}
    return found


def is_documented(recording: str) -> bool:
    """Whether a page names the recording, by its whole name or by what happens in it."""
    return (
        f"{recording}`" in DOCS
        or f"`{recording.partition('-')[2]}`" in DOCS
        or f"...-{recording.partition('-')[2]}`" in DOCS
    )


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("machine", MANY)
def test_each_recording_teaches_something(machine: str) -> None:
    """One that shows the same as others does not ship: it becomes a run on demand, or a page shows what it is for."""
    found = shown(machine)
    times = Counter(one for every in found.values() for one in every)
    like_others = [name for name, every in found.items() if all(times[one] > 1 for one in every)]
    assert [] == [name for name in like_others if name not in ORDINARY and not is_documented(name)]


def test_ordinary_runs_ship() -> None:
    """One of a machine at most; none is listed that is gone."""
    assert ORDINARY <= {name_of(path) for name in MANY for path in recorded(name)}
    assert len(ORDINARY) == len({name.partition("-")[0] for name in ORDINARY})
