"""The worked runs of the fibre machine: what is told of each comes true."""

from __future__ import annotations

from safeloc.models.fibre import machine
from safeloc.models.fibre_parts.variables import FibreConfig
from safeloc.models.fibre_worked import RUNS
from safeloc.shipped.making import STREAMS
from safeloc.streams.steps import read_steps
from safeloc.system import lower
from tests.models.fibre_family import labels, mode_labels, replayed

NAME = "fibre-no-end-of-section"


def test_an_amplitude_that_stays_changed_is_given_up() -> None:
    """Counted at first, then nothing, with the reason; lawful to the end."""
    made = machine(FibreConfig())
    trace = replayed(lower(made), list(read_steps(STREAMS / f"{NAME}.jsonl").steps))
    modes = mode_labels(made, trace)
    assert ["WAITING", "COUNTING"] == list(dict.fromkeys(modes))
    given_up = modes.index("WAITING", modes.index("COUNTING"))
    assert ("WAITING", "NO_END_OF_SECTION") == (modes[-1], labels(trace, "reason")[given_up])
    assert not trace.steps[given_up].outputs["count_known"]


def test_the_recording_is_its_run() -> None:
    """The file that ships is what the model of it makes."""
    assert list(read_steps(STREAMS / f"{NAME}.jsonl").steps) == list(RUNS[NAME].steps(FibreConfig()))
