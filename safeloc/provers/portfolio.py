"""All engines together: k-induction first, then search for a violation, then Spacer; several properties in parallel.

A property that hangs its solver is ended by the clock: each one has a process of its own.
"""

from __future__ import annotations

import multiprocessing
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection, wait
from typing import Any, assert_never

from safeloc.errors import EngineError
from safeloc.expr import Value
from safeloc.provers.base import base
from safeloc.provers.bmc import Exhausted, bmc, search
from safeloc.provers.evidence import confirmed
from safeloc.provers.falsify import falsify
from safeloc.provers.kinduction import kinduction
from safeloc.provers.limits import Limits
from safeloc.provers.spacer import spacer
from safeloc.results import Finding
from safeloc.spec import Goal, Property, observe
from safeloc.system import TransitionSystem
from safeloc.verdict import Proved, Unknown, Verdict, Violated

GRACE_SECONDS = 30.0
OnFinding = Callable[[Finding], None]


def prove_one(goal: Goal, limits: Limits) -> Verdict:
    """The verdict of the first engine that decides. EngineError if engines contradict each other."""
    if goal.prop.kind == "reachable":
        return _reach(goal, limits)
    proof = kinduction(goal, limits)
    if isinstance(proof, Proved):
        return proof
    third = replace(limits, seconds=limits.seconds / 3)
    for engine in (bmc, falsify, spacer):
        verdict = engine(goal, third)
        if not isinstance(verdict, Unknown):
            return verdict
        proof = verdict if verdict.depth > proof.depth else proof
    return Unknown(f"{proof.reason}; no engine decided within {limits.seconds:g} s", proof.depth)


def _reach(goal: Goal, limits: Limits) -> Verdict:
    """A witness, or a proof that there is none."""
    found = search(goal, limits)
    if not isinstance(found, Exhausted):
        return Proved(None, "bmc", len(found.steps), ("interpreter",), witness=found)
    never = kinduction(goal, limits)
    if isinstance(never, Proved):
        return Violated(None, never.engine, "no run comes there: proved by induction")
    return Unknown(found.reason, found.depth)


def prove(
    system: TransitionSystem,
    properties: Sequence[Property],
    limits: Limits,
    *,
    jobs: int = 1,
    on_finding: OnFinding | None = None,
) -> list[Finding]:
    """A Finding for every declared lemma and every property, in order.

    The base (ranges, lemmas) is proved first and shared. `jobs` processes work on the properties.
    """
    started = time.monotonic()
    known = base(system, seconds=limits.seconds)
    findings = [*_lemma_findings(system, time.monotonic() - started)]
    for finding in findings:
        _tell(on_finding, finding)
    goals = [observe(system, prop) for prop in properties]
    del known
    by_index: dict[int, Finding] = {}
    for index, verdict, seconds in _verdicts(goals, limits, jobs):
        by_index[index] = _finding(goals[index], verdict, seconds)
        _tell(on_finding, by_index[index])
    return [*findings, *(by_index[index] for index in range(len(goals)))]


def _tell(on_finding: OnFinding | None, finding: Finding) -> None:
    if on_finding is not None:
        on_finding(finding)


def _lemma_findings(system: TransitionSystem, seconds: float) -> Iterator[Finding]:
    known = base(system)
    for name, term in system.lemmas.items():
        proved = Proved(term, "1-induction", 1, ("cvc5",), known.certificates)
        result = (
            proved if name in known.facts or name in known.always else Unknown(f"lemma not used: {known.refuted[name]}")
        )
        reach = "for all inputs in range" if name in known.always else "under the assumption"
        yield Finding(
            f"{system.name}/lemma/{name}",
            system.name,
            "lemma",
            name,
            result,
            f"1-induction, all lemmas together, {reach}",
            seconds,
        )


def _finding(goal: Goal, verdict: Verdict, seconds: float) -> Finding:
    prop = goal.prop
    return Finding(
        f"{goal.original.name}/property/{prop.name}",
        goal.original.name,
        "property",
        prop.statement,
        verdict,
        _method(verdict),
        seconds,
        prop.trace,
        prop.assumption,
    )


