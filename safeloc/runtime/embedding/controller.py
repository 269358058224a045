"""A machine inside a host's controller (MRK-2, RFL-13): one call a cycle, one report back.

    controller = Controller(load_target("odometry"))
    report = controller.step(records)      # the records of all devices in this cycle
    report.interval, report.mode, report.rejections

A controller has no clock: cycle n ends at `start_ms + n period_ms` of the records' own clock, and each call is one cycle,
also one without records. It has no global state, and its memory is bounded. Calls from several threads
are taken one after the other.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from itertools import islice
from typing import NoReturn, get_args

from safeloc.codegen.compiled import Row
from safeloc.errors import InputError
from safeloc.language.nodes import Value
from safeloc.runtime.border import Deliveries, Fault, Reason
from safeloc.runtime.embedding import memory
from safeloc.runtime.embedding.arguments import NotCopiedError, a_mapping, as_expected, as_program, in_words, period_of
from safeloc.runtime.embedding.follower import Follower
from safeloc.runtime.embedding.listeners import Listeners
from safeloc.runtime.embedding.program import Program
from safeloc.runtime.embedding.readable_records import judged, stated
from safeloc.runtime.embedding.report import Report
from safeloc.runtime.embedding.row_layout import Told
from safeloc.runtime.embedding.watch import Watch
from safeloc.runtime.streams.cycles import Cycle, CycleBuilder
from safeloc.runtime.streams.records import Record, Unusable
from safeloc.target import Target

ANOTHER = "make a new one of the same program, and restore this one's snapshot in it."

EVERY = "*"
"""The channel of a fault that concerns every channel of the cycle."""

MOST_RECORDS = 1_000
"""Records taken in one cycle; with more, the cycle is doubtful as a whole: a flood must not fill the memory."""


class Controller:
    """One vehicle's machine, cycle by cycle.

    period_ms  length of a cycle; by default the configuration's
    start_ms   start of the first cycle, on the clock of the records
    expected   channel -> number of its records per cycle; a channel with fewer gives no input
    first      values of state variables declared ANY
    assumptions  judge the observable laws of the worlds in each cycle (docs/evidence.md). It changes nothing that the
               machine does: a breach stands in the report

    It cannot be copied: two controllers with the same history would both be wrong. Use `snapshot` and `restore` instead.

    InputError for what is no program or target, a period that is missing, below 1 ms or another than the configuration's,
    a start or a count that is no whole number, and for a wrong `first`.
    """

    def __init__(
        self,
        program: Program | Target,
        *,
        period_ms: int | None = None,
        start_ms: int = 0,
        expected: Mapping[str, int] | None = None,
        first: Mapping[str, Value] | None = None,
        assumptions: bool = False,
    ) -> None:
        self.program = as_program(program)
        first = a_mapping("first", first)
        self.setting = memory.Setting(period_of(self.program, period_ms), as_expected(expected), first)
        self._first = self._state = self.program.first(first)
        self._builder = self._building(start_ms)
        self._watch = Watch(self.program, self.setting.period_ms) if assumptions else None
        self._lock = threading.RLock()
        self._busy = False
        self._halted = ""
        self._listeners = Listeners(self.program)
        self._report = self._now()

    # ------------------------------------------------------------------ one cycle

    def step(self, records: Iterable[Record | Unusable], *, lost: str = "") -> Report:
        """Run one cycle with its records, in the order of arrival.

        lost   why something of this cycle may be missing (a queue ran over, a line was cut); "" if nothing is. What is
               left could be half a distance, so nothing of the cycle is used then.

        Every record is used, or is in `rejections` with its place in `records` (from 0). InputError for what is no
        record; nothing has happened then. Exceptions of listeners come out as one ExceptionGroup after the step.
        """
        taken = _listed(records)
        in_words("lost", lost)
        with self._alone():
            if len(taken) > MOST_RECORDS:
                lost = lost or f"more than {MOST_RECORDS} records in one cycle"
            for number, record in enumerate(taken[:MOST_RECORDS]):
                known = judged(self.program, number, record)
                if isinstance(known, Fault):
                    self._builder.refuse(known)
                else:
                    fault = self._builder.take(number, known)
                    if fault is not None and fault.reason is Reason.STALE and self._watch is not None:
                        self._watch.late(known, self._builder.deliveries.last)
            cycle = self._builder.close()
            told = {} if lost else self.program.told(cycle.inputs)
            return self._moved(cycle, told, _with_loss(cycle.faults, lost), cycle.remarks.get("truth_mm"))

    def step_inputs(self, inputs: Mapping[str, object], *, lost: str = "", truth_mm: int | None = None) -> Report:
        """Run one cycle with the machine's inputs by name, for a host that validates its measurements itself.

        truth_mm   the true position, if a simulation or survey knows it: for the report, not for the machine

        Optional inputs that are left out (or None) are missing. A value of a wrong kind or out of range is refused
        with its reason, and then nothing else of the cycle is used: half a reading may mean something else.
        InputError for a name that the machine does not have; nothing has happened then.
        """
        self.program.require_known(a_mapping("inputs", inputs))
        in_words("lost", lost)
        if truth_mm is not None and type(truth_mm) is not int:
            raise InputError(f"truth_mm is {truth_mm!r}; give whole mm, or leave it out.")
        with self._alone():
            told, faults = stated(self.program, inputs)
            refused = _with_loss(tuple(faults), lost)
            return self._moved(self._builder.close(), {} if refused else told, refused, truth_mm)

    def begin_anew(self, reason: str, start_ms: int | None = None) -> Report:
        """Discard the position and start from the initial state; `start_ms` is the start of the next cycle, by default at
        once.

        InputError if the machine's initial state makes a claim about the world. Only the host can know whether it is true;
        it then makes a new controller.
        """
        if not in_words("reason", reason):
            raise InputError("reason is empty; give the reason for the restart in words.")
        with self._alone():
            self._require_quiet(reason)
            if start_ms is not None:
                self._builder = self._building(start_ms)
            self._state = self._first
            breaches = () if self._watch is None else self._watch.begin_anew()
            return self._become(self._first, replace(self._now(), anew=reason, breaches=breaches))

    @property
    def report(self) -> Report:
        """The report of the last cycle."""
        with self._lock:
            return self._report

    @property
    def next_end_ms(self) -> int:
        """The end of the open cycle, on the clock of the records."""
        return self._builder.end_ms

    @property
    def halted(self) -> str:
        """The reason why this controller has stopped; "" while it runs.

        It stops if a mandatory input is missing, the machine does not tolerate a step without inputs, and its initial state
        makes a claim about the world: neither continuing nor a restart would be sound.
        """
        return self._halted

    @property
    def may_begin_anew(self) -> bool:
        """True if the initial state makes no claim about the world, so that a restart is safe."""
        return self.program.quiet(self._first)

    # ------------------------------------------------------------------ who is told

    def listen(self, listener: Callable[[Report], object]) -> None:
        """Call it with each report, in the thread that steps, before the step returns. It must not step."""
        with self._lock:
            self._listeners.add(listener)

    def follow(self, model: object, machine: str | None = None) -> Follower:
        """Make the host's object a state machine (package `transitions`) that follows the modes.

        Its callbacks `on_enter_<mode>` and `on_exit_<mode>` are called when the mode changes; they find the report
        in `event.kwargs["report"]`. `machine` says which one of several. InputError for attributes in the way, and for
        callbacks that would have to be awaited.
        """
        with self._lock:
            return self._listeners.follow(model, machine, self._report.modes)

    # ------------------------------------------------------------------ remembering

    def snapshot(self) -> bytes:
        """Return all that is remembered between cycles, as one line of JSON with a checksum."""
        return self.freeze()()

    def freeze(self) -> Callable[[], bytes]:
        """Capture the state in microseconds; return a function that makes the snapshot later, also in another thread."""
        with self._lock:
            builder = self._builder
            deliveries, observed = dict(builder.deliveries.last), None if self._watch is None else self._watch.observed
            kept = memory.Kept(builder.start_ms, builder.done, deliveries, self._state, self._halted, observed)
        return partial(memory.snapshot, self.program, self.setting, kept)

    def restore(self, data: bytes) -> Report:
        """Go on where the snapshot was taken; what was missed since is for the host to step, cycle by cycle.

        SnapshotError where it is damaged, newer than this version, or of another machine, configuration, period,
        expectation or first state; nothing has changed then. No listener is called.
        """
        kept = memory.restored(self.program, self.setting, data)
        with self._alone():
            deliveries = Deliveries()
            deliveries.last = dict(kept.deliveries)
            self._builder = self._building(kept.start_ms, kept.done, deliveries)
            self._state, self._halted = kept.state, kept.halted
            if self._watch is not None:
                self._watch.restore(kept.observed)
            self._report = self._now()
            self._listeners.place(self._report.modes)
            return self._report

    def __copy__(self) -> NoReturn:
        raise NotCopiedError(f"{self.program.name}: a controller is not copied; {ANOTHER}")

    def __deepcopy__(self, _memo: object) -> NoReturn:
        self.__copy__()

    def __reduce_ex__(self, _protocol: object) -> NoReturn:
        raise NotCopiedError(f"{self.program.name}: a controller is not pickled; {ANOTHER}")

    # ------------------------------------------------------------------ inside

    @contextmanager
    def _alone(self) -> Iterator[None]:
        with self._lock:
            if self._busy:
                raise InputError(
                    "a listener must not step its own controller; note what is to be done, and do it later."
                )
            if self._halted:
                raise InputError(f"{self.program.name} has halted: {self._halted}. Make a new controller.")
            self._busy = True
            try:
                yield
            finally:
                self._busy = False

    def _building(self, start_ms: int, done: int = 0, deliveries: Deliveries | None = None) -> CycleBuilder:
        if type(start_ms) is not int or start_ms < 0:  # NaN is later than nothing: every record would be in time
            raise InputError(f"start_ms is {start_ms!r}; give whole ms of the records' clock, from 0.")
        period_ms, expected = self.setting.period_ms, self.setting.expected
        return CycleBuilder(
            period_ms, start_ms=start_ms, channels=self.program.channels, expected=expected, done=done,
            places=self.program.places, deliveries=deliveries,
        )  # fmt: skip

    def _moved(self, cycle: Cycle, told: Told, faults: tuple[Fault, ...], truth_mm: int | None) -> Report:
        told, unheard = self.program.heard(told)
        faults = (*faults, *unheard)
        needed = self.program.missing(told)
        if needed:
            return self._without(cycle, faults, f"input {needed[0]} is missing")
        row = self.program.row(told)
        after, fired = self.program.code.step(self._state, row)
        moves = self.program.moves(fired, self._state, after)
        breaches = () if self._watch is None else self._watch.judge(self._state, row, after)
        report = self.program.report(after, moves, cycle.number, cycle.end_ms, faults, "", truth_mm, breaches)
        return self._become(after, report)

    def _without(self, cycle: Cycle, faults: tuple[Fault, ...], reason: str) -> Report:
        """Handle a cycle without a mandatory input: restart the machine, or halt it if its initial state makes a claim."""
        try:
            self._require_quiet(reason)
        except InputError as error:
            self._halted = reason
            raise error from None
        breaches = () if self._watch is None else self._watch.begin_anew()
        report = self.program.report(self._first, (), cycle.number, cycle.end_ms, faults, reason, None, breaches)
        return self._become(self._first, report)

    def _require_quiet(self, reason: str) -> None:
        if not self.program.quiet(self._first):
            raise InputError(
                f"{self.program.name} cannot restart by itself ({reason}): its initial state makes a claim about the "
                "world. Make a new controller when that claim is true."
            )

    def _become(self, after: Row, report: Report) -> Report:
        self._state, self._report = after, report
        self._listeners.tell(report)
        return report

    def _now(self) -> Report:
        """The state as it is, with nothing having happened."""
        builder = self._builder
        return self.program.report(self._state, (), builder.done, builder.end_ms - builder.period_ms, (), "", None)


KINDS = frozenset((*get_args(Record), Unusable))


def _listed(records: Iterable[Record | Unusable]) -> list[Record | Unusable]:
    """At most one more than is taken, so that a flood shows without being held."""
    if not isinstance(records, Iterable):
        raise InputError(f"expected records (safeloc.runtime.streams.records), got {type(records).__name__}.")
    taken = list(islice(records, MOST_RECORDS + 1))
    for record in taken:
        if type(record) not in KINDS:
            raise InputError(f"expected records (safeloc.runtime.streams.records), got {type(record).__name__}.")
    return taken


def _with_loss(faults: tuple[Fault, ...], lost: str) -> tuple[Fault, ...]:
    return (*faults, Fault(EVERY, Reason.LOST, lost)) if lost else faults
