"""Position from radar reflectors near them, from odometry between them (RFL-1 to RFL-3, RFL-5, RFL-6, RFL-8, RFL-10).

    DELOCALIZED  nothing is reported; only an accepted balise leads out
    NOT_READY    odometry alone, without or after a failed self-test, until another balise
    REFERENCE    self-test: after a balise, its reflector has to be measured at the prescribed distance
    ODOMETRY     between reflectors; whatever echoes come are things beside the track
    SEARCH       the next reflector may come into view, and is looked for
    VIEW         it is measured: its echo has the minimum intensity and passed every check
    COAST        it should be in view, but was not measured in this cycle
    PASSING      too close for an echo that can be evaluated, until it lies behind

In VIEW the position is that of the measurement, with the measurement's own error bound, be it better or worse than
what was known before. In every other mode odometry goes on from the last position, with a growing margin.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from safeloc.language.expr import (
    TRUE,
    Bool,
    Expr,
    Lit,
    Num,
    Var,
    all_of,
    as_num,
    between,
    ceil_to,
    exact_to,
    ite,
    members,
)
from safeloc.language.machine import ANY, Initial, Machine, current_mode, modes
from safeloc.language.units import MM, NM
from safeloc.models.reflector.cycle import Judged, Zones, judge
from safeloc.models.reflector.echo import Judgement
from safeloc.models.reflector.map_data import Reflector, is_it_or_clear
from safeloc.models.reflector.table import rows
from safeloc.models.reflector.variables import NO_POSITION, Parts, ReflectorConfig, parts
from safeloc.models.vocabulary.error_law import NM_PER_MM
from safeloc.models.vocabulary.reflectors import NO_MODEL

SOURCE = members("source", "NONE", "ODOMETRY", "REFLECTOR")
NO_SOURCE, BY_ODOMETRY, BY_REFLECTOR = SOURCE
MODES = ("DELOCALIZED", "NOT_READY", "REFERENCE", "ODOMETRY", "SEARCH", "VIEW", "COAST", "PASSING")


def machine(config: ReflectorConfig | None = None) -> Machine:
    """The reflector machine of a vehicle (RFL-1 to RFL-3, RFL-5, RFL-6, RFL-8, RFL-10, RFL-D2, RFL-D3)."""
    return build(parts(config or ReflectorConfig())).machine


@dataclass(frozen=True, eq=False)
class ReflectorMachine:
    """The machine together with the terms it was built from, for properties to speak about."""

    machine: Machine
    own: Parts
    judged: Judged

    def in_mode(self, *labels: str) -> Bool:
        """The machine is in one of the named modes."""
        mode = self.machine.mode
        return mode.one_of(*(Lit(MODES.index(label), mode.unit) for label in labels))


def build(own: Parts) -> ReflectorMachine:
    """The machine over the given variables."""
    mode = modes(*MODES)
    current = current_mode(mode)
    judged = judge(own, _zones(current, mode))
    made = Machine(
        name="reflector",
        modes=mode,
        inputs=[
            *own.odometer.inputs,
            own.frame,
            *(var for slot in own.slots for var in slot.inputs),
            *own.balise.inputs,
            *own.ahead.inputs,
            own.contradicted,
        ],
        state=_state(own),
        outputs=_outputs(own, current, mode),
        transitions=list(rows(own, judged, mode)),
        ghosts={own.ghosts.truth: ANY, own.ghosts.wander: ANY},
        ghost_inputs=[
            own.ghosts.true_step,
            own.ghosts.next_wander,
            *own.ghosts.reflector,
            *own.ghosts.origin,
        ],
        ghost_moves={
            own.ghosts.truth: own.ghosts.truth + own.ghosts.true_step,
            own.ghosts.wander: _wander_after(own),
        },
        assumption=assumption(own, judged),
        clauses={ODOMETER: _odometer_law(own)},
        lemmas=_lemmas(own, current, mode),
        definitions=_definitions(judged),
        mode_variable=current,
        doc=(
            "Position of end A from the range to radar reflectors near them, and from odometry between them. Assumed: "
            "a measured distance that passes the speed gate obeys the odometer's error law, and no cycle runs farther "
            "than the highest speed allows; a balise that does not contradict the position is true within its accuracy; "
            "an echo of a reflector gives its range within the echo's error bound; at or above the minimum intensity a "
            "reflector's model is read correctly; reflectors stand where the map has them within its accuracy, and no "
            "other one of the same model is nearer to one than the map says; no other thing shows the looked-for model "
            "with the minimum intensity at a range that fits. Nothing is assumed of any other echo."
        ),
    )
    return ReflectorMachine(made, own, judged)


def _zones(current: Num, mode: tuple[Lit, ...]) -> Zones:
    lost, _, reference, _, search, view, coast, passing = mode
    return Zones(
        located=current.ne(lost),
        exact=current.eq(view),
        in_view=current.one_of(view, coast, passing),
        referring=current.eq(reference),
        searching=current.eq(search),
    )


def _state(own: Parts) -> dict[Var, Initial]:
    verdicts: dict[Var, Initial] = {var: 0 for slot in own.slots for var in (slot.judged, slot.judged_next)}
    return {
        **own.track.state(),
        **own.anchor.state(),
        **own.target.state(),
        own.odometer.gap: 0,
        own.reference: 0,
        own.search_from: 0,
        own.run: 0,
        own.procedure: 0,
        own.found: own.found.low,
        own.pauses: 0,
        own.misses: 0,
        own.recognised: False,
        own.range: 0,
        own.range_error: 0,
        own.lateral: 0,
        own.error: NO_POSITION,
        **verdicts,
    }


def _outputs(own: Parts, current: Num, mode: tuple[Lit, ...]) -> dict[str, Expr]:
    lost, _, reference, odometry, search, view, coast, passing = mode
    valid, precise = current.ne(lost), current.eq(view)
    sighted = current.one_of(reference, search, view, coast, passing)
    return {
        "valid": valid,
        "position_mm": own.track.position,
        "over_mm": ceil_to(own.track.over, MM),
        "under_mm": ceil_to(own.track.under, MM),
        "precise": precise,
        "ready": current.one_of(odometry, search, view, coast, passing),
        "searching": current.one_of(reference, search),
        "source": ite(precise, BY_REFLECTOR, ite(valid, BY_ODOMETRY, NO_SOURCE)),
        "error": own.error,
        "recognised": own.recognised,
        "reflector_model": ite(sighted, own.target.model, NO_MODEL),
        "reflector_position_mm": ite(sighted, own.target.position, 0),
        "range_mm": own.range,
        "range_error_mm": own.range_error,
        "lateral_mm": own.lateral,
    }


def _definitions(cycle: Judged) -> dict[str, Expr]:
    """Names for what the table speaks of."""
    named: dict[str, Expr] = {
        "reference measurement starts": cycle.started,
        "target measured": cycle.target.accepted,
        "next reflector measured": cycle.ahead.accepted,
        "echoes for the target conflict": cycle.target.conflict,
        "prescribed distance holds": cycle.reference_holds,
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


# ------------------------------------------------------------------ the environment, and what helps to prove


ODOMETER = "the odometer keeps its law"
"""The clause that an earlier machine can be made to keep, if it judges the distance."""


def _wander_after(own: Parts) -> Num:
    """Of a distance that comes judged it may move in every cycle: whatever it does is charged."""
    told = TRUE if own.config.told_distance else own.odometer.admitted
    return ite(told, own.ghosts.next_wander, own.ghosts.wander)


def _odometer_law(own: Parts) -> Bool:
    """What a cycle is charged covers what its distance misses."""
    ghosts, odometer = own.ghosts, own.odometer
    error = ghosts.true_step - exact_to(odometer.moved, NM) - (_wander_after(own) - ghosts.wander)
    return between(-odometer.growth, error, odometer.growth)


def assumption(own: Parts, cycle: Judged) -> Bool:
    """Error laws of balise and radar, the layout rules of the map, and what clutter does not do; the odometer is a clause."""
    after = own.ghosts.truth + own.ghosts.true_step
    balise = (own.balise.read & ~cycle.balise_contradicts).implies(cycle.balise.holds(after))
    on_line = between(own.ghosts.truth.low, after, own.ghosts.truth.high)
    return all_of([balise, on_line, *_radar_law(own, cycle, after)])


def _radar_law(own: Parts, cycle: Judged, after: Num) -> Iterator[Bool]:
    """Per slot: range law, recognition and layout, and clutter."""
    looked_for = ((cycle.target.judgements, cycle.reflector), (cycle.ahead.judgements, own.ahead.reflector))
    for index, slot in enumerate(own.slots):
        real, origin = own.ghosts.reflector[index], own.ghosts.origin[index]
        forward, backward = cycle.now.lag
        bound = exact_to(slot.error, NM)
        off = after - (origin + own.config.radar_offset_mm * NM_PER_MM - exact_to(slot.range.value, NM))
        yield (real & slot.range.present & own.frame).implies(between(-bound - backward, off, bound + forward))
        for judgements, reflector in looked_for:
            yield judgements[index].fits.implies(real)
            yield (real & _seems(judgements[index], reflector, own)).implies(
                is_it_or_clear(reflector, origin, own.config.radar_offset_mm, own.config.accuracy_nm)
            )


def _seems(one: Judgement, reflector: Reflector, own: Parts) -> Bool:
    """An echo of the reflector's model with the minimum intensity."""
    strong = one.slot.intensity >= own.config.minimum_intensity_cdb
    return one.slot.range.present & strong & one.slot.model.eq(reflector.model)


def _lemmas(own: Parts, current: Num, mode: tuple[Lit, ...]) -> dict[str, Bool]:
    lost, *_, view, coast, passing = mode
    truth, wander = own.ghosts.truth, own.ghosts.wander
    half = as_num(own.odometer.law.wander_nm, NM)

    def reckoned(position: Num, over: Num, under: Num) -> Bool:
        off = truth - exact_to(position, NM) - wander
        return between(half - under, off, over - half)

    track, anchor = own.track, own.anchor
    located = all_of([current.ne(lost), current.ne(view)])
    return {
        "a dead-reckoned interval holds the truth": located.implies(reckoned(track.position, track.over, track.under)),
        "a measured interval holds the truth": current.eq(view).implies(track.interval.holds(truth)),
        "the anchor holds the truth": current.one_of(view, coast, passing).implies(
            reckoned(anchor.position, anchor.over, anchor.under)
        ),
        "nothing is kept while delocalized": current.eq(lost).implies(
            all_of(var.eq(0) for var in (track.position, track.over, track.under))
        ),
        "no range outside the view zone": current.ne(view).implies(own.range.eq(0)),
    }
