"""The recording of a train that locates itself by the position code, in a stretch whose amplitude once does not return.

Written by `python -m safeloc.models.fibre_area.recordings`; a test checks that it comes out the same.
"""

from __future__ import annotations

from pathlib import Path

from safeloc.models.fibre_area import FibreAreaConfig
from safeloc.models.fibre_area.simulate import Journey, first_state, simulate_journey
from safeloc.models.verification import VerificationConfig
from safeloc.runtime.streams.steps import write_steps

CONFIG = FibreAreaConfig(verification=VerificationConfig(traction_mm_s2=1_500))
FOLDER, NAME = Path(__file__).parents[1] / "streams", "fibre_area-late-record.jsonl.gz"
LATE_RECORD = Journey(
    cycles=385,
    record=380,
    speeds_mm_s=((0, 30_000),),
    referred=False,
    area_mm=(0, 8_000_000),
    cuts_mm=((3_000_000, 4_000_000),),
    front_stuck=(100_000, 850_000),
    rear_stuck=(100_000, 850_000),
)
"""No counter refers the ends; both read a section that does not end, and later a word of the code."""


def write(folder: Path) -> None:
    """Write the recording anew."""
    config = CONFIG
    steps = simulate_journey(config, seed=1, journey=LATE_RECORD)
    write_steps(folder / NAME, steps, machine="fibre_area", first=first_state(config, LATE_RECORD), short=True)


if __name__ == "__main__":
    write(FOLDER)
