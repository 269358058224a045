"""Position from radar reflectors near them, from odometry between them (RFL-1 to RFL-3, RFL-5, RFL-6, RFL-8, RFL-10).

    DELOCALIZED  nothing is reported; only an accepted balise leads out
    NOT_READY    odometry alone until the next balise: no self-test yet, a failed one, or one that passed too long ago
    REFERENCE    self-test: after a balise, the radar has to measure the balise's reflector at the prescribed distance
    ODOMETRY     between reflectors; every echo is taken for a thing beside the track
    SEARCH       the next reflector may come into view, and the machine searches its echo
    VIEW         the radar measures the reflector: its echo has the minimum intensity and passed every check
    COAST        the reflector should be in view, but was not measured in this cycle
    PASSING      the reflector is too close for a usable echo, and does not surely lie behind yet

In VIEW the machine reports the measured position with the measurement's own error bound, even if the position was known
better before. The bound consists of the echo's error, the radar error that the last self-test could not exclude, and the
radar's drift since then. In every other mode odometry goes on from the last position, with a growing margin.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

from safeloc.language.expr import Bool, Expr, Lit, Num, all_of, as_num, between, ceil_to, exact_to, ite
from safeloc.language.machine import Machine, Model, current_mode, modes
from safeloc.language.units import MM, NM
from safeloc.models.reflector.cycle import Judgement, Zones, judge
from safeloc.models.reflector.table import rows
from safeloc.models.reflector.variables import (
    BY_ODOMETRY,
    BY_REFLECTOR,
    MODES,
    NO_SOURCE,
    Parts,
    ReflectorConfig,
    parts,
)
from safeloc.models.reflector.world import ODOMETER, named, world
from safeloc.models.vocabulary.absent import margin_if, position_if
from safeloc.models.vocabulary.reflectors import NO_MODEL

__all__ = ["ODOMETER", "ReflectorMachine", "build", "machine"]


def machine(config: ReflectorConfig | None = None) -> Machine:
    """Return the reflector machine of a vehicle (RFL-1 to RFL-3, RFL-5, RFL-6, RFL-8, RFL-10, RFL-D2, RFL-D3)."""
    return build(parts(config or ReflectorConfig())).machine


@dataclass(frozen=True, eq=False)
class ReflectorMachine(Model[Parts]):
    """The machine with the variables and terms that its properties read."""

    judgement: Judgement


def build(own: Parts) -> ReflectorMachine:
    """Return the machine over the given variables."""
    mode = modes(*MODES)
    current = current_mode(mode)
    judgement = judge(own, _zones(current, mode))
    made = own.declared.machine(
        name="reflector",
        modes=mode,
        outputs=_outputs(own, current, mode),
        transitions=list(rows(own, judgement, mode)),
        world=world(own, current.eq(mode[0])),
        lemmas=_lemmas(own, current, mode),
        definitions=_definitions(judgement),
        doc=(
            "Position of end A: near a radar reflector from the range to it, elsewhere from odometry. Assumed: a measured "
            "distance that a vehicle can have run obeys the odometer's error law, and the vehicle runs no faster than its "
            "highest speed; a balise reading is true within its accuracy, or, while a position is known, comes from a balise "
            "far away; the error of a range is at most the echo's error bound, plus the radar's scale error, plus a systematic "
            "error of any size that drifts no faster than stated; at or above the minimum intensity the radar shows the model "
            "of the reflector that truly sent the echo, or none, and receives no reflector from beyond the strong range; reflectors stand "
            "where the map has them within its accuracy, and it has no other one of the same model nearer than it says; the prescribed "
            "distance from a balise to its reflector is that of the map; no other thing shows a reflector's signature with "
            "the minimum intensity. Nothing is assumed of any other echo."
        ),
    )
    return ReflectorMachine(made, own, judgement)


def _zones(current: Num, mode: tuple[Lit, ...]) -> Zones:
    lost, _, reference, odometry, search, view, coast, passing = mode
    return Zones(
        located=current.ne(lost),
        ready=current.one_of(odometry, search, view, coast, passing),
        exact=current.eq(view),
        in_view=current.one_of(view, coast, passing),
        referring=current.eq(reference),
        searching=current.eq(search),
    )


def _outputs(own: Parts, current: Num, mode: tuple[Lit, ...]) -> dict[str, Expr]:
    lost, _, reference, odometry, search, view, coast, passing = mode
    valid, precise = current.ne(lost), current.eq(view)
    sighted = current.one_of(reference, search, view, coast, passing)
    return {
        "valid": valid,
        "position_mm": position_if(valid, own.track.position),
        "margin_above_mm": margin_if(valid, ceil_to(own.track.above, MM)),
        "margin_below_mm": margin_if(valid, ceil_to(own.track.below, MM)),
        "precise": precise,
        "ready": current.one_of(odometry, search, view, coast, passing),
        "searching": current.one_of(reference, search),
        "source": ite(precise, BY_REFLECTOR, ite(valid, BY_ODOMETRY, NO_SOURCE)),
        "error": own.error,
        "recognised": own.recognised_now,
        "reflector_model": ite(sighted, own.target.model, NO_MODEL),
        "reflector_position_mm": position_if(sighted, own.target.position),
        "range_mm": own.range,
        "range_error_mm": own.measured_error,
        "lateral_mm": own.lateral,
    }


def _definitions(cycle: Judgement) -> dict[str, Expr]:
    """Return the terms that guards are made of, by name."""
    named: dict[str, Expr] = {
        "reference measurement starts": cycle.started,
        "target measured": cycle.target.accepted,
        "next reflector measured": cycle.ahead.accepted,
        "echoes for the target conflict": cycle.target.conflict,
        "prescribed distance holds": cycle.reference_holds,
        "radar is right as far as seen": cycle.agrees,
        "self-test is too long ago": cycle.stale,
        "self-test grows too coarse": cycle.too_coarse,
        "balise contradicts": cycle.balise_contradicts,
        "tolerable without an echo": cycle.tolerable,
        "search zone opens": cycle.search_opens,
        "search zone is over": cycle.search_over,
        "error is constant": cycle.steady,
        "too close": cycle.too_close,
        "lies behind": cycle.gone_by,
        "lost": cycle.lost,
    }
    for one in cycle.target.judgements:
        named[f"echo {one.slot.number} for the target"] = one.verdict
    for one in cycle.ahead.judgements:
        named[f"echo {one.slot.number} for the next reflector"] = one.verdict
    return named


# ------------------------------------------------------------------ lemmas


def _reckoned(own: Parts, position: Num, above: Num, below: Num, wrong: Num | None = None) -> Bool:
    """Return that a dead-reckoned interval holds the truth (less `wrong`), apart from the odometer's wander."""
    half = as_num(own.odometer.law.wander_nm, NM)
    where = own.ghosts.truth if wrong is None else own.ghosts.truth - wrong
    off = where - exact_to(position, NM) - own.ghosts.wander
    return between(half - below, off, above - half)


