"""Two processes ask a question only once; the one that waits has given its slot back, and its clock stands still."""

from __future__ import annotations

import multiprocessing
import signal
import sys
import time
from multiprocessing.connection import Connection
from pathlib import Path

from safeloc.codegen.smtlib import Query, to_smtlib
from safeloc.language.expr import number
from safeloc.language.units import COUNT
from safeloc.proof.cache.answers import keep_proved, kept_in
from safeloc.proof.cache.store import Store
from safeloc.proof.provers import implication
from safeloc.proof.provers.implication import unproved
from safeloc.proof.provers.limits import CLOCK, clock_stopped, deadline
from safeloc.proof.provers.once import alone_in_asking
from safeloc.proof.provers.recheck import certify
from safeloc.proof.provers.slots import Slots, sharing

FORK = multiprocessing.get_context("fork")
X = number("x", COUNT, 0, 100)
QUESTION = Query("q", [X > 5], {"goal": X > 4})
TEXT = to_smtlib(QUESTION)


def ask(places: Slots, pipe: Connection) -> None:
    """Ask both solvers, with a slot; return the number of questions to z3, and whether all goals follow."""
    asked = list[str]()
    ours = implication._failures

    def counted(query: Query[str], seconds: float, seed: int) -> object:
        asked.append(query.name)
        return ours(query, seconds, seed)

    implication._failures = counted  # type: ignore[assignment]  # in this process only
    places.take()
    with sharing(places):
        pipe.send("ready")
        proved = unproved(QUESTION, 10) == {} and certify(QUESTION, seconds=10).undecided == ()
    places.give()
    pipe.send((asked, proved))


def test_who_waits_gives_its_place_and_asks_nothing(tmp_path: Path) -> None:
    """The slot is free during the wait; then the answer is in the cache, and the process holds a slot until it ends."""
    places = Slots(1)
    here, there = FORK.Pipe()
    with kept_in(Store(tmp_path)):
        with alone_in_asking("z3", TEXT):
            other = FORK.Process(target=ask, args=(places, there))
            other.start()
            assert here.recv() == "ready"
            places.take()  # comes back only from a process that waits for the turn
            keep_proved(TEXT)
        assert not here.poll(0.2)  # its place is still taken
        places.give()
        assert here.recv() == ([], True)
    other.join()
    assert [True, False] == [places.try_take() for _ in range(2)]
    places.close()


def wait_until_told(places: Slots, pipe: Connection) -> None:
    """Wait for a turn and end at a signal, as a process does whose run is interrupted."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(3))
    places.take()
    with sharing(places):
        pipe.send("ready")
        unproved(QUESTION, 10)


def test_who_is_told_to_end_while_it_waits_ends(tmp_path: Path) -> None:
    """It does not wait for a slot, which others may hold for long."""
    places = Slots(1)
    here, there = FORK.Pipe()
    with kept_in(Store(tmp_path)), alone_in_asking("z3", TEXT):
        other = FORK.Process(target=wait_until_told, args=(places, there))
        other.start()
        assert here.recv() == "ready"
        places.take()  # it waits now, and will have no place
        other.terminate()
        other.join(60)
        assert other.exitcode == 3
    places.close()


def test_without_a_cache_nobody_waits() -> None:
    """There is no place where the other process's answer could be found."""
    with alone_in_asking("z3", TEXT), alone_in_asking("z3", TEXT):
        assert {} == unproved(QUESTION, 10)


def test_a_stopped_clock_ends_no_work() -> None:
    """A deadline has as much left after its clock stood still as before."""
    ends = deadline(0.05 / CLOCK)
    before = ends.left
    with clock_stopped():
        time.sleep(0.1)
    assert before == ends.left > 0
    time.sleep(0.1)
    assert ends.passed
