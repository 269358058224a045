"""A machine inside a host's controller (MRK-2, RFL-13): one call and one report per cycle.

    controller = Controller(load_target("odometry"))
    report = controller.step(records)      # the records of all devices in this cycle
    report.interval, report.mode, report.rejections

A controller has no clock: cycle n ends at `start_ms + n period_ms` on the clock of the records, and each call is one cycle,
even without records. There is no global state, and memory is bounded. Calls from several threads are processed one after
the other.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Mapping
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
from safeloc.runtime.embedding.readable_records import checked_inputs, readable
from safeloc.runtime.embedding.report import Report
from safeloc.runtime.embedding.row_layout import Placed
from safeloc.runtime.embedding.watch import Watch
from safeloc.runtime.streams.cycles import Cycle, CycleBuilder
from safeloc.runtime.streams.records import Record, Unusable
from safeloc.target import Target

_ANOTHER = "make a new controller of the same program, and restore this one's snapshot in it."

EVERY = "*"
"""The channel of a fault that concerns every channel of the cycle."""

MOST_RECORDS = 1_000
"""Most records of one cycle; with more, none of them is used, so that a flood of records cannot fill the memory."""


class Controller:
    """One vehicle's machine, cycle by cycle.

    period_ms  length of a cycle; by default the configuration's
    start_ms   start of the first cycle, on the clock of the records
    expected   channel -> number of its records per cycle; a channel with fewer gives no input
    first      values of state variables declared ANY
    assumptions  check the observable laws of the worlds in each cycle (docs/evidence.md) and put breaches into the report;
               the machine does the same in any case

    It cannot be copied: two controllers with the same history would both be wrong. Use `snapshot` and `restore` instead.

    InputError if `program` is no program or target, if the period is missing, below 1 ms or not that of the configuration,
    if a start or a count is no whole number, and for a wrong `first`.
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
        self._alone = _Alone(self, self._lock)
        self._halted = ""
        self._listeners = Listeners(self.program)
        self._report = self._now()

    # ------------------------------------------------------------------ one cycle

    def step(self, records: Iterable[Record | Unusable], *, lost: str = "") -> Report:
        """Run one cycle with its records, in the order of arrival.

        lost   the reason why data of this cycle may be missing (a queue overflowed, a line was cut); "" if none is. Then no
               record of the cycle is used, since the rest could be half a distance.

        Each record is used, or listed in `rejections` with its place in `records` (from 0). InputError for an object that is
        no record; the controller is then unchanged. Exceptions of listeners are raised as one ExceptionGroup after the step.
        """
        taken = _listed(records)
        in_words("lost", lost)
        with self._alone:
            if len(taken) > MOST_RECORDS:
                lost = lost or f"more than {MOST_RECORDS} records in one cycle"
            for number, record in enumerate(taken[:MOST_RECORDS]):
                known = readable(self.program, number, record)
                if isinstance(known, Fault):
                    self._builder.refuse(known)
                else:
                    fault = self._builder.take(number, known)
                    if fault is not None and fault.reason is Reason.STALE and self._watch is not None:
                        self._watch.late(known, self._builder.deliveries.last)
            cycle = self._builder.close()
            inputs = {} if lost else self.program.placed(cycle.inputs)
            return self._moved(cycle, inputs, _with_loss(cycle.faults, lost), cycle.remarks.get("truth_mm"))

    def step_inputs(self, inputs: Mapping[str, object], *, lost: str = "", truth_mm: int | None = None) -> Report:
        """Run one cycle with the machine's inputs by name, for a host that validates its measurements itself.

        truth_mm   the true position, if a simulation or survey knows it: for the report, not for the machine

        Optional inputs that are left out (or None) are absent. If a value has a wrong type or is out of range, it is refused
        with a reason, and no other value of the cycle is used: half a reading may mean something else.
        InputError for a name that the machine does not have; the controller is then unchanged. InputError, with what was refused, if the
        controller has to halt (`halted`).
        """
        self.program.require_known(a_mapping("inputs", inputs))
        in_words("lost", lost)
        if truth_mm is not None and type(truth_mm) is not int:
            raise InputError(f"truth_mm is {truth_mm!r}; give whole mm, or leave it out.")
        with self._alone:
            placed, faults = checked_inputs(self.program, inputs)
            refused = _with_loss(tuple(faults), lost)
            return self._moved(self._builder.close(), {} if refused else placed, refused, truth_mm)

    def begin_anew(self, reason: str, start_ms: int | None = None) -> Report:
        """Discard the position and restart from the initial state.

        start_ms   start of the next cycle; by default the cycles continue

        InputError if the initial state makes a claim about the world: only the host can know whether the claim is true, and
        then makes a new controller.
        """
        if not in_words("reason", reason):
            raise InputError("reason is empty; give the reason for the restart in words.")
        with self._alone:
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

        It stops if a mandatory input is missing, the machine does not tolerate a step without inputs, and the initial state
        makes a claim about the world: then neither continuing nor restarting would be sound.
        """
        return self._halted

    @property
    def may_begin_anew(self) -> bool:
        """True if the initial state makes no claim about the world, so that a restart is safe."""
        return self.program.quiet(self._first)

    # ------------------------------------------------------------------ listeners

    def listen(self, listener: Callable[[Report], object]) -> None:
        """Add a listener. It is called with each report, in the thread that steps, before the step returns; it must not step."""
        with self._lock:
            self._listeners.add(listener)

    def follow(self, model: object, machine: str | None = None) -> Follower:
        """Make the host's object a state machine (package `transitions`) that follows the modes.

        Its callbacks `on_enter_<mode>` and `on_exit_<mode>` are called when the mode changes; `event.kwargs["report"]` is the
        report. `machine` names one of several machines. InputError if the object already has an attribute of a name that is
        needed, and for callbacks that would have to be awaited.
        """
        with self._lock:
            return self._listeners.follow(model, machine, self._report.modes)

    # ------------------------------------------------------------------ snapshots

    def snapshot(self) -> bytes:
        """Return the complete memory between cycles, as one line of JSON with a checksum."""
        return self.freeze()()

    def freeze(self) -> Callable[[], bytes]:
        """Capture the memory within microseconds; return a function that makes the snapshot later, also in another thread."""
        with self._lock:
            builder = self._builder
            deliveries, observed = dict(builder.deliveries.last), None if self._watch is None else self._watch.observed
            content = memory.Content(builder.start_ms, builder.done, deliveries, self._state, self._halted, observed)
        return partial(memory.snapshot, self.program, self.setting, content)

    def restore(self, data: bytes) -> Report:
        """Continue from a snapshot. The host then has to make one call for each cycle since the snapshot.

        SnapshotError for a snapshot that is damaged, newer than this version, or of another machine, configuration, period,
        expectation or first state; the controller is then unchanged. No listener is called.
        """
        content = memory.restored(self.program, self.setting, data)
        with self._alone:
            deliveries = Deliveries()
            deliveries.last = dict(content.deliveries)
            self._builder = self._building(content.start_ms, content.done, deliveries)
            self._state, self._halted = content.state, content.halted
            if self._watch is not None:
                self._watch.restore(content.observed)
            self._report = self._now()
            self._listeners.place(self._report.modes)
            return self._report

    def __copy__(self) -> NoReturn:
        raise NotCopiedError(f"{self.program.name}: a controller cannot be copied; {_ANOTHER}")

    def __deepcopy__(self, _memo: object) -> NoReturn:
        self.__copy__()

    def __reduce_ex__(self, _protocol: object) -> NoReturn:
        raise NotCopiedError(f"{self.program.name}: a controller cannot be pickled; {_ANOTHER}")

    # ------------------------------------------------------------------ inside

    def _building(self, start_ms: int, done: int = 0, deliveries: Deliveries | None = None) -> CycleBuilder:
        if type(start_ms) is not int or start_ms < 0:  # with NaN, every record would count as in time
            raise InputError(f"start_ms is {start_ms!r}; give whole ms of the records' clock, from 0.")
        period_ms, expected = self.setting.period_ms, self.setting.expected
        return CycleBuilder(
            period_ms, start_ms=start_ms, channels=self.program.channels, expected=expected, done=done,
            places=self.program.places, deliveries=deliveries,
        )  # fmt: skip

    def _moved(self, cycle: Cycle, inputs: Placed, faults: tuple[Fault, ...], truth_mm: int | None) -> Report:
        inputs, incomplete = self.program.complete(inputs)
        faults = (*faults, *incomplete)
        needed = self.program.missing(inputs)
        if needed:
            return self._without(cycle, faults, f"input {needed[0]} is missing{_first_refused(faults)}")
        row = self.program.row(inputs)
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
        """Return a report of the present state, without transitions and rejections."""
        builder = self._builder
        return self.program.report(self._state, (), builder.done, builder.end_ms - builder.period_ms, (), "", None)


class _Alone:
    """Entered by one call at a time, from whatever thread; InputError in a listener's call, and if the controller has halted."""

    def __init__(self, controller: Controller, lock: threading.RLock) -> None:
        self._controller, self._lock, self._busy = controller, lock, False

    def __enter__(self) -> None:
        self._lock.acquire()
        why = ""
        if self._busy:
            why = "a listener must not step its own controller; make the call after the step has returned."
        elif self._controller.halted:
            name = self._controller.program.name
            why = f"{name} has halted: {self._controller.halted}. Make a new controller."
        if why:
            self._lock.release()
            raise InputError(why)
        self._busy = True

    def __exit__(self, *_raised: object) -> None:
        self._busy = False
        self._lock.release()


KINDS = frozenset((*get_args(Record), Unusable))


def _listed(records: Iterable[Record | Unusable]) -> list[Record | Unusable]:
    """Return the records, but at most one more than a cycle may have; InputError for an object that is no record."""
    if not isinstance(records, Iterable):
        raise InputError(f"expected records (safeloc.runtime.streams.records), got {type(records).__name__}.")
    taken = list(islice(records, MOST_RECORDS + 1))
    for record in taken:
        if type(record) not in KINDS:
            raise InputError(f"expected records (safeloc.runtime.streams.records), got {type(record).__name__}.")
    return taken


def _first_refused(faults: tuple[Fault, ...]) -> str:
    """Return in words what was refused first in a cycle; empty if nothing was delivered that could be refused."""
    first = next((fault for fault in faults if fault.reason is not Reason.MISSING), None)
    if first is None:
        return ""
    told = first.detail.rstrip(".").removeprefix(f"{first.channel}: ") or first.reason.value
    return f"; {first.channel} was refused: {told}"


def _with_loss(faults: tuple[Fault, ...], lost: str) -> tuple[Fault, ...]:
    return (*faults, Fault(EVERY, Reason.LOST, lost)) if lost else faults
