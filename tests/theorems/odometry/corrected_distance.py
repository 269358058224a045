"""The correction of `safeloc.models.vocabulary.reading_rates` as a machine, in a world in which a unit over-reads and under-reads by different rates.

Its claim is the law that machines with symmetric rates assume of the corrected distance. It is proved for distances of any length and
number. The remainder of the rounding is the one-off part of the error.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.expr import Bool, Expr, NumVar, Var, floor_div, ite, maximum, number, with_unit
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import Property, always, earlier_num
from safeloc.language.units import COUNT, MM, NM, PPM_PER_ONE
from safeloc.language.world import Law, World
from safeloc.models.vocabulary.error_law import ErrorLaw
from safeloc.models.vocabulary.reading_rates import ReadingRates

FARTHEST_MM = 20_000
"""The longest measured distance of a cycle: 500 km/h, in cycles of some 140 ms."""
_HALF_NM = 2
"""Half nanometres in a nanometre: half of an odd difference of two rates is a whole number of them."""
_ONE_MM = PPM_PER_ONE * _HALF_NM


@dataclass(frozen=True, eq=False)
class Corrected:
    """The machine and its variables.

    measured   input: the distance of the cycle, mm
    true       of the world: the run of the cycle, nm
    corrected  state: the corrected distance of the cycle, mm
    carried    state: the remainder of its rounding, half nm
    """

    machine: Machine
    measured: NumVar
    true: NumVar
    corrected: NumVar
    carried: NumVar


def corrected_distance(rates: ReadingRates, *, shift_ppm: int | None = None) -> Corrected:
    """Return the machine for these rates; `shift_ppm`: another difference of the rates in the correction, to try a wrong one."""
    (running,) = table = modes("RUNNING")
    difference = rates.under_ppm - rates.over_ppm if shift_ppm is None else shift_ppm
    measured = number("measured_mm", MM, -FARTHEST_MM, FARTHEST_MM)
    true = number("true_run_nm", NM, -3 * FARTHEST_MM * PPM_PER_ONE, 3 * FARTHEST_MM * PPM_PER_ONE)
    corrected = number("corrected_mm", MM, -3 * FARTHEST_MM, 3 * FARTHEST_MM)
    carried = number("carried_half_nm", COUNT, -_ONE_MM // 2, _ONE_MM // 2 - 1)
    exact = with_unit(measured, COUNT) * (_ONE_MM + difference) + carried
    rounded = floor_div(exact + _ONE_MM // 2, _ONE_MM)
    update: dict[Var, Expr] = {corrected: with_unit(rounded, MM), carried: exact - rounded * _ONE_MM}
    machine = Machine(
        name="corrected_distance",
        modes=table,
        inputs=[measured],
        state={corrected: 0, carried: 0},
        outputs={"corrected_mm": corrected},
        transitions=[Transition("correct", running, running, set=update)],
        world=World(
            ghosts={},
            choices=[true],
            moves={},
            clauses={
                "the unit over-reads and under-reads by no more than its rates": Law(
                    _within(rates, measured, true),
                    "The vehicle runs farther than the unit measures by no more than one rate, and less far by no more than another.",
                    owner="supplier",
                )
            },
        ),
        doc="Corrects the distances of a unit that over-reads and under-reads by different rates.",
    )
    return Corrected(machine, measured, true, corrected, carried)


def _within(rates: ReadingRates, measured: NumVar, true: NumVar) -> Bool:
    """Return whether the run lies between the measured distance less the one rate and the distance and the other, in its direction."""
    length, back = with_unit(maximum(measured, -measured), NM), measured < 0
    farther = ite(back, with_unit(measured, NM) * PPM_PER_ONE - true, true - with_unit(measured, NM) * PPM_PER_ONE)
    return (farther <= length * rates.under_ppm) & (-farther <= length * rates.over_ppm)


def lawful(made: Corrected, law: ErrorLaw, period_ms: int) -> Property:
    """Return the claim: the error of a corrected distance, without its one-off part, is within the symmetric law."""
    wander = made.carried - earlier_num(made.carried)
    error = with_unit(made.true, COUNT) * _HALF_NM - with_unit(made.corrected, COUNT) * _ONE_MM - wander
    length = with_unit(maximum(made.corrected, -made.corrected), COUNT)
    most = (length * law.rate_ppm + law.floor_mm_s * period_ms * 1_000) * _HALF_NM
    return always("corrected distances keep the symmetric law", (error <= most) & (-error <= most))


def one_off(made: Corrected, law: ErrorLaw) -> Property:
    """Return the claim: the one-off part wanders within half the constant of the law."""
    half = law.constant_mm * _ONE_MM // 2
    return always("the remainder is within the constant", (made.carried <= half) & (-made.carried <= half))
