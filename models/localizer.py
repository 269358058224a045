"""All ways of locating of one vehicle, as one machine in one step (RFL-13, RFL-14, MRK-2, MRK-3).

    motion         the odometer that all of them share, and the true movement
    odometry       distance since markers read at the front and at the rear
    balise         balise groups, supervised by linking
    reflector      radar reflectors in the view zone
    selection, position   usable satellites, and the position along the track from them alone
    verification   the trackside's fibre position, verified against an axle counter
    downlink       brings the verified fibre position on board; its age is charged
    arbitration    what all that state a position have in common
    delocalized    what the vehicle does with it: pass it on, or be restrictive
    uplink         brings the position that is passed on to the trackside; its age is charged

A later machine sees what an earlier one computed in the same step. Any of the five sources may be left out. Each keeps its
own proofs; what arbitration, the links and the restrictive state assume of the machines before them is not assumed of the
whole, but owed by those, and proved.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

from pydantic import model_validator

from safeloc.composition import Clause, Composition, compose
from safeloc.config import Config, quantity
from safeloc.expr import Bool, BoolVar, Expr, Num, NumVar, Optional, Var, ite, maximum
from safeloc.machine import Machine
from safeloc.models import (
    arbitration,
    balise,
    delocalized,
    motion,
    odometry,
    reflector,
    satellite_selection,
    transmission,
    verification,
)
from safeloc.models import satellite as satellites
from safeloc.models.arbitration import SOURCES, Arbitration, ArbitrationConfig, Source
from safeloc.models.arbitration_parts.variables import parts as arbitration_parts
from safeloc.models.balise_parts.variables import BaliseConfig
from safeloc.models.balise_parts.variables import parts as balise_parts
from safeloc.models.motion import Motion, MotionConfig
from safeloc.models.odometry_parts.error_law import RADAR
from safeloc.models.odometry_parts.variables import (
    CONTRADICTION,
    LOCATED,
    NO_REFERENCE,
    SENSOR_FAILURE,
    TOLERANCE,
    OdometryConfig,
)
from safeloc.models.odometry_parts.variables import parts as odometry_parts
from safeloc.models.reflector_parts import variables as reflecting
from safeloc.models.reflector_parts.variables import ReflectorConfig
from safeloc.models.satellite_parts import variables as satellite_words
from safeloc.models.satellite_parts.law import REFERENCE
from safeloc.models.satellite_parts.variables import SatelliteConfig
from safeloc.models.transmission import Transmission, TransmissionConfig
from safeloc.models.verification import VerificationConfig

SourceName = Literal["odometry", "balise", "reflector", "satellite", "fibre"]


CHECKED = MotionConfig(check=RADAR)
"""An odometer that a Doppler radar checks."""


class LocalizerConfig(Config):
    """One vehicle with all its ways of locating; what they share is said once, in `motion`, and must be the same in each.

    Where `motion` has a check unit it is odometry's second unit at the front, and balises and reflectors hear of a distance
    what it is worth (`told_distance`, with the law `motion.told`).
    """

    sources: tuple[SourceName, ...] = ("odometry", "balise", "reflector", "satellite", "fibre")
    tolerance_mm: int = quantity(30_000, "mm", 1, 500_000, "[S] OCORA 7239: 30 m on main line")
    motion: MotionConfig = CHECKED
    odometry: OdometryConfig = OdometryConfig()
    balise: BaliseConfig = BaliseConfig(odometer=CHECKED.told, told_distance=True, tolerance_mm=45_000)
    reflector: ReflectorConfig = ReflectorConfig(odometer=CHECKED.told, told_distance=True)
    satellite: SatelliteConfig = SatelliteConfig(period_ms=100, coast_limit_cycles=20)
    fibre: VerificationConfig = VerificationConfig(
        period_ms=100, margin_limit_mm=300_000, reference_age_limit_cycles=20, currency_cycles=50
    )
    downlink: TransmissionConfig = TransmissionConfig()
    uplink: TransmissionConfig = TransmissionConfig()

    @property
    def used(self) -> dict[str, Config]:
        """The configurations that count, by name: those of the sources that there are, and of the links."""
        chosen: dict[str, Config] = {name: getattr(self, name) for name in SOURCES if name in self.sources}
        links: dict[str, Config] = {"downlink": self.downlink} if "fibre" in self.sources else {}
        return {**chosen, **links, "uplink": self.uplink}

    @property
    def arbitration(self) -> ArbitrationConfig:
        """What arbitration depends on."""
        return ArbitrationConfig(
            sources=tuple(name for name in SOURCES if name in self.sources),
            tolerance_mm=self.tolerance_mm,
            max_step_mm=self.motion.limits.max_step_mm,
            position_limit_mm=self.motion.position_limit_mm,
        )

    @model_validator(mode="after")
    def _one_vehicle(self) -> LocalizerConfig:
        if not self.sources or len(set(self.sources)) != len(self.sources):
            raise ValueError(f"sources {list(self.sources)} must be at least one of {list(SOURCES)}, each once.")
        checked = self.motion.check is not None
        wanted = {
            "period_ms": self.motion.period_ms,
            "position_limit_mm": self.motion.position_limit_mm,
            "max_speed_mm_s": self.motion.max_speed_mm_s,
            "odometer": self.motion.told,
            "told_distance": checked,
            "first_unit": self.motion.odometer,
        }
        if checked:
            wanted |= {"second_unit": self.motion.check, "measuring_step_mm": self.motion.measuring_step_mm}
        for name, config in self.used.items():
            for figure, value in wanted.items():
                slack = name == "fibre" and figure == "max_speed_mm_s"
                if not slack and getattr(config, figure, value) != value:
                    raise ValueError(
                        f"{name}.{figure} is {getattr(config, figure)}, but the vehicle's is {value} (motion); make them the same."
                    )
        return self

    @model_validator(mode="after")
    def _fits(self) -> LocalizerConfig:
        widest = 10 * self.tolerance_mm
        for name, limit in {
            "odometry.tolerance_mm": self.odometry.tolerance_mm,
            "balise.tolerance_mm": self.balise.tolerance_mm,
            "reflector.tolerance_mm": self.reflector.tolerance_mm,
            "satellite.tolerance_mm": self.satellite.tolerance_mm,
            "downlink.margin_limit_mm": self.downlink.margin_limit_mm,
        }.items():
            if limit > widest:
                raise ValueError(
                    f"{name} {limit} is beyond ten times tolerance_mm {self.tolerance_mm}: it tells nothing."
                )
        if self.fibre.margin_limit_mm > self.downlink.margin_limit_mm:
            raise ValueError(
                f"fibre.margin_limit_mm {self.fibre.margin_limit_mm} is beyond downlink.margin_limit_mm "
                f"{self.downlink.margin_limit_mm}: a report of that width cannot be sent."
            )
        if self.tolerance_mm > self.uplink.margin_limit_mm:
            raise ValueError("uplink.margin_limit_mm must not be below tolerance_mm: a report could not be sent.")
        return self


@dataclass(frozen=True, eq=False)
class Stated:
    """What a source's machine states, in terms of that machine after the step."""

    valid: Bool
    position: Num
    under: Num
    over: Num
    reference: Bool
    reason: Num


