"""How long the audit of a line takes as it grows: python -m benchmarks.bench_audit. The target is 2 s for 10 000 elements."""

from __future__ import annotations

import sys
import time

from benchmarks.long_line import ELEMENTS_PER_BLOCK, long_line
from safeloc.railway.audit import audit
from safeloc.railway.map.toml_files import from_toml, to_toml

TARGET_ELEMENTS, TARGET_S = 10_000, 2.0
SIZES = (1_000, 3_000, TARGET_ELEMENTS, 30_000)


def measure(elements: int) -> tuple[float, float]:
    """Seconds to read a line of so many elements from TOML, and to audit it. Its routes double with every block."""
    text = to_toml(long_line(-(-elements // ELEMENTS_PER_BLOCK)))
    started = time.perf_counter()
    line = from_toml(text, "long line")
    read = time.perf_counter() - started
    report = audit(line)
    if report.findings:
        raise AssertionError(f"the line keeps every rule, but: {report.findings[0].as_text()}")
    return read, time.perf_counter() - started - read


def main() -> int:
    """Print the table; exit code 1 where the target is missed."""
    print("elements   read s  audit s")
    missed = False
    for elements in SIZES:
        read, audited = measure(elements)
        missed |= elements == TARGET_ELEMENTS and audited >= TARGET_S
        print(f"{elements:8}  {read:7.2f}  {audited:7.2f}")
    print(f"target, {TARGET_ELEMENTS} elements in {TARGET_S} s: {'missed' if missed else 'met'}")
    return int(missed)


if __name__ == "__main__":
    sys.exit(main())
