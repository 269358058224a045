"""Make the witnesses that ship: `python -m tests.witnesses [--anew] [--minutes MINUTES] [MACHINE ...]` writes MACHINE.witnesses.jsonl.xz
into the folder of each machine.

A witness is a short run to a mode, a transition or a case of a property. With witnesses at hand `verify` need not search for it. Run
this after an edit that made some of them show nothing (tests/models/test_witnesses.py says so), or that brought new events.

--anew             search for every event again; without it, runs that still show something stay
--minutes MINUTES  search a composition so long for runs of the whole to events that one of its machines alone shows
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Sequence
from functools import partial

from safeloc.catalogue import ENTRIES, load_target
from safeloc.language.machine import Any_
from safeloc.language.trace import Trace
from safeloc.language.verdict import Proved
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.obligations import obligations
from safeloc.proof.provers.recorded_witnesses import NO_WITNESSES, Recording, Witnesses
from safeloc.proof.results import Finding
from safeloc.proof.verification.witness_files import read_witnesses, write_witnesses
from safeloc.runtime.streams.steps import read_steps
from safeloc.target import MODELS, Target
from tests.onward_runs import onward_runs

MOST_STEPS = 1000
"""Longer runs are left to the recordings that show them."""
EVENTS = ("mode", "transition", "case")
"""Words with which the names of the obligations begin whose witness is a run to an event."""


def witnesses(target: Target, *, anew: bool, minutes: float = 0.0) -> list[Trace]:
    """Return the runs to events that are not in a recording only, without those that begin a longer one."""
    recordings = [Recording(stream.first, stream.steps) for stream in map(read_steps, target.streams)]
    known = dict(NO_WITNESSES if anew else read_witnesses(target.witnesses))
    if minutes:
        name = target.system.name
        further = onward_runs(target, [*known.get(name, ()), *recordings], minutes, partial(print, flush=True))
        known[name] = [*known.get(name, ()), *(Recording(first_of(run), run.stream()) for run in further)]
    of_whole = {one: runs for one, runs in known.items() if one == target.system.name}
    found = _events(target, recordings, of_whole)  # searched also for what one machine alone shows in vain since then
    if known != of_whole:
        further = [Recording(first_of(run), run.stream()) for run in found if run.system.name == target.system.name]
        of_whole[target.system.name] = [*of_whole.get(target.system.name, ()), *further]
        found += _events(target, recordings, {**known, **of_whole})
    return without_beginnings(found)


def _events(target: Target, recordings: Sequence[Recording], known: Witnesses) -> list[Trace]:
    found = obligations(
        target.system, Limits(), jobs=2, recordings=recordings, witnesses=known, properties=target.properties
    )
    return [run for finding in found for run in run_of(finding)]


def run_of(finding: Finding) -> list[Trace]:
    """Return the run to an event, if the finding is one and has one that is worth keeping."""
    name, result = finding.id.rpartition("/obligation/")[2], finding.result
    if not name.startswith(EVENTS) or not isinstance(result, Proved) or result.witness is None:
        return []
    return [result.witness] if result.engine != "recorded" and 0 < len(result.witness.steps) <= MOST_STEPS else []


def without_beginnings(runs: Iterable[Trace]) -> list[Trace]:
    """Leave out runs with which another one begins; the longest come last, and equal sets of runs give equal lists."""
    kept: dict[str, Trace] = {}
    for run in sorted(runs, key=lambda one: -len(one.steps)):
        if not any(text.startswith(_text(run)) for text in kept):
            kept[_text(run)] = run
    return [kept[text] for text in sorted(kept, key=lambda text: (len(text), text))]


def _text(run: Trace) -> str:
    return repr([run.system.name, first_of(run)])[:-1] + "".join(f", {step}" for step in run.stream())


def first_of(run: Trace) -> dict[str, int | bool]:
    """Return the open values of the first state."""
    state = run.system.state
    return {var.name: run.initial[var.name] for var in state if isinstance(run.system.initial[var], Any_)}


def main(arguments: Sequence[str] | None = None) -> None:
    """Write the files of the named machines, or of all."""
    parser = argparse.ArgumentParser(prog="python -m tests.witnesses", description=__doc__.splitlines()[0])
    parser.add_argument("--anew", action="store_true")
    parser.add_argument("--minutes", type=float, default=0.0)
    parser.add_argument("machine", nargs="*", default=sorted(ENTRIES))
    asked = parser.parse_args(arguments)
    for name in asked.machine:
        runs = witnesses(load_target(name), anew=asked.anew, minutes=asked.minutes)
        path = MODELS / ENTRIES[name].folder / f"{name}.witnesses.jsonl.xz"
        if runs:
            write_witnesses(path, [(run.system.name, first_of(run), run.stream()) for run in runs])
        else:
            path.unlink(missing_ok=True)
        print(f"{name}: {len(runs)} runs, {path.stat().st_size if runs else 0} bytes", flush=True)


if __name__ == "__main__":
    main()
