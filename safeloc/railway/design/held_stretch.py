"""The stretch over which the balise machine holds its position after a group: a bound with a proof, and a run one millimetre beyond.

The machine that ships is made with the vehicle's figures. Its world is watched: it also counts the true run since the last group. The
greatest run within which the machine never withdraws its position is that of the audit's rule; a proof on the machine and a run of it,
one millimetre farther, show that this is the bound.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from safeloc.language.expr import (
    FALSE,
    Bool,
    BoolVar,
    Expr,
    NumVar,
    Var,
    all_of,
    as_num,
    between,
    boolean,
    exact_to,
    ite,
    number,
    with_unit,
)
from safeloc.language.interpret import evaluate, start, taken
from safeloc.language.machine import Machine
from safeloc.language.spec import Property, always, earlier_num, observe
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.units import MM, NM, NM_PER_MM, PPM_PER_ONE
from safeloc.language.verdict import Verdict
from safeloc.models import balise
from safeloc.models.balise import variables as v
from safeloc.models.balise.reckoning import layout
from safeloc.models.balise.variables import BaliseConfig, parts
from safeloc.models.layout_rules import longest_measured_mm, longest_stretch_mm
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove_one

WITHDRAWN = "tolerance exceeded"
"""The transition by which the machine withdraws its position because its margin is too wide."""
_FARTHEST_NM = 10**16


@dataclass(frozen=True, eq=False)
class Watched:
    """The balise machine in a world that also counts the true run since the last group.

    run       ghost: the true run since the group that set the interval, nm
    forwards  ghost: since that group the whole way was measured, forwards
    """

    model: balise.Balise
    machine: Machine
    system: TransitionSystem
    run: NumVar
    forwards: BoolVar


def watched(config: BaliseConfig) -> Watched:
    """Return the machine with its watched world. Its first group is trusted, so that one group locates."""
    model = balise.build(parts(config.model_copy(update={"trust_first_group": True})))
    own, seen = model.own, model.own.world
    run, forwards = number("run_since_group_nm", NM, -_FARTHEST_NM, _FARTHEST_NM), boolean("measured_forwards")
    half = own.config.odometer.wander_nm
    wander = number("wander_at_group_nm", NM, -half, half)
    since, accepted = own.read.since, model.judgement.accepted
    measured, admitted = own.odometer.measured.value, own.odometer.admitted
    farther = run + seen.true_cycle_distance
    moves: dict[Var, Expr] = {
        run: ite(accepted, seen.true_since, ite(between(run.low, farther, run.high), farther, run)),
        wander: ite(accepted, seen.reading_wander, wander),
        forwards: (accepted & since.present & (since.value >= 0))
        | all_of([~accepted, forwards, admitted, measured >= 0, between(run.low, farther, run.high)]),
    }
    world = model.machine.world
    ghosts = {**world.ghosts, run: 0, wander: 0, forwards: False}
    lemmas = _lemmas(model, run, wander, forwards)
    machine = replace(
        model.machine,
        world=replace(world, ghosts=ghosts, moves={**world.moves, **moves}),
        lemmas={**model.machine.lemmas, **lemmas},
    )
    return Watched(model, machine, lower(machine), run, forwards)


def _lemmas(model: balise.Balise, run: NumVar, wander: NumVar, forwards: BoolVar) -> dict[str, Bool]:
    own = model.own
    located = model.machine.flag("valid") & forwards
    least = exact_to(own.memory.run, NM) - with_unit(own.memory.run * own.config.odometer.rate_ppm, NM)
    return {
        "a run watched forwards is measured as a whole": located.implies(own.memory.measured),
        "the measured run exceeds the true one by the law at most": located.implies(
            least <= run - (own.world.wander - wander)
        ),
    }


def _held_within(one: Watched, run_mm: int, accuracy_mm: int) -> Property:
    """Claim that the position is not withdrawn for its tolerance within that true run after a group of that accuracy."""
    own = one.model.own
    line = own.config.position_limit_mm * NM_PER_MM
    reached = earlier_num(own.held.position) + exact_to(own.odometer.distance, NM)
    lost = one.machine.fired(WITHDRAWN) & own.memory.verdict.ne(v.ACCEPTED)
    on_line = between(-line, reached, line)
    near = all_of([on_line, one.forwards, one.run <= run_mm * NM_PER_MM, own.memory.accuracy <= accuracy_mm])
    return always(
        f"the position is held for {run_mm} mm after a group",
        (lost & near).implies(FALSE),
        statement="while the vehicle runs forwards, every distance is measured and the run since the last group is no longer, the "
        "machine does not withdraw its position for its tolerance",
    )


# ------------------------------------------------------------------ the bound


@dataclass(frozen=True, eq=False)
class HeldStretch:
    """The stretch over which a machine holds its position after a group, or after a marker that its rear reader read.

    accuracy_mm  location accuracy of the group or marker
    run_mm       the greatest true run, whole mm, within which it is never withdrawn; negative: no run at all
    measured_mm  the least measured distance at which it is withdrawn
    steps        a run of the machine that withdraws it within 1 mm more, inputs and ghosts by name
    first        the values of the first state that the world chooses
    """

    accuracy_mm: int
    run_mm: int
    measured_mm: int
    steps: Sequence[Mapping[str, int | str]]
    first: Mapping[str, int]


def held_stretch(config: BaliseConfig, accuracy_mm: int) -> HeldStretch | None:
    """Return the bound after a group of that accuracy, by the audit's rule; None if no run is too long, since the error does not grow."""
    fix_mm, law = accuracy_mm + config.detection_mm, config.odometer
    if fix_mm + law.constant_mm >= config.tolerance_mm:
        return HeldStretch(accuracy_mm, -1, 0, (), {})
    if law.rate_ppm == 0:
        return None
    figures, fix = layout(config), as_num(fix_mm, MM)
    kept, run = (
        int(found) for found in evaluate([longest_measured_mm(fix, figures), longest_stretch_mm(fix, figures)], {})
    )
    steps = tuple(_steps(config, accuracy_mm, kept + 1))
    return HeldStretch(accuracy_mm, run, kept + 1, steps, _first(config, accuracy_mm))


