"""The explanation of one property on a recording: where it is violated and by which inputs, or how near it comes to that."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from safeloc.explain.explanation import Explanation, Section, failing_section, says, violation
from safeloc.explain.margin import least_margin
from safeloc.explain.mattering_inputs import Row, mattering_rows, open_first, simplest
from safeloc.language.monitor import check
from safeloc.language.spec import Property, observe
from safeloc.language.trace import Trace
from safeloc.language.verdict import Held, NotAsked, Result, Unknown, Violated, told
from safeloc.proof.provers.shorten import rested
from safeloc.proof.results import Finding
from safeloc.proof.verification.replay import recorded_run
from safeloc.target import Target

_SECONDS = 10.0


def explained_recording(target: Target, prop: Property, path: Path) -> tuple[Explanation, Finding]:
    """Explain a property on a recording, and return the finding about it."""
    run = recorded_run(target, path, prop)
    result: Result = NotAsked(_NOT_APPLICABLE) if run is None else check(run, prop)
    found, simple = ([], None) if run is None else _evidence(run, prop, result)
    sections = (
        Section("What it says", tuple(says(target, prop))),
        Section("On this recording", (_verdict(result, run, prop, path),)),
        *found,
    )
    name = f"{target.name}/replay/{path.name.partition('.')[0]}: {prop.name}"
    finding = Finding(name, target.name, "replay", prop.statement, result, f"replay of {path.name}", 0.0)
    return Explanation(sections, simple), finding


_NOT_APPLICABLE = "the property reads the truth, and the recording has no ghosts; a simulated stream has them"


def _verdict(result: Result, run: Trace | None, prop: Property, path: Path) -> str:
    if isinstance(result, Violated) and result.trace is not None and run is not None:
        at, of = len(result.trace.steps), len(run.steps)
        return f"violated: first {f'in step {at}' if at else 'in the first state'} of {of} steps of {path.name}"
    if isinstance(result, Held) and prop.kind == "reachable":
        return f"reached: first in step {result.steps} of {path.name}"
    if isinstance(result, Held) and run is not None:
        return f"held: not violated in {len(run.steps)} steps of {path.name}; this is no proof"
    assert isinstance(result, (Unknown, NotAsked))  # what `check` says besides
    return f"{told(result)}: {result.reason}"


def _evidence(run: Trace, prop: Property, result: Result) -> tuple[list[Section], Trace | None]:
    if isinstance(result, Violated) and result.trace is not None:
        simple = simplest(result.trace, prop, _SECONDS)
        return [*_in_the_recording(result.trace, prop), *_simpler(simple, prop)], simple
    if isinstance(result, Held) and prop.kind == "always":
        return list(_nearest(run, prop)), None
    return [], None


# ------------------------------------------------------------------ violated


def _in_the_recording(run: Trace, prop: Property) -> Iterator[Section]:
    """Yield the part that fails, and the inputs that matter at the steps of the recording: all others are put to rest, and no
    step is left out."""
    yield failing_section(run, prop)
    kept = rested(observe(run.system, prop), open_first(run), [step.inputs for step in run.steps], _SECONDS)
    rows = mattering_rows(kept)
    names = dict.fromkeys(name for row in rows for name in row.inputs)
    lines = tuple(_span(name, rows) for name in names) or ("none: with all inputs at rest it is violated as well",)
    yield Section("The recorded inputs that matter; with all others at rest, the same step violates it", lines)


def _simpler(simple: Trace, prop: Property) -> Iterator[Section]:
    """Yield the explanation of the simplest run that was found; the headings say that it is another one than the recording."""
    steps = "1 step" if len(simple.steps) == 1 else f"{len(simple.steps)} steps"
    for one in violation(simple, prop):
        yield replace(one, heading=f"In a simpler run, of {steps}: {one.heading[0].lower()}{one.heading[1:]}")


def _span(name: str, rows: Sequence[Row]) -> str:
    steps = [row.number for row in rows if name in row.inputs]
    last = rows[steps[-1] - 1].inputs[name]
    where = f"step {steps[0]}" if len(steps) == 1 else f"{len(steps)} of the steps {steps[0]} to {steps[-1]}"
    return f"{name} in {where}; {name}={last} in step {steps[-1]}"


# ------------------------------------------------------------------ not violated


def _nearest(run: Trace, prop: Property) -> Iterator[Section]:
    """Yield the least margin of the inequalities in the property, if it has any."""
    found = least_margin(run, prop)
    if found is None:
        return
    values = ", ".join(f"{name} = {value}" for name, value in found.values.items())
    line = f"{found.margin} {found.unit} in step {found.step}: {found.text}    {values}"
    yield Section("How near it came: the least margin", (line,))