@dataclass(frozen=True, eq=False)
class Piece:
    """A source: its machines in order, how they are wired, what it states, and what sources before it owe it."""

    machines: tuple[Machine, ...]
    wires: Mapping[Var, Expr]
    stated: Stated
    owed: tuple[Clause, ...] = ()


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
    """What a composition adds behind a localizer's own machines, as for `compose`."""

    machines: tuple[Machine, ...] = ()
    wires: Mapping[Var, Expr] = field(default_factory=dict)
    shared: tuple[Var, ...] = ()
    owes: tuple[Machine | Clause, ...] = ()


def _no_more(_: Motion, __: Machine, ___: Transmission) -> More:
    return More()


def compose_machines(
    config: LocalizerConfig | None = None,
    *,
    name: str = "localizer",
    behind: Callable[[Motion, Machine, Transmission], More] = _no_more,
) -> Localizer:
    """The localizer of a vehicle: its sources in declared order, then what counts, then what is done with it.

    behind   from the movement, the restrictive state and the uplink: what another composition adds
    """
    config = config or LocalizerConfig()
    moves = motion.build(motion.parts(config.motion))
    pieces: dict[str, Piece] = {}
    for source in config.arbitration.sources:
        pieces[source] = _PIECES[source](config, moves, pieces)
    downlink, link_wires = _downlink(config, moves, pieces)
    counts = arbitration.build(arbitration_parts(config.arbitration))
    guard = delocalized.machine(
        delocalized.DelocalizedConfig(
            tolerance_mm=config.tolerance_mm, position_limit_mm=config.motion.position_limit_mm
        )
    )
    uplink = _link("uplink", config.uplink, moves)
    more = behind(moves, guard, uplink)
    wires = {
        **{var: term for piece in pieces.values() for var, term in piece.wires.items()},
        **link_wires,
        **_into_arbitration(counts, moves, _all_stated(pieces, downlink)),
        **_into_guard(guard, counts, moves),
        **_into_uplink(uplink, guard, moves),
        **more.wires,
    }
    sources = [machine for piece in pieces.values() for machine in piece.machines]
    links = [downlink.machine] if downlink else []
    machines = (moves.machine, *sources, *links, counts.machine, guard, uplink.machine, *more.machines)
    owed = [one for piece in pieces.values() for one in piece.owed]
    whole = compose(
        name,
        machines,
        wires,
        shared=[*moves.shared, *more.shared],
        owes=[*owed, *links, counts.machine, guard, uplink.machine, *more.owes],
    )
    return Localizer(config, whole, moves, pieces, downlink, counts, guard, uplink)


