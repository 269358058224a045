"""How the time of `verify` grows with the size of what is verified.

`python -m benchmarks.bench_growth [--line 10 30 100] [--composed 10 31 100 1000] [--localizer 1 2 3 4 5] [--out FILE] [--svg PICTURE]`:
processor seconds by kind for machines of so many state variables (benchmarks.counted_line), for compositions of so many in all
(benchmarks.composed_line; above WHOLE_UP_TO only the lemmas, contracts and properties), and for localizers of so many sources, of which
only these are proved as well (the obligations and tests of one source take five times as long). As with `verify --fresh`, nothing is kept
of earlier runs, and what occurs twice in a run is decided once. Limits are those of `verify`: they count effort, so other work on the
machine changes no verdict. Behind each figure stands the exponent between its size and the one before, `!` above STEEP. FILE keeps a line
a size, and what stands in it is not measured again.
"""

from __future__ import annotations

import argparse
import math
import multiprocessing
import resource
import tempfile
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import TypeVar

from benchmarks.composed_line import composed_target
from benchmarks.counted_line import line_target
from benchmarks.growth_drawing import drawn
from benchmarks.localizers import SOURCES, with_sources
from safeloc.language.verdict import word
from safeloc.proof.cache.answers import kept_in
from safeloc.proof.cache.store import Store
from safeloc.proof.provers.limits import Limits
from safeloc.proof.results import Finding
from safeloc.proof.verification.one import Plan, Work
from safeloc.shipped_machines import ENTRIES
from safeloc.target import Target
from tests.kept_lines import keep, kept_lines

VARIABLES = (10, 30, 100)
IN_ALL = (10, 31, 100, 1000)
WHOLE_UP_TO = 100
"""State variables of a composition up to which obligations and tests are measured as well."""
PLAN = Plan(Limits(), examples=60, steps=60, seed=0)
JOBS = 2
FAMILIES = ("line", "composed", "localizer")
TITLES = {"line": "one machine", "composed": "a composition, a small machine each section"}
KINDS = ("properties", "obligations", "tests")
STEEP = 1.3
"""An exponent above which growth is called worse than linear."""
T = TypeVar("T")


