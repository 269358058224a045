"""How soon the command line answers: python -m benchmarks.bench_start [rounds]

Processor time (user and system) of whole processes, the median of all rounds; the contenders take turns, so that whatever
else the machine does falls on all of them alike. Ratios to Python that has loaded Typer and rich, which is the least that a
command line made with them can take, are what to compare; the targets in seconds are those of a machine with nothing else
to do. A missed target is shown, and is no failure.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
from collections.abc import Mapping, Sequence
from statistics import median

ROUNDS = 7
UNIT = "Typer and rich"
EVERY_COMMAND = "from safeloc.cli.commands import COMMANDS, loaded\nfor name in COMMANDS: loaded(name)"
CONTENDERS: Mapping[str, Sequence[str]] = {
    "Python alone": ("-c", "pass"),
    UNIT: ("-c", "import typer, rich.console, rich.table, rich.panel"),
    "import safeloc": ("-c", "import safeloc"),
    "--version": ("-m", "safeloc", "--version"),
    "--help": ("-m", "safeloc", "--help"),
    "every command loaded": ("-c", EVERY_COMMAND),
    "list": ("-m", "safeloc", "list"),
    "list properties --machine odometry": ("-m", "safeloc", "list", "properties", "--machine", "odometry"),
    "list properties": ("-m", "safeloc", "list", "properties"),
}
TARGETS_S: Mapping[str, float] = {"--help": 0.2, "list properties": 1.0}


def processor_seconds(arguments: Sequence[str]) -> float:
    """User and system time of one process, from its start to its end."""
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, *arguments], env=kept, stdout=subprocess.DEVNULL, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def measure(contenders: Mapping[str, Sequence[str]], rounds: int) -> dict[str, float]:
    """Median seconds by name; a first round, which writes compiled files, does not count."""
    found: dict[str, list[float]] = {name: [] for name in contenders}
    for number in range(rounds + 1):
        for name, arguments in contenders.items():
            seconds = processor_seconds(arguments)
            if number:
                found[name].append(seconds)
    return {name: median(times) for name, times in found.items()}


def table(seconds: Mapping[str, float]) -> list[str]:
    """Seconds, and their ratio to those of the unit."""
    width = max(map(len, seconds))
    head = f"{'':{width}}  processor s  ratio to {UNIT}"
    return [head, *(f"{name:{width}}  {one:11.3f}  {one / seconds[UNIT]:8.2f}" for name, one in seconds.items())]


def judged(seconds: Mapping[str, float]) -> list[str]:
    """One line a target: what was found, met or missed."""
    return [
        f"{'met   ' if seconds[name] <= most else 'MISSED'}  {name} <= {most:g} s: {seconds[name]:.3f} s"
        for name, most in TARGETS_S.items()
    ]


def main() -> None:
    """Measures and prints."""
    found = measure(CONTENDERS, int(sys.argv[1]) if len(sys.argv) > 1 else ROUNDS)
    print(*table(found), "", *judged(found), sep="\n")


if __name__ == "__main__":
    main()
