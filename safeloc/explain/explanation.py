"""The explanation of one property: sections of text, each with a heading."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import assert_never

from safeloc.explain.failing_parts import Part, failing_parts
from safeloc.explain.lemma_candidates import tried_lemmas
from safeloc.explain.mattering_inputs import Row, mattering_rows, open_first, simplest
from safeloc.language.antecedents import cases
from safeloc.language.expr import TRUE
from safeloc.language.render import infix, names_of_outputs
from safeloc.language.spec import Property, observe
from safeloc.language.terms import Sharing
from safeloc.language.trace import Trace, shown
from safeloc.language.verdict import Held, NotAsked, Proved, Result, Unknown, Vacuous, Violated, told
from safeloc.proof.cores.cores import Core
from safeloc.proof.provers.escape import escape
from safeloc.proof.provers.limits import Limits
from safeloc.proof.results import Finding
from safeloc.target import Target

_LONGEST = 2_000
"""Most characters of a term; the whole is in the source, at the line that is named."""
_DEEPEST = 14
_MOST_PARTS = 40
_MOST_STEPS = 40
_FOLDED = 4
"""Fewest steps that fire the same, without an input that matters, of which only the first and the last are told."""
_SIMPLER_SECONDS = 10.0
KINDS = {
    "always": "always: it holds in the first state and after every step",
    "within": "within: after each trigger the response comes in time",
    "reachable": "reachable: some run comes to it",
}


@dataclass(frozen=True)
class Section:
    """A heading and the lines below it; the words of `heading` have no full stop."""

    heading: str
    lines: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Explanation:
    """All sections, in the order of reading, and the run of a violation, as simple as it could be made."""

    sections: tuple[Section, ...]
    run: Trace | None = None


def explained(
    target: Target,
    prop: Property,
    finding: Finding,
    limits: Limits,
    *,
    find_core: Callable[[Property], Core],
    shown_by: Sequence[str] = (),
) -> Explanation:
    """Explain a property and the finding about it.

    limits     bounds of the questions that are asked for the explanation: counterexample to induction, lemmas
    find_core  finds the smallest set on which a proof rests
    shown_by   lines that say how strongly each requirement is shown (safeloc.assurance.mutation.strength)
    """
    found, run = _evidence(target, prop, finding.result, limits, find_core)
    not_measured = (
        f"not measured: `safeloc mutate {_address(target)}` makes the machine wrong on purpose and says what notices it"
    )
    sections = (
        Section("What it says", tuple(says(target, prop))),
        Section("What it assumes", tuple(_assumes(target, prop))),
        Section("How it was decided", tuple(_decided(finding))),
        *found,
        Section("Which wrong machines it notices", tuple(shown_by) or (not_measured,)),
    )
    return Explanation(sections, run)


def _address(target: Target) -> str:
    return target.spec or target.name


# ------------------------------------------------------------------ what it says


def says(target: Target, prop: Property) -> Iterator[str]:
    """Yield what a property says: its statement, its term, its cases, and where it is declared."""
    share = Sharing()
    names = names_of_outputs(target.system.outputs, share)
    yield prop.statement
    yield f"{KINDS[prop.kind]}:"
    yield f"    {infix(share(prop.term), _LONGEST, names, deepest=_DEEPEST)}"
    if prop.kind == "within":
        response = infix(share(prop.response), _LONGEST, names, deepest=_DEEPEST)
        yield f"    response, in the same step or at most {prop.steps} steps later: {response}"
    for one in cases(prop):
        yield f"It requires something only in {one.words}."
    yield f"declared at {prop.src}"
    yield f"requirements: {', '.join(prop.requirements) or 'none named'}"


def _assumes(target: Target, prop: Property) -> Iterator[str]:
    if prop.unconditional:
        yield "nothing about the world: it is claimed for all inputs in range"
    else:
        names = [f"{machine.name}: {name}" for machine in target.machines for name in machine.world.clauses]
        yield from names
        if names:
            yield f"`safeloc list assumptions {_address(target)}` lists each law with its figures, source and owner"
        else:
            yield "no law of a world is declared: it is claimed for all inputs in range"
    if prop.further_assumption is not TRUE:
        yield f"besides, in every step: {infix(prop.further_assumption, _LONGEST, deepest=_DEEPEST)}"


def _decided(finding: Finding) -> Iterator[str]:
    yield f"{told(finding.result)}: {finding.method}, {finding.seconds:.1f} s"
    match finding.result:
        case Proved(by_construction=why) if why:
            yield why
        case Proved(engine="bmc", depth=steps):
            yield f"the shortest run to it has {steps} steps"
        case Proved(depth=0, invariant=found) if found is not None:
            yield "this holds at the start, is kept by every step, and implies it:"
            yield f"    {infix(found, _LONGEST, deepest=_DEEPEST)}"
        case Proved(depth=1):
            yield "it holds at the start, and after every step from a state in which it and the proved lemmas hold"
        case Proved(depth=k):
            yield f"it holds in the first {k} states, and after every {k} steps from states in which it and the proved lemmas hold"
        case Unknown(reason) as unknown:
            yield f"{reason} ({unknown.searched})"
        case Violated(reason=reason) | Vacuous(reason=reason) | NotAsked(reason=reason) if reason:
            yield reason
        case _:
            pass


# ------------------------------------------------------------------ the evidence


def _evidence(
    target: Target, prop: Property, result: Result, limits: Limits, find_core: Callable[[Property], Core]
) -> tuple[list[Section], Trace | None]:
    match result:
        case Proved(witness=Trace() as run):
            return [Section("The run that shows it", tuple(run.table(_MOST_STEPS).splitlines()))], None
        case Proved():
            return [Section("What the proof rests on", tuple(_rests_on(target, find_core(prop))))], None
        case Violated(trace=Trace() as found):
            run = simplest(found, prop, _SIMPLER_SECONDS)
            return list(violation(run, prop)), run
        case Unknown():
            return list(_open(target, prop, limits)), None
        case Vacuous() | Violated() | NotAsked() | Held():
            return [], None
        case _:
            assert_never(result)


def _rests_on(target: Target, found: Core) -> Iterator[str]:
    if found.why_none:
        yield f"No smallest set: {found.why_none}. It may need every law above, and every lemma of its machines."
        yield f"`safeloc cores {_address(target)} --property {found.claim!r} --seconds 300` looks longer"
        return
    if found.kept_by:
        yield f"proved on machine {found.kept_by} by itself"
    for kind, heading in (
        ("clause", "laws"),
        ("contract", "contracts"),
        ("lemma", "lemmas"),
        ("range", "ranges"),
        ("row", "transitions"),
    ):
        names = [f"{one.machine}: {one.name}" for one in found.rests_on if one.kind == kind]
        if names:
            yield f"{heading}: {'; '.join(names)}"
    if not found.rests_on:
        yield "nothing but the declared ranges: no law, lemma or transition is needed"
    else:
        open_ = f", but for {len(found.open_)} that no solver decided" if found.open_ else ""
        yield f"The proof needs each of these{open_}."


def violation(run: Trace, prop: Property) -> Iterator[Section]:
    """Yield the inputs of a run that violates a property, and the part of its term that fails."""
    first = {name: shown(run.system.variable(name), value) for name, value in open_first(run).items()}
    lines = [f"first: {_values(first)}"] if first else []
    rows = list(_row_lines(mattering_rows(run)))
    lines += [row for row, _ in rows[-_MOST_STEPS:]] or ["its first state violates it"]
    if len(rows) > _MOST_STEPS:
        lines.insert(1, f"... {sum(steps for _, steps in rows[:-_MOST_STEPS])} more steps")
    yield Section("The inputs that matter; all others are absent, false or nearest to zero", tuple(lines))
    yield failing_section(run, prop)


def failing_section(run: Trace, prop: Property) -> Section:
    """Return the part of a property's term that fails in the last step of the run, with the values of its parts."""
    parts = failing_parts(run, prop)
    lines = [part_line(one) for one in parts[:_MOST_PARTS]]
    if len(parts) > _MOST_PARTS:
        lines.append(f"... {len(parts) - _MOST_PARTS} more parts")
    if prop.kind == "within":
        lines.insert(
            0,
            f"the trigger came in step {len(run.steps) - prop.steps}; this is the response in step {len(run.steps)}, the last one in time:",
        )
    where = f"in step {len(run.steps)}" if run.steps else "in the first state"
    return Section(f"The part that fails {where}, with its values", tuple(lines))


