"""The worked runs of the fibre machine: what is told of each comes true."""

from __future__ import annotations

import pytest

from safeloc.language.system import lower
from safeloc.models.fibre import machine
from safeloc.models.fibre.variables import FibreConfig
from safeloc.models.fibre.worked import RUNS
from safeloc.runtime.streams.steps import read_steps
from tests.models.fibre_family import labels, mode_labels, replayed
from tests.shipped_recordings import shipped

NAME = "fibre-no-end-of-section"


def test_an_amplitude_that_stays_changed_is_given_up() -> None:
    """Counted at first, then nothing, with the reason; lawful to the end."""
    made = machine(FibreConfig())
    trace = replayed(lower(made), list(read_steps(shipped(NAME)).steps))
    modes = mode_labels(made, trace)
    assert ["WAITING", "COUNTING"] == list(dict.fromkeys(modes))
    given_up = modes.index("WAITING", modes.index("COUNTING"))
    assert ("WAITING", "NO_END_OF_SECTION") == (modes[-1], labels(trace, "reason")[given_up])
    assert not trace.steps[given_up].outputs["count_known"]


def test_a_known_section_that_does_not_end_raises_f() -> None:
    """Located until the section is longer than any; then F, with the reason, and no place."""
    made = machine(FibreConfig())
    trace = replayed(lower(made), list(read_steps(shipped("fibre-section-without-end")).steps))
    modes = mode_labels(made, trace)
    assert ["LOCATED", "FAULTED"] == list(dict.fromkeys(modes))
    raised = modes.index("FAULTED")
    assert "NO_END_OF_SECTION" == labels(trace, "reason")[raised]
    assert trace.steps[raised - 1].outputs["valid"] and not trace.steps[raised].outputs["valid"]


@pytest.mark.parametrize("name", RUNS)
def test_the_recording_is_its_run(name: str) -> None:
    """The file that ships is what the model of it makes."""
    assert list(read_steps(shipped(name)).steps) == list(RUNS[name].steps(FibreConfig()))