@dataclass(frozen=True)
class Cost:
    """What a size took: processor seconds by kind, and the findings that are neither proved nor held."""

    family: str
    size: int
    variables: int
    seconds: dict[str, float]
    findings: int
    open: list[str]
    memory_mb: float

    @property
    def grown(self) -> int:
        """What the exponent is of: state variables of a line, sources of a localizer."""
        return self.size if self.family == "localizer" else self.variables

    @property
    def all_s(self) -> float:
        """Seconds of all kinds."""
        return sum(self.seconds.values())


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a line a size, and draw them all."""
    asked = _arguments(arguments)
    kept = [Cost(**line) for line in kept_lines(asked.out)] if asked.out else []
    wanted = [(family, size) for family in FAMILIES for size in getattr(asked, family)]
    for family, size in wanted:
        if any((one.family, one.size) == (family, size) for one in kept):
            continue
        kept.append(_alone(partial(measured, family, size)))
        if asked.out:
            keep(asked.out, asdict(kept[-1]))
    kept.sort(key=lambda one: (FAMILIES.index(one.family), one.size))
    print(*table(kept), sep="\n")
    if asked.svg:
        asked.svg.write_text(_drawn(kept) + "\n", encoding="utf-8")


def _arguments(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.bench_growth", description=__doc__)
    parser.add_argument("--line", type=int, nargs="*", default=list(VARIABLES), help="state variables")
    parser.add_argument("--composed", type=int, nargs="*", default=list(IN_ALL), help="state variables in all")
    numbers = range(1, len(SOURCES) + 1)
    parser.add_argument("--localizer", type=int, nargs="*", default=list(numbers), choices=numbers, help="sources")
    parser.add_argument("--out", type=Path, help="a line a size; read again to go on")
    parser.add_argument("--svg", type=Path, help="where the picture goes")
    return parser.parse_args(arguments)


# ------------------------------------------------------------------ measuring


def _alone(work: Callable[[], Cost]) -> Cost:
    """In a process of its own, so that nothing is known of another size."""
    with ProcessPoolExecutor(1, multiprocessing.get_context("fork")) as pool:
        return pool.submit(work).result()


def measured(family: str, size: int) -> Cost:
    """What one size took, and what came of it. AssertionError where a generated machine is not all proved."""
    target, whole = _made(family, size)
    findings, seconds = list[Finding](), dict[str, float]()
    with tempfile.TemporaryDirectory() as kept, kept_in(Store(Path(kept)), fresh=True):
        for kind, stage in _stages(target, all_=whole):
            found, seconds[kind] = _timed(stage)
            findings += found
    open_ = [f"{word(one.result)} {one.id}" for one in findings if word(one.result) not in ("proved", "held")]
    if family != "localizer" and open_:
        raise AssertionError(f"{family}: a line of {size} state variables is not all proved: {'; '.join(open_)}")
    most = max(resource.getrusage(who).ru_maxrss for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return Cost(family, size, len(target.system.state), seconds, len(findings), open_, most / 1_000)


def _made(family: str, size: int) -> tuple[Target, bool]:
    """The target, and whether obligations and tests of it are measured as well."""
    if family == "line":
        return line_target(size), True
    if family == "composed":
        return composed_target(size), size <= WHOLE_UP_TO
    return _localizer(size), False


def _localizer(sources: int) -> Target:
    return ENTRIES["localizer"].make(with_sources(sources))


def _stages(target: Target, *, all_: bool) -> Iterator[tuple[str, Callable[[], list[Finding]]]]:
    """What `verify` does with a target, one kind after the other; only the first of them unless all are wanted."""
    work, owed = Work(target, JOBS, lambda *_: None, lambda _: None), list[Finding]()

    def obliged() -> list[Finding]:
        owed.extend(work.obliged(PLAN.limits))
        return owed

    yield "properties", lambda: work.proved(target.properties, PLAN.limits)
    if all_:
        yield "obligations", obliged
        yield "tests", lambda: work.tested(PLAN, owed)


def _timed(work: Callable[[], T]) -> tuple[T, float]:
    """What the work gives, and processor seconds of this process and those that it started."""
    before = _processor_s()
    done = work()
    return done, _processor_s() - before


def _processor_s() -> float:
    used = (resource.getrusage(resource.RUSAGE_SELF), resource.getrusage(resource.RUSAGE_CHILDREN))
    return sum(one.ru_utime + one.ru_stime for one in used)


# ------------------------------------------------------------------ telling


def exponent(smaller: tuple[float, float], larger: tuple[float, float]) -> float:
    """The power of the size with which seconds grow between two (size, seconds)."""
    return math.log(larger[1] / smaller[1]) / math.log(larger[0] / smaller[0])


def table(costs: Sequence[Cost]) -> list[str]:
    """A line a size; behind the seconds of each kind the exponent since the size before, `!` where it is steep."""
    lines = [
        f"{'family':<10} {'size':>5} {'variables':>9} {'properties s':>16} {'obligations s':>16} {'tests s':>16} {'all s':>16}  MB  findings"
    ]
    for before, one in zip([None, *costs], costs, strict=False):
        earlier = before if before is not None and before.family == one.family else None
        kinds = [_told(earlier, one, kind) for kind in (*KINDS, "")]
        found = f"{one.findings}, {len(one.open)} open" if one.open else f"{one.findings}"
        lines.append(
            f"{one.family:<10} {one.size:>5} {one.variables:>9} {' '.join(kinds)}  {one.memory_mb:.0f}  {found}"
        )
    return lines


def _drawn(costs: Sequence[Cost]) -> str:
    localizers = [(one.grown, one.all_s) for one in costs if one.family == "localizer"]
    return drawn({title: _by_kind(costs, family) for family, title in TITLES.items()}, localizers)


def _by_kind(costs: Sequence[Cost], family: str) -> dict[str, list[tuple[float, float]]]:
    of = [one for one in costs if one.family == family]
    return {kind: [(one.grown, one.seconds[kind]) for one in of if kind in one.seconds] for kind in KINDS}


def _told(before: Cost | None, one: Cost, kind: str) -> str:
    def spent(cost: Cost) -> float:
        return cost.seconds.get(kind, 0.0) if kind else cost.all_s

    if not spent(one):
        return f"{'-':>16}"
    if before is None or not spent(before) or (not kind and before.seconds.keys() != one.seconds.keys()):
        return f"{spent(one):>8.1f}{'':>8}"
    power = exponent((before.grown, spent(before)), (one.grown, spent(one)))
    return f"{spent(one):>8.1f} ^{power:>5.2f}{'!' if power > STEEP else ' '}"


if __name__ == "__main__":
    main()
