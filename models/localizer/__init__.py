"""All ways of locating of one vehicle, as one machine in one step (RFL-13, RFL-14, MRK-2, MRK-3).

    motion         the odometer that all of them share, and the true movement
    odometry       distance since markers read at the front and at the rear
    balise         balise groups, supervised by linking
    line           no machine on board: the map's next reflector, with balises
    reflector      radar reflectors in the view zone, anchored by the groups that the balise machine accepted
    selection, position   usable satellites, and the position along the track from them alone
    verification   the trackside's fibre position, verified against an axle counter
    downlink       brings the verified fibre position on board; its age widens it
    arbitration    what all that state a position have in common
    delocalized    what the vehicle does with it: pass it on, or be restrictive
    uplink         brings the position that is passed on to the trackside; its age widens it

A later machine sees what an earlier one computed in the same step. Any of the five sources may be left out. Each keeps its
own proofs; what arbitration, the links and the restrictive state assume of the machines before them, and the satellites'
position of a reference, is not assumed of the whole, but proved from those. Sources of a user's own come behind the five.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from safeloc.language.composition import Clause, Composition, compose
from safeloc.language.expr import Bool, Expr, Num, Var
from safeloc.language.machine import Machine
from safeloc.models import arbitration, delocalized, motion, transmission
from safeloc.models.arbitration import Arbitration, Source
from safeloc.models.arbitration.variables import parts as arbitration_parts
from safeloc.models.localizer.configuration import CHECKED, LocalizerConfig, SourceName
from safeloc.models.localizer.own_source import Maker, OwnSource, Vehicle, distinct, own_source, vehicle_of
from safeloc.models.localizer.sources import PIECES, Piece, Stated, plainly
from safeloc.models.motion import Motion
from safeloc.models.transmission import Transmission, TransmissionConfig
from safeloc.models.vocabulary.absent import wired_interval
from safeloc.models.vocabulary.reasons import NO_REFERENCE

__all__ = [
    "CHECKED", "Localizer", "LocalizerConfig", "More", "OwnSource", "Piece", "SourceName", "Stated", "Vehicle", "compose_machines",
]  # fmt: skip


@dataclass(frozen=True, eq=False)
class Localizer:
    """The composition and its machines."""

    config: LocalizerConfig
    composition: Composition
    motion: Motion
    pieces: Mapping[str, Piece]
    downlink: Transmission | None
    arbitration: Arbitration
    guard: Machine
    uplink: Transmission

    @property
    def machines(self) -> tuple[Machine, ...]:
        """All machines, in order of the step."""
        return self.composition.system.machines


@dataclass(frozen=True, eq=False)
class More:
    """Machines that a composition adds behind a localizer's own, with arguments for `compose`."""

    machines: tuple[Machine, ...] = ()
    wires: Mapping[Var, Expr] = field(default_factory=dict)
    shared: tuple[Var, ...] = ()
    discharge: tuple[Machine | Clause, ...] = ()


_Behind = Callable[[Motion, Machine, Transmission, Mapping[str, Piece]], More]
"""What another composition adds: from the movement, the restrictive state, the uplink, and the sources by name."""


def _no_more(_: Motion, __: Machine, ___: Transmission, ____: Mapping[str, Piece]) -> More:
    return More()


def compose_machines(
    config: LocalizerConfig | None = None,
    *,
    name: str = "localizer",
    own: Sequence[Maker] = (),
    only_own: bool = False,
    behind: _Behind = _no_more,
) -> Localizer:
    """Compose the localizer of a vehicle: its sources in declared order, the arbitration, then the machines that use the result.

    own      functions that make further sources (safeloc.models.localizer.own_source); `only_own`: and no shipped ones
    behind   what another composition adds
    """
    config = config or LocalizerConfig()
    moves = motion.build(motion.parts(config.motion))
    shipped = _shipped_pieces(config, moves, () if only_own else config.arbitration.sources)
    further = _own_pieces(config, moves, own)
    pieces = {**shipped, **further}
    downlink, link_wires = _downlink(config, moves, pieces)
    counts = arbitration.build(arbitration_parts(config.arbitration_of(tuple(shipped), tuple(further))))
    restrictive = delocalized.parts(
        delocalized.DelocalizedConfig(
            tolerance_mm=config.tolerance_mm, position_limit_mm=config.motion.position_limit_mm
        )
    )
    guard = delocalized.build(restrictive)
    uplink = _link("uplink", config.uplink, moves)
    more = behind(moves, guard, uplink, pieces)
    wires = {
        **{var: term for piece in pieces.values() for var, term in piece.wires.items()},
        **link_wires,
        **_into_arbitration(counts, moves, _all_stated(pieces, downlink)),
        **restrictive.reads(counts.machine),
        restrictive.next_truth: moves.own.ghosts.truth,
        **_into_uplink(uplink, guard, moves),
        **more.wires,
    }
    sources = [machine for piece in pieces.values() for machine in piece.machines]
    links = [downlink.machine] if downlink else []
    machines = (moves.machine, *sources, *links, counts.machine, guard, uplink.machine, *more.machines)
    discharged = [one for piece in pieces.values() for one in piece.discharged]
    composition = compose(
        name,
        machines,
        wires,
        shared=[*moves.shared, *more.shared],
        discharge=[*discharged, *links, counts.machine, guard, uplink.machine, *more.discharge],
    )
    return Localizer(config, composition, moves, pieces, downlink, counts, guard, uplink)


