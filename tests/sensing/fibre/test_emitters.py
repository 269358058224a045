"""Test patterns: heard at their place, foreign ones told apart."""

from __future__ import annotations

import numpy as np
import pytest

from safeloc.sensing.fibre.emitters import Heard, Listener
from safeloc.sensing.fibre.figures import Emission, Emitter, FibreConfig, Interrogator

BITS = {"E1": "1100101011110001", "E2": "1011011100010101"}
PLACES = {"E1": 500_000, "E2": 1_500_000}
CONFIG = FibreConfig(
    interrogator=Interrogator(fibre_mm=2_000_000),
    emission=Emission(emitters=tuple(Emitter(id=name, fibre_mm=PLACES[name], bits=BITS[name]) for name in BITS)),
)
CHANNELS = CONFIG.interrogator.channels


def heard(bits: str, channel: int, *, spoil: int | None = None, offset: int = 0, level: float = 100) -> list[Heard]:
    """What is heard of a pattern at a channel and, fainter, beside it; `spoil`: a window that is wrong."""
    windows = [False] * (20 + offset) + [bit == "1" for bit in bits for _ in range(4)] + [False] * 60
    if spoil is not None:
        windows[20 + offset + spoil] = not windows[20 + offset + spoil]
    listener = Listener(CONFIG)
    made: list[Heard] = []
    for number, sounds in enumerate(windows):
        tone = np.ones(CHANNELS, np.float32)
        if sounds:
            tone[channel - 1 : channel + 2] = (level / 4, level, level / 4)
        made += listener.listen(tone, number * 50.0)
    return made


@pytest.mark.parametrize("name", ["E1", "E2"])
@pytest.mark.parametrize("offset", range(4))
def test_a_pattern_is_heard_at_its_place(name: str, offset: int) -> None:
    """Once, whenever it begins."""
    channel = PLACES[name] // 10_000
    (one,) = heard(BITS[name], channel, offset=offset)
    assert (name, BITS[name]) == (one.emitter, one.bits)
    assert abs(one.fibre_mm - PLACES[name]) < 10_000
    assert abs(one.begin_ms - (20 + offset) * 50) <= 50


def test_a_pattern_at_a_wrong_place_is_no_emitter() -> None:
    """Another emitter's pattern does not pass for this one's."""
    (one,) = heard(BITS["E1"], 150)
    assert (None, BITS["E1"]) == (one.emitter, one.bits)


def test_a_foreign_pattern_is_told_as_foreign() -> None:
    """One bit wrong is foreign: nothing is corrected."""
    foreign = BITS["E1"][:-1] + "0"
    (one,) = heard(foreign, 50)
    assert (None, foreign) == (one.emitter, one.bits)


@pytest.mark.parametrize("window", [1, 2, 4 * 5 + 1, 4 * 15 + 2])
def test_a_pattern_that_is_not_clear_is_not_heard(window: int) -> None:
    """Half a bit is no bit."""
    assert [] == [one for one in heard(BITS["E1"], 50, spoil=window) if one.emitter]


def test_faint_sound_is_not_heard() -> None:
    """Below the contrast."""
    assert [] == heard(BITS["E1"], 50, level=5)


def test_a_pattern_without_silence_before_or_after_is_not_heard() -> None:
    """A tone that goes on, and one that goes on before."""
    assert [] == heard(BITS["E1"] + "1", 50)
    assert "E1" not in [one.emitter for one in heard("10" + BITS["E1"], 50)]


def test_a_gap_in_the_frames_ends_a_pattern() -> None:
    """What was heard before it does not count."""
    listener, tone = Listener(CONFIG), np.ones(CHANNELS, np.float32)
    for number in range(60):
        listener.listen(tone, number * 50.0)
    listener.reset()
    assert [] == [one for number in range(79) for one in listener.listen(tone * 100, number * 50.0)]
