"""The run over which the odometry machine holds its position after a marker: a bound with a proof, and a run one millimetre beyond.

The machine that ships is made with the vehicle's figures. Its world is watched: it also counts the true run since one of its readers last
read a marker. The greatest run within which the machine does not withdraw its position is that of the audit's rule; a proof on the machine
and a run of it, one millimetre farther, show that this is the bound.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from safeloc.language.expr import (
    FALSE,
    Bool,
    BoolVar,
    Expr,
    NumVar,
    Var,
    all_of,
    any_of,
    as_num,
    between,
    boolean,
    ite,
    maximum,
    number,
    with_unit,
)
from safeloc.language.interpret import evaluate
from safeloc.language.machine import Machine
from safeloc.language.spec import always, observe
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.units import MM, NM, NM_PER_MM, PPM_PER_ONE
from safeloc.language.verdict import Verdict
from safeloc.models import odometry
from safeloc.models.layout_rules import LayoutConfig
from safeloc.models.layout_rules.marker_readers import MarkerReaders
from safeloc.models.layout_rules.markers import longest_measured_mm, longest_run_mm
from safeloc.models.odometry.marker_reading import ACCEPTED, NOT_BETTER
from safeloc.models.odometry.variables import OdometryConfig, parts
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove_one
from safeloc.railway.design.held_stretch import WITHDRAWN, HeldStretch

_READS = "which readings count is the machine's verdict; no clause reads what is counted"
_FARTHEST_NM, _FARTHEST_MM = 10**16, 10**10


@dataclass(frozen=True, eq=False)
class Followed:
    """The odometry machine in a world that also counts the run since a marker was read.

    end          the reader: 0 front, 1 rear
    accuracy_mm  markers of no greater accuracy count
    run          ghost: the true run since that reader stood over its last marker, nm
    measured     ghost: the distance measured since then, mm
    forwards     ghost: since then the vehicle ran forwards, and both units measured the same in every cycle
    """

    model: odometry.Odometry
    machine: Machine
    system: TransitionSystem
    end: int
    accuracy_mm: int
    run: NumVar
    measured: NumVar
    forwards: BoolVar


def followed(config: OdometryConfig, end: int, accuracy_mm: int) -> Followed:
    """Return the machine with its watched world. Its first marker is trusted, so that one marker locates."""
    model = odometry.build(parts(config.model_copy(update={"trust_first_marker": True})))
    own, seen = model.own, model.own.ghosts
    device, reader, reading = own.set_by(end), own.readers[end], model.judgement.readings[end]
    moved = model.judgement.moved(device)
    run, measured = number(f"run_since_{reader.name}_nm", NM, -_FARTHEST_NM, _FARTHEST_NM), _mm("measured_since_mm")
    half = device.units[0].law.wander_nm
    forwards, wander = boolean("measured_forwards"), number("wander_at_marker_nm", NM, -half, half)
    unit = seen.units[own.units.index(device.units[0])]
    accuracy = reader.accuracy.value_or(as_num(config.marker_accuracy_mm, MM))
    counts = reading.verdict.one_of(ACCEPTED, NOT_BETTER) & ~seen.readers[end].stray & (accuracy <= accuracy_mm)
    read = all_of([counts, reader.since.present, reader.since.value >= 0])
    alike = all_of(moved.admitted) & device.units[0].measured.value.eq(device.units[1].measured.value)
    farthest = (config.position_limit_mm - 2 * config.tolerance_mm) * NM_PER_MM
    on_line = between(-farthest, seen.truth + seen.true_cycle_distance, farthest)
    recent = (moved.age <= config.age_limit_ms) & (moved.run <= config.position_limit_mm)
    ahead = all_of([alike, device.units[0].measured.value >= 0, seen.true_cycle_distance >= 0, on_line, recent])
    farther, more = run + seen.true_cycle_distance, measured + moved.reach
    in_range = between(run.low, farther, run.high) & (more <= measured.high)
    behind = seen.readers[end].spot + (seen.length if end else as_num(0, NM))
    since_marker = seen.truth + seen.true_cycle_distance - behind
    fits = between(run.low, since_marker, run.high)
    moves: dict[Var, Expr] = {
        run: ite(read & fits, since_marker, ite(in_range, farther, run)),
        measured: ite(read & fits, reader.since.value, ite(in_range, more, measured)),
        wander: ite(read & fits, unit.next_wander, wander),
        forwards: ahead & ((read & fits) | all_of([forwards, in_range, model.machine.flag("valid")])),
    }
    world = model.machine.world
    ghosts = {**world.ghosts, run: 0, measured: 0, wander: 0, forwards: False}
    machine = replace(
        model.machine,
        world=replace(world, ghosts=ghosts, moves={**world.moves, **moves}, reads_machine=_READS),
        lemmas={**model.machine.lemmas, **_lemmas(model, end, accuracy_mm, (run, measured, wander), forwards)},
    )
    return Followed(model, machine, lower(machine), end, accuracy_mm, run, measured, forwards)


def _mm(name: str) -> NumVar:
    return number(name, MM, 0, _FARTHEST_MM)


def _lemmas(
    model: odometry.Odometry, end: int, accuracy_mm: int, watched: tuple[NumVar, NumVar, NumVar], forwards: BoolVar
) -> dict[str, Bool]:
    own, (run, measured, wander) = model.own, watched
    device, figures = own.set_by(end), layout_of(own.config)
    law, readers = device.units[0].law, figures.readers
    fixed = readers.fix_error_nm(accuracy_mm, law.rate_ppm) + law.constant_mm * NM_PER_MM
    most = with_unit(measured * law.rate_ppm, NM) + fixed
    near = any_of(unit.alive & (maximum(unit.above, unit.below) <= most) for unit in device.units)
    held = most <= own.config.tolerance_mm * NM_PER_MM
    located = model.machine.flag("valid") & forwards
    now = own.ghosts.units[own.units.index(device.units[0])].wander
    least = with_unit(measured * (PPM_PER_ONE - law.rate_ppm), NM)
    return {
        "the margin since a marker is the audit's at most": (located & held).implies(near),
        "the measured run exceeds the true one by the law at most": forwards.implies(
            least <= run + readers.unsteady_nm - (now - wander)
        ),
    }


def layout_of(config: OdometryConfig) -> LayoutConfig:
    """Return the audit's figures for the machine's configuration, whose units have one law."""
    names = set(MarkerReaders.model_fields) - {"groups_are_markers"}
    return LayoutConfig(
        tolerance_mm=config.tolerance_mm,
        odometry_constant_mm=config.first_unit.constant_mm,
        odometry_rate_ppm=config.first_unit.rate_ppm,
        markers=MarkerReaders(**config.model_dump(include=names)),
    )


# ------------------------------------------------------------------ the bound


def held_run(config: OdometryConfig, accuracy_mm: int) -> HeldStretch | None:
    """Return the bound after a marker of that accuracy, by the audit's rule; None if no run is too long or none is short enough."""
    figures = layout_of(config)
    fix = as_num(figures.readers.fix_error_nm(accuracy_mm, figures.odometry_rate_ppm), NM)
    if figures.odometry_rate_ppm == 0:
        return None
    terms = [longest_measured_mm(fix, figures), longest_run_mm(fix, as_num(0, MM), figures)]
    kept, run = (int(found) for found in evaluate(terms, {}))
    if run < 0:
        return None
    first = {f"{unit}_wander_nm": config.first_unit.wander_nm for unit in _units(config)}
    return HeldStretch(
        accuracy_mm, run, kept + 1, tuple(_steps(config, accuracy_mm, kept + 1)), {"truth_nm": 0, **first}
    )


