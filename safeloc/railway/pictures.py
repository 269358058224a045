"""Declarations of pictures of recorded runs, by the names of inputs, state and outputs.

A declaration only; safeloc.report draws it. A machine of the user may declare the same pictures for its own signals.
All signals are in mm and mm/s unless stated otherwise; the true position is that of the recording, or the ghost in nm.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from safeloc.errors import ModelError
from safeloc.language.renamed import refuse_old_keywords, renamed
from safeloc.language.system import TransitionSystem
from safeloc.reported import Reported

ThingKind = Literal["balise", "reflector", "marker"]


@dataclass(frozen=True)
class Read:
    """Names that a picture reads.

    inputs    inputs, which may be absent at times
    always    inputs that are never absent
    reported  outputs or state
    """

    inputs: tuple[str, ...] = ()
    always: tuple[str, ...] = ()
    reported: tuple[str, ...] = ()


@dataclass(frozen=True)
class Things:
    """Things beside the line that the inputs of a run tell of.

    at      optional input: where such a thing stands
    label   input whose value names it
    zone    inputs: where its view zone begins and ends, in mm before it; None for a thing that is passed over
    called  recording (file name without ending) -> place -> what a drawing of that line calls it
    """

    kind: ThingKind
    at: str
    label: str
    zone: tuple[str, str] | None = None
    called: Mapping[str, Mapping[int, str]] = field(default_factory=dict)


@dataclass(frozen=True)
class Deviation:
    """Deviation of the reported position over distance, with the interval and the tolerable error (source 001, fig. 1)."""

    title: str
    reported: Reported
    tolerance_mm: int
    things: tuple[Things, ...] = ()
    mode: str = "mode"

    @property
    def reads(self) -> Read:
        """The names that it reads."""
        inputs = [name for things in self.things for name in (things.at, things.label, *(things.zone or ()))]
        return Read(inputs=tuple(inputs), reported=(*self.reported.outputs, self.mode))


@dataclass(frozen=True)
class StopSignals:
    """Inputs that tell of one stop point, and the number by which it is selected.

    called  recording (file name without ending) -> what a drawing of that platform calls it
    """

    number: int
    at: str
    before: str
    after: str
    called: Mapping[str, str] = field(default_factory=dict)


@refuse_old_keywords(ModelError, {"under": "below", "over": "above"})
@dataclass(frozen=True)
class Approach:
    """Speed over distance to the stop point, with orders and stop window (source 001, fig. 2).

    position, above, below, valid  the interval that comes with the run
    braking, idle                  members of the order: to brake, and none while no stop is pending
    brake_mm_s2, reaction_ms, speed_error_mm_s   from these the speed at which braking is due, at each distance
    period_ms                      time of a step, for the strip over time
    """

    title: str
    speed: str
    position: str
    above: str
    below: str
    valid: str
    order: str
    braking: str
    idle: str
    selected: str
    stops: tuple[StopSignals, ...]
    brake_mm_s2: int
    reaction_ms: int
    speed_error_mm_s: int
    reduced_speed_mm_s: int
    period_ms: int
    mode: str = "mode"
    truth: str = "truth_nm"

    @property
    def reads(self) -> Read:
        """The names that it reads."""
        windows = [name for stop in self.stops for name in (stop.before, stop.after)]
        always = (self.speed, self.position, self.above, self.below, self.valid, *windows)
        return Read((self.selected, *(stop.at for stop in self.stops)), always, (self.order, self.mode))


@dataclass(frozen=True)
class Hypothesis:
    """The route of that number, which may be the true one.

    possible      output
    low, high     outputs: where the vehicle would be on it
    place, model  inputs: the reflector that the map has on it, nearest to where the sighting puts it
    course        input: which way it takes where a turn is seen
    """

    number: int
    possible: str
    low: str
    high: str
    place: str
    model: str
    course: str


@dataclass(frozen=True)
class Sighting:
    """Signals of a sighting: optional input with the range, inputs with its error, the model and the turn."""

    range: str
    error: str
    model: str
    turned: str
    start: str


PlanKind = Literal["switch", "balise", "reflector"]


@dataclass(frozen=True)
class PlanTrack:
    """A piece of track: points (distance from the common start in mm, lane), and the numbers of the routes over it."""

    name: str
    points: tuple[tuple[int, float], ...]
    routes: tuple[int, ...]


@dataclass(frozen=True)
class PlanMark:
    """Something on the plan; `model` of a reflector."""

    kind: PlanKind
    name: str
    at_mm: int
    lane: float
    model: str = ""
    routes: tuple[int, ...] = ()


@dataclass(frozen=True)
class TrackPlan:
    """A line as a drawing: lanes are numbered from the top; `routes` says of each route's number what it is called."""

    line: str
    routes: Mapping[int, str]
    tracks: tuple[PlanTrack, ...]
    marks: tuple[PlanMark, ...]
    lanes: int


