"""A balise reading as the reflector machine gets it: the balise machine has checked it already (RFL-5).

It gives an absolute interval and starts the reference measurement. The telegram, else the map, else a variable of the
system prescribes the distance from the balise to the first reflector behind it (source l. 205).
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.declared import Declared
from safeloc.language.expr import Bool, Lit, Num, Optional, abs_, as_num, exact_to, ite, optional
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM, PPM
from safeloc.models.reflector.odometer import ReflectorOdometer
from safeloc.models.vocabulary.interval import Interval


@dataclass(frozen=True, eq=False)
class BaliseReading:
    """Inputs of one reading, absent in most cycles. Lengths in mm.

    position   place of end A when it passes the balise
    since      distance run since then, as latched by the counters
    reference  telegram: distance from balise to reflector
    search_from     telegram: distance after the balise from which on the reflector is searched (RFL-8)
    """

    identity: Optional
    position: Optional
    accuracy: Optional
    since: Optional
    reference: Optional
    search_from: Optional
    accuracy_mm: int
    latency_ppm: int
    law_ppm: int

    @property
    def read(self) -> Bool:
        """The vehicle read a balise of this line."""
        return self.identity.present & self.position.present

    @property
    def run(self) -> Num:
        """Distance run since the vehicle passed the balise, mm."""
        return self.since.value_or(as_num(0, MM))

    def fix(self, odometer: ReflectorOdometer) -> Interval:
        """Return the interval of end A at the end of the cycle by this reading."""
        accuracy = exact_to(self.accuracy.value_or(as_num(self.accuracy_mm, MM)), NM)
        own = accuracy + abs_(self.run) * Lit(self.law_ppm, PPM)
        late, untimed = odometer.lag(self.latency_ppm), odometer.lag(NM_PER_MM)
        forward, backward = (ite(self.since.present, a, b) for a, b in zip(late, untimed, strict=True))
        return Interval(self.position.value + self.run, own + forward, own + backward)


def balise_reading(
    declared: Declared,
    limit_mm: int,
    max_cycle_distance_mm: int,
    range_limit_mm: int,
    last_identity: int,
    *,
    accuracy_mm: int,
    latency_ppm: int,
    law_ppm: int,
) -> BaliseReading:
    """Return fresh inputs `balise_...`."""
    return BaliseReading(
        declared.sensor(optional("balise", COUNT, 1, last_identity)),
        declared.sensor(optional("balise_position_mm", MM, -limit_mm, limit_mm)),
        declared.sensor(optional("balise_accuracy_mm", MM, 0, 100_000)),
        declared.sensor(optional("balise_since_mm", MM, -max_cycle_distance_mm, max_cycle_distance_mm)),
        declared.sensor(optional("balise_reference_mm", MM, 0, range_limit_mm)),
        declared.sensor(optional("balise_search_from_mm", MM, 0, range_limit_mm)),
        accuracy_mm,
        latency_ppm,
        law_ppm,
    )