def _steps(config: OdometryConfig, accuracy_mm: int, measured_mm: int) -> Iterator[dict[str, int | bool]]:
    """Yield a run at the highest speed: the front reader passes a marker, a vehicle's length later the rear one does, and from there on
    every unit measures too much, as far as its law allows, until it has measured so much.
    """
    half, rate = config.first_unit.wander_nm, config.first_unit.rate_ppm
    farthest = config.limits.max_cycle_distance_mm
    passing = _passing(config, farthest)
    yield _step(config, farthest, passing[0], half)
    marker = 2 * passing[0] + layout_of(config).readers.unsteady_nm
    yield _step(config, farthest, passing[0], half) | _reading("front", accuracy_mm, marker)
    for true in passing[1:-1]:
        yield _step(config, farthest, true, half)
    yield _step(config, farthest, passing[-1], half) | _reading("rear", accuracy_mm, marker)
    run, wander = 0, half
    for step in _slowing_down(config, measured_mm):
        run += step
        after = half - 2 * half * run // measured_mm
        yield _step(config, step, step * (PPM_PER_ONE - rate) + after - wander, after)
        wander = after


def _passing(config: OdometryConfig, farthest_mm: int) -> list[int]:
    """Return true distances of cycles, nm: one in which the front reader passes a marker, and those until the rear one does."""
    least = farthest_mm * (PPM_PER_ONE - config.first_unit.rate_ppm)
    length = config.vehicle_length_mm * NM_PER_MM
    number = max(1, length // least)
    return [least, *(length * (at + 1) // number - length * at // number for at in range(number))]


def _step(config: OdometryConfig, measured_mm: int, true_nm: int, wander_nm: int) -> dict[str, int | bool]:
    step: dict[str, int | bool] = {
        "true_cycle_distance_nm": true_nm,
        "true_length_nm": config.vehicle_length_mm * NM_PER_MM,
        **{f"{name}_marker_spot_nm": 0 for name in ("front", "rear")},
        **{f"{name}_marker_stray": False for name in ("front", "rear")},
    }
    for unit in _units(config):
        step |= {f"{unit}_mm": measured_mm, f"{unit}_next_wander_nm": wander_nm}
    return step


def _units(config: OdometryConfig) -> list[str]:
    laws = config.first_unit, config.second_unit
    return [f"{end}_{law.kind}" for end in ("front", "rear")[: config.devices] for law in laws]


def _reading(end: str, accuracy_mm: int, spot_nm: int) -> dict[str, int | bool]:
    figures = {"position_mm": spot_nm // NM_PER_MM, "accuracy_mm": accuracy_mm, "since_mm": 0, "spot_nm": spot_nm}
    return {f"{end}_marker": 1, **{f"{end}_marker_{name}": value for name, value in figures.items()}}


def _slowing_down(config: OdometryConfig, total_mm: int) -> list[int]:
    """Return distances of cycles with that sum, from the greatest one on; none differs from the one before by more than the machine admits."""
    farthest, change = config.limits.max_cycle_distance_mm, config.limits.max_cycle_distance_change_mm
    number = -(-total_mm // farthest)
    short, last = number * farthest - total_mm, 0
    while change * last * (last + 1) // 2 < short:
        last += 1
    over = change * last * (last + 1) // 2 - short
    less = [change * (at + 1) - over // last - (at >= last - over % last) for at in range(last)]
    return [farthest] * (number - last) + [farthest - one for one in less]


# ------------------------------------------------------------------ its proof


def proof_of(one: Followed, run_mm: int, limits: Limits) -> Verdict:
    """Prove on the machine that it holds its position as far as the bound says, after any reading by that reader."""
    lost = one.machine.fired(WITHDRAWN) & one.forwards & (one.run <= run_mm * NM_PER_MM)
    claim = always(
        f"the position is held for {run_mm} mm after a marker",
        lost.implies(FALSE),
        statement="while the vehicle runs forwards, both units measure the same in every cycle and the run since the reader's last marker "
        "is no longer, the machine does not withdraw its position for its tolerance",
    )
    return prove_one(observe(one.system, claim), limits)
