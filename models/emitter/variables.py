"""Inputs, state, ghosts and configuration of the function check by a test emitter."""

from __future__ import annotations

from pydantic import model_validator

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import boolean, choice, enumeration, members, number, optional
from safeloc.language.units import COUNT, MM

HEARD = members("pattern_verdict", "NOTHING", "PASSED", "FOREIGN", "NOT_DUE", "ELSEWHERE", "NO_PLACE")
NOTHING, PASSED, FOREIGN, NOT_DUE, ELSEWHERE, NO_PLACE = HEARD
_MOST_BITS = 62
REQUIREMENTS = ("FVA-8", "FVA-17")


class EmitterConfig(Config):
    """One emitter: its pattern, its place, and its times."""

    pattern: int = quantity(0b1011_0010_1110_0011, "bits", 1, 2**_MOST_BITS - 1, "[M] its own among all of the line")
    place_mm: int = quantity(1_000_000, "mm", -1_000_000_000, 1_000_000_000, "[D] where it stands")
    place_tolerance_mm: int = quantity(30_000, "mm", 0, 1_000_000, "[D] the front end names an emitter within 30 m")
    due_cycles: int = quantity(20, "cycles", 2, 1_000_000, "[M] every 10 s at 500 ms")
    window_cycles: int = quantity(4, "cycles", 1, 1_000_000, "[M] 2 s: jitter, and length of the pattern")
    answer_cycles: int = quantity(6, "cycles", 1, 1_000_000, "[M] 3 s from request to recognition")
    passes_to_recover: int = quantity(2, "patterns", 1, 100, "[M] one may be an accident")

    @model_validator(mode="after")
    def _in_time(self) -> EmitterConfig:
        if self.window_cycles >= self.due_cycles or self.answer_cycles >= self.due_cycles:
            raise ValueError(
                f"window_cycles ({self.window_cycles}) and answer_cycles ({self.answer_cycles}) have to lie below "
                f"due_cycles ({self.due_cycles}); a pattern that counts at any time tests nothing."
            )
        return self


class Parts:
    """The variables of the machine.

    pattern, place  recognised pattern of this cycle, and its place along the track
    requested       the host requests the emitter's pattern in this cycle
    since_passed           cycles since the last pattern that counted
    since_request           cycles since an open request, 0: none is open
    passes          patterns that counted since the failure
    works           ghost: the whole chain works
    silent          ghost: remaining cycles in which the emitter is silent unless its pattern is requested
    may_answer      ghost: cycles in which the emitter may still answer a request, 0: none is open
    """

    def __init__(self, config: EmitterConfig) -> None:
        self.declared = declared = Declared()
        far, silence = 2_000_000_000, config.due_cycles - config.window_cycles - 1
        self.config = config
        self.pattern = declared.sensor(optional("heard_pattern", COUNT, 0, 2**_MOST_BITS - 1))
        self.place = declared.sensor(optional("heard_place_mm", MM, -far, far))
        self.requested = declared.sensor(boolean("test_requested"))
        self.since_passed = declared.state(number("since_passed_cycles", COUNT, 0, config.due_cycles), first=0)
        self.since_request = declared.state(number("since_request_cycles", COUNT, 0, config.answer_cycles), first=0)
        self.passes = declared.state(number("passes", COUNT, 0, config.passes_to_recover), first=0)
        self.last_verdict = declared.state(choice("last_verdict", enumeration(HEARD)), first=NOTHING)
        self.works = declared.ghost(boolean("chain_works"), first=True)
        self.silent = declared.ghost(number("emitter_silent_cycles", COUNT, 0, silence), first=silence)
        self.may_answer = declared.ghost(number("emitter_may_answer_cycles", COUNT, 0, config.answer_cycles), first=0)
        self.next_works = declared.choice(boolean("next_chain_works"))


def parts(config: EmitterConfig) -> Parts:
    """Return fresh variables for one emitter."""
    return Parts(config)
