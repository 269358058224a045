"""What a reflector machine gets of a frame."""

from __future__ import annotations

import pytest

from safeloc.errors import InputError
from safeloc.sensing.along_track import Delay
from safeloc.sensing.echoes import Echo
from safeloc.sensing.figures import Installation
from safeloc.sensing.images import NoFrame, Refusal
from safeloc.sensing.radar import Frame
from safeloc.sensing.reflector_inputs import step_inputs
from safeloc.sensing.signature import Doubt, Model
from tests.sensing.scenes import CONFIG

STRAIGHT = CONFIG.model_copy(update={"installation": Installation(least_radius_mm=3_000_000)})
STILL = Delay(0, 0, 0, 0)


def echo(model: Model, range_mm: int, intensity_cdb: int) -> Echo:
    """A candidate."""
    doubt = Doubt.SHAPE if model is Model.UNKNOWN else None
    return Echo(model, doubt, range_mm, 20, -30_000, 1_000, intensity_cdb, 2_146)


NEAR, FAR, WEAK = echo(Model.A, 40_000, 5_600), echo(Model.C, 80_000, 4_400), echo(Model.D, 120_000, 3_700)
MAST = echo(Model.UNKNOWN, 20_000, 7_000)


def frame(*echoes: Echo) -> Frame:
    """A frame with these."""
    return Frame(0, 0, 0, echoes)


def test_a_slot_has_all_its_inputs() -> None:
    """Range along the track, error, model, intensity below full scale, place aside to the left."""
    given = step_inputs(frame(NEAR), STRAIGHT, STILL)
    assert given.inputs == {
        "frame_present": True,
        "echo_1_range_mm": 39_885,
        "echo_1_error_mm": given.inputs["echo_1_error_mm"],
        "echo_1_model": "A",
        "echo_1_intensity_cdb": 5_600 - CONFIG.sensor.full_scale_cdb,
        "echo_1_lateral_mm": -1_200,
    }
    assert 20 < int(given.inputs["echo_1_error_mm"]) < 60
    assert given.missing is None


def test_reflectors_come_before_clutter_and_strong_before_weak() -> None:
    """What has no slot is reported."""
    given = step_inputs(frame(MAST, NEAR, FAR, WEAK), CONFIG, STILL, slots=2)
    assert ("A", "C") == (given.inputs["echo_1_model"], given.inputs["echo_2_model"])
    assert (WEAK, MAST) == given.dropped
    assert len(given.inputs) == 11


def test_clutter_fills_what_is_left() -> None:
    """As an echo of no model."""
    given = step_inputs(frame(MAST, NEAR), CONFIG, STILL)
    assert ("A", "NONE") == (given.inputs["echo_1_model"], given.inputs["echo_2_model"])
    assert () == given.dropped


def test_what_is_behind_by_now_has_no_slot() -> None:
    """A reflector 20 m ahead a second ago, at 30 m/s; the next one takes the slot."""
    given = step_inputs(frame(echo(Model.B, 20_000, 6_500), FAR), CONFIG, Delay(1_000, 1_000, 30_000, 30_000))
    assert given.inputs["echo_1_model"] == "C"
    assert [Model.B] == [one.model for one in given.dropped]
    assert "echo_2_range_mm" not in given.inputs


def test_no_frame_and_no_echo_are_two_things() -> None:
    """A refused image gives no frame, with its reason; an empty one gives a frame."""
    assert step_inputs(frame(), CONFIG, STILL).inputs == {"frame_present": True}
    refused = step_inputs(NoFrame(Refusal.JAMMED), CONFIG, STILL)
    assert refused.inputs == {"frame_present": False}
    assert refused.missing == NoFrame(Refusal.JAMMED)


def test_a_machine_has_slots() -> None:
    """At least one."""
    with pytest.raises(InputError, match=r"^a machine has at least one slot for echoes; got 0\.$"):
        step_inputs(frame(), CONFIG, STILL, slots=0)
