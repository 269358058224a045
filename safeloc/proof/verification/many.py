"""Several targets at once: each is conducted by a process of its own, and all processes share the same places.

The longest targets begin first. Progress is reported at once; all findings of a target arrive when it is done. All processes
are forked before any findings arrive: a process that holds the findings of many targets is ten times as large, and each
fork of it, and each fork of that, would cost as much more.
"""

from __future__ import annotations

import gc
import multiprocessing
import os
import signal
import time
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.context import ForkProcess
from typing import Any, NoReturn

from safeloc.errors import EngineError, SafelocError
from safeloc.language.verdict import word
from safeloc.proof.cache.answers import kept_in
from safeloc.proof.cache.store import Store
from safeloc.proof.cache.targets import Asked, asked, found_before, keep
from safeloc.proof.provers.slots import Slots, sharing
from safeloc.proof.results import Finding
from safeloc.proof.verification.one import Plan, Work, expected
from safeloc.proof.verification.plain import Plain, pack_findings, unpack_findings
from safeloc.target import Target


@dataclass(frozen=True)
class Began:
    """The start of a target, with the expected number of findings."""

    target: str
    findings: int


@dataclass(frozen=True)
class Phase:
    """The current phase of a target's verification."""

    target: str
    text: str


@dataclass(frozen=True)
class Found:
    """One finding of a target: its id, verdict and seconds."""

    target: str
    id: str
    verdict: str
    seconds: float


@dataclass(frozen=True)
class Over:
    """The end of a target, with its time in seconds."""

    target: str
    seconds: float


@dataclass(frozen=True)
class Kept:
    """An unchanged target: the number of findings from the cache, and their date (UTC)."""

    target: str
    findings: int
    since: str


Event = Began | Phase | Found | Over | Kept
OnEvent = Callable[[Event], None]


@dataclass(frozen=True)
class _Done:
    """The findings of a target as plain data."""

    packed: Plain


@dataclass(frozen=True)
class _Failed:
    """The error that ended a target's verification."""

    error: SafelocError


@dataclass
class _Conductor:
    """The process of one target: it waits until it is told to begin through its pipe."""

    target: Target
    process: ForkProcess
    pipe: Connection
    began: float = 0.0

    def begin(self) -> None:
        self.began = time.monotonic()
        self.pipe.send(None)


def verify_targets(
    targets: Sequence[Target],
    plan: Plan,
    *,
    jobs: int,
    on_event: OnEvent,
    look_in: Store | None = None,
    keep_in: Store | None = None,
) -> dict[str, list[Finding]]:
    """Verify several targets and return all findings by target; at most `jobs` processes compute at a time.

    look_in  where findings of an earlier run may be; of an unchanged target these are returned (safeloc.proof.cache). None
             looks at nothing that was found before this run
    keep_in  where findings, and the answers of solvers, are kept

    What a target raises (StreamError for a recording that it cannot take, EngineError) is raised here; the rest is ended.
    """
    keeping = look_in is not None or keep_in is not None
    questions = {target: asked(target, "verified", plan) for target in targets} if keeping else {}
    found = dict(_found_before(look_in, questions, on_event))
    left = sorted((target for target in targets if target.name not in found), key=expected, reverse=True)
    places = Slots(max(1, jobs))
    try:
        with kept_in(keep_in, fresh=look_in is None):
            for target, packed, seconds in _conducted(left, plan, jobs, places, on_event):
                found[target.name] = unpack_findings(packed, target.system)
                if target in questions:
                    keep(keep_in, questions[target], found[target.name])
                on_event(Over(target.name, seconds))
    finally:
        places.close()
    return {target.name: found[target.name] for target in targets}


def _found_before(
    store: Store | None, questions: Mapping[Target, Asked], on_event: OnEvent
) -> Iterator[tuple[str, list[Finding]]]:
    """Findings of unchanged targets, by name."""
    for target, question in questions.items():
        findings = found_before(store, question)
        if findings is not None:
            on_event(Kept(target.name, len(findings), findings[0].kept_since if findings else ""))
            yield target.name, findings


