"""One target from its properties to its findings: proofs, obligations, property tests, replays of its recordings."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from pathlib import Path

from safeloc.errors import EngineError, SafelocError
from safeloc.language.spec import Property
from safeloc.language.verdict import Proved
from safeloc.proof.provers.antecedents import found
from safeloc.proof.provers.case_search import CaseSearch
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.obligations import CHECKS, Obliging, assumption_obligations, obligations, reaching
from safeloc.proof.provers.portfolio import OnFinding, Proving, prove, with_base
from safeloc.proof.provers.proved_base import Base
from safeloc.proof.provers.recorded_witnesses import Recording, Witnesses
from safeloc.proof.provers.workers import Lost, Queue, Task
from safeloc.proof.results import Finding
from safeloc.proof.testing import run_tests
from safeloc.proof.verification.other_figures import refused_recordings
from safeloc.proof.verification.plain import Plain, pack_findings, unpack_findings
from safeloc.proof.verification.replay import replay_stream, run_with_truth
from safeloc.proof.verification.unasked import as_left_open, left_open, nothing_asked
from safeloc.proof.verification.witness_files import read_witnesses
from safeloc.runtime.streams.gzipped import name_of
from safeloc.runtime.streams.steps import read_steps
from safeloc.target import Target

OnPhase = Callable[[str, int], None]
"""Callback for the start of a phase: its description, and the expected number of findings."""


_UNLIMITED_S = 1e9
"""Property tests end by themselves: their number is limited."""
ASSUMPTION_COUNT = 3
"""Number of the obligations of the assumption."""


@dataclass(frozen=True)
class Plan:
    """The effort for one target.

    limits    bounds of the provers, for each property
    examples  number of runs of the property tests
    steps     greatest length of one stretch of such a run
    seed      seed of these runs
    quick     property tests and recordings only: everything that needs a proof is left open, with the verdict "not asked"
    """

    limits: Limits
    examples: int
    steps: int
    seed: int
    quick: bool = False


@dataclass(frozen=True, eq=False)
class Work:
    """Verifies one target, in at most `jobs` processes at a time; calls `on_phase` and `on_finding` during the work."""

    target: Target
    jobs: int
    on_phase: OnPhase
    on_finding: OnFinding

    def verified(self, plan: Plan) -> list[Finding]:
        """Return all findings, in order: lemmas and properties, obligations, tests, replays.

        StreamError for a recording that the target cannot take, EngineError where solvers contradict each other.
        """
        replayed = list[Finding]()
        replays = [partial(self._replay, stream, replayed) for stream in self._streams]
        if plan.quick:
            findings = [*nothing_asked(self.target), *left_open(self.target), *self.tested(plan, ())]
            for replay in replays:
                replay()
        else:
            findings = [one for part in self._side_by_side(plan.limits, plan, replays) for one in part]
        return self._noted([*findings, *replayed])

    def _noted(self, findings: list[Finding]) -> list[Finding]:
        """Return the findings; the first one gets a note of the recordings that were left out."""
        left_out = [name_of(path) for path in self.target.streams if path not in self._streams]
        if not left_out:
            return findings
        note = {
            "recordings left out": f"{', '.join(left_out)}: recorded with figures that this configuration cannot take"
        }
        return [replace(findings[0], notes={**findings[0].notes, **note}), *findings[1:]]

    def _replay(self, stream: Path, findings: list[Finding]) -> None:
        """Replay a recording, and add the findings to these."""
        self.on_phase(f"replaying {stream.name}", len(self.target.properties))
        findings += self._announced(replay_stream(self.target, stream)[1])

    def proved_and_obliged(self, limits: Limits) -> tuple[list[Finding], list[Finding]]:
        """Prove lemmas, contracts, all properties and the obligations, side by side; return those, and the obligations."""
        proved, obliged, _ = self._side_by_side(limits, None)
        return proved, obliged

    def _side_by_side(
        self, limits: Limits, tests: Plan | None, meanwhile: Sequence[Callable[[], None]] = ()
    ) -> tuple[list[Finding], list[Finding], list[Finding]]:
        """Prove everything, and run the property tests of a plan as soon as the runs are known along which they start.

        meanwhile  what this process does when a processor is free
        """
        self.on_phase(
            f"proving {self.target.name}", claims(self.target, self.target.properties) + obligation_count(self.target)
        )
        asked = self._announced(nothing_asked(self.target))
        system, properties, queue = self.target.system, self.target.properties, Queue(self.jobs)
        recordings = self._recordings()
        cases = CaseSearch(system, properties, limits, recordings, self._witnesses)
        proving = Proving(system, properties, limits, cases, self.on_finding)
        obliging = Obliging(system, limits, cases, self.on_finding, recordings, self._witnesses)
        tested = list[Finding]()

        def begin(known: Base, seconds: float) -> None:
            cases.begin_search(queue)
            obliging.begin_search(queue)
            obliging.begin_assumption(queue)
            proving.begin(queue, known, seconds)
            obliging.begin_checks(queue)

        def test(plan: Plan) -> None:
            self.on_phase(f"testing {self.target.name}", len(properties))
            work = partial(self._tests_as_data, plan, obliging.reached)
            task = Task(f"{self.target.name}: property tests", work, _UNLIMITED_S)
            queue.add(task, lambda data, _: tested.extend(self._announced(self._received(data))), next_=True)

        with_base(queue, system, limits, begin)
        obliging.begin_known_runs(queue)
        cases.begin_known_runs(queue)
        if tests is not None:
            cases.when_known(lambda _: obliging.when_reached(partial(test, tests)))
        queue.do_meanwhile(meanwhile)
        queue.run()
        return [*asked, *proving.findings], obliging.findings, tested

    def _tests_as_data(self, plan: Plan, reached: Sequence[Finding]) -> Plain | SafelocError:
        """Return the findings of the property tests for another process, or the error that a recording is."""
        try:
            return pack_findings(self._tests(plan, reached), self.target.system)
        except SafelocError as error:
            return error

    def _received(self, data: Plain | SafelocError | Lost) -> list[Finding]:
        if isinstance(data, SafelocError):
            raise data
        if isinstance(data, Lost):
            raise EngineError(f"{self.target.name}: property tests: {data.reason}.")
        return unpack_findings(data, self.target.system)

    def proved(self, properties: Sequence[Property], limits: Limits) -> list[Finding]:
        """Prove lemmas, contracts and these properties."""
        self.on_phase(f"proving {self.target.name}", claims(self.target, properties))
        return prove(
            self.target.system,
            properties,
            limits,
            jobs=self.jobs,
            on_finding=self.on_finding,
            recordings=self._recordings(),
            witnesses=self._witnesses,
        )

    def obliged(self, limits: Limits) -> list[Finding]:
        """Prove the obligations that every machine has without any declared property."""
        self.on_phase(f"obligations of {self.target.name}", obligation_count(self.target))
        return obligations(
            self.target.system,
            limits,
            jobs=self.jobs,
            on_finding=self.on_finding,
            recordings=self._recordings(),
            witnesses=self._witnesses,
            properties=self.target.properties,
        )

    def assumption_kept(self, limits: Limits) -> list[Finding]:
        """Prove that the assumption can be kept: the obligations without which a proof under it may be empty."""
        self.on_phase(f"assumption of {self.target.name}", ASSUMPTION_COUNT)
        return assumption_obligations(
            self.target.system, limits, jobs=self.jobs, on_finding=self.on_finding, recordings=self._recordings()
        )

    def tested(self, plan: Plan, obliged: Sequence[Finding]) -> list[Finding]:
        """Run the property tests, given the findings of the obligations.

        Runs also start along witnesses and shipped streams, so that deep modes and cases are tested.
        """
        self.on_phase(f"testing {self.target.name}", len(self.target.properties))
        return self._announced(self._tests(plan, reaching(self.target.system, obliged)))

    def _tests(self, plan: Plan, reached: Sequence[Finding]) -> list[Finding]:
        """Run the property tests, given the findings about modes and transitions."""
        system, properties = self.target.system, self.target.properties
        shown = [one.result.witness for one in reached if isinstance(one.result, Proved)]
        witnesses = [
            run for run in shown if run is not None and not run.system.composition
        ]  # of the composition, not of one machine alone
        streams = [run_with_truth(self.target, path) for path in self._streams]
        corpus = [run for run in (*witnesses, *found(system, properties).runs(), *streams) if run is not None]
        tests = run_tests(system, properties, examples=plan.examples, steps=plan.steps, seed=plan.seed, corpus=corpus)
        return list(map(as_left_open, tests)) if plan.quick else tests

    @cached_property
    def _streams(self) -> tuple[Path, ...]:
        """The recordings of the target, but for those of other figures that the machine cannot take; each of these is announced."""
        refused = refused_recordings(self.target)
        for path, why in refused.items():
            self.on_phase(f"leaving out {name_of(path)}, recorded with other figures: {why}", 0)
        return tuple(path for path in self.target.streams if path not in refused)

    @cached_property
    def _witnesses(self) -> Witnesses:
        return read_witnesses(self.target.witnesses)

    def _recordings(self) -> list[Recording]:
        return [Recording(stream.first, stream.steps) for stream in map(read_steps, self._streams)]

    def _announced(self, findings: list[Finding]) -> list[Finding]:
        for one in findings:
            self.on_finding(one)
        return findings


def claims(target: Target, properties: Sequence[Property]) -> int:
    """Estimate the number of findings from proving these properties and all lemmas."""
    return len(properties) + sum(len(machine.lemmas) for machine in target.machines)


def obligation_count(target: Target) -> int:
    """Estimate the number of obligations: one of each kind, and one for each mode and transition."""
    return len(CHECKS) + 1 + sum(len(machine.modes) + len(machine.transitions) for machine in target.machines)


def expected(target: Target) -> int:
    """Estimate the number of findings of all phases."""
    tests, replays = len(target.properties), len(target.streams) * len(target.properties)
    return claims(target, target.properties) + obligation_count(target) + tests + replays
