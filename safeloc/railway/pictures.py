"""Declarations of pictures of recorded runs, by the names of inputs, state and outputs.

This module only declares pictures; safeloc.report draws them. A user's own machine may declare the same pictures for its
signals. All signals are in mm and mm/s unless stated otherwise; the true position is that of the recording, or the ghost in nm.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from safeloc.errors import ModelError
from safeloc.language.renamed import check_keywords, renamed
from safeloc.language.system import TransitionSystem
from safeloc.reported import Reported, Tracks

ThingKind = Literal["balise", "reflector", "marker"]


@dataclass(frozen=True)
class Read:
    """The names of the signals that a picture reads.

    inputs    inputs that may be absent
    always    inputs that are never absent
    reported  outputs or state
    """

    inputs: tuple[str, ...] = ()
    always: tuple[str, ...] = ()
    reported: tuple[str, ...] = ()


@dataclass(frozen=True)
class Things:
    """Balises, reflectors or markers that the inputs of a run report.

    at      optional input with the place
    label   input with the name
    zone    inputs with begin and end of the view zone, in mm before the place; None for things that are passed over
    called  recording (file name without ending) -> place -> name in the drawing of that line
    """

    kind: ThingKind
    at: str
    label: str
    zone: tuple[str, str] | None = None
    called: Mapping[str, Mapping[int, str]] = field(default_factory=dict)


@dataclass(frozen=True)
class Deviation:
    """A picture of the reported position's error over distance, with interval and tolerable error (source 001, fig. 1)."""

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
    """The inputs of one stop point, and the number that selects it.

    called  recording (file name without ending) -> name in the drawing of that platform
    """

    number: int
    at: str
    before: str
    after: str
    called: Mapping[str, str] = field(default_factory=dict)


@check_keywords(ModelError, {"under": "below", "over": "above"})
@dataclass(frozen=True)
class Approach:
    """A picture of speed over distance to the stop point, with orders and stop window (source 001, fig. 2).

    position, above, below, valid  the interval in the recording
    braking, idle                  members of the order: to brake, and no order because no stop is pending
    brake_mm_s2, reaction_ms, speed_error_mm_s   figures for the curve of the speed at which braking has to begin
    period_ms                      duration of a step, for the strip over time
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
    """The signals of one possible route.

    possible      output: the route is still possible
    low, high     outputs: bounds of the position on it
    place, model  inputs: the mapped reflector on it nearest to the sighted one
    course        input: straight on or turning off, on this route, at a turn that the radar sees
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
    """The signals of a sighting: optional input with the range, inputs with its error, the model and the turn."""

    range: str
    error: str
    model: str
    turned: str
    start: str


PlanKind = Literal["switch", "balise", "reflector", "marker"]


@dataclass(frozen=True)
class PlanTrack:
    """A piece of track: points (distance from the common start in mm, lane), and the numbers of the routes over it."""

    name: str
    points: tuple[tuple[int, float], ...]
    routes: tuple[int, ...]


@dataclass(frozen=True)
class PlanMark:
    """A switch, balise, marker or reflector on the plan; `model` is that of a reflector."""

    kind: PlanKind
    name: str
    at_mm: int
    lane: float
    model: str = ""
    routes: tuple[int, ...] = ()


@dataclass(frozen=True)
class TrackPlan:
    """The drawing of a line. Lanes are numbered from the top; `routes`: number of a route -> its name."""

    line: str
    routes: Mapping[int, str]
    tracks: tuple[PlanTrack, ...]
    marks: tuple[PlanMark, ...]
    lanes: int


