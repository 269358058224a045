"""The outputs that form a machine's reported interval, and the comparison of the interval with the true position.

WRONG    the reported interval does not contain the true position: a safety failure
INVALID  no interval is reported: a loss of availability. The two are never counted together.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Literal

from safeloc.errors import InputError, ModelError
from safeloc.language.nodes import Value
from safeloc.language.renamed import check_keywords, renamed

Standing = Literal["contained", "WRONG", "INVALID"]


@dataclass(frozen=True)
class PossibleTrack:
    """Names of the outputs of one track that is possible: the number of its edge (0: none), and the interval along that edge, in mm."""

    edge: str
    low: str
    high: str


@dataclass(frozen=True)
class Tracks:
    """Names of the outputs that tell the track. A place without its track is that of the wrong branch as well.

    edge         number of the edge along which the reported interval lies; 0 while it is not known
    count        how many tracks are possible; 0 while nothing is known
    possible     every track on which the vehicle may be
    coordinates  positions along the announced way, which are the same on every branch: no places on the map
    """

    edge: str
    count: str
    possible: tuple[PossibleTrack, ...]
    coordinates: tuple[str, ...] = ()

    @property
    def meanings(self) -> dict[str, str]:
        """Return the meaning of these outputs to a host, by name."""
        found = {
            self.edge: "edge of the map on which end A is, counted with its direction; 0: it is not known",
            self.count: "how many tracks are possible; 0: nothing is known of the track",
        }
        for one in self.possible:
            found[one.edge] = "edge on which end A may be; 0: none"
            found[one.low] = f"if end A is on the edge of {one.edge}, it is at least this far from its beginning"
            found[one.high] = f"if end A is on the edge of {one.edge}, it is at most this far from its beginning"
        for name in self.coordinates:
            found[name] = (
                f"distance along the announced way: the same on every branch, so no place on the map while {self.edge} is 0"
            )
        return found


@check_keywords(ModelError, {"under": "below", "over": "above"})
@dataclass(frozen=True)
class Reported:
    """Names of outputs: the interval is [position - below, position + above] in mm while `valid` equals `valid_is`.

    below   how far the truth may lie towards smaller coordinates of the line
    above   how far the truth may lie towards greater coordinates
    truth   the ghost in nm that the interval has to contain; "" for a machine without one
    tracks  the outputs that tell the track, for an interval along an edge of the map; None for one along the line

    For a train whose front runs towards growing coordinates the margin above is ETCS's L_DOUBTUNDER (under-reading amount:
    the true front may be that far ahead of the estimate), and the margin below is L_DOUBTOVER; when it runs the other
    way they change places.
    """

    position: str = "position_mm"
    below: str = "margin_below_mm"
    above: str = "margin_above_mm"
    valid: str = "valid"
    valid_is: bool = True
    truth: str = "truth_nm"
    tracks: Tracks | None = None

    @property
    def outputs(self) -> tuple[str, ...]:
        """The names of these outputs."""
        return (self.position, self.below, self.above, self.valid)

    @property
    def meanings(self) -> dict[str, str]:
        """Return the meaning of these outputs to a host, by name; `valid` may be told by an output of another sense."""
        where = f"{self.valid} is {int(self.valid_is)}"
        along = (
            "on the line" if self.tracks is None else f"from the beginning of the edge that {self.tracks.edge} tells"
        )
        return {
            **({} if self.tracks is None else self.tracks.meanings),
            self.valid: f"{int(self.valid_is)} while an interval is reported; else position and margins tell nothing",
            self.position: f"estimate of the place of end A {along}, while {where}",
            self.below: f"the true place is at most this far below {self.position}, while {where}",
            self.above: f"the true place is at most this far above {self.position}, while {where}",
        }

    def interval_mm(self, outputs: Mapping[str, Value]) -> tuple[int, int] | None:
        """Return lower and upper end in mm; None while no interval is reported."""
        if bool(outputs[self.valid]) is not self.valid_is:
            return None
        return outputs[self.position] - outputs[self.below], outputs[self.position] + outputs[self.above]

    def standing(self, outputs: Mapping[str, Value], truth_mm: int) -> Standing:
        """Compare the report with the true position in whole mm."""
        interval = self.interval_mm(outputs)
        if interval is None:
            return "INVALID"
        return "contained" if interval[0] <= truth_mm <= interval[1] else "WRONG"


def usual_names(where: str, outputs: Collection[str]) -> Reported | None:
    """Return the interval of a machine that uses the usual names (the defaults of `Reported`); None otherwise.

    InputError for a machine with the names in use until 0.1.0, which would otherwise have no interval without any
    message.
    """
    usual = Reported()
    if set(usual.outputs) <= set(outputs):
        return usual
    if {usual.valid, usual.position, "under_mm", "over_mm"} <= set(outputs):
        raise InputError(
            f"{where}: of its outputs {renamed(('under_mm', 'over_mm'), usual.outputs).removeprefix('; ')}. Rename them, or declare "
            "reported = Reported(below='under_mm', above='over_mm')."
        )
    return None
