"""How the cost of proving the localizer grows with its sources, and how deep the whole is searched without any proof used.

`python -m benchmarks.localizer_proofs [SECONDS]`: for one to five sources, the wall time of all lemmas, contracts and
properties with their re-check (assume-guarantee), and the depth to which bounded search finds no violation of containment
in SECONDS (60 by default): a cross-check that shares nothing with those proofs but the machines.
"""

from __future__ import annotations

import sys
import time

from safeloc.models.localizer import LocalizerConfig, SourceName, compose_machines
from safeloc.properties.localizer import properties
from safeloc.provers.bmc import bmc
from safeloc.provers.limits import Limits
from safeloc.provers.portfolio import prove
from safeloc.spec import observe
from safeloc.verdict import Proved

SOURCES: tuple[SourceName, ...] = ("odometry", "balise", "reflector", "satellite", "fibre")


def main(seconds: float) -> None:
    """A line for each number of sources."""
    print(f"{'sources':>7} {'findings':>8} {'proved':>6} {'wall s':>7}  search of the whole")
    for count in range(1, len(SOURCES) + 1):
        whole = compose_machines(LocalizerConfig(sources=SOURCES[:count]))
        system, wanted, began = whole.composition.system, properties(whole), time.perf_counter()
        findings = prove(system, wanted, Limits())
        wall, proved = time.perf_counter() - began, sum(isinstance(one.result, Proved) for one in findings)
        containment = next(prop for prop in wanted if prop.name == "containment")
        found = bmc(observe(system, containment), Limits(depth=100, seconds=seconds))
        print(f"{count:>7} {len(findings):>8} {proved:>6} {wall:>7.1f}  {found}")


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 60.0)
