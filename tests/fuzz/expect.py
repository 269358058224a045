"""What is expected of the product beyond sound verdicts, and which traps it still falls into.

Whoever finds a defect that cannot be mended at once puts its trap into OPEN, or takes its expectation out of NOW;
test_traps.py then expects it to be found still, strictly: it fails once the trap is mended and stands here.
"""

from __future__ import annotations

from tests.fuzz.tally import Expect

NOW = Expect(
    vacuous=True,
    dead_ends=True,
    overlap_happens=True,
    falsifier_starts=True,
)

OPEN: frozenset[str] = frozenset()
