"""The safety oracle: whatever happens to the lines of a stream on their way, a reported interval holds the truth.

    python -m tests.runtime.streams.oracle --lines 10000000 --seed 1 --out FILE

Simulated odometry as steps with cycle numbers; the truth stays here and is on no line. Each run lets one or several
mishaps befall its lines. A mishap that breaks no assumption must give no wrong interval. One that breaks an
assumption says which: a wrong interval then is told with it, and counted apart.

A block of runs is a line of FILE; started again with the same FILE, it goes on behind the last one. The last line of output is
`N passed, N failed`, of runs; the exit code is 1 where one failed.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, fields
from functools import cache
from itertools import count
from pathlib import Path
from random import Random
from typing import Any

from safeloc.catalogue import load_target
from safeloc.runtime.embedding import Program
from safeloc.runtime.service.fleet import Fleet, FleetSettings
from safeloc.runtime.service.lines import LineCutter
from tests.kept_lines import keep, kept_lines
from tests.runtime.embedding.driving import trusting

PERIOD_MS = 100
Lines = list[str]


@dataclass(frozen=True)
class Mishap:
    """What may happen to a line: `befall` changes the lines at a place. `breaks` names the assumption, if one is broken."""

    name: str
    befall: Callable[[Lines, int, Random], None]
    breaks: str = ""


def _drop(lines: Lines, at: int, _: Random) -> None:
    del lines[at]


def _drop_many(lines: Lines, at: int, random: Random) -> None:
    del lines[at : at + random.randint(2, 40)]


def _double(lines: Lines, at: int, _: Random) -> None:
    lines.insert(at, lines[at])


def _swap(lines: Lines, at: int, _: Random) -> None:
    lines[at], lines[at - 1] = lines[at - 1], lines[at]


def _late(lines: Lines, at: int, random: Random) -> None:
    lines.insert(min(len(lines), at + random.randint(2, 50)), lines[at])
    del lines[at]


def _cut(lines: Lines, at: int, random: Random) -> None:
    lines[at] = lines[at][: random.randrange(len(lines[at]) or 1)]


def _split(lines: Lines, at: int, random: Random) -> None:
    place = random.randrange(len(lines[at]) or 1)
    lines[at : at + 1] = [lines[at][:place], lines[at][place:]]


def _join(lines: Lines, at: int, random: Random) -> None:
    many = random.choice((2, 2, 3, 20))
    lines[at : at + many] = ["\r".join(lines[at : at + many])]


def _glue(lines: Lines, at: int, _: Random) -> None:
    lines[at : at + 2] = ["".join(lines[at : at + 2])]


def _rename(lines: Lines, at: int, random: Random) -> None:
    fields = _fields(lines[at])
    if fields:
        name = random.choice(list(fields))
        lines[at] = json.dumps({(f"x_{name}" if one == name else one): value for one, value in fields.items()})


def _other_vehicle(lines: Lines, at: int, _: Random) -> None:
    lines[at] = lines[at].replace('"vehicle": "1"', '"vehicle": "2"')


def _no_measurement(lines: Lines, at: int, random: Random) -> None:
    _change(lines, at, random, random.choice((float("nan"), float("inf"), 1.5, "7", True, [1], 10**30, -(10**30))))


def _garbage(lines: Lines, at: int, random: Random) -> None:
    lines.insert(at, "".join(chr(random.randrange(1, 0x250)) for _ in range(random.randrange(60))).replace("\n", ""))


def _ahead(lines: Lines, at: int, random: Random) -> None:
    fields = _fields(lines[at])
    if "cycle" in fields:
        lines[at] = json.dumps({**fields, "cycle": fields["cycle"] + random.choice((1, 2, 30, 10_000, 2**62))})


def _empty(lines: Lines, at: int, _: Random) -> None:
    lines[at] = json.dumps(
        {name: None if name.startswith(("front", "rear")) else one for name, one in _fields(lines[at]).items()}
    )


def _false_distance(lines: Lines, at: int, _: Random) -> None:
    """All units agree on half of what was run."""
    fields = _fields(lines[at])
    for name, value in fields.items():
        if name.endswith(("wheel_mm", "radar_mm")) and isinstance(value, int):
            fields[name] = value // 2
    lines[at] = json.dumps(fields)


def _fields(line: str) -> dict[str, object]:
    try:
        found = json.loads(line)
    except ValueError:
        return {}
    return found if isinstance(found, dict) else {}


def _change(lines: Lines, at: int, random: Random, value: object) -> None:
    fields = _fields(lines[at])
    measured = [name for name in fields if name.startswith(("front", "rear"))]
    if measured:
        lines[at] = json.dumps({**fields, random.choice(measured): value})


MISHAPS = (
    Mishap("drop", _drop), Mishap("drop many", _drop_many), Mishap("double", _double), Mishap("swap", _swap),
    Mishap("late", _late), Mishap("cut", _cut), Mishap("split", _split), Mishap("join", _join), Mishap("glue", _glue),
    Mishap("rename a field", _rename), Mishap("another vehicle's name", _other_vehicle),
    Mishap("no measurement", _no_measurement), Mishap("garbage", _garbage), Mishap("all empty", _empty),
    Mishap("ahead", _ahead, "a step has the number of its own cycle"),
    Mishap("false distance", _false_distance, "what all units of an end measure is within their error law"),
)  # fmt: skip
"""Every one that is known, those that break an assumption last."""


@dataclass
class Outcome:
    """What was seen: `wrong` by the assumption that was broken, "" where none was; `first` says where, for each.

    failed  runs with a wrong interval though no assumption was broken, or with something that nobody planned
    """

    lines: int = 0
    located: int = 0
    runs: int = 0
    failed: int = 0
    wrong: Counter[str] = field(default_factory=Counter)
    first: dict[str, str] = field(default_factory=dict)
    unforeseen: list[str] = field(default_factory=list)

    def add(self, other: Outcome) -> None:
        """Both together."""
        self.lines, self.located = self.lines + other.lines, self.located + other.located
        self.runs, self.failed = self.runs + other.runs, self.failed + other.failed
        self.wrong += other.wrong
        self.first = {**other.first, **self.first}
        self.unforeseen += other.unforeseen


@cache
def program() -> Program:
    """Odometry that believes its first marker, so that there is a place from the beginning on."""
    return trusting()


@cache
def run(seed: int) -> tuple[tuple[str, ...], tuple[int, ...]]:
    """A simulated run: the lines without truth and ghosts, and the truth of each cycle."""
    target = load_target("odometry")
    assert target.simulate is not None
    ghosts = {var.name for var in target.system.ghosts}
    lines, truth = [], []
    for cycle, step in enumerate(target.simulate(seed), 1):
        inputs = {name: value for name, value in step.items() if name not in ghosts and name != "truth_mm"}
        lines.append(json.dumps({"vehicle": "1", "cycle": cycle, **inputs}))
        truth.append(int(step["truth_mm"]))
    return tuple(lines), tuple(truth)


def one(seed: int, mishaps: Sequence[Mishap], share: float) -> Outcome:
    """One simulated run with these mishaps befalling this share of its lines."""
    random = Random(f"{seed} {share} {[mishap.name for mishap in mishaps]}")
    sound, truth = run(seed % 7)
    lines = list(sound)
    for at in sorted(random.sample(range(1, len(lines)), max(1, int(share * len(lines)))), reverse=True):
        if at < len(lines):
            random.choice(mishaps).befall(lines, at, random)
    breaks = "; ".join(sorted({mishap.breaks for mishap in mishaps if mishap.breaks}))
    where = f"seed {seed}, {share:.2%} of {', '.join(mishap.name for mishap in mishaps)}"
    return _judged(lines, truth, breaks, where)


def _judged(lines: Lines, truth: Sequence[int], breaks: str, where: str) -> Outcome:
    outcome = Outcome(len(lines), runs=1)
    for told in _answers(lines):
        if "itself failed" in str(told.get("reason", "")):
            outcome.unforeseen.append(f"{where}: {told}")
        interval = told.get("interval_mm")
        cycle = int(told.get("time_ms", 0)) // PERIOD_MS
        if interval is None or told["vehicle"] != "1" or not 1 <= cycle <= len(truth):
            continue
        outcome.located += 1
        if not interval[0] <= truth[cycle - 1] <= interval[1]:
            outcome.wrong[breaks] += 1
            outcome.first.setdefault(breaks, f"{where}: cycle {cycle}, truth {truth[cycle - 1]} mm, told {interval}")
    outcome.failed = int(outcome.wrong[""] > 0 or bool(outcome.unforeseen))
    return outcome


def _answers(lines: Lines) -> Iterator[dict[str, object]]:
    """Through the cutter of lines and a fleet, as a process has them."""
    fleet, cutter = Fleet(program(), FleetSettings(PERIOD_MS, inputs=True)), LineCutter()
    for text in lines:
        for line in cutter.feed(text.encode("utf-8", "surrogatepass") + b"\n"):
            yield from fleet.handle("peer", line, from_start=True)
    yield from fleet.finish()


SHARES = (0.001, 0.01, 0.05, 0.3)
RUNS_A_BLOCK = 2 * len(MISHAPS)


def block(number: int, seed: int) -> Outcome:
    """So many runs: each mishap alone, then each with others; one that breaks an assumption stays alone."""
    random, outcome = Random(f"{seed} {number}"), Outcome()
    harmless = [mishap for mishap in MISHAPS if not mishap.breaks]
    for place in range(RUNS_A_BLOCK):
        alone = MISHAPS[place % len(MISHAPS)]
        together = place >= len(MISHAPS) and not alone.breaks
        mishaps = [alone, *random.sample(harmless, random.randint(1, 5))] if together else [alone]
        run_seed = (seed * 1_000_003 + number) * RUNS_A_BLOCK + place
        outcome.add(one(run_seed, mishaps, random.choice(SHARES)))
    return outcome


def search(most_lines: int, seed: int, out: Path | None = None) -> Outcome:
    """Blocks until that many lines have gone through; those that stand in the file are not gone through again."""
    outcome = Outcome()
    done = {line["block"]: _outcome(line) for line in (kept_lines(out) if out else ()) if line["seed"] == seed}
    for number in count():
        found = done.get(number) or block(number, seed)
        if out and number not in done:
            keep(out, {"seed": seed, "block": number, **vars(found)})
        outcome.add(found)
        if number not in done:
            print(f"{outcome.lines} of {most_lines} lines, {outcome.failed} runs failed", flush=True)
        if outcome.lines >= most_lines:
            return outcome
    raise AssertionError("there are more numbers than lines")


def _outcome(line: dict[str, Any]) -> Outcome:
    made = Outcome(**{one.name: line[one.name] for one in fields(Outcome)})
    made.wrong = Counter(made.wrong)
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    """0: no interval was wrong while every assumption held. 1: one was."""
    parser = argparse.ArgumentParser(description="Mishaps to the lines of a stream, and the intervals that are told.")
    parser.add_argument("--lines", type=int, default=1_000_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, help="a line a block; read again to go on")
    chosen = parser.parse_args(arguments)
    outcome = search(chosen.lines, chosen.seed, chosen.out)
    print(f"{outcome.lines} lines, {outcome.located} located reports")
    for breaks in sorted({"", *outcome.wrong}):
        told = f"with the assumption broken that {breaks}" if breaks else "with every assumption kept"
        print(f"{outcome.wrong[breaks]} wrong {told}. {outcome.first.get(breaks, '')}")
    for told in outcome.unforeseen[:10]:
        print(f"unforeseen: {told}")
    print(f"{outcome.runs - outcome.failed} passed, {outcome.failed} failed")
    return 1 if outcome.failed else 0


if __name__ == "__main__":
    sys.exit(main())