# ------------------------------------------------------------------ the sources


def _same_distance(step: Optional, heard: Optional) -> dict[Var, Expr]:
    """An odometer input that hears a unit of the vehicle."""
    return {step.value: heard.value, step.present: heard.present}


def _told_distance(step: Optional, more: NumVar | None, moves: Motion) -> dict[Var, Expr]:
    """An odometer input that hears what is told of the vehicle's odometer."""
    if moves.own.check is None or more is None:
        return _same_distance(step, moves.own.odometer.step)
    says = moves.machine
    return {step.value: says.output("distance_mm"), step.present: moves.told, more: says.output("more_nm")}


def _odometry(config: LocalizerConfig, moves: Motion, _: Mapping[str, Piece]) -> Piece:
    own = odometry_parts(config.odometry, with_fault=config.odometry.single_fault_safe)
    own = replace(own, truth=moves.own.truth, true_step=moves.own.true_step)
    model = odometry.build(own)
    wires = [_same_distance(unit.step, heard) for unit, heard in zip(own.units, moves.own.inputs, strict=False)]
    return Piece((model.machine,), {var: term for one in wires for var, term in one.items()}, _plainly(model.machine))


def _balise(config: LocalizerConfig, moves: Motion, _: Mapping[str, Piece]) -> Piece:
    own = balise_parts(config.balise)
    world = replace(own.world, truth=moves.own.truth, true_step=moves.own.true_step)
    if moves.own.check is not None:
        world = replace(world, wander=moves.own.check.wander, next_wander=moves.own.check.next_wander)
    own = replace(own, world=world)
    machine = balise.build(own).machine
    wires = _told_distance(own.odometer.step, own.odometer.more, moves)
    return Piece((machine,), wires, _plainly(machine), _owed_law(Clause(machine, balise.ODOMETER), moves))


def _owed_law(law: Clause, moves: Motion) -> tuple[Clause, ...]:
    """With a check unit the law of the distance is owed by `motion`."""
    return () if moves.own.check is None else (law,)


def _plainly(machine: Machine) -> Stated:
    """What a machine states whose outputs have the common names and reasons."""
    return Stated(
        machine.flag("valid"),
        machine.output("position_mm"),
        machine.output("under_mm"),
        machine.output("over_mm"),
        machine.flag("reference_accepted"),
        machine.output("reason"),
    )


def _reflector(config: LocalizerConfig, moves: Motion, _: Mapping[str, Piece]) -> Piece:
    own = reflecting.parts(config.reflector)
    ghosts = replace(own.ghosts, truth=moves.own.truth, true_step=moves.own.true_step)
    if moves.own.check is not None:
        ghosts = replace(ghosts, wander=moves.own.check.wander, next_wander=moves.own.check.next_wander)
    own = replace(own, ghosts=ghosts)
    machine = reflector.build(own).machine
    error = machine.output("error")
    why = ite(error.eq(reflecting.TOLERANCE), TOLERANCE, CONTRADICTION)
    why = ite(error.one_of(reflecting.SENSOR_FAILURE, reflecting.NO_SELF_TEST), SENSOR_FAILURE, why)
    why = ite(error.one_of(reflecting.NO_POSITION, reflecting.NO_ERROR), NO_REFERENCE, why)
    stated = Stated(
        machine.flag("valid"),
        ite(machine.flag("valid"), machine.output("position_mm"), 0),
        ite(machine.flag("valid"), machine.output("under_mm"), 0),
        ite(machine.flag("valid"), machine.output("over_mm"), 0),
        machine.flag("valid") & machine.flag("precise") & machine.flag("recognised"),
        why,
    )
    wires = _told_distance(own.odometer.step, own.odometer.more, moves)
    return Piece((machine,), wires, stated, _owed_law(Clause(machine, reflector.ODOMETER), moves))


