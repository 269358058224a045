"""Check of a report folder: every certificate by both solvers, every claim against its declaration."""

from __future__ import annotations

import hashlib
import multiprocessing
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

from safeloc.checker.answer import NO_PROOF, OPEN, WRONG
from safeloc.checker.claims import Claims, Goals
from safeloc.checker.dag import Dag
from safeloc.checker.loading import declared
from safeloc.checker.rules import Theory
from safeloc.checker.run_checks import Occurrences
from safeloc.checker.solve import NONE, Opinion, Opinions
from safeloc.checker.text import Certificate, read
from safeloc.errors import InputError, SafelocError
from safeloc.report import certificates, stored
from safeloc.runtime.streams.columns import Runs as KeptRuns
from safeloc.runtime.streams.columns import read_runs
from safeloc.runtime.streams.steps import StepStream
from safeloc.target import Target

_BATCH = 1_000_000  # characters of certificates in one batch of a process
Progress = Callable[[int, int], None]
"""Called with the number of certificates that are checked, and of all."""


@dataclass(frozen=True)
class Checked:
    """A result of the report, with the checker's answer and its reason."""

    id: str
    verdict: str
    answer: str
    why: str


@dataclass
class Checking:
    """The results of checking a folder.

    rows       the checked results
    assigned   certificates of the report's machines; any other certificate is wrong
    wrong      invalid certificates with reasons: unreadable, contradicted by a solver, hypotheses not allowed
    undecided  certificates with goals that a solver did not decide in time
    opinions   answers of the solvers, by file
    """

    rows: list[Checked] = field(default_factory=list)
    assigned: set[str] = field(default_factory=set)
    wrong: dict[str, str] = field(default_factory=dict)
    undecided: dict[str, str] = field(default_factory=dict)
    opinions: dict[str, Opinion] = field(default_factory=dict)

    def include(self, other: Checking) -> None:
        """Add the results of another machine."""
        self.rows += other.rows
        self.assigned |= other.assigned
        self.wrong |= other.wrong
        self.undecided |= other.undecided

    @property
    def exit_code(self) -> int:
        """0: every proof is confirmed; 1: a certificate or a claim is wrong; 3: something could not be confirmed."""
        if self.wrong or any(row.answer == WRONG for row in self.rows):
            return 1
        return 3 if self.undecided or any(row.answer == OPEN for row in self.rows) else 0


def check_folder(
    folder: Path, *, jobs: int = 2, seconds: float = 60.0, progress: Progress = lambda _, __: None
) -> Checking:
    """Check all proofs that a report claims; `seconds` is the limit of a solver for each goal.

    InputError if the folder is no report of this version.
    """
    data = stored.read_report(folder)
    archives = certificates.read_archives(folder / certificates.FOLDER, data["certificates"])
    texts = archives.texts
    found = Checking(wrong=dict(archives.damaged))
    found.wrong |= {name: why for name, text in texts.items() if (why := _misnamed(name, text))}
    for name, answered in _opinions(texts, jobs, seconds):
        found.opinions[name] = answered
        progress(len(found.opinions), len(texts))
    with multiprocessing.get_context("fork").Pool(
        processes(jobs, len(data["machines"])), _INHERITED.append, [(folder, data, texts, found)]
    ) as pool:
        for part in pool.map(_check_machine, range(len(data["machines"])), chunksize=1):
            found.include(part)
    found.wrong |= dict.fromkeys({*texts} - found.assigned - {*found.wrong}, "it belongs to no machine of the report")
    return found


def processes(jobs: int, tasks: int) -> int:
    """Return how many processes are started for these tasks: none that would have nothing to do, and one at least."""
    return max(1, min(jobs, tasks))


def _misnamed(name: str, text: str) -> str:
    """Return the error of a file whose name does not end in the digest of its text; "" if it does."""
    digest = hashlib.sha256(text.encode()).hexdigest()[:16]
    return "" if name.endswith(f"-{digest}.smt2") else f"its text has digest {digest}: it was changed"


def _opinions(texts: Mapping[str, str], jobs: int, seconds: float) -> Iterator[tuple[str, Opinion]]:
    """Yield the solvers' answers about each text, from `jobs` processes; texts that differ in comments only are asked once."""
    same: dict[str, list[str]] = {}
    for name, text in texts.items():
        commands = "\n".join(line for line in text.split("\n") if not line.startswith(";"))
        same.setdefault(commands, []).append(name)
    batches = _batches({names[0]: texts[names[0]] for names in same.values()})
    also = {names[0]: names for names in same.values()}
    with multiprocessing.get_context("fork").Pool(processes(jobs, len(batches))) as pool:
        for found in pool.imap_unordered(partial(asked, seconds), batches):
            yield from ((name, opinion) for one, opinion in found for name in also[one])


