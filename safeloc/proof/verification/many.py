"""Several targets at once: a process for each target, and slots at the processors that all processes share.

The longest targets begin first, and the shortest one beside them. Progress is reported at once; all findings of a target
arrive when it is done. All processes are forked before any findings arrive: a process that holds the findings of many
targets is ten times as large, and so would be every process that is forked from it.
"""

from __future__ import annotations

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
from safeloc.language.verdict import told
from safeloc.proof.cache.answers import kept_in
from safeloc.proof.cache.store import Store
from safeloc.proof.cache.targets import Asked, asked, found_before, keep
from safeloc.proof.provers.collection import collect_rarely
from safeloc.proof.provers.slots import Slots, sharing
from safeloc.proof.results import Finding
from safeloc.proof.testing import prepare
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
    """The process of one target; it waits for a message in its pipe before it begins."""

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

    look_in  store with findings of earlier runs, which are returned for unchanged targets (safeloc.proof.cache); None: earlier
             findings are not used
    keep_in  store for the findings, and for the answers of solvers

    An error of a target (StreamError for a recording that it cannot take, EngineError) is raised here, and the other targets are
    ended.
    """
    keeping = look_in is not None or keep_in is not None
    questions = {target: asked(target, "verified", plan) for target in targets} if keeping else {}
    found = dict(_found_before(look_in, questions, on_event))
    left = _in_turn([target for target in targets if target.name not in found], jobs)
    slots = Slots(max(1, jobs))
    try:
        with kept_in(keep_in, fresh=look_in is None):
            for target, packed, seconds in _conducted(left, plan, jobs, slots, on_event):
                found[target.name] = unpack_findings(packed, target.system)
                if target in questions:
                    found[target.name] = keep(keep_in, questions[target], found[target.name], packed)
                on_event(Over(target.name, seconds))
    finally:
        slots.close()
    return {target.name: found[target.name] for target in targets}


def _in_turn(targets: Sequence[Target], jobs: int) -> list[Target]:
    """Return the targets in the order in which they begin: the longest first, since it ends last.

    If several processes have more targets than they can begin at once, the shortest begins beside it: its results come soon.
    """
    order = sorted(targets, key=_size, reverse=True)
    return order if len(order) <= jobs or jobs == 1 else [order[-1], *order[:-1]]


def _size(target: Target) -> int:
    """Estimate the work on a target: its number of findings times that of its state variables."""
    return expected(target) * len(target.system.state)


def _found_before(
    store: Store | None, questions: Mapping[Target, Asked], on_event: OnEvent
) -> Iterator[tuple[str, list[Finding]]]:
    """Yield the findings of unchanged targets, by name."""
    for target, question in questions.items():
        findings = found_before(store, question)
        if findings is not None:
            on_event(Kept(target.name, len(findings), findings[0].kept_since if findings else ""))
            yield target.name, findings


def _conducted(
    waiting: Sequence[Target], plan: Plan, jobs: int, slots: Slots, on_event: OnEvent
) -> Iterator[tuple[Target, Plain, float]]:
    """Yield each target with its findings as plain data and its seconds, when complete; at most `jobs` targets at a
    time.
    """
    left, running = list[_Conductor](), list[_Conductor]()
    if waiting:
        prepare()
    try:
        for target in waiting:
            left.append(_forked(target, plan, jobs, slots, [one.pipe for one in left]))
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


def _forked(target: Target, plan: Plan, jobs: int, slots: Slots, others: Sequence[Connection]) -> _Conductor:
    context = multiprocessing.get_context("fork")
    here, there = context.Pipe(duplex=True)
    process = context.Process(target=_conduct, args=(target, plan, jobs, slots, there, [*others, here]))
    process.start()
    there.close()
    return _Conductor(target, process, here)


def _received(one: _Conductor, on_event: OnEvent) -> Plain | None:
    """Pass on a message of a target's process, or return its findings when it is done; an error of it is raised here."""
    try:
        message: Any = one.pipe.recv()
    except EOFError:
        one.process.join()
        raise EngineError(
            f"{one.target.name}: its process ended with code {one.process.exitcode} before it was done."
        ) from None
    match message:
        case _Done(packed):
            one.process.join()
            one.pipe.close()
            return packed
        case _Failed(error):
            raise error
        case _:
            on_event(message)
            return None


# ------------------------------------------------------------------ in the conductor's process


def _conduct(
    target: Target, plan: Plan, jobs: int, slots: Slots, pipe: Connection, inherited: Sequence[Connection]
) -> None:
    """Verify one target as soon as the parent sends the start; every process that computes holds a slot, this one too.

    inherited  the parent's ends of pipes: closed here, so that this process notices when the parent is gone
    """
    collect_rarely()
    signal.signal(signal.SIGTERM, _leave)
    for one in inherited:
        one.close()
    try:
        pipe.recv()
    except (EOFError, KeyboardInterrupt):
        os._exit(1)
    slots.take()
    try:
        with sharing(slots), suppress(BrokenPipeError):
            pipe.send(_verified(target, plan, jobs, pipe))
    except KeyboardInterrupt:
        os._exit(1)
    finally:
        slots.give()
        pipe.close()


def _leave(*_: object) -> NoReturn:
    raise SystemExit(1)


def _verified(target: Target, plan: Plan, jobs: int, pipe: Connection) -> _Done | _Failed:
    def phase(text: str, _: int) -> None:
        pipe.send(Phase(target.name, text))

    def finding(one: Finding) -> None:
        pipe.send(Found(target.name, one.id, told(one.result), one.seconds))

    try:
        findings = Work(target, jobs, phase, finding).verified(plan)
        return _Done(pack_findings(findings, target.system))
    except SafelocError as error:
        return _Failed(error)
    except Exception as error:  # not swallowed: the parent raises it, but only this process knows its traceback
        traceback.print_exception(error)
        return _Failed(EngineError(f"{target.name}: {type(error).__name__}: {error}"))


def in_order(found: Mapping[str, Sequence[Finding]]) -> list[Finding]:
    """Return all findings of all targets, target by target."""
    return [finding for findings in found.values() for finding in findings]