@dataclass(frozen=True)
class Recognition:
    """Picture of the possible routes over the distance run, below the plan of the line (source 001, fig. 3).

    plan  recording (file name without ending) -> its line; it is called only where a picture is drawn
    """

    title: str
    hypotheses: tuple[Hypothesis, ...]
    sighting: Sighting
    plan: Callable[[str], TrackPlan | None]
    mode: str = "mode"
    truth: str = "truth_nm"

    @property
    def reads(self) -> Read:
        """The names that it reads."""
        told = [name for one in self.hypotheses for name in (one.possible, one.low, one.high)]
        of_map = [name for one in self.hypotheses for name in (one.model, one.course)]
        inputs = (self.sighting.range, self.sighting.start, *(one.place for one in self.hypotheses))
        return Read(inputs, (self.sighting.model, self.sighting.turned, *of_map), (*told, self.mode))


@dataclass(frozen=True)
class Stanford:
    """Error of the reported position against the margin stated for it, with the alarm limit (Stanford diagram)."""

    title: str
    reported: Reported
    limit_mm: int

    @property
    def reads(self) -> Read:
        """The names that it reads."""
        return Read(reported=self.reported.outputs)


@dataclass(frozen=True)
class Standing:
    """One of several like parts: the enumeration that says what it is, and the number that says whose."""

    signal: str
    called: str


@dataclass(frozen=True)
class Standings:
    """Picture of the state of each channel along the run, such as satellites by channel.

    names  a number of `called` -> its name; 0 is no one
    """

    title: str
    reported: Reported
    rows: tuple[Standing, ...]
    names: Callable[[int], str] = str

    @property
    def reads(self) -> Read:
        """The names that it reads."""
        return Read(
            reported=(*self.reported.outputs, *(name for row in self.rows for name in (row.signal, row.called)))
        )


@dataclass(frozen=True)
class Stretch:
    """A piece of line with a name, from `low_mm` to `high_mm`."""

    low_mm: int
    high_mm: int
    name: str


@dataclass(frozen=True)
class TrueEnds:
    """The true positions of a train's ends, in mm, in each column of an image."""

    low_mm: tuple[int, ...]
    high_mm: tuple[int, ...]


@dataclass(frozen=True)
class VirtualSection:
    """A virtual section of a recording, and from which of its steps on it was in which state."""

    low_mm: int
    high_mm: int
    states: tuple[tuple[int, str], ...]


@dataclass(frozen=True)
class LoudFibre:
    """The loudness of each piece of a fibre in each stretch of time.

    says        the scene and the outcome that is expected, in words
    first_ms    time of the recording's first step; `step_ms` of each, `steps_per_column` of them in a column
    rows        of pieces of `row_mm`, from the fibre's beginning on: a hexadecimal digit for each column, in steps of
                `level_cdb` over quiet, f and louder; a dot where nothing was told
    sections    localization sections as they are; `marks`: places with names
    virtual     virtual sections beside the one that the machine as it ships has: each is independent of the others
    """

    title: str
    says: str
    first_ms: int
    step_ms: int
    steps_per_column: int
    row_mm: int
    level_cdb: int
    rows: tuple[str, ...]
    trains: tuple[TrueEnds, ...]
    sections: tuple[Stretch, ...]
    marks: Mapping[str, int]
    virtual: tuple[VirtualSection, ...] = ()