def _batches(texts: Mapping[str, str]) -> list[list[tuple[str, str]]]:
    """Return batches of texts, with those of one machine together, since they share most terms; the longest batches first."""
    found: list[list[tuple[str, str]]] = []
    filled: dict[str, tuple[list[tuple[str, str]], int]] = {}
    for name, text in sorted(texts.items()):
        machine = next((line for line in text.split("\n", 8) if line.startswith("; system: ")), "")
        batch, letters = filled.get(machine, ([], _BATCH))
        if letters >= _BATCH:
            batch, letters = [], 0
            found.append(batch)
        batch.append((name, text))
        filled[machine] = batch, letters + len(text)
    return sorted(found, key=lambda batch: -sum(len(text) for _, text in batch))


def asked(seconds: float, batch: Sequence[tuple[str, str]]) -> list[tuple[str, Opinion]]:
    """Ask the solvers about some texts; an unreadable text gets no answers."""
    dag = Dag()
    opinions = Opinions(dag, seconds)
    found = list[tuple[str, Opinion]]()
    for name, text in batch:
        try:
            found.append((name, opinions(read(name, text, dag), text)))
        except InputError:
            found.append((name, NONE))
    return found


# ------------------------------------------------------------------ one machine


_INHERITED: list[tuple[Path, dict[str, Any], dict[str, str], Checking]] = []
"""Data that a forked process inherits from its parent: folder, report, texts, and the results so far."""


def _check_machine(number: int) -> Checking:
    """Check the results of one machine of the report, after the solvers' answers about its texts."""
    folder, data, texts, before = _INHERITED[-1]
    machine, found = data["machines"][number], Checking(wrong=dict(before.wrong), opinions=before.opinions)
    rows = [row for row in data["results"] if row["machine"] == machine["name"]]
    try:
        file = folder / stored.TRACES / stored.runs_files(data)[machine["name"]]
        check_target(declared(machine), rows, texts, _StoredRuns(file), found)
    except SafelocError as error:
        why = f"its declaration cannot be loaded: {error}"
        found.assigned.update(_of(machine["name"], texts))
        found.rows += [Checked(row["id"], row["verdict"], OPEN, why) for row in rows]
    return replace(found, opinions={})


class _StoredRuns:
    """The runs that a report stores for one machine, by result; the file, if there is one, is read at the first request."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._runs: KeptRuns | None = None

    def __call__(self, result: str) -> StepStream | None:
        """Return the stream of a result's run; None if no run is stored. StreamError if the file is damaged."""
        if self._runs is None and self._path.exists():
            self._runs = read_runs(self._path)
        return None if self._runs is None or result not in self._runs else self._runs.stream(result)


def check_target(
    target: Target,
    rows: Sequence[Mapping[str, Any]],
    texts: Mapping[str, str],
    run: Callable[[str], StepStream | None],
    found: Checking,
) -> None:
    """Check the results of one target, and add the answers to `found`, which has the solvers' answers about all texts."""
    goals = Goals(target)
    theory = Theory(target.system, goals)
    take_usable(_of(target.name, texts), texts, theory, found)
    claimed = frozenset(str(row["id"]) for row in rows)
    claims = Claims(target, goals, theory, Occurrences(target, theory.write, run, claimed), claimed)
    found.rows += [_checked(row, claims, texts, found) for row in rows]


def take_usable(names: Sequence[str], texts: Mapping[str, str], theory: Theory, found: Checking) -> None:
    """Let a theory establish what certificates show whose goals both solvers confirm."""
    taken = [one for name in names if (one := _usable(name, texts, theory, found)) is not None]
    found.assigned.update(names)
    found.wrong |= theory.take(taken)


def _of(system: str, texts: Mapping[str, str]) -> list[str]:
    """Return the names of the certificates whose header names this system."""
    return [name for name, text in texts.items() if f"\n; system: {system}\n" in text]


def _usable(name: str, texts: Mapping[str, str], theory: Theory, found: Checking) -> Certificate | None:
    """Return the certificate with the goals that both solvers confirm; None if it is wrong."""
    if name in found.wrong:
        return None
    opinion = found.opinions[name]
    try:
        one = read(name, texts[name], theory.dag)
        if any(other not in texts for other in one.relies_on):
            raise InputError("it relies on a certificate that is missing")
        if opinion.contradicted() or opinion.goals != len(one.goals):
            raise InputError(f"{' and '.join(opinion.contradicted())} do not confirm it")
    except InputError as error:
        found.wrong[name] = str(error)
        return None
    sure = tuple(goal for number, goal in enumerate(one.goals) if opinion.confirmed(number))
    if len(sure) < len(one.goals):
        found.undecided[name] = f"{len(one.goals) - len(sure)} of {len(one.goals)} goals undecided"
    return replace(one, goals=sure)


def _checked(row: Mapping[str, Any], claims: Claims, texts: Mapping[str, str], found: Checking) -> Checked:
    answer, why = claims.answer(row)
    listed = [] if answer == NO_PROOF else row["certificates"]
    bad = [name for name in listed if name not in texts or name in found.wrong]
    late = [name for name in listed if name in found.undecided]
    if bad:
        answer, why = WRONG, f"{len(bad)} of its certificates are missing or wrong"
    elif answer == WRONG and late:
        answer, why = OPEN, f"a solver did not decide {len(late)} of its certificates in time"
    return Checked(row["id"], row["verdict"], answer, why)
