"""The time left of a run: it is estimated from earlier times of the targets, and from the times in this run."""

from __future__ import annotations

from pathlib import Path

from safeloc.proof.cache.store import Store
from safeloc.proof.cache.times import keep_seconds, seconds_before
from safeloc.proof.verification.time_left import USUAL_SECONDS, TimeLeft


class Clock:
    """A clock that is moved by hand."""

    now = 0.0

    def __call__(self) -> float:
        """Seconds."""
        return self.now


def test_what_was_learned_before_is_within_a_quarter_of_the_truth() -> None:
    """Two jobs, four targets that take a tenth longer than before: from the second quarter on the error is a quarter at
    most.
    """
    took = {"a": 40.0, "b": 30.0, "c": 20.0, "d": 10.0}
    truth = {name: 1.1 * seconds for name, seconds in took.items()}
    clock = Clock()
    left = TimeLeft(dict.fromkeys(took, 10), took, 2, clock)
    ends = [(truth["b"], "b"), (truth["a"], "a"), (truth["b"] + truth["c"], "c"), (truth["a"] + truth["d"], "d")]
    whole = max(at for at, _ in ends)
    begins = {"a": 0.0, "b": 0.0, "c": truth["b"], "d": truth["a"]}
    for tick in range(int(whole)):
        clock.now = float(tick)
        for name, at in begins.items():
            if at <= tick < at + 1:
                left.began(name)
        for at, name in ends:
            if at <= tick < at + 1:
                left.over(name, truth[name])
        if whole / 4 <= tick < 0.9 * whole:
            assert abs(left.seconds - (whole - tick)) <= 0.25 * whole


def test_what_is_not_known_is_taken_from_the_others() -> None:
    """The number of findings scales the time of others; before any is known, the usual time does."""
    left = TimeLeft({"a": 10, "b": 20}, {}, 1, Clock())
    assert 30 * USUAL_SECONDS == left.seconds
    left.over("a", 5.0)
    assert 10.0 == left.seconds
    left.over("b", 0.0)
    assert 0.0 == left.seconds


def test_no_end_comes_before_that_of_the_longest() -> None:
    """The estimate is at least the time left of the longest target, however many jobs there are."""
    assert 40.0 == TimeLeft({"a": 1, "b": 1}, {"a": 40.0, "b": 1.0}, 8, Clock()).seconds


def test_times_are_kept_by_name_and_question(tmp_path: Path) -> None:
    """For an edited machine the time before the edit is used."""
    store = Store(tmp_path)
    keep_seconds(store, "odometry", "plan", 12.34)
    assert {"odometry": 12.3} == seconds_before(store, ["odometry", "balise"], "plan")
    assert {} == seconds_before(store, ["odometry"], "another plan")
