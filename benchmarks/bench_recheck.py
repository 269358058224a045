"""What checking a report again costs beside making it.

`python -m benchmarks.bench_recheck [MACHINE ...]`: for each machine (three small ones without any) processor seconds of
`verify` and of `recheck` in one run, their ratio, and how many certificates and goals there are.
"""

from __future__ import annotations

import resource
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeVar

from safeloc.catalogue import load_target
from safeloc.checker.folder import check_folder
from safeloc.proof.provers.limits import Limits
from safeloc.proof.verification.many import in_order, verify_targets
from safeloc.proof.verification.one import Plan
from safeloc.report.folder import write_folder

SMALL = ("stop_point", "balise", "axle_counter")
PLAN = Plan(Limits(), examples=60, steps=60, seed=0)
T = TypeVar("T")


def main(names: Sequence[str]) -> None:
    """Print one line a machine."""
    print(f"{'machine':<20} {'verify s':>9} {'recheck s':>9} {'ratio':>6} {'files':>6} {'goals':>6}  exit code")
    for name in names or SMALL:
        with tempfile.TemporaryDirectory() as place:
            _, making = _timed(lambda name=name, place=place: _verified(name, Path(place)))  # type: ignore[misc]
            found, checking = _timed(lambda place=place: check_folder(Path(place)))  # type: ignore[misc]
        goals = sum(one.goals for one in found.opinions.values())
        told = f"{making:>9.1f} {checking:>9.1f} {checking / making:>6.2f} {len(found.opinions):>6} {goals:>6}"
        print(f"{name:<20} {told}  {found.exit_code}", flush=True)


def _verified(name: str, folder: Path) -> None:
    target = load_target(name)
    findings = in_order(verify_targets([target], PLAN, jobs=2, on_event=lambda _: None))
    write_folder(folder, findings, [target])


def _timed(work: Callable[[], T]) -> tuple[T, float]:
    """What the work gives, and processor seconds of this process and those that it started."""
    before = _processor_s()
    done = work()
    return done, _processor_s() - before


def _processor_s() -> float:
    used = (resource.getrusage(resource.RUSAGE_SELF), resource.getrusage(resource.RUSAGE_CHILDREN))
    return sum(one.ru_utime + one.ru_stime for one in used)


if __name__ == "__main__":
    main(sys.argv[1:])