def _satellite(config: LocalizerConfig, moves: Motion, earlier: Mapping[str, Piece]) -> Piece:
    selection = satellite_selection.build(satellite_selection.parts(config.satellite.selection))
    own = replace(satellite_words.parts(config.satellite), truth=moves.own.truth)
    machine = satellites.build(own)
    wires: dict[Var, Expr] = {
        told: one.standing.eq(satellite_selection.USABLE)
        for told, one in zip(own.usable, selection.own.channels, strict=True)
    }
    wires[own.next_truth] = moves.own.truth
    trusted = next((earlier[name].stated for name in ("balise", "odometry", "reflector") if name in earlier), None)
    if trusted is not None:
        accuracy = maximum(trusted.under, trusted.over)
        heard = trusted.reference & (accuracy <= own.accuracy.high)
        wires |= {
            own.reference.present: heard,
            own.reference.value: ite(heard, trusted.position, 0),
            own.accuracy: ite(heard, accuracy, 0),
        }
    why = machine.output("reason")
    reason = ite(why.eq(satellite_words.TOLERANCE), TOLERANCE, NO_REFERENCE)
    reason = ite(why.eq(satellite_words.COASTED_OUT), SENSOR_FAILURE, reason)
    reason = ite(why.one_of(satellite_words.CONTRADICTION, satellite_words.DRIFT), CONTRADICTION, reason)
    stated = Stated(
        machine.flag("valid"),
        machine.output("position_mm"),
        machine.output("under_mm"),
        machine.output("over_mm"),
        machine.flag("valid") & machine.output("fix").eq(satellite_words.ACCEPTED),
        ite(machine.flag("valid"), LOCATED, reason),
    )
    owed = () if trusted is None else (Clause(machine, REFERENCE),)
    return Piece((selection.machine, machine), wires, stated, owed)


def _fibre(config: LocalizerConfig, moves: Motion, _: Mapping[str, Piece]) -> Piece:
    """The trackside's verified position; on board it is stated by the downlink."""
    model = verification.build(replace(verification.parts(config.fibre), truth=moves.own.truth))
    machine, trusted = model.machine, model.machine.flag("trusted")
    stated = Stated(
        trusted,
        machine.output("position_mm"),
        machine.output("under_mm"),
        machine.output("over_mm"),
        trusted,
        NO_REFERENCE,
    )
    return Piece((machine,), {model.own.next_truth: moves.own.truth}, stated)


_PIECES = {
    "odometry": _odometry,
    "balise": _balise,
    "reflector": _reflector,
    "satellite": _satellite,
    "fibre": _fibre,
}


# ------------------------------------------------------------------ what stands behind them


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
        **_into_link(link, stated.valid, stated.position, stated.under, stated.over),
        link.own.next_truth: moves.own.truth,
    }


def _link(name: str, config: TransmissionConfig, moves: Motion) -> Transmission:
    return transmission.build(replace(transmission.parts(config), truth=moves.own.truth), name)


def _into_link(link: Transmission, valid: Bool, position: Num, under: Num, over: Num) -> dict[Var, Expr]:
    return {link.own.valid: valid, link.own.position: position, link.own.under: under, link.own.over: over}


def _all_stated(pieces: Mapping[str, Piece], downlink: Transmission | None) -> dict[str, Stated]:
    """What arbitration hears, by source: of the fibre what has come on board."""
    stated = {name: piece.stated for name, piece in pieces.items()}
    if downlink is not None:
        machine = downlink.machine
        position, under, over = (machine.output(f"{what}_mm") for what in ("position", "under", "over"))
        held = machine.flag("valid")
        stated["fibre"] = Stated(held, position, under, over, held, NO_REFERENCE)
    return stated


def _into_arbitration(counts: Arbitration, moves: Motion, stated: Mapping[str, Stated]) -> dict[Var, Expr]:
    wires: dict[Var, Expr] = {
        counts.own.distance.value: moves.machine.output("distance_mm"),
        counts.own.distance.present: moves.told,
        counts.own.next_truth: moves.own.truth,
    }
    for source in counts.own.sources:
        wires |= _hears(source, stated[source.name])
    return wires


def _hears(source: Source, stated: Stated) -> dict[Var, Expr]:
    return {
        source.valid: stated.valid,
        source.position: stated.position,
        source.under: stated.under,
        source.over: stated.over,
        source.reference: stated.reference,
        source.reason: stated.reason,
    }


def _into_guard(guard: Machine, counts: Arbitration, moves: Motion) -> dict[Var, Expr]:
    sees, says = {var.name: var for var in guard.inputs if isinstance(var, (NumVar, BoolVar))}, counts.machine
    return {
        sees["source_valid"]: says.flag("valid"),
        sees["reference_accepted"]: says.flag("reference_accepted"),
        sees["source_reason"]: says.output("reason"),
        sees["source_position_mm"]: says.output("position_mm"),
        sees["source_over_mm"]: says.output("over_mm"),
        sees["source_under_mm"]: says.output("under_mm"),
        next(iter(guard.ghost_inputs)): moves.own.truth,
    }


def _into_uplink(uplink: Transmission, guard: Machine, moves: Motion) -> dict[Var, Expr]:
    numbers = (guard.output(f"{what}_mm") for what in ("position", "under", "over"))
    return {**_into_link(uplink, ~guard.flag("restrictive"), *numbers), uplink.own.next_truth: moves.own.truth}