def _shipped_pieces(config: LocalizerConfig, moves: Motion, sources: Sequence[str]) -> dict[str, Piece]:
    """The shipped sources of these names; a later one may read those before it."""
    pieces: dict[str, Piece] = {}
    for source in sources:
        pieces[source] = PIECES[source](config, moves, pieces)
    return pieces


def _own_pieces(config: LocalizerConfig, moves: Motion, own: Sequence[Maker]) -> dict[str, Piece]:
    """The sources that a user added, by their machines' names."""
    vehicle = vehicle_of(moves, config.widest_mm)
    made = [own_source(make, vehicle) for make in own]
    distinct(made)
    return {one.machine.name: Piece((one.machine,), {}, plainly(one.machine), models=(one,)) for one in made}


# ------------------------------------------------------------------ what stands behind the sources


def _downlink(
    config: LocalizerConfig, moves: Motion, pieces: Mapping[str, Piece]
) -> tuple[Transmission | None, dict[Var, Expr]]:
    """The link that brings fibre reports on board: one is sent when trust is stated, and when it is revoked."""
    if "fibre" not in pieces:
        return None, {}
    link, (machine,) = _link("downlink", config.downlink, moves), pieces["fibre"].machines
    stated = pieces["fibre"].stated
    return link, {
        link.own.sent: machine.flag("trusted") | machine.flag("untrusted"),
        **_into_link(link, stated.valid, stated.position, stated.below, stated.above),
        link.own.next_truth: moves.own.ghosts.truth,
    }


def _link(name: str, config: TransmissionConfig, moves: Motion) -> Transmission:
    return transmission.build(transmission.Parts(config, moves.own.ghosts.truth), name)


def _into_link(link: Transmission, valid: Bool, position: Num, below: Num, above: Num) -> dict[Var, Expr]:
    return {link.own.valid: valid, link.own.position: position, link.own.below: below, link.own.above: above}


def _all_stated(pieces: Mapping[str, Piece], downlink: Transmission | None) -> dict[str, Stated]:
    """Return each source's statement as arbitration gets it: of the fibre, the one that has arrived on board."""
    stated = {name: piece.stated for name, piece in pieces.items()}
    if downlink is not None:
        machine = downlink.machine
        held = machine.flag("valid")
        stated["fibre"] = Stated(held, *wired_interval(machine), held, NO_REFERENCE)
    return stated


def _into_arbitration(counts: Arbitration, moves: Motion, stated: Mapping[str, Stated]) -> dict[Var, Expr]:
    wires: dict[Var, Expr] = {
        counts.own.distance.value: moves.machine.output("distance_mm"),
        counts.own.distance.present: moves.reported,
        counts.own.next_truth: moves.own.ghosts.truth,
    }
    for source in counts.own.sources:
        wires |= _hears(source, stated[source.name])
    return wires


def _hears(source: Source, stated: Stated) -> dict[Var, Expr]:
    return {
        source.valid: stated.valid,
        source.position: stated.position,
        source.below: stated.below,
        source.above: stated.above,
        source.reference: stated.reference,
        source.reason: stated.reason,
    }


def _into_uplink(uplink: Transmission, guard: Machine, moves: Motion) -> dict[Var, Expr]:
    link = _into_link(uplink, ~guard.flag("restrictive"), *wired_interval(guard))
    return {**link, uplink.own.next_truth: moves.own.ghosts.truth}