def _lemmas(own: Parts, current: Num, mode: tuple[Lit, ...]) -> dict[str, Bool]:
    lost, _, reference, odometry, search, view, coast, passing = mode
    truth = own.ghosts.truth
    ready = current.one_of(odometry, search, view, coast, passing)
    reckoned = partial(_reckoned, own)
    track, anchor = own.track, own.anchor
    located = all_of([current.ne(lost), current.ne(view)])
    on_map = named(own, own.ghosts.announced) | named(own, own.ghosts.sought)
    return {
        "a dead-reckoned interval holds the truth": located.implies(reckoned(track.position, track.above, track.below)),
        "a measured interval holds the truth": current.eq(view).implies(track.interval.holds(truth)),
        "a measured interval holds where the radar has the truth": current.eq(view).implies(
            between(
                own.open_short - track.below,
                truth - own.ghosts.bias - exact_to(track.position, NM),
                track.above - own.open_long,
            )
        ),
        "a measured interval includes the error left open": current.eq(view).implies(
            (track.above >= own.open_long) & (track.below >= own.open_short)
        ),
        "in a self-test the anchor holds the truth": current.eq(reference).implies(
            reckoned(anchor.position, anchor.above, anchor.below)
        ),
        "in view the anchor holds where the radar has the truth": current.one_of(view, coast, passing).implies(
            reckoned(anchor.position, anchor.above, anchor.below, own.ghosts.bias)
        ),
        "the reference is where the balise has it": (current.eq(reference) & on_map).implies(
            between(
                -own.config.map_accuracy_mm,
                own.reference - own.run_since_balise + anchor.position - own.target.position,
                own.config.map_accuracy_mm,
            )
        ),
        "the radar's error is within the error left open": ready.implies(
            between(-own.open_short, own.ghosts.bias, own.open_long)
        ),
        "no interval stays stored while delocalized": current.eq(lost).implies(
            all_of(var.eq(0) for var in (track.position, track.above, track.below))
        ),
        "the target is an entry of the map": current.one_of(reference, search, view, coast, passing).implies(
            own.target.model.ne(NO_MODEL) & on_map
        ),
        "no range outside the view zone": current.ne(view).implies(own.range.eq(0)),
    }
