"""Odometry on a line whose markers come in order, each once, and are read truly at the front; missed ones are allowed.

What `tests/theorems/odometry/front_only.py` asks of a stream is shown here of every stream on such a line: no reading is refused
at the front, but for those in the very cycle in which the position is lost. (That the devices never exclude each other
is an obligation of the odometry machine itself: that transition is proved impossible while its assumption is kept.)
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from safeloc.language.composition import Composition, compose
from safeloc.language.expr import Bool, Expr, NumVar, Var, ite, number, optional
from safeloc.language.machine import ANY, Machine, Transition, modes
from safeloc.language.terms import Substitution
from safeloc.language.units import COUNT, MM
from safeloc.language.world import World
from safeloc.models.odometry import Odometry, build
from safeloc.models.odometry.variables import OdometryConfig, parts


@dataclass(frozen=True, eq=False)
class LineAhead:
    """The odometry machine, the line ahead of its front reader, and both as one system."""

    source: Odometry
    line: Machine
    composition: Composition

    @property
    def says(self) -> Substitution:
        """From the odometry machine's terms to the whole."""
        return self.composition.of(self.source.machine)


def compose_line(config: OdometryConfig | None = None) -> LineAhead:
    """Compose the odometry machine, with its whole assumption, and a line ahead without a turn."""
    model = build(parts(config or OdometryConfig()))
    source = replace(model, machine=replace(model.machine, world=_on_the_line(model)))
    line, wires = _line(source)
    joined = compose("odometry_on_a_line_ahead", [source.machine, line], wires)
    whole = LineAhead(source, line, joined)
    system = replace(joined.system, lemmas={**joined.system.lemmas, "the last marker lies behind": _behind(whole)})
    return replace(whole, composition=replace(joined, system=system))


def _on_the_line(model: Odometry) -> World:
    """The machine's own world; no turn; and the front reader reads no marker that is not under it."""
    around, stray = model.machine.world, model.own.ghosts.readers[0].stray
    more = {"the vehicle does not turn": ~model.judgement.reversed, "the front reader reads no stray marker": ~stray}
    why = "the machine judges by itself whether the vehicle turns; what is shown is of streams on which it does not"
    return replace(around, clauses={**around.clauses, **more}, reads_machine=why)


def _line(source: Odometry) -> tuple[Machine, dict[Var, Expr]]:
    """Identities and places grow: any naming in which no identity comes twice is one of these but for the names."""
    (running,) = modes("RUNNING")
    reader = source.own.readers[0]
    marker = optional("marker", COUNT, reader.marker.value.low, reader.marker.value.high)
    place = optional("place_mm", MM, reader.place.value.low, reader.place.value.high)
    last = number("last_marker", COUNT, 0, marker.value.high)
    last_place = number("last_mm", MM, place.value.low, place.value.high)
    known = marker.present & place.present
    machine = Machine(
        name="line",
        modes=(running,),
        inputs=[marker, place],
        state={},
        outputs={},
        transitions=[
            Transition("marker read", running, running, known, requirements=("MRK-1",), rank=0),
            Transition("no marker", running, running, requirements=("MRK-1",), rank=1),
        ],
        world=World(
            ghosts={last: 0, last_place: ANY},
            moves={last: ite(known, marker.value, last), last_place: ite(known, place.value, last_place)},
            clauses={"markers lie in order": known.implies((marker.value > last) & (place.value > last_place))},
        ),
        doc="The markers that the front reader comes to: in order, each once.",
    )
    wires: dict[Var, Expr] = {marker.present: reader.marker.present, marker.value: reader.marker.value}
    return machine, {**wires, place.present: reader.place.present, place.value: reader.place.value}


def _behind(whole: LineAhead) -> Bool:
    """The machine runs forward and remembers, if any, a marker that lies behind."""
    own, line = whole.source.own, whole.composition.of(whole.line)
    last, last_place = (line.num(ghost) for ghost in whole.line.world.ghosts if isinstance(ghost, NumVar))
    behind = whole.says.num(own.last_marker_position) <= last_place
    passed = whole.says.num(own.last_marker) <= last
    return whole.says.bool(~own.backwards) & passed & (whole.says.bool(own.last_marker.eq(0)) | behind)