def _conducted(
    waiting: Sequence[Target], plan: Plan, jobs: int, places: Slots, on_event: OnEvent
) -> Iterator[tuple[Target, Plain, float]]:
    """Each target's findings as plain data, and its seconds, as they are complete; as many targets at a time as there are places."""
    left, running = list[_Conductor](), list[_Conductor]()
    try:
        for target in waiting:
            left.append(_forked(target, plan, jobs, places, [one.pipe for one in left]))
        while left or running:
            while left and len(running) < max(1, jobs):
                running.append(left.pop(0))
                running[-1].begin()
                on_event(Began(running[-1].target.name, expected(running[-1].target)))
            wait([one.pipe for one in running])
            for one in [one for one in running if one.pipe.poll()]:
                done = _received(one, on_event)
                if done is not None:
                    running.remove(one)
                    yield one.target, done, time.monotonic() - one.began
    finally:
        for one in (*running, *left):
            one.process.terminate()
            one.process.join()


def _forked(target: Target, plan: Plan, jobs: int, places: Slots, others: Sequence[Connection]) -> _Conductor:
    context = multiprocessing.get_context("fork")
    here, there = context.Pipe(duplex=True)
    process = context.Process(target=_conduct, args=(target, plan, jobs, places, there, [*others, here]))
    process.start()
    there.close()
    return _Conductor(target, process, here)


def _received(one: _Conductor, on_event: OnEvent) -> Plain | None:
    """Pass on a message of a target's process; return its findings when it is done. Its error is raised here."""
    try:
        said: Any = one.pipe.recv()
    except EOFError:
        one.process.join()
        raise EngineError(
            f"{one.target.name}: its process ended with code {one.process.exitcode} before it was done."
        ) from None
    match said:
        case _Done(packed):
            one.process.join()
            one.pipe.close()
            return packed
        case _Failed(error):
            raise error
        case _:
            on_event(said)
            return None


# ------------------------------------------------------------------ in the conductor's process


def _conduct(
    target: Target, plan: Plan, jobs: int, places: Slots, pipe: Connection, inherited: Sequence[Connection]
) -> None:
    """Verify one target as soon as the parent sends the start; every process that computes has a place, this one too.

    inherited  the parent's ends of pipes: closed here, so that this process notices when the parent is gone
    """
    gc.freeze()  # the collector never walks through what is inherited, which would copy every page of it
    signal.signal(signal.SIGTERM, _leave)
    for one in inherited:
        one.close()
    try:
        pipe.recv()
    except (EOFError, KeyboardInterrupt):
        os._exit(1)
    places.take()
    try:
        with sharing(places), suppress(BrokenPipeError):
            pipe.send(_verified(target, plan, jobs, pipe))
    except KeyboardInterrupt:
        os._exit(1)
    finally:
        places.give()
        pipe.close()


def _leave(*_: object) -> NoReturn:
    raise SystemExit(1)


def _verified(target: Target, plan: Plan, jobs: int, pipe: Connection) -> _Done | _Failed:
    def phase(text: str, _: int) -> None:
        pipe.send(Phase(target.name, text))

    def finding(one: Finding) -> None:
        pipe.send(Found(target.name, one.id, word(one.result), one.seconds))

    try:
        findings = Work(target, jobs, phase, finding).verified(plan)
        return _Done(pack_findings(findings, target.system))
    except SafelocError as error:
        return _Failed(error)
    except Exception as error:  # not swallowed: the parent raises it, and where it came from is known here only
        traceback.print_exception(error)
        return _Failed(EngineError(f"{target.name}: {type(error).__name__}: {error}"))


def in_order(found: Mapping[str, Sequence[Finding]]) -> list[Finding]:
    """Return all findings of all targets, target by target."""
    return [finding for findings in found.values() for finding in findings]
