"""Recordings of stays with a detector within its bounds: one without trouble, and named ones.

`python -m safeloc.models.fibre_area.recorded_runs` writes those that ship, `... recorded_runs FOLDER` those that are made on demand. Tests
check that the former come out the same, and the latter with the same digest.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from safeloc.models.fibre_area import FibreAreaConfig
from safeloc.models.fibre_area.simulate import Journey, first_state, simulate_journey
from safeloc.models.verification import VerificationConfig
from safeloc.runtime.streams.steps import write_steps

CONFIG = FibreAreaConfig(verification=VerificationConfig(traction_mm_s2=1_500))
FOLDER = Path(__file__).with_name("recordings")
LONG = (0, 3_000_000)
LATE_RECORD = Journey(
    cycles=385,
    record=380,
    speeds_mm_s=((0, 30_000),),
    referred=False,
    area_mm=(0, 8_000_000),
    cuts_mm=((5_500_000, 6_500_000),),
    front_stuck=(100_000, 850_000),
    rear_stuck=(100_000, 850_000),
)
"""No counter refers the ends; both read a section that does not end, and later a word of the code. The train is in the section when its record comes."""
SERVICE = Journey(cycles=180, area_mm=LONG)
UNCOUNTED = Journey(cycles=130, area_mm=LONG, cuts_mm=((500_000, 2_500_000),), uncounted=(52, 120))
"""The detector loses count for longer than integrity is waited for, and counts again."""
SPLIT = Journey(cycles=200, area_mm=LONG, cuts_mm=((700_000, 1_200_000),), split=60)
"""The last wagons come off at 1.2 km and stand; the count tells it 800 m later, the longest that it may take."""
TURNED_BACK = Journey(
    cycles=255, enters=3, speeds_mm_s=((0, 30_000), (86, -30_000)), record=20, area_mm=LONG,
    cuts_mm=((1_300_000, 1_600_000),),
)  # fmt: skip
"""It turns at 1.5 km and leaves where it came in."""
_UNTRUSTED_ON_THE_WAY_BACK = replace(TURNED_BACK, counted_every=5, emitter_dead=(213, TURNED_BACK.cycles))
"""The emitter fails on the way back, when the low end has led for a count's run: from a counted cycle on nothing is told."""
MISSED = Journey(cycles=90, front_missed=(1,), record=1, sender="NEIGHBOUR", tested=2)
"""The neighbouring area hands the train over before the emitter was tested; later the machine of the front does not notice a section."""
UNANNOUNCED = Journey(cycles=60, area_mm=LONG, cuts_mm=((400_000, 800_000),), record=17, unannounced=(20, 60_000))
"""A train that nobody announces follows 60 m behind, far enough for the counter to end the record before it comes. Its first axles are taken for those of the train before it,
until that record has come, 2 s later."""
NAMED: Mapping[str, Journey] = {
    "late-record": LATE_RECORD,
    "service": SERVICE,
    "split": SPLIT,
    "uncounted": UNCOUNTED,
    "turned-back-untrusted": _UNTRUSTED_ON_THE_WAY_BACK,
    "unannounced": UNANNOUNCED,
    "missed-section": MISSED,
}
"""The recordings that ship, by the end of their name."""
ON_DEMAND: Mapping[str, Journey] = {"turned-back": TURNED_BACK}
"""Recordings that do not ship: each of their transitions and cases also occurs in one that does."""


def write(folder: Path, journeys: Mapping[str, Journey] = NAMED) -> list[Path]:
    """Write the recordings anew; return their paths."""
    paths = list[Path]()
    for name, journey in journeys.items():
        paths.append(folder / f"fibre_area-{name}.jsonl.gz")
        steps = simulate_journey(CONFIG, seed=1, journey=journey)
        write_steps(paths[-1], steps, machine="fibre_area", first=first_state(CONFIG, journey), short=True)
    return paths


if __name__ == "__main__":
    if sys.argv[1:]:
        write(Path(sys.argv[1]), ON_DEMAND)
    else:
        write(FOLDER)
