"""Images at the border: each fault has its reason, and nothing is repaired."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from safeloc.runtime.border import Reason
from safeloc.sensing.images import NoFrame, Order, RadarImage, Refusal, admitted, floor_cdb, in_cdb
from tests.sensing.scenes import CONFIG

SENSOR = CONFIG.sensor


def noise(seed: int = 0) -> np.ndarray:
    """A sound image of nothing."""
    return np.random.default_rng(seed).exponential(1.0, SENSOR.shape)


def with_cell(value: float) -> np.ndarray:
    """One cell of this value."""
    power = noise()
    power[500, 8] = value
    return power


SPOILT: dict[str, tuple[Reason | Refusal, Callable[[], object]]] = {
    "a list": (Reason.WRONG_TYPE, lambda: noise().tolist()),
    "nothing": (Reason.WRONG_TYPE, lambda: None),
    "single precision": (Reason.WRONG_TYPE, lambda: noise().astype(np.float32)),
    "whole numbers": (Reason.WRONG_TYPE, lambda: np.ones(SENSOR.shape, dtype=np.int64)),
    "complex": (Reason.WRONG_TYPE, lambda: noise() * 1j),
    "a row less": (Refusal.WRONG_SHAPE, lambda: noise()[:-1]),
    "turned": (Refusal.WRONG_SHAPE, lambda: noise().T),
    "a cube": (Refusal.WRONG_SHAPE, lambda: noise()[None]),
    "NaN": (Reason.NOT_FINITE, lambda: with_cell(float("nan"))),
    "infinite": (Reason.NOT_FINITE, lambda: with_cell(float("inf"))),
    "below zero": (Refusal.NEGATIVE, lambda: with_cell(-1e-300)),
    "all zero": (Refusal.DEAD, lambda: np.zeros(SENSOR.shape)),
    "too quiet": (Refusal.DEAD, lambda: noise() / 10),
    "too loud": (Refusal.JAMMED, lambda: noise() * 100),
    "an echo beyond the range": (Refusal.OVERLOADED, lambda: with_cell(10.0**9.6)),
}


@pytest.mark.parametrize("name", SPOILT)
def test_a_spoilt_image_is_refused(name: str) -> None:
    """With its own reason."""
    reason, power = SPOILT[name]
    refused = admitted(SENSOR, RadarImage(power(), 0, 0))
    assert isinstance(refused, NoFrame)
    assert reason is refused.reason


def test_a_sound_image_is_taken_as_it_is() -> None:
    """The very array."""
    power = noise()
    assert admitted(SENSOR, RadarImage(power, 0, 0)) is power


def test_the_floor_is_the_noise() -> None:
    """0 for the receiver's own noise, 1000 for ten times; None when half the cells are zero."""
    assert floor_cdb(noise()) == pytest.approx(0, abs=10)
    assert floor_cdb(noise() * 10) == pytest.approx(1_000, abs=10)
    assert floor_cdb(np.zeros((4, 4))) is None


def test_hundredths_of_db_go_down() -> None:
    """Rounded down, so that an echo is never called stronger than it is."""
    assert in_cdb(1.0) == 0
    assert in_cdb(100.0) == 2_000
    assert in_cdb(99.999) == 1_999
    assert in_cdb(0.5) == -302


# ------------------------------------------------------------------ the place in the stream


def image(time_ms: object, sequence: object, seed: int = 0) -> RadarImage:
    """A sound image with this time and number."""
    return RadarImage(noise(seed), time_ms, sequence)  # type: ignore[arg-type]


def reasons(*deliveries: tuple[RadarImage, int]) -> list[Reason | Refusal | None]:
    """How each of a stream is judged, given with its instant; images may be 100 ms old."""
    order = Order(100)
    judged = [order.judge(one, now_ms) for one, now_ms in deliveries]
    return [None if one is None else one.reason for one in judged]


def test_new_images_are_taken() -> None:
    """Each newer than the one before, some lost between them, up to the age allowed."""
    assert [None, None, None] == reasons((image(0, 0, 0), 0), (image(50, 1, 1), 150), (image(200, 9, 2), 200))


@pytest.mark.parametrize(
    ("reason", "second", "now_ms"),
    [
        (Reason.DUPLICATE, image(1_000, 5, 1), 1_050),
        (Reason.OUT_OF_ORDER, image(950, 4, 1), 1_050),
        (Reason.OUT_OF_ORDER, image(1_050, 5, 1), 1_050),
        (Reason.OUT_OF_ORDER, image(1_000, 6, 1), 1_050),
        (Reason.FUTURE, image(1_051, 6, 1), 1_050),
        (Reason.STALE, image(1_001, 6, 1), 1_102),
        (Refusal.FROZEN, image(1_050, 6, 0), 1_050),
        (Reason.WRONG_TYPE, image(1_050.0, 6, 1), 1_050),
        (Reason.WRONG_TYPE, image(1_050, True, 1), 1_050),
        (Reason.WRONG_TYPE, image(None, 6, 1), 1_050),
    ],
    ids=["duplicate", "older", "number again", "time again", "future", "stale", "frozen", "float", "flag", "none"],
)
def test_what_is_out_of_place_is_refused(reason: Reason | Refusal, second: RadarImage, now_ms: int) -> None:
    """After a first image of time 1000 and number 5."""
    assert [None, reason] == reasons((image(1_000, 5, 0), 1_000), (second, now_ms))


def test_a_buffer_may_be_used_again() -> None:
    """What counts is what stood in it: other content is new, the same content is frozen."""
    order, power = Order(100), noise(0)
    assert order.judge(RadarImage(power, 0, 0), 0) is None
    power[:] = noise(1)
    assert order.judge(RadarImage(power, 50, 1), 50) is None
    frozen = order.judge(RadarImage(power, 100, 2), 100)
    assert frozen is not None
    assert frozen.reason is Refusal.FROZEN


def test_one_wrong_clock_silences_nothing() -> None:
    """An image from after now is not remembered; a stale one is: what is older than it stays old."""
    first, ahead = (image(0, 0, 0), 0), (image(10_000, 1, 1), 50)
    assert [None, Reason.FUTURE, None] == reasons(first, ahead, (image(100, 2, 2), 100))
    stale = (image(100, 2, 1), 900)
    assert [None, Reason.STALE, Reason.OUT_OF_ORDER] == reasons(first, stale, (image(90, 1, 2), 901))
