"""How the cost of proving the localizer grows with its sources, and how deep the whole is searched without any proof used.

`python -m benchmarks.localizer_proofs [SECONDS] [MOST]`: for one to MOST sources (5), wall and processor time of all lemmas,
contracts and properties with their re-check (assume-guarantee); then, as a cross-check that shares nothing with those proofs
but the machines, the whole as one system: to which depth exact search finds no violation of containment in SECONDS (60) for
each of some seeds, and how many long runs the falsifiers drove in as long.
"""

from __future__ import annotations

import resource
import sys
import time

from benchmarks.localizers import SOURCES, with_sources
from safeloc.language.spec import Goal, observe
from safeloc.language.verdict import Proved, Unknown, Verdict
from safeloc.models.localizer import compose_machines
from safeloc.proof.provers.bmc import bmc
from safeloc.proof.provers.falsify import falsify
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
from safeloc.properties.localizer import properties

SEEDS = (0, 1)


def main(seconds: float, most: int) -> None:
    """A line for each number of sources."""
    print(
        f"{'sources':>7} {'findings':>8} {'proved':>6} {'wall s':>7} {'cpu s':>7}  {'steps':>5}  the whole as one system"
    )
    for count in range(1, most + 1):
        whole = compose_machines(with_sources(count))
        system, wanted = whole.composition.system, properties(whole)
        began, used = time.perf_counter(), _processor_seconds()
        findings = prove(system, wanted, Limits())
        wall, cpu = time.perf_counter() - began, _processor_seconds() - used
        proved = sum(isinstance(one.result, Proved) for one in findings)
        containment = observe(system, next(prop for prop in wanted if prop.name == "containment"))
        depth, said = _as_one(containment, seconds)
        print(f"{count:>7} {len(findings):>8} {proved:>6} {wall:>7.1f} {cpu:>7.1f}  {depth:>5}  {said}", flush=True)


def _as_one(goal: Goal, seconds: float) -> tuple[int, str]:
    """The depth that exact search exhausted, the deepest of the seeds; and what was said, a violation first."""
    verdicts: list[Verdict] = [bmc(goal, Limits(depth=100, seconds=seconds, seed=seed)) for seed in SEEDS]
    verdicts.append(falsify(goal, Limits(seconds=seconds)))
    depths = [one.depth for one in verdicts if isinstance(one, Unknown)]
    found = [str(one) for one in verdicts if not isinstance(one, Unknown)]
    return max(depths, default=-1), "; ".join(found) or str(verdicts[-1])


def _processor_seconds() -> float:
    """Of this process and of those that it started."""
    return sum(
        usage.ru_utime + usage.ru_stime
        for usage in (resource.getrusage(resource.RUSAGE_SELF), resource.getrusage(resource.RUSAGE_CHILDREN))
    )


if __name__ == "__main__":
    told = sys.argv[1:]
    main(float(told[0]) if told else 60.0, int(told[1]) if len(told) > 1 else len(SOURCES))