def _row_lines(rows: Sequence[Row]) -> Iterator[tuple[str, int]]:
    """Yield lines, each with its number of steps; many steps that fire the same without an input that matters are three lines."""
    for (fired, has_inputs), group in groupby(rows, key=lambda row: (row.fired, bool(row.inputs))):
        some = list(group)
        if has_inputs or len(some) < _FOLDED:
            yield from ((_row(one), 1) for one in some)
        else:
            yield _row(some[0]), 1
            yield f"      ... {len(some) - 2} more steps: {fired}", len(some) - 2
            yield _row(some[-1]), 1


def _row(row: Row) -> str:
    return f"{row.number:4}  {row.fired}  [{_values(row.inputs)}]"


def _values(values: Mapping[str, str]) -> str:
    return " ".join(f"{name}={value}" for name, value in values.items())


def part_line(part: Part) -> str:
    """Return a part of a term in a line: whether it holds, its text, and the values that it reads."""
    if part.depth:
        text = f"{'  ' * part.depth}{'true ' if part.holds else 'false'} {part.text}"
    else:
        text = f"{'true, but must not be' if part.holds else 'false, but must be true'}: {part.text}"
    more = f" and {part.left_out} more" if part.left_out else ""
    values = ", ".join(f"{name} = {value}" for name, value in part.values.items())
    return f"{text}    {values}{more}".rstrip()


def _open(target: Target, prop: Property, limits: Limits) -> Iterator[Section]:
    """Yield the counterexample to induction, and the lemmas that were tried."""
    goal = observe(target.system, prop)
    found = escape(goal, limits)
    if found is None:
        yield Section(
            "Why it is not inductive",
            ("no counterexample to induction was found within the limits; give more --seconds",),
        )
        return
    last = len(found.run.steps)
    yield Section(
        "A counterexample to induction",
        (
            f"{last} step{'s' * (last > 1)} from a state that keeps all that is proved; whether any run comes to it is not known:",
            *found.run.table(_MOST_STEPS).splitlines(),
            f"The row that leads out: {found.row}",
        ),
    )
    yield Section("Lemmas that were tried", tuple(_tried(target, prop, limits)))


def _tried(target: Target, prop: Property, limits: Limits) -> Iterator[str]:
    tried = tried_lemmas(observe(target.system, prop), limits)
    yield (
        f"{tried.held} simple conditions hold in drawn runs (ranges, values that a mode fixes, two variables of one unit); "
        f"{tried.inductive} of them are inductive together"
    )
    if tried.needed is None:
        yield "The property is not inductive with them either: it needs a lemma of another form, or it does not hold."
        return
    yield "With these as lemmas it is inductive, and none of them can be left out:"
    yield from (f"    {infix(one, _LONGEST)}" for one in tried.needed)