@dataclass(frozen=True)
class NamedInterval:
    """A reported interval with its name in the legend."""

    name: str
    reported: Reported


@dataclass(frozen=True)
class SectionState:
    """A virtual section: names of the state that holds its bounds and its mode."""

    name: str
    low: str
    high: str
    mode: str


@dataclass(frozen=True)
class Waterfall:
    """Amplitude of a fibre over distance and time, with trains, intervals and sections over it (issue 4).

    loud      recording (file name without ending) -> what was heard there; it is called only where a picture is drawn
    sections  virtual sections of the machine itself
    signals   outputs that tell of position signals
    modes     states and outputs, enumerations or truth values, that stand in strips below, by their labels
    """

    title: str
    loud: Callable[[str], LoudFibre | None]
    intervals: tuple[NamedInterval, ...]
    sections: tuple[SectionState, ...] = ()
    signals: tuple[str, ...] = ()
    modes: Mapping[str, str] = field(default_factory=lambda: {"mode": "mode"})

    @property
    def reads(self) -> Read:
        """The names that it reads."""
        intervals = [name for one in self.intervals for name in one.reported.outputs]
        sections = [name for one in self.sections for name in (one.low, one.high, one.mode)]
        return Read(reported=(*intervals, *sections, *self.signals, *self.modes.values()))


@dataclass(frozen=True)
class Refusals:
    """A verdict by which something is rejected, withdrawn or withheld.

    of      whose verdict it is, as the table names it
    signal  the enumeration that tells it
    fine    members by which nothing is refused
    also    outputs or state that say more while it is refused, such as which two exclude each other
    """

    of: str
    signal: str
    fine: tuple[str, ...]
    also: tuple[str, ...] = ()


@dataclass(frozen=True)
class Sources:
    """The intervals of several sources over time, each about the truth, with what they have in common (issue 6).

    period_ms  time of a step
    fused      what is passed on; while it is not valid the vehicle is restrictive
    lead       enumeration: which source leads
    beside     what is read along the line, drawn where the front end passes it
    refusals   the verdicts that make up the table of what was rejected
    says       recording (file name without ending) -> what is to come of it; it is called only where a picture is drawn
    """

    title: str
    period_ms: int
    fused: Reported
    lead: str
    sources: tuple[NamedInterval, ...]
    beside: tuple[Things, ...] = ()
    refusals: tuple[Refusals, ...] = ()
    says: Callable[[str], str] | None = None

    @property
    def reads(self) -> Read:
        """The names that it reads."""
        intervals = [name for one in self.sources for name in one.reported.outputs]
        told = [name for one in self.refusals for name in (one.signal, *one.also)]
        inputs = [name for things in self.beside for name in (things.at, things.label)]
        return Read(tuple(inputs), reported=(*self.fused.outputs, self.lead, *intervals, *told))


Picture: TypeAlias = Deviation | Approach | Recognition | Stanford | Standings | Waterfall | Sources


def unreadable(picture: Picture, system: TransitionSystem) -> list[str]:
    """List in words the signals that the picture reads and the system does not have; empty if all exist."""
    reads, optional = picture.reads, {option.value.name for option in system.optionals}
    inputs = {var.name for var in system.inputs}
    told = {var.name for var in system.state} | set(system.outputs)
    wrong = [
        f"no input {name!r}{renamed([name], inputs)}" for name in (*reads.inputs, *reads.always) if name not in inputs
    ]
    wrong += [f"input {name!r} may be absent" for name in reads.always if name in optional]
    return wrong + [
        f"no output or state {name!r}{renamed([name], told)}" for name in reads.reported if name not in told
    ]
