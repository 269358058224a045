"""Named stays of a train in an area, as recordings of the verification.

`python -m safeloc.models.verification.recorded_runs` writes the runs that ship, `... recorded_runs FOLDER` those that are made
on demand. The fibre's readings are true within their bounds; `unnoticed` has runs in which they are not.
"""

from __future__ import annotations

from collections.abc import Mapping

from safeloc.models.fibre.simulate import Stay, simulate_stay
from safeloc.models.verification.variables import VerificationConfig
from safeloc.proof.drawn_runs.worked import WorkedRun, write_named

SEED = 1


def _worked(outcome: str, stay: Stay) -> WorkedRun[VerificationConfig]:
    return WorkedRun(outcome, lambda config: simulate_stay(config, seed=SEED, stay=stay))


RUNS: Mapping[str, WorkedRun[VerificationConfig]] = {
    "verification-stay": _worked("Nothing goes wrong: trusted from the counter's record until the train leaves.", Stay()),
    "verification-split": _worked(
        "Four axles stay behind: untrusted at the next count of the fibre, and the position that was reported is revoked.",
        Stay(lost_from=30),
    ),
    "verification-emitter-fails": _worked(
        "The test emitter fails: the chain is not tested any more, and the position is revoked.",
        Stay(cycles=40, emitter_fails=25),
    ),
    "verification-fibre-error": _worked(
        "The fibre reports an error: untrusted in that cycle, and the position is revoked.", Stay(cycles=40, error_from=20)
    ),
    "verification-lost-handover": _worked(
        "The neighbouring area's record is due and does not come: untrusted, and no position is ever reported.",
        Stay(cycles=20, reference=None),
    ),
}  # fmt: skip
"""The recordings that ship, by name."""
ON_DEMAND: Mapping[str, WorkedRun[VerificationConfig]] = {
    "verification-miscount": _worked(
        "The counter counts an axle too many: untrusted at the fibre's first count, no position is ever reported.",
        Stay(counted=41),
    ),
}
"""Runs that do not ship, by name: another one shows each of their transitions and cases."""


if __name__ == "__main__":
    write_named(__file__, RUNS, ON_DEMAND, VerificationConfig())
