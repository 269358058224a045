"""The long run over the mutants of all machines: python -m tests.mutants --sample 10000 --seed 1 --out FILE

Every machine and composition gets its share of the sample, by how many mutants it has, and 10 at least; `--sample 0` takes all of them. A
mutant passes that a proof notices, that is no wrong machine, or that has a written reason. One line of FILE a mutant; started
again with the same FILE, it goes on where it was ended. The last line of output is `N passed, N failed`.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from safeloc.assurance.mutation.composed_work import JudgingComposed, Parts, parts
from safeloc.assurance.mutation.declared import declared_of
from safeloc.assurance.mutation.members import composed, member_mutants
from safeloc.assurance.mutation.mutants import mutants, sample
from safeloc.assurance.mutation.places import Places, noted
from safeloc.assurance.mutation.reasons import shipped_reasons
from safeloc.assurance.mutation.results import QUESTIONS, Judged
from safeloc.assurance.mutation.wires import wire_edits
from safeloc.assurance.mutation.work import Judging, OnJudged, Plan
from safeloc.catalogue import ENTRIES, load_target
from safeloc.proof.provers.limits import Limits
from safeloc.target import Target
from tests.kept_lines import keep, kept_lines

LEAST = 10
SECONDS = 2.0
"""The limit for each question to a solver."""


@dataclass(frozen=True, eq=False)
class Loaded:
    """A target with the ids of all its mutants."""

    name: str
    target: Target
    places: Places
    ids: tuple[str, ...]


def main(arguments: Sequence[str] | None = None) -> int:
    """The exit code."""
    parser = argparse.ArgumentParser(prog="python -m tests.mutants", description=__doc__)
    parser.add_argument("--sample", type=int, default=10_000, help="mutants of all machines together; 0: all there are")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--machine", action="append", help="only this one (repeatable)")
    parser.add_argument("--out", type=Path, required=True, help="a line a mutant; read again to go on")
    asked = parser.parse_args(arguments)
    names = asked.machine or [*ENTRIES]
    share = shares({name: len(loaded(name).ids) for name in names}, asked.sample)
    lines: list[Mapping[str, Any]] = []
    for name in names:
        lines += of_target(loaded(name), share[name], asked.seed, asked.jobs, asked.out)
        print(told(name, [line for line in lines if line["target"] == name]), flush=True)
    return closing(lines)


def loaded(name: str) -> Loaded:
    """A shipped machine or composition as it is."""
    with noted() as places:
        target = load_target(name)
    if not target.system.parts:
        return Loaded(name, target, places, tuple(one.id for one in mutants(declared_of(target), places)))
    whole = composed(target, places)
    every = [*member_mutants(whole, places), *(edit.mutant for edit in wire_edits(whole, places))]
    return Loaded(name, target, places, tuple(one.id for one in every))


def shares(counts: Mapping[str, int], total: int) -> dict[str, int]:
    """How many mutants of each machine are judged: its share of the total, some at least, and no more than there are."""
    every = sum(counts.values())
    if not total:
        return dict(counts)
    return {name: min(count, max(LEAST, total * count // every)) for name, count in counts.items()}


def of_target(own: Loaded, most: int, seed: int, jobs: int, out: Path) -> list[Mapping[str, Any]]:
    """Judge what FILE does not have yet; a line for each of this sample, in its order."""
    wanted, judge = parts_of_sample(own, most, seed, jobs)
    reasons = shipped_reasons(own.name).of({"machine": frozenset(own.ids)})
    done = {line["id"]: line for line in kept_lines(out) if line["target"] == own.name}

    def heard(one: Judged) -> None:
        done[one.id] = line_of(own.name, one, reasons)
        keep(out, done[one.id])

    judge([one for one in wanted if one not in done], heard)
    return [done[one] for one in wanted]


def parts_of_sample(
    own: Loaded, most: int, seed: int, jobs: int
) -> tuple[list[str], Callable[[Sequence[str], OnJudged], object]]:
    """The ids of the sample, and what judges some of them."""
    plan = Plan(Limits(seconds=SECONDS, seed=seed), seed, jobs)
    if own.target.system.parts:
        whole = composed(own.target, own.places)
        some = parts(whole, own.places, most=most, seed=seed)
        ids = [*(one.id for one in some.members), *some.wires]

        def in_whole(left: Sequence[str], heard: OnJudged) -> object:
            members = [one for one in some.members if one.id in left]
            wires = {one: edit for one, edit in some.wires.items() if one in left}
            return JudgingComposed(whole, plan, heard).all(Parts(members, wires, some.existing)) if left else None

        return ids, in_whole
    declared = declared_of(own.target)
    few = sample(mutants(declared, own.places), most, seed)

    def alone(left: Sequence[str], heard: OnJudged) -> object:
        return Judging(own.target, declared, plan, heard).of_machine([one for one in few if one.id in left])

    return [one.id for one in few], alone


def line_of(target: str, one: Judged, reasons: Mapping[str, str]) -> dict[str, Any]:
    """What is kept of a mutant."""
    outcome = one.everywhere
    wrong = outcome.fate if outcome.fate in QUESTIONS and one.id not in reasons else ""
    return {"target": target, "id": one.id, "fate": outcome.fate, "wrong": wrong, "seconds": one.seconds} | {
        name: asdict(one)[name] for name in ("place", "kind", "words")
    }


def told(name: str, lines: Sequence[Mapping[str, Any]]) -> str:
    """A machine's line: how many of each fate."""
    fates = Counter(str(line["fate"]) for line in lines)
    seconds = sum(float(line["seconds"]) for line in lines)
    return f"{name}: {len(lines)} in {seconds:.0f} s: " + ", ".join(
        f"{count} {fate}" for fate, count in fates.most_common()
    )


def closing(lines: Sequence[Mapping[str, Any]]) -> int:
    """Print what failed, and how many; the exit code."""
    wrong = list(_wrong(lines))
    for line in wrong:
        print(f"{line['id']} ({line['place']}: {line['words']}): {line['wrong']}, and no written reason")
    print(f"{len(lines) - len(wrong)} passed, {len(wrong)} failed")
    return 1 if wrong else 0


def _wrong(lines: Sequence[Mapping[str, Any]]) -> Iterator[Mapping[str, Any]]:
    return (line for line in lines if line["wrong"])


if __name__ == "__main__":
    sys.exit(main())
