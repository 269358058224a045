"""Which outputs of a machine are its reported interval, and how the interval stands to the truth.

WRONG    the reported interval misses the truth: a safety failure
INVALID  nothing is reported: availability. The two are never one verdict.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Literal

from safeloc.language.nodes import Value

Standing = Literal["contained", "WRONG", "INVALID"]


@dataclass(frozen=True)
class Reported:
    """Names of outputs: the interval is [position - under, position + over] in mm while `valid` equals `valid_is`.

    truth   the ghost in nm that the interval must hold; "" for a machine without one
    """

    position: str = "position_mm"
    under: str = "under_mm"
    over: str = "over_mm"
    valid: str = "valid"
    valid_is: bool = True
    truth: str = "truth_nm"

    @property
    def outputs(self) -> tuple[str, ...]:
        """The outputs it reads."""
        return (self.position, self.under, self.over, self.valid)

    def interval_mm(self, outputs: Mapping[str, Value]) -> tuple[int, int] | None:
        """Lower and upper end, None while nothing is reported."""
        if bool(outputs[self.valid]) is not self.valid_is:
            return None
        return outputs[self.position] - outputs[self.under], outputs[self.position] + outputs[self.over]

    def standing(self, outputs: Mapping[str, Value], truth_mm: int) -> Standing:
        """How the report stands to the truth, given in whole mm."""
        interval = self.interval_mm(outputs)
        if interval is None:
            return "INVALID"
        return "contained" if interval[0] <= truth_mm <= interval[1] else "WRONG"


def usual_names(outputs: Collection[str]) -> Reported | None:
    """The interval of a machine that uses the usual names valid, position_mm, under_mm, over_mm; None otherwise."""
    usual = Reported()
    return usual if set(usual.outputs) <= set(outputs) else None