def _method(verdict: Verdict) -> str:
    match verdict:
        case Proved(engine=engine, rechecked=rechecked):
            return f"{engine}, re-checked by {' and '.join(rechecked)}"
        case Violated(engine=engine):
            return f"{engine}, replayed in the interpreter"
        case Unknown():
            return "k-induction, bounded search, falsifiers, Spacer"
        case _:
            assert_never(verdict)


# ------------------------------------------------------------------ processes


@dataclass
class _Worker:
    index: int
    process: Any
    pipe: Connection
    started: float


def _verdicts(goals: Sequence[Goal], limits: Limits, jobs: int) -> Iterator[tuple[int, Verdict, float]]:
    """Verdicts as they come, each from a process of its own."""
    context = multiprocessing.get_context("fork")
    waiting, running = list(range(len(goals))), list[_Worker]()
    while waiting or running:
        while waiting and len(running) < max(1, jobs):
            index = waiting.pop(0)
            here, there = context.Pipe(duplex=False)
            process = context.Process(target=_work, args=(goals[index], limits, there), daemon=True)
            process.start()
            there.close()
            running.append(_Worker(index, process, here, time.monotonic()))
        wait([worker.pipe for worker in running], timeout=1.0)
        for worker in list(running):
            verdict = _collected(worker, goals[worker.index], limits)
            if verdict is not None:
                running.remove(worker)
                yield worker.index, verdict, time.monotonic() - worker.started


def _collected(worker: _Worker, goal: Goal, limits: Limits) -> Verdict | None:
    """The worker's verdict, if it has one; a worker that is out of time is ended and its goal is Unknown."""
    if worker.pipe.poll():
        try:
            packed = worker.pipe.recv()
        except EOFError:
            worker.process.join()
            return Unknown(f"the prover's process ended with code {worker.process.exitcode}")
        worker.process.join()
        return _unpack(packed, goal)
    if time.monotonic() - worker.started > 3 * limits.seconds + GRACE_SECONDS:
        worker.process.kill()
        worker.process.join()
        return Unknown(f"ended by the clock after {3 * limits.seconds + GRACE_SECONDS:g} s")
    return None


def _work(goal: Goal, limits: Limits, pipe: Connection) -> None:
    try:
        pipe.send(_pack(prove_one(goal, limits)))
    except Exception as error:  # handed over to the parent, which raises it
        pipe.send({"error": f"{type(error).__name__}: {error}"})
    finally:
        pipe.close()


def _pack(verdict: Verdict) -> dict[str, Any]:
    """Plain data only: terms are graphs too deep to be sent."""
    match verdict:
        case Proved():
            plain = {"engine": verdict.engine, "depth": verdict.depth, "rechecked": verdict.rechecked}
            run = None if verdict.witness is None else _run(verdict)
            return {"word": "proved", **plain, "certificates": dict(verdict.certificates), "run": run}
        case Violated(trace, engine, reason):
            run = None if trace is None else (dict(trace.initial), [dict(step.inputs) for step in trace.steps])
            return {"word": "violated", "engine": engine, "reason": reason, "run": run}
        case Unknown(reason, depth):
            return {"word": "unknown", "reason": reason, "depth": depth}
        case _:
            assert_never(verdict)


def _run(verdict: Proved) -> tuple[dict[str, Value], list[dict[str, Value]]]:
    assert verdict.witness is not None
    return dict(verdict.witness.initial), [dict(step.inputs) for step in verdict.witness.steps]


def _unpack(data: Mapping[str, Any], goal: Goal) -> Verdict:
    if "error" in data:
        raise EngineError(f"{goal.original.name}: {goal.prop.name}: {data['error']}")
    run = data.get("run")
    trace = None if run is None else confirmed(goal, run[0], run[1], data["engine"])
    match data["word"]:
        case "proved":
            return Proved(
                goal.good if trace is None else None, data["engine"], data["depth"], data["rechecked"],
                data["certificates"], trace,
            )  # fmt: skip
        case "violated":
            return Violated(trace, data["engine"], data["reason"])
        case _:
            return Unknown(data["reason"], data["depth"])