@dataclass(frozen=True)
class Recognition:
    """A picture of the possible routes over the distance run, below the plan of the line (source 001, fig. 3).

    plan  recording (file name without ending) -> plan of its line; called only if the picture is drawn
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
        possible = [name for one in self.hypotheses for name in (one.possible, one.low, one.high)]
        of_map = [name for one in self.hypotheses for name in (one.model, one.course)]
        inputs = (self.sighting.range, self.sighting.start, *(one.place for one in self.hypotheses))
        return Read(inputs, (self.sighting.model, self.sighting.turned, *of_map), (*possible, self.mode))


@dataclass(frozen=True)
class Stanford:
    """A Stanford diagram: error of the reported position over its reported margin, with the alert limit."""

    title: str
    reported: Reported
    limit_mm: int

    @property
    def reads(self) -> Read:
        """The names that it reads."""
        return Read(reported=self.reported.outputs)


@dataclass(frozen=True)
class Standing:
    """One of several equal channels: the enumeration with its state, and the number of its owner."""

    signal: str
    called: str


@dataclass(frozen=True)
class Standings:
    """A picture of the state of each channel along the run, such as satellites by channel.

    names  a number of `called` -> name of the owner; 0 stands for none
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
    """A virtual section of a recording. `states`: (step, state from that step on)."""

    low_mm: int
    high_mm: int
    states: tuple[tuple[int, str], ...]


@dataclass(frozen=True)
class LoudFibre:
    """The loudness of each piece of a fibre in each stretch of time.

    says        the scene and its expected outcome, in words
    first_ms    time of the recording's first step
    step_ms, steps_per_column   duration of a step, and steps in a column
    rows        one for each piece of `row_mm`, from the fibre's beginning on: a hexadecimal digit for each column, in steps
                of `level_cdb` over quiet (f: this or louder); a dot if nothing was reported
    sections    true localization sections
    marks       places with names
    virtual     virtual sections besides the only one of the shipped machine; each is independent of the others
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
    """A picture of a fibre's amplitude over distance and time, with trains, intervals and sections over it.

    loud      recording (file name without ending) -> loudness of its fibre; called only if the picture is drawn
    sections  virtual sections of the machine itself
    signals   outputs with position signals
    modes     label -> state or output (enumeration or truth value) in a strip below
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
    """A verdict that rejects, withdraws or withholds something.

    of      owner of the verdict, as named in the table
    signal  enumeration with the verdict
    fine    members that refuse nothing
    also    outputs or state with details of a refusal, such as which two sources exclude each other
    """

    of: str
    signal: str
    fine: tuple[str, ...]
    also: tuple[str, ...] = ()


@dataclass(frozen=True)
class Sources:
    """A picture of the intervals of several sources over time, relative to the true position, and their intersection.

    period_ms  duration of a step
    fused      interval that is passed on; while it is not valid the vehicle is in the restrictive state
    lead       enumeration: the leading source
    beside     things read along the line, drawn where the front end passes them
    refusals   verdicts for the table of rejections
    says       recording (file name without ending) -> expected outcome; called only if the picture is drawn
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
        verdicts = [name for one in self.refusals for name in (one.signal, *one.also)]
        inputs = [name for things in self.beside for name in (things.at, things.label)]
        return Read(tuple(inputs), reported=(*self.fused.outputs, self.lead, *intervals, *verdicts))


def _by_number(_: str) -> Mapping[int, str]:
    return {}


@dataclass(frozen=True)
class PossibleEdges:
    """A picture of the edges of a map over time: where each is possible, where it is told, and where it is the true one.

    true_edge  ghost with the number of the true edge
    called     recording (file name without ending) -> number of an edge -> its name on the map of that recording
    period_ms  duration of a step
    """

    title: str
    tracks: Tracks
    true_edge: str
    period_ms: int
    mode: str = "mode"
    called: Callable[[str], Mapping[int, str]] = _by_number

    @property
    def reads(self) -> Read:
        """The names that it reads."""
        return Read(reported=(self.tracks.edge, *(one.edge for one in self.tracks.possible), self.true_edge, self.mode))


Picture: TypeAlias = Deviation | Approach | Recognition | Stanford | Standings | Waterfall | Sources | PossibleEdges


def unreadable(picture: Picture, system: TransitionSystem) -> list[str]:
    """Return sentences on signals that the picture reads and the system does not have; empty if all exist."""
    reads, optional = picture.reads, {option.value.name for option in system.optionals}
    inputs = {var.name for var in system.inputs}
    known = {var.name for var in system.state} | set(system.outputs)
    wrong = [
        f"no input {name!r}{renamed([name], inputs)}" for name in (*reads.inputs, *reads.always) if name not in inputs
    ]
    wrong += [f"input {name!r} may be absent" for name in reads.always if name in optional]
    return wrong + [
        f"no output or state {name!r}{renamed([name], known)}" for name in reads.reported if name not in known
    ]
