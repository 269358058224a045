"""One end of a train on a fibre with sections, timed: the place by sections, checked by the time of flight (FWG-1 to FWG-15).

    course          no machine on board: the true course of the end
    time_of_flight  time T and distance Ls along the fibre, and the place along the track          models.time_of_flight
    additional      which place by time of flight is compared                                      fibre_timed.additional
    fibre           the place by sections; error signal F if the two differ by more than a threshold  models.fibre

All act in one step. `fibre` by itself takes the additional place as it comes; here it is the place that the time of flight gives in this
very cycle, and no input of the whole. That its bounds contain the end is not assumed: the containment of `time_of_flight` proves it.

A place is compared only where a true one cannot differ by more than the threshold. So F for this reason shows a broken law: of light,
pattern, cable or sections. The threshold is fixed, as the source has it (l. 91 to 93, claim 7); its least figure follows from the errors
of light, cable and sections (`FibreTimedConfig`), and a smaller one is refused.

Reflecting points stay an input of `fibre`: whether a pattern coincides with one is what the detector reports.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.composition import Clause, Composition, compose
from safeloc.language.expr import Expr, Var, as_num, ite
from safeloc.language.units import MM
from safeloc.models import fibre, time_of_flight
from safeloc.models.fibre import Fibre
from safeloc.models.fibre_timed.additional import TRUE_PLACE, Additional, additional
from safeloc.models.fibre_timed.additional import Parts as AdditionalParts
from safeloc.models.fibre_timed.configuration import FibreTimedConfig
from safeloc.models.fibre_timed.course import course
from safeloc.models.time_of_flight import TimeOfFlight
from safeloc.models.vocabulary.absent import wired_interval
from safeloc.models.vocabulary.vehicle_world import ON_THE_LINE

__all__ = ["FibreTimed", "FibreTimedConfig", "compose_machines"]
NAME = "fibre_timed"


@dataclass(frozen=True, eq=False)
class FibreTimed:
    """The composition and its machines."""

    config: FibreTimedConfig
    composition: Composition
    flight: TimeOfFlight
    additional: Additional
    sections: Fibre


def compose_machines(config: FibreTimedConfig | None = None) -> FibreTimed:
    """Compose the device of one end; all machines share one truth."""
    config = config or FibreTimedConfig()
    located, timed = fibre.parts(config.fibre), time_of_flight.parts(config.time_of_flight)
    flight, sections = time_of_flight.build(timed), fibre.build(located)
    compared = additional(AdditionalParts(config, located, timed))
    truth, amplitude = located.ghosts.truth, located.amplitude
    wires: dict[Var, Expr] = {
        timed.next_truth: truth,
        compared.own.next_truth: truth,
        **_place(flight, compared.own),
        **_compared(compared, sections),
    }
    whole = compose(
        NAME,
        [course(located), flight.machine, compared.machine, sections.machine],
        wires,
        shared=[truth, located.ghosts.true_run, amplitude.value, amplitude.present],
        discharge=[Clause(compared.machine, TRUE_PLACE), Clause(sections.machine, ON_THE_LINE)],
    )
    return FibreTimed(config, whole, flight, compared, sections)


def _place(flight: TimeOfFlight, to: AdditionalParts) -> dict[Var, Expr]:
    """Return the wires of the place by time of flight, with its margins."""
    position, below, above = wired_interval(flight.machine)
    placed = flight.machine.flag("valid")
    return {to.position.present: placed, to.position.value: position, to.below: below, to.above: above}


def _compared(compared: Additional, sections: Fibre) -> dict[Var, Expr]:
    """Return the wires of the place that the fibre machine compares with that of its sections."""
    handed, to = compared.machine.flag("compared"), sections.own.flight_position
    return {to.present: handed, to.value: ite(handed, compared.own.place, as_num(0, MM))}
