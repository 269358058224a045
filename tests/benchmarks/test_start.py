"""What the benchmark of the start says of what it has measured."""

from __future__ import annotations

import subprocess

import pytest

from benchmarks.bench_start import CONTENDERS, TARGETS_S, UNIT, judged, measure, table


def test_processor_time_is_that_of_the_process() -> None:
    """A process that computes takes more than one that does nothing; one that fails is no result."""
    found = measure({"idle": ("-c", "pass"), "busy": ("-c", "sum(range(10_000_000))")}, rounds=1)
    assert 0 < found["idle"] < found["busy"]
    with pytest.raises(subprocess.CalledProcessError):
        measure({"wrong": ("-c", "raise SystemExit(1)")}, rounds=1)


def test_targets_are_judged() -> None:
    """Each target is of a contender; what is as fast as the target meets it, what is slower does not."""
    assert TARGETS_S.keys() <= CONTENDERS.keys()
    met = judged(TARGETS_S)
    missed = judged({name: 1.5 * most for name, most in TARGETS_S.items()})
    assert ["met   ", "met   "] == [line[:6] for line in met]
    assert ["MISSED", "MISSED"] == [line[:6] for line in missed]
    assert met[0] == "met     --help <= 0.2 s: 0.200 s"


def test_ratios_are_to_the_unit() -> None:
    """Twice the unit's time is 2.00."""
    assert ["1.00", "2.00"] == [line.split()[-1] for line in table({UNIT: 0.08, "--help": 0.16})[1:]]
