"""How fast the generated code runs, in one run on one machine: `make bench`.

Ratios are what to compare; steps a second depend on the machine. A missed target is shown, and is no failure.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from benchmarks import contenders
from benchmarks.odometer import expected
from benchmarks.turns import judged, race, table
from benchmarks.whole_machines import UNIT, WHOLE


def main() -> None:
    """Measures and prints."""
    with tempfile.TemporaryDirectory() as folder:
        small = race(contenders.contenders(Path(folder)), expected)
    print(*table("Small odometer, 3 state variables", small, contenders.UNIT), "", sep="\n")
    print(*(judged(target, small) for target in contenders.TARGETS), "", sep="\n")
    for one in WHOLE:
        whole = race(one.contenders(), one.expected)
        print(*table(one.title, whole, UNIT), "", sep="\n")
        print(*(judged(target, whole) for target in one.targets), "", sep="\n")


if __name__ == "__main__":
    main()