def _first(config: BaliseConfig, accuracy_mm: int) -> dict[str, int]:
    """The front end stands where the antenna reads the group as early as it may; the odometer has all of its constant before it."""
    ahead = config.antenna_mm - config.detection_mm - accuracy_mm
    return {"truth_nm": ahead * NM_PER_MM, "odometer_wander_nm": config.odometer.wander_nm}


def _steps(config: BaliseConfig, accuracy_mm: int, measured_mm: int) -> list[dict[str, int | str]]:
    """Return a run that measures so much, always as much too long as the law allows, after a group at the place 0."""
    law, half = config.odometer, config.odometer.wander_nm
    spot = {"read_place_nm": -accuracy_mm * NM_PER_MM, "true_since_nm": 0}
    still = {
        "odometer_mm": 0,
        "true_cycle_distance_nm": 0,
        "odometer_next_wander_nm": half,
        "reading_wander_nm": half,
        **spot,
    }
    steps: list[dict[str, int | str]] = [{**still, "national_accuracy_mm": accuracy_mm}, {**still, **_TELEGRAM}]
    run, wander = 0, half
    for run_step in _speeding_up(config, measured_mm):
        run += run_step
        after = half - 2 * half * run // measured_mm
        true = run_step * (PPM_PER_ONE - law.rate_ppm) + after - wander
        steps.append(
            {**still, "odometer_mm": run_step, "true_cycle_distance_nm": true, "odometer_next_wander_nm": after}
        )
        wander = after
    return steps


_TELEGRAM: dict[str, int | str] = {
    "telegram_group": 1, "telegram_link": "LINKED", "telegram_check": "PASSED", "telegram_total": 2, "telegram_read": 2,
    "telegram_first": 1, "telegram_last": 2, "telegram_age_ms": 0, "telegram_since_mm": 0, "telegram_position_mm": 0,
    "telegram_orientation": "NOMINAL",
}  # fmt: skip
"""A group of two balises at the place 0, read in the cycle in which the antenna stands over it."""


def _speeding_up(config: BaliseConfig, total_mm: int) -> list[int]:
    """Return distances of cycles with that sum; none changes by more than the machine takes for possible."""
    change, most = (
        max(1, config.limits.max_cycle_distance_change_mm // 2),
        max(1, config.limits.max_cycle_distance_mm * 9 // 10),
    )
    steps, left, next_mm = list[int](), total_mm, 0
    while (next_mm := min(next_mm + change, most)) <= left:
        steps.append(next_mm)
        left -= next_mm
    return sorted([*steps, left]) if left else steps


# ------------------------------------------------------------------ its proof and its run


def proof_of(one: Watched, held: HeldStretch, limits: Limits) -> Verdict:
    """Prove on the machine that it holds its position as far as the bound says."""
    return prove_one(observe(one.system, _held_within(one, held.run_mm, held.accuracy_mm)), limits)


class _Counting(Protocol):
    """A machine in a world that counts the true run since a reference, and whether all of it was measured forwards."""

    @property
    def system(self) -> TransitionSystem: ...
    @property
    def run(self) -> NumVar: ...
    @property
    def forwards(self) -> BoolVar: ...


def broken_beyond(one: _Counting, held: HeldStretch) -> int | None:
    """Return the cycle, from 0, in which the run withdraws the position within 1 mm more than the bound, by the reference
    interpreter; None if it does not, or if the run breaks a law of the world.
    """
    system = one.system
    made = taken(system, start(system, held.first), held.steps, while_=system.assume)
    for cycle, (moved, state) in enumerate(made):
        if WITHDRAWN in moved.fired.values():
            near = int(state[one.run]) <= (held.run_mm + 1) * NM_PER_MM
            return cycle if near and state[one.forwards] else None
    return None
